//! Terms of rigid bodies.

use crate::functional::Mass;
use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::system::Body;
use crate::model::terms::Terms;

const INERTIA: &str = "body inertia";

/// Inertia and weight of the bodies that are solved for: the mass at the centre, and on each director dᵢ the Euler inertia
/// E_i = ½ (J_j + J_k − J_i).
pub(in crate::model) fn build(bodies: &[Body], reference: &[Pose], terms: &mut Terms<'_>) {
    if bodies.is_empty() {
        terms.without(INERTIA, "no body that moves");
    }
    for (b, body) in bodies.iter().enumerate() {
        let centre = MaterialVector::point(Some(b), &body.centre, reference);
        terms.weigh(&centre, body.mass);
        if terms.is_of_motion() {
            let centre = terms.vector(centre);
            terms.collect(
                INERTIA,
                "mass of",
                &body.name,
                Mass::point(centre, body.mass),
            );
            let [j1, j2, j3] = body.inertia;
            let euler = [j2 + j3 - j1, j3 + j1 - j2, j1 + j2 - j3];
            for (i, euler) in euler.into_iter().enumerate().filter(|(_, e)| *e != 0.0) {
                let axis: Vector = body.directors.column(i).into();
                let director = MaterialVector::direction(Some(b), &axis, reference);
                let mass = Mass::point(terms.vector(director), 0.5 * euler);
                terms.collect(INERTIA, "mass of", &body.name, mass);
            }
        } else {
            terms.without(INERTIA, "a state of rest has no inertia");
        }
    }
}
