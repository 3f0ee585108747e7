//! Drifts of the bodies of a tree of joints.
//!
//! A joint at the place a turns its child about a: a point of the child at the reference place X is at `x_a + R (X − a)` with the rotation R of
//! the child from the reference configuration, and x_a is a point of the parent at the place a. Where a parameter π moves the places, the
//! point moves by the drift D of its body and by its own place,
//!
//! ```text
//! ∂x/∂π = D + R ∂X/∂π,     D_child = D_parent + (R_parent − R_child) ∂a/∂π,     D_ground = 0,
//! ```
//!
//! which are directions fixed in bodies: at given coordinates of the joints x is linear in π.

use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::constants::constant::{Constant, Drifts, Parameter};
use crate::model::presolve::graph::Graph;
use crate::model::presolve::presolved::{BodyLocation, Presolved};
use crate::model::system::System;

/// Drifts of the bodies of a scene and its presolved system; nothing where nothing is free.
pub(crate) fn of_tree(
    parameters: &[Parameter],
    system: &System,
    presolved: &Presolved,
    graph: &Graph,
    reference: &[Pose],
) -> Drifts {
    if parameters.is_empty() {
        return Drifts::default();
    }
    let of = |parameter: &Parameter| drifts(parameter, system, presolved, graph, reference);
    let is_place = |parameter: &Parameter| {
        let mut constants = parameter.constants.iter();
        constants.any(|one| one.constant.is_place())
    };
    Drifts {
        of: match parameters.iter().any(is_place) {
            false => Vec::new(),
            true => parameters.iter().map(of).collect(),
        },
        reference: reference.to_vec(),
    }
}

/// Drifts of all bodies by a parameter, from the ground outwards.
fn drifts(
    parameter: &Parameter,
    system: &System,
    presolved: &Presolved,
    graph: &Graph,
    reference: &[Pose],
) -> Vec<MaterialVector> {
    let mut drifts = vec![MaterialVector::default(); reference.len()];
    for &body in graph.free() {
        let moved = of_centre(parameter, system, presolved, body);
        drifts[body] = step(
            &MaterialVector::default(),
            [None, Some(body)],
            &moved,
            reference,
        );
    }
    for branch in graph.outwards() {
        let joint = presolved.joints[branch.joint];
        let moved = parameter.moves(|axis| Constant::JointPlace(joint, axis));
        let (from, to) = (branch.from, branch.to);
        let before = from.map_or_else(MaterialVector::default, |body| drifts[body].clone());
        drifts[to] = step(&before, [from, Some(to)], &moved, reference);
    }
    drifts
}

/// `D + (R_parent − R_child) ∂a/∂π`.
fn step(
    of_parent: &MaterialVector,
    [parent, child]: [Option<usize>; 2],
    moved: &Vector,
    reference: &[Pose],
) -> MaterialVector {
    if *moved == Vector::zeros() {
        return of_parent.clone();
    }
    let [parent, child] =
        [parent, child].map(|body| MaterialVector::direction(body, moved, reference));
    let turned = MaterialVector::combine(1.0, &parent, -1.0, &child);
    MaterialVector::combine(1.0, of_parent, 1.0, &turned)
}

/// Motion of the centre of mass of a body that floats, the mean over those that are welded to it.
fn of_centre(parameter: &Parameter, system: &System, presolved: &Presolved, body: usize) -> Vector {
    let (mut moved, mut mass) = (Vector::zeros(), 0.0);
    for (b, place) in presolved.bodies.iter().enumerate() {
        let (BodyLocation::Body(to) | BodyLocation::Welded { to, .. }) = *place else {
            continue;
        };
        if to == body {
            let own = system.bodies[b].mass;
            moved += parameter.moves(|axis| Constant::BodyPlace(b, axis)) * own;
            mass += own;
        }
    }
    moved / mass
}
