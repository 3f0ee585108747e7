//! Bodies and muscles as solids in space: the geometry that figures and page share.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::kinematics::Pose;
use crate::model::system::{Attachment, Shape, System};

/// Points around a circle.
pub const AROUND: usize = 48;

/// Circle of `radius` about `centre` in the plane of the orthonormal `a`, `b`; lengths in mm.
pub fn circle(
    centre: Vector3<f64>,
    a: Vector3<f64>,
    b: Vector3<f64>,
    radius: f64,
) -> Vec<Vector3<f64>> {
    (0..AROUND)
        .map(|i| {
            let (s, c) = (TAU * i as f64 / AROUND as f64).sin_cos();
            centre + radius * (c * a + s * b)
        })
        .collect()
}

/// A box that may be skewed: corner `i` is at + or − along edge `j` as bit `j` of `i` is set or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// Centre in mm.
    pub centre: Vector3<f64>,
    /// Half of each edge in mm; the third runs along the length.
    pub halves: [Vector3<f64>; 3],
}

/// A face of a prism: its outward normal, not of unit length, and its corners in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Outward normal.
    pub normal: Vector3<f64>,
    /// Corners in mm.
    pub corners: [Vector3<f64>; 4],
}

impl Prism {
    /// A box along the directors of a pose, with edge lengths in mm.
    pub fn block(pose: &Pose, size: [f64; 3]) -> Self {
        let half = |i: usize| pose.directors.column(i) * (size[i] / 2.0);
        Self {
            centre: pose.centre,
            halves: [half(0), half(1), half(2)],
        }
    }

    /// A muscle at instant `k`: sides of its cross-section follow its body and shrink as 1/√Λ,
    /// so that the volume stays.
    pub fn muscle(system: &System, trajectory: &Trajectory, k: usize, muscle: usize) -> Self {
        let muscle = &system.muscles[muscle];
        let from = trajectory.point(k, &muscle.from, system);
        let to = trajectory.point(k, &muscle.to, system);
        let span = to - from;
        let length = span.norm().max(1e-9);
        let rest = (muscle.to.at - muscle.from.at).norm();
        let shrink = (rest / length).sqrt();
        let (a, b) = section_axes(
            &muscle.from,
            &muscle.to,
            &trajectory.poses[k],
            span / length,
        );
        let [width, depth] = muscle.cross_section.map(|side| side * shrink / 2.0);
        Self {
            centre: (from + to) / 2.0,
            halves: [a * width, b * depth, span / 2.0],
        }
    }

    /// The eight corners in mm.
    pub fn corners(&self) -> [Vector3<f64>; 8] {
        std::array::from_fn(|i| {
            let sign = |j: usize| if i >> j & 1 == 1 { 1.0 } else { -1.0 };
            self.centre
                + (0..3)
                    .map(|j| self.halves[j] * sign(j))
                    .sum::<Vector3<f64>>()
        })
    }

    /// The six faces.
    pub fn faces(&self) -> [Face; 6] {
        std::array::from_fn(|i| {
            let (axis, sign) = (i / 2, if i % 2 == 0 { 1.0 } else { -1.0 });
            let out = self.halves[axis] * sign;
            let (a, b) = (self.halves[(axis + 1) % 3], self.halves[(axis + 2) % 3]);
            let middle = self.centre + out;
            Face {
                normal: a.cross(&b) * a.cross(&b).dot(&out).signum(),
                corners: [
                    middle - a - b,
                    middle + a - b,
                    middle + a + b,
                    middle - a + b,
                ],
            }
        })
    }
}

/// Two orthonormal directions across a span: the body's director that lies most across it, made normal, and the third.
fn section_axes(
    from: &Attachment,
    to: &Attachment,
    poses: &[Pose],
    along: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let directors = match to.body.or(from.body) {
        Some(body) => poses[body].directors,
        None => nalgebra::Matrix3::identity(),
    };
    let across = (0..3)
        .map(|i| directors.column(i).into_owned())
        .min_by(|a, b| a.dot(&along).abs().total_cmp(&b.dot(&along).abs()))
        .unwrap_or_else(Vector3::x);
    let a = (across - along * across.dot(&along)).normalize();
    (a, along.cross(&a))
}

/// The line across a side face at `height` from −1 to 1 along the length of its prism.
pub(super) fn slice(
    corners: &[Vector3<f64>; 4],
    half: &Vector3<f64>,
    centre: Vector3<f64>,
    height: f64,
) -> Vec<Vector3<f64>> {
    let at = |p: &Vector3<f64>| (p - centre).dot(half) / half.norm_squared();
    let edges = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
    edges
        .filter(|(a, b)| (at(a) - height) * (at(b) - height) < 0.0)
        .map(|(a, b)| a + (b - a) * ((height - at(&a)) / (at(&b) - at(&a))))
        .collect()
}

/// Vertices in mm and triangles of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceMesh {
    /// Vertices in mm.
    pub vertices: Vec<Vector3<f64>>,
    /// Vertices of each triangle.
    pub triangles: Vec<[usize; 3]>,
}

impl SurfaceMesh {
    /// Adds the surface of a body.
    pub fn add_body(&mut self, shape: &Shape, pose: &Pose) {
        match *shape {
            Shape::Cylinder { length, radius } => {
                self.add_rings(pose, &[(-length / 2.0, radius), (length / 2.0, radius)]);
            }
            Shape::Sphere { radius } => {
                let rings: Vec<_> = (0..=12)
                    .map(|i| (TAU / 24.0 * f64::from(i)).sin_cos())
                    .map(|(s, c)| (-radius * c, radius * s))
                    .collect();
                self.add_rings(pose, &rings);
            }
            Shape::Box { size } => self.add_prism(&Prism::block(pose, size)),
            Shape::None => {}
        }
    }

    /// Adds the surface of a prism.
    pub fn add_prism(&mut self, prism: &Prism) {
        for face in prism.faces() {
            let n = self.vertices.len();
            self.vertices.extend(face.corners);
            self.triangles
                .extend([[n, n + 1, n + 2], [n, n + 2, n + 3]]);
        }
    }

    /// Adds the surface of revolution about d₃ through rings of (height, radius), closed by flat ends.
    fn add_rings(&mut self, pose: &Pose, rings: &[(f64, f64)]) {
        const SIDES: usize = 24;
        let [d1, d2, d3] = [0, 1, 2].map(|i| pose.directors.column(i).into_owned());
        let first = self.vertices.len();
        for (height, radius) in rings {
            let centre = pose.centre + d3 * *height;
            let ring = circle(centre, d1, d2, *radius);
            self.vertices.extend(ring.iter().step_by(AROUND / SIDES));
        }
        let vertex = |ring: usize, side: usize| first + ring * SIDES + side % SIDES;
        for ring in 1..rings.len() {
            for side in 0..SIDES {
                let (a, b) = (vertex(ring - 1, side), vertex(ring - 1, side + 1));
                let (c, d) = (vertex(ring, side), vertex(ring, side + 1));
                self.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        for ring in [0, rings.len() - 1] {
            for side in 1..SIDES - 1 {
                self.triangles
                    .push([vertex(ring, 0), vertex(ring, side), vertex(ring, side + 1)]);
            }
        }
    }
}
