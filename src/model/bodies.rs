//! Rigid bodies and their shapes.

use crate::kinematics::Pose;
use nalgebra::{Matrix3, Vector3};

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
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Not drawn.
    None,
}

impl Body {
    /// Pose in the reference configuration.
    pub fn pose(&self) -> Pose {
        Pose {
            centre: self.centre,
            directors: self.directors,
        }
    }
}

impl Shape {
    /// Principal moments of a homogeneous body of a mass in g about its centre, in its director frame, in g mm².
    pub fn inertia(&self, mass: f64) -> [f64; 3] {
        match *self {
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
}

/// Right-handed directors with d₃ along a unit axis; a permutation of the ground axes for one of them.
pub fn directors_along(axis: &Vector3<f64>) -> Matrix3<f64> {
    let least = (axis.iamax() + 1) % 3;
    let helper = Vector3::ith(least, 1.0);
    let first = (helper - axis * axis[least]).normalize();
    Matrix3::from_columns(&[first, axis.cross(&first), *axis])
}
