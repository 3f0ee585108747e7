//! Immobile parts of a system: bodies, blocks and muscles at rest on which no force acts.
//!
//! In the reference configuration muscles and blocks are free of stress, so that weight and electric fields are the only
//! forces. Joints, muscles and glue connect bodies. Two parts fixed to the ground are not thereby connected.

use crate::math::DisjointSets;
use crate::model::analysis::Analysis;
use crate::model::constant::Constant;
use crate::model::field_extent;
use crate::model::system::{Joint, System};

/// Parts of a scene that rest all the time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Immobile {
    /// For each body, true if it rests.
    pub bodies: Vec<bool>,
    /// For each block of the scene, true if it rests.
    pub solids: Vec<bool>,
    /// For each muscle, true if it rests.
    pub muscles: Vec<bool>,
}

/// Returns the immobile parts of a system whose sources at zero voltage drive nothing any more.
pub(super) fn immobile(system: &System, question: &Analysis) -> Immobile {
    let counts = [
        system.bodies.len(),
        system.solids.len(),
        system.muscles.len(),
    ];
    let [of_bodies, of_solids, of_muscles] = counts;
    let Some(stirred) = &question.stirred else {
        return Immobile {
            bodies: vec![false; of_bodies],
            solids: vec![false; of_solids],
            muscles: vec![false; of_muscles],
        };
    };
    let (first_solid, first_muscle) = (of_bodies, of_bodies + of_solids);
    let count = counts.iter().sum();
    let mut parts = DisjointSets::new(count);
    // The ground, which is no part, hangs together with nothing.
    let mut join = |a: Option<usize>, b: usize| {
        if let Some(a) = a {
            parts.join(a, b);
        }
    };
    for joint in &system.joints {
        join(joint.parent, joint.child);
    }
    for (m, muscle) in system.muscles.iter().enumerate() {
        for end in [&muscle.from, &muscle.to] {
            join(end.body, first_muscle + m);
        }
    }
    for (s, solid) in system.solids.iter().enumerate() {
        for glue in &solid.glued {
            join(glue.body, first_solid + s);
        }
    }
    let weighs = system.gravity.is_some();
    let mut moved: Vec<usize> = Vec::new();
    let is_sought = |spring: usize| {
        let constants = question.parameters.iter().flat_map(|p| &p.constants);
        constants
            .into_iter()
            .any(|c| c.constant == Constant::SpringLength(spring))
    };
    for (index, component) in system.components.iter().enumerate() {
        let points = component.points();
        let bodies: Vec<usize> = points.iter().filter_map(|point| point.body).collect();
        for pair in bodies.windows(2) {
            join(Some(pair[0]), pair[1]);
        }
        // Springs come first.
        if component.is_prestressed() || is_sought(index) {
            moved.extend(bodies);
        }
    }
    let is_loaded = |joint: &&Joint| joint.spring.is_some_and(|spring| spring.rest != 0.0);
    let loaded = system.joints.iter().filter(is_loaded);
    moved.extend(loaded.flat_map(|joint| joint.parent.into_iter().chain([joint.child])));
    let bodies = (0..of_bodies).filter(|b| weighs || stirred.bodies.contains(b));
    moved.extend(bodies);
    for (s, solid) in system.solids.iter().enumerate() {
        let is_heavy = weighs && solid.materials.iter().any(|m| m.density.is_some());
        let starts = solid.velocities.iter().any(|v| v.norm() > 0.0);
        if is_heavy
            || starts
            || stirred.solids.contains(&s)
            || field_extent::dielectric(solid).contains(&true)
        {
            moved.push(first_solid + s);
        }
    }
    for (m, muscle) in system.muscles.iter().enumerate() {
        let is_heavy = weighs && muscle.material.density.is_some();
        if muscle.material.electric.is_some() || is_heavy {
            moved.push(first_muscle + m);
        }
    }
    let set_of = parts.all();
    let mut is_moved = vec![false; count];
    for part in moved {
        is_moved[set_of[part]] = true;
    }
    let rests = |from: usize, count: usize| (from..from + count).map(|i| !is_moved[set_of[i]]);
    Immobile {
        bodies: rests(0, of_bodies).collect(),
        solids: rests(first_solid, of_solids).collect(),
        muscles: rests(first_muscle, of_muscles).collect(),
    }
}
