//! Limits of optimal control problems.

use crate::control::problem::Limit;
use crate::interface::control::Control;
use crate::interface::handle::Handle;
use crate::math::Vector;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{FieldPlace, Pulling, Reaction, What};
use std::ops::RangeInclusive;

impl Control {
    /// Greatest true electric field of muscles in V/mm.
    pub fn field_below(mut self, muscles: &[Handle<Muscle>], max: f64) -> Self {
        let limit = |muscle: &Handle<Muscle>| {
            let place = FieldPlace::Muscle(muscle.index());
            Limit::below(What::Field(place), max)
        };
        self.limits.extend(muscles.iter().map(limit));
        self
    }

    /// Range of the stretch of a muscle.
    pub fn stretch_within(self, muscle: Handle<Muscle>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::new(What::Stretch(muscle.index()), bounds(range)))
    }

    /// Range of the force in N with which a lumped muscle pulls its ends together, in the middle of the intervals.
    pub fn tension_within(self, muscle: Handle<Muscle>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::new(
            What::Tension(Pulling::Muscle(muscle.index())),
            bounds(range),
        ))
    }

    /// Range of the coordinate of a joint in rad or mm.
    pub fn joint_within(self, joint: Handle<Joint>, range: RangeInclusive<f64>) -> Self {
        let (joint, near) = (joint.index(), 0.0);
        self.limited(Limit::new(What::Joint { joint, near }, bounds(range)))
    }

    /// Range of the mean rate of the coordinate of a joint in each interval in rad/ms or mm/ms.
    pub fn joint_rate_within(self, joint: Handle<Joint>, range: RangeInclusive<f64>) -> Self {
        let (joint, near) = (joint.index(), 0.0);
        self.limited(Limit::of_rate(What::Joint { joint, near }, bounds(range)))
    }

    /// Range of the current in A of the source of a lumped muscle: behind a resistor its mean in each interval, otherwise that between the
    /// middles of neighbouring intervals.
    pub fn current_within(self, muscle: Handle<Muscle>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::new(What::Current(muscle.index()), bounds(range)))
    }

    /// Range of the rate of the voltage of a muscle in V/ms between the middles of neighbouring intervals.
    pub fn voltage_rate_within(self, muscle: Handle<Muscle>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::of_rate(What::Voltage(muscle.index()), bounds(range)))
    }

    /// Range of the power in W of the source of a lumped muscle, at the times of a current.
    pub fn power_within(self, muscle: Handle<Muscle>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::new(What::Power(muscle.index()), bounds(range)))
    }

    /// Range in N of the component, along a unit vector of the ground frame, of the force from the parent of a joint on its child, at the
    /// instants between intervals.
    pub fn reaction_within(
        self,
        joint: Handle<Joint>,
        along: Vector,
        range: RangeInclusive<f64>,
    ) -> Self {
        self.transmits_within(joint, Reaction::Force, along, range)
    }

    /// Range in N mm of the component, along a unit vector of the ground frame, of the torque from the parent of a joint on its child about the
    /// point of the joint, at the instants between intervals.
    pub fn reaction_torque_within(
        self,
        joint: Handle<Joint>,
        along: Vector,
        range: RangeInclusive<f64>,
    ) -> Self {
        self.transmits_within(joint, Reaction::Torque, along, range)
    }

    fn transmits_within(
        self,
        joint: Handle<Joint>,
        of: Reaction,
        along: Vector,
        range: RangeInclusive<f64>,
    ) -> Self {
        let joint = joint.index();
        self.limited(Limit::new(
            What::Reaction { joint, of, along },
            bounds(range),
        ))
    }

    /// Range of the size of the mean velocity of a marker in each interval in mm/ms.
    pub fn marker_speed_within(self, marker: Handle<Marker>, range: RangeInclusive<f64>) -> Self {
        self.limited(Limit::new(What::Speed(marker.index()), bounds(range)))
    }

    /// Makes the limit that was added last hold only at a part of the duration, above 0 and at most 1, the end: at the instant nearest to it, or in
    /// the interval before that instant. Nothing without a limit.
    pub fn only_at(mut self, part: f64) -> Self {
        if let Some(last) = self.limits.pop() {
            self.limits.push(last.at_part(part));
        }
        self
    }

    /// Adds a limit of any quantity, such as the clearance of a marker from a plane.
    pub fn limited(mut self, limit: Limit) -> Self {
        self.limits.push(limit);
        self
    }
}

fn bounds(range: RangeInclusive<f64>) -> [f64; 2] {
    let (min, max) = range.into_inner();
    [min, max]
}
