//! Rigid bodies and their shapes.

use crate::kinematics::Pose;
use crate::mesh::error::MeshError;
use crate::mesh::triangulated::{Surface, rings_of_sphere};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A rigid body in the reference configuration.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Unique name.
    pub name: String,
    /// Mass in g.
    pub mass: f64,
    /// Principal moments of inertia about the centre of mass in g mm².
    pub inertia: [f64; 3],
    /// Centre of mass in mm.
    pub centre: Vector3<f64>,
    /// Principal axes as columns: the directors d₁, d₂, d₃.
    pub directors: Matrix3<f64>,
    /// Shape, for pictures.
    pub shape: Shape,
}

/// Outline of a body about its centre, in its director frame, in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Cylinder along d₃.
    Cylinder {
        /// Length along d₃.
        length: f64,
        /// Radius.
        radius: f64,
    },
    /// Box with edges along the directors.
    Box {
        /// Edge lengths.
        size: [f64; 3],
    },
    /// Sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// Surface of triangles.
    Surface(Arc<Surface>),
    /// Not drawn.
    None,
}

impl Shape {
    /// Its sizes in mm: length and radius of a cylinder, edges of a box, radius of a sphere.
    pub(crate) fn size_mut(&mut self, index: usize) -> Option<&mut f64> {
        match (self, index) {
            (Self::Cylinder { length, .. }, 0) => Some(length),
            (Self::Cylinder { radius, .. }, 1) | (Self::Sphere { radius }, 0) => Some(radius),
            (Self::Box { size }, _) => size.get_mut(index),
            _ => None,
        }
    }
}

impl Body {
    /// Pose in the reference configuration.
    pub fn pose(&self) -> Pose {
        Pose {
            centre: self.centre,
            directors: self.directors,
        }
    }

    /// A homogeneous body without a mass yet, within a closed surface in the ground frame: centre of mass and principal axes are those of
    /// the solid.
    ///
    /// # Errors
    /// As of [`Surface::enclosed`].
    pub fn within(surface: Surface) -> Result<Self, MeshError> {
        let solid = surface.enclosed()?;
        let (_, directors) = principal(&solid.inertia());
        let centre = solid.centre;
        let shape = Shape::surface(surface, &Pose { centre, directors });
        Ok(Self {
            centre,
            directors,
            ..Self::from_shape(shape)
        })
    }

    /// A body at the origin without a name and a mass.
    pub(crate) fn from_shape(shape: Shape) -> Self {
        Self {
            name: String::new(),
            mass: 0.0,
            inertia: [0.0; 3],
            centre: Vector3::zeros(),
            directors: Matrix3::identity(),
            shape,
        }
    }
}

/// Off-diagonal entries of a tensor below this part of its trace are those of rounding.
const DIAGONAL: f64 = 1e-12;

/// Principal moments of a symmetric tensor, and right-handed principal axes as columns; the axes of the frame where the tensor is diagonal.
pub fn principal(tensor: &Matrix3<f64>) -> ([f64; 3], Matrix3<f64>) {
    match is_diagonal(tensor) {
        true => (tensor.diagonal().into(), Matrix3::identity()),
        false => eigen(tensor),
    }
}

/// Returns true if off-diagonal entries of a tensor of inertia are those of rounding.
pub fn is_diagonal(tensor: &Matrix3<f64>) -> bool {
    let across = tensor - Matrix3::from_diagonal(&tensor.diagonal());
    across.amax() <= DIAGONAL * tensor.trace()
}

/// Eigenvalues of a symmetric tensor, and right-handed eigenvectors as columns.
pub(crate) fn eigen(tensor: &Matrix3<f64>) -> ([f64; 3], Matrix3<f64>) {
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = SymmetricEigen::new(*tensor);
    let mut directors = eigenvectors;
    if directors.determinant() < 0.0 {
        directors.column_mut(2).neg_mut();
    }
    (eigenvalues.into(), directors)
}

impl Shape {
    /// Principal moments of a homogeneous body of a mass in g about its centre, in its director frame, in g mm².
    pub fn inertia(&self, mass: f64) -> [f64; 3] {
        match *self {
            Self::Surface(ref surface) => surface.enclosed().map_or([f64::NAN; 3], |solid| {
                (solid.inertia().diagonal() * (mass / solid.volume)).into()
            }),
            Self::Cylinder { length, radius } => {
                let transverse = mass * (3.0 * radius.powi(2) + length.powi(2)) / 12.0;
                [transverse, transverse, mass * radius.powi(2) / 2.0]
            }
            Self::Box { size } => {
                let [a, b, c] = size.map(|side| side.powi(2));
                [b + c, c + a, a + b].map(|sum| mass * sum / 12.0)
            }
            Self::Sphere { radius } => [0.4 * mass * radius.powi(2); 3],
            Self::None => [0.0; 3],
        }
    }

    /// Volume in mm³; `None` without one.
    pub fn volume(&self) -> Option<f64> {
        match *self {
            Self::Cylinder { length, radius } => Some(PI * radius.powi(2) * length),
            Self::Box { size } => Some(size.iter().product()),
            Self::Sphere { radius } => Some(4.0 / 3.0 * PI * radius.powi(3)),
            Self::Surface(ref surface) => surface.enclosed().ok().map(|solid| solid.volume),
            Self::None => None,
        }
    }

    /// A surface in the ground frame as the shape of a body in a pose.
    pub fn surface(surface: Surface, pose: &Pose) -> Self {
        let turned = pose.directors.transpose();
        let own = surface.transformed(|x| turned * (x - pose.centre));
        Self::Surface(Arc::new(own))
    }

    /// Adds the surface of a body in a pose.
    pub fn add_to(&self, surface: &mut Surface, pose: &Pose) {
        let axes = [0, 1, 2].map(|i| pose.directors.column(i).into_owned());
        match *self {
            Self::Cylinder { length, radius } => {
                let rings = [(-length / 2.0, radius), (length / 2.0, radius)];
                surface.add_rings(pose.centre, axes, &rings);
            }
            Self::Sphere { radius } => {
                surface.add_rings(pose.centre, axes, &rings_of_sphere(radius));
            }
            Self::Box { size } => {
                let halves = [0, 1, 2].map(|i| axes[i] * (size[i] / 2.0));
                surface.add_box(pose.centre, &halves);
            }
            Self::Surface(ref own) => {
                let placed = |x| pose.centre + pose.directors * x;
                surface.add(&own.as_ref().clone().transformed(placed));
            }
            Self::None => {}
        }
    }
}

/// Right-handed directors with d₃ along a unit axis; a permutation of the ground axes for one of them.
pub fn directors_along(axis: &Vector3<f64>) -> Matrix3<f64> {
    let least = (axis.iamax() + 1) % 3;
    let helper = Vector3::ith(least, 1.0);
    let first = (helper - axis * axis[least]).normalize();
    Matrix3::from_columns(&[first, axis.cross(&first), *axis])
}

/// A material point of a body, or of the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attachment {
    /// The body; `None` is the ground.
    pub body: Option<usize>,
    /// Place in the reference configuration in mm, in the ground frame.
    pub at: Vector3<f64>,
}

impl Attachment {
    /// Its place in mm at poses of the bodies, those of the reference configuration given too.
    pub fn place(&self, poses: &[Pose], reference: impl Fn(usize) -> Pose) -> Vector3<f64> {
        match self.body {
            None => self.at,
            Some(body) => poses[body].point(&reference(body).local(&self.at)),
        }
    }
}
