//! Analysis that a task requires of the model.
//!
//! A source has no input where neither the task nor the states at its ends name one other than zero; a body or a block is
//! initially moving where a start, a goal or a limit names it.

use std::collections::{BTreeMap, BTreeSet};

use crate::control::problem::{BoundaryState, Control, Limit, Orientation, Place, Simulation};
use crate::feedback::Law;
use crate::model::system::{Attachment, Muscle, System};
use crate::model::{Analysis, Component, InitiallyMoving, PartKind, What};

impl Simulation {
    /// The analysis of a motion in steps of `step` ms.
    pub fn analysis(&self, system: &System, step: f64) -> Analysis {
        let is_driven = |s: usize| {
            let name = system.sources()[s].name.clone();
            let is_own = |law: &Law| law.inputs.iter().any(|input| input.name == name);
            let controller = self.controller.as_ref();
            self.voltages.drive(s) || controller.is_some_and(|one| is_own(&one.law))
        };
        let mut named = Named::new(system);
        named.of_start(&self.start);
        Analysis {
            coordinates: self.coordinates,
            zero_inputs: zero_inputs(system, is_driven, [&self.start]),
            initially_moving: Some(named.initially_moving),
            ..Analysis::of_motion(step)
        }
    }
}

impl Control {
    /// The analysis of a horizon of intervals of about `interval` ms, without the quantities that are measured.
    pub fn analysis(&self, system: &System, interval: f64) -> Analysis {
        // A source at zero volts takes current from a charged muscle.
        let is_behind = |s: usize| {
            system
                .muscles
                .get(s)
                .is_some_and(Muscle::is_behind_resistor)
        };
        let limited = self.limits.iter().filter_map(|limit| match limit.what {
            What::Current(source) | What::Power(source) => Some(source),
            _ => None,
        });
        let costs = self.objective.quantities.iter();
        let measured: Vec<usize> = limited
            .chain(costs.filter_map(|cost| cost.quantity.source()))
            .collect();
        let is_limited = |s: usize| is_behind(s) && measured.contains(&s);
        let is_driven = |s: usize| match (self.given.get(&s), &self.course) {
            _ if is_limited(s) => true,
            (Some(signal), _) => !signal.is_zero(),
            (None, Some(course)) => course.drive(s) || self.load_bounds.contains_key(&s),
            (None, None) => true,
        };
        let mut named = Named::new(system);
        named.of_start(&self.start);
        named.of_goal(&self.goal);
        self.limits.iter().for_each(|limit| named.of_limit(limit));
        for waypoint in &self.waypoints {
            named.of_places(&waypoint.places, &waypoint.orientations);
            waypoint.angles.keys().for_each(|&j| named.of_joint(j));
        }
        Analysis {
            coordinates: self.coordinates,
            zero_inputs: zero_inputs(system, is_driven, [&self.start, &self.goal]),
            initially_moving: Some(named.initially_moving),
            parameters: self.parameters.clone(),
            ..Analysis::of_motion(interval)
        }
    }
}

/// Sources whose voltage is zero all the time, and at rest before and after.
pub(super) fn zero_inputs<const N: usize>(
    system: &System,
    is_driven: impl Fn(usize) -> bool,
    ends: [&BoundaryState; N],
) -> BTreeSet<usize> {
    let is_held = |s: usize| {
        ends.iter().any(|state| match state {
            BoundaryState::EndOf(_) => false,
            held => held.voltages().is_some_and(|v| v[s] != 0.0),
        })
    };
    let sources = system.sources();
    let takes = (0..sources.len()).filter(|&s| sources[s].acts());
    // Other electrodes drive a current through the resistor of a source at zero volts.
    let is_silent = |&s: &usize| !is_driven(s) && !is_held(s);
    let is_behind = |s: &usize| system.has_electrodes_behind_resistor(*s);
    takes.filter(is_silent).filter(|s| !is_behind(s)).collect()
}

/// Bodies and blocks that are named.
struct Named<'a> {
    system: &'a System,
    initially_moving: InitiallyMoving,
}

impl<'a> Named<'a> {
    fn new(system: &'a System) -> Self {
        Self {
            system,
            initially_moving: InitiallyMoving::default(),
        }
    }

    /// A start away from the reference configuration, or in motion; where another motion ended anything may be. Sources that hold a
    /// state of rest are not at zero voltage, and move what they move.
    fn of_start(&mut self, state: &BoundaryState) {
        match state {
            BoundaryState::JointAngles {
                angles,
                rates,
                velocities,
            } => {
                self.initially_moving.bodies.extend(velocities.keys());
                let all = angles.iter().chain(rates);
                let moved = all.filter(|(_, value)| **value != 0.0);
                moved.for_each(|(&joint, _)| self.of_joint(joint));
            }
            BoundaryState::EndOf(_) => self.of_everything(),
            BoundaryState::RestAtVoltages(..)
            | BoundaryState::Markers { .. }
            | BoundaryState::Free
            | BoundaryState::Periodic => {}
        }
    }

    fn of_everything(&mut self) {
        let system = self.system;
        self.initially_moving.bodies.extend(0..system.bodies.len());
        self.initially_moving.solids.extend(0..system.solids.len());
    }

    fn of_goal(&mut self, state: &BoundaryState) {
        match state {
            BoundaryState::RestAtVoltages(..) | BoundaryState::EndOf(_) | BoundaryState::Free => {}
            // Its start may be anything.
            BoundaryState::Periodic => self.of_everything(),
            BoundaryState::JointAngles { angles, .. } => {
                angles.keys().for_each(|&j| self.of_joint(j));
            }
            BoundaryState::Markers {
                places,
                orientations,
                ..
            } => self.of_places(places, orientations),
        }
    }

    fn of_places(
        &mut self,
        places: &BTreeMap<usize, Place>,
        orientations: &BTreeMap<usize, Orientation>,
    ) {
        places.keys().for_each(|&m| self.of_marker(m));
        self.initially_moving.bodies.extend(orientations.keys());
    }

    /// A limit of what moves. A field without voltage is none, and sources move what they move.
    fn of_limit(&mut self, limit: &Limit) {
        if matches!(limit.what, What::Field(_) | What::Amount { .. }) {
            return;
        }
        for (kind, part) in limit.what.parts() {
            let components = &self.system.components;
            match kind {
                PartKind::Joint => self.of_joint(part),
                PartKind::Marker => self.of_marker(part),
                PartKind::Body => self.initially_moving.bodies.extend([part]),
                PartKind::Muscle => {
                    let muscle = &self.system.muscles[part];
                    self.of_points(&[muscle.from, muscle.to]);
                }
                PartKind::Spring => self.of_points(&components.springs[part].points()),
                PartKind::Tendon => self.of_points(&components.tendons[part].through),
                PartKind::Contact => {
                    let contact = &components.contacts[part];
                    let solids = contact.nodes().into_iter().map(|[solid, _]| solid);
                    self.initially_moving.solids.extend(solids);
                    self.of_points(&contact.points());
                }
                PartKind::Source | PartKind::Block => {}
            }
        }
    }

    fn of_joint(&mut self, joint: usize) {
        let joint = &self.system.joints[joint];
        let bodies = joint.parent.into_iter().chain([joint.child]);
        self.initially_moving.bodies.extend(bodies);
    }

    fn of_marker(&mut self, marker: usize) {
        let marker = &self.system.markers[marker];
        self.initially_moving.solids.extend(marker.solid);
        self.of_points(&[marker.point]);
    }

    fn of_points(&mut self, points: &[Attachment]) {
        let bodies = points.iter().filter_map(|point| point.body);
        self.initially_moving.bodies.extend(bodies);
    }
}
