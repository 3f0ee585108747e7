//! Limits of optimal control problems.

use crate::control::problem::Limit;
use crate::interface::control::Control;
use crate::interface::handle::Handle;
use crate::math::Vector;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{FieldPlace, Pulling, Reaction, What};
use std::ops::RangeInclusive;

/// Declares limits of quantities of parts to a range.
macro_rules! ranges {
    ($($(#[$about:meta])* $name:ident($part:ident: $of:ty $(, $further:ident: $kind:ty)?) $limit:ident $what:expr;)*) => {
        impl Control {
            $($(#[$about])*
            pub fn $name(self, $part: Handle<$of> $(, $further: $kind)?, range: RangeInclusive<f64>) -> Self {
                let $part = $part.index();
                let (min, max) = range.into_inner();
                self.limited(Limit::$limit($what, [min, max]))
            })*
        }
    };
}

ranges! {
    /// Range of the stretch of a muscle.
    stretch_within(muscle: Muscle) new What::Stretch(muscle);
    /// Range of the force in N with which a lumped muscle pulls its ends together, in the middle of the intervals.
    tension_within(muscle: Muscle) new What::Tension(Pulling::Muscle(muscle));
    /// Range of the coordinate of a joint in rad or mm.
    joint_within(joint: Joint) new What::Joint { joint, near: 0.0 };
    /// Range of the mean rate of the coordinate of a joint in each interval in rad/ms or mm/ms.
    joint_rate_within(joint: Joint) of_rate What::Joint { joint, near: 0.0 };
    /// Range of the current in A of the source of a lumped muscle: behind a resistor its mean in each interval, otherwise that between the
    /// middles of neighbouring intervals.
    current_within(muscle: Muscle) new What::Current(muscle);
    /// Range of the rate of the voltage of a muscle in V/ms between the middles of neighbouring intervals.
    voltage_rate_within(muscle: Muscle) of_rate What::Voltage(muscle);
    /// Range of the power in W of the source of a lumped muscle, at the times of a current.
    power_within(muscle: Muscle) new What::Power(muscle);
    /// Range in N of the component, along a unit vector of the ground frame, of the force from the parent of a joint on its child, at the
    /// instants between intervals.
    reaction_within(joint: Joint, along: Vector) new What::Reaction { joint, of: Reaction::Force, along };
    /// Range in N mm of the component, along a unit vector of the ground frame, of the torque from the parent of a joint on its child about the
    /// point of the joint, at the instants between intervals.
    reaction_torque_within(joint: Joint, along: Vector) new What::Reaction { joint, of: Reaction::Torque, along };
    /// Range of the size of the mean velocity of a marker in each interval in mm/ms.
    marker_speed_within(marker: Marker) new What::Speed(marker);
}

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
