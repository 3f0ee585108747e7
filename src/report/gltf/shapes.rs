//! Triangles of bodies, muscles, markers and surfaces.

use nalgebra::{Matrix3, Vector3};

use crate::kinematics::Pose;
use crate::mesh::triangulated::Surface;
use crate::model::system::Shape;

/// Length in m of a length in mm.
pub(super) const METRE: f64 = 1e-3;

/// A body in its own frame, in m.
pub(super) fn body(shape: &Shape) -> Surface {
    let own = Pose {
        centre: Vector3::zeros(),
        directors: Matrix3::identity(),
    };
    let mut mesh = Surface::default();
    shape.add_to(&mut mesh, &own);
    for vertex in &mut mesh.vertices {
        *vertex *= METRE;
    }
    mesh
}

/// A ball about the origin.
pub(super) fn sphere(radius: f64) -> Surface {
    body(&Shape::Sphere {
        radius: radius / METRE,
    })
}

/// A cube of edge 2 about the origin.
pub(super) fn cube() -> Surface {
    let mut mesh = Surface::default();
    let halves = [Vector3::x(), Vector3::y(), Vector3::z()];
    mesh.add_box(Vector3::zeros(), &halves);
    mesh
}

/// Two triangles for each quadrilateral.
pub(super) fn triangles(quads: &[[usize; 4]]) -> Vec<[usize; 3]> {
    let halves = |&[a, b, c, d]: &[usize; 4]| [[a, b, c], [a, c, d]];
    quads.iter().flat_map(halves).collect()
}
