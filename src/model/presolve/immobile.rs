//! Immobile parts of a system: bodies, blocks and muscles at rest on which no force acts.
//!
//! Without prestretch, muscles and blocks are free of stress in the reference configuration: weight, electric fields and loads are then the only
//! forces. Joints, muscles and glue connect bodies. Two parts fixed to the ground are not thereby connected.

use crate::math::DisjointSets;
use crate::model::analysis::{Analysis, InitiallyMoving};
use crate::model::components::LoadPlace;
use crate::model::components::component::Component;
use crate::model::constants::constant::Constant;
use crate::model::system::System;
use crate::model::terms::field_extent;
use std::collections::BTreeSet;

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

/// Returns the immobile parts of a scene, in whose `system` sources at zero voltage drive nothing any more.
pub(crate) fn immobile(scene: &System, system: &System, analysis: &Analysis) -> Immobile {
    let parts = Parts {
        bodies: system.bodies.len(),
        solids: system.solids.len(),
        muscles: system.muscles.len(),
    };
    let Some(initially_moving) = &analysis.initially_moving else {
        return parts.resting(|_| false);
    };
    let set_of = parts.connected(system).all();
    let mut is_moved = vec![false; parts.count()];
    for part in parts.moved([scene, system], initially_moving, analysis) {
        is_moved[set_of[part]] = true;
    }
    parts.resting(|part| !is_moved[set_of[part]])
}

/// Numbers of the parts of a system, which are counted through: bodies, blocks, muscles.
#[derive(Clone, Copy)]
struct Parts {
    bodies: usize,
    solids: usize,
    muscles: usize,
}

impl Parts {
    fn solid(self, s: usize) -> usize {
        self.bodies + s
    }

    fn muscle(self, m: usize) -> usize {
        self.bodies + self.solids + m
    }

    fn count(self) -> usize {
        self.muscle(self.muscles)
    }

    /// The parts for which `rests` holds.
    fn resting(self, rests: impl Fn(usize) -> bool) -> Immobile {
        Immobile {
            bodies: (0..self.bodies).map(&rests).collect(),
            solids: (0..self.solids).map(|s| rests(self.solid(s))).collect(),
            muscles: (0..self.muscles).map(|m| rests(self.muscle(m))).collect(),
        }
    }

    /// Sets of parts that joints, muscles, glue and components connect.
    fn connected(self, system: &System) -> DisjointSets {
        let mut sets = DisjointSets::new(self.count());
        // The ground is no part, and connects nothing.
        let mut join = |a: Option<usize>, b: usize| {
            if let Some(a) = a {
                sets.join(a, b);
            }
        };
        for joint in &system.joints {
            join(joint.parent, joint.child);
        }
        for (m, muscle) in system.muscles.iter().enumerate() {
            for end in [&muscle.from, &muscle.to] {
                join(end.body, self.muscle(m));
            }
        }
        for (s, solid) in system.solids.iter().enumerate() {
            for glue in &solid.glued {
                join(glue.body, self.solid(s));
            }
            for tie in &solid.tied {
                join(Some(self.solid(tie.solid)), self.solid(s));
            }
        }
        for component in system.components.iter() {
            for pair in self.tied(component).windows(2) {
                join(Some(pair[0]), pair[1]);
            }
        }
        sets
    }

    /// Bodies and blocks to which a component is attached.
    fn tied(self, component: &dyn Component) -> Vec<usize> {
        let points = component.points().into_iter();
        let bodies = points.filter_map(|point| point.body);
        let solids = component.nodes().into_iter();
        let solids = solids.map(|[solid, _]| self.solid(solid));
        bodies.chain(solids).collect()
    }

    /// Parts that move by themselves: a force acts on them, or they are set in motion.
    fn moved(
        self,
        [scene, system]: [&System; 2],
        initially_moving: &InitiallyMoving,
        analysis: &Analysis,
    ) -> Vec<usize> {
        let weighs = system.gravity.is_some();
        let mut moved: Vec<usize> = Vec::new();
        for (index, component) in system.components.iter().enumerate() {
            if component.is_prestressed() || is_sought_length(system, index, analysis) {
                moved.extend(self.tied(component));
            }
        }
        for (source, load) in scene.loads() {
            if !analysis.zero_inputs.contains(&source) {
                moved.extend(system.loaded_bodies(load));
                if let LoadPlace::Block { block, .. } = load.on {
                    moved.push(self.solid(block));
                }
            }
        }
        let loaded = system.joints.iter().enumerate().filter(|(j, joint)| {
            let rest = Constant::JointRest(*j);
            joint.moves_by_itself() || analysis.is_sought(|constant| constant == rest)
        });
        let loaded = loaded.map(|(_, joint)| joint);
        moved.extend(loaded.flat_map(|joint| joint.parent.into_iter().chain([joint.child])));
        moved.extend((0..self.bodies).filter(|b| weighs || initially_moving.bodies.contains(b)));
        for (s, solid) in system.solids.iter().enumerate() {
            let is_heavy = weighs && solid.materials.iter().any(|m| m.density.is_some());
            let starts = solid.velocities.iter().any(|v| v.norm() > 0.0);
            if is_heavy
                || starts
                || solid.prestretch.is_some()
                || initially_moving.solids.contains(&s)
                || field_extent::dielectric(solid, &BTreeSet::new()).contains(&true)
            {
                moved.push(self.solid(s));
            }
        }
        for (m, muscle) in system.muscles.iter().enumerate() {
            let is_heavy = weighs && muscle.material.density.is_some();
            if muscle.material.electric.is_some() || muscle.prestretch.is_some() || is_heavy {
                moved.push(self.muscle(m));
            }
        }
        moved
    }
}

/// Returns true if the length without force of a component, or that between its ends, is a free parameter; springs come before tendons.
fn is_sought_length(system: &System, component: usize, analysis: &Analysis) -> bool {
    let springs = system.components.springs.len();
    analysis.is_sought(|constant| match constant {
        Constant::SpringLength(s) | Constant::SpringEnd(s, ..) => s == component,
        Constant::TendonLength(t) | Constant::TendonPoint(t, ..) => springs + t == component,
        _ => false,
    })
}
