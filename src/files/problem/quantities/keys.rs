//! Keys of the quantities that limits, costs and recordings name.

use crate::control::problem::{During, Limit, QuantityCost};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse};
use crate::files::problem::at::At;
use crate::files::problem::quantities::entry::{CostEntry, LimitEntry, Named, PlaneSpec, Recorded};
use crate::files::problem::quantities::joint::{
    self, FinalJointSpec, JointAngleLimitSpec, JointRateCostSpec, JointRateLimitSpec,
    ReactionForceLimitSpec, ReactionTorqueLimitSpec, TrackJointSpec, TrackJointsSpec,
};
use crate::files::problem::quantities::marker::{
    self, ClearanceCostSpec, ClearanceLimitSpec, ContactForceLimitSpec, FinalMarkerSpec,
    GapLimitSpec, MarkerLimitSpec, MarkerSpeedCostSpec, MarkerSpeedLimitSpec, TrackMarkerSpec,
};
use crate::files::problem::quantities::muscle::{
    self, ElectricFieldLimitSpec, FieldCostSpec, MuscleMassLimitSpec, MuscleVolumeLimitSpec,
    StretchLimitSpec, TensionCostSpec, TensionLimitSpec,
};
use crate::files::problem::quantities::source::{
    self, CurrentCostSpec, CurrentLimitSpec, PowerCostSpec, PowerLimitSpec, VoltageRateLimitSpec,
};
use crate::files::units::quantity::{MeasuredSize, Quantity as Written};
use crate::model::What;

/// Declares an entry that has exactly one of some keys, beside others, and what is seen of the one that is written.
macro_rules! one_of {
    ($(#[$about:meta])* $name:ident: $entry:ty = |$one:ident| $seen:expr;
     keys { $($(#[$doc:meta])* $key:ident: $spec:ty;)* }
     beside { $($(#[$beside_doc:meta])* $beside:ident: $other:ty;)* }) => {
        read_objects! {
            $(#[$about])*
            pub struct $name {
                $($(#[$beside_doc])* pub $beside: Option<$other>,)*
                $($(#[$doc])* pub $key: Option<$spec>,)*
            }
        }

        impl $name {
            /// The entry that is written, and its place.
            fn entry<'a>(&self, at: &At<'a>) -> Result<($entry, At<'a>)> {
                at.exactly_one([$((
                    stringify!($key),
                    self.$key.as_ref().map(|$one| ($seen, at.key(stringify!($key)))),
                ),)*])
            }
        }
    };
}

/// A cost with its weight.
type Weighted<'a> = (&'a dyn CostEntry, Option<f64>);

one_of! {
    /// A path limit: exactly one of the keys but `part`. `min` and `max` may be equal with `part`: the quantity is then prescribed there.
    LimitSpec: &dyn LimitEntry = |one| one as &dyn LimitEntry;
    keys {
        /// Limits of a joint coordinate.
        joint_angle: JointAngleLimitSpec;
        /// Limits of the rate of a joint coordinate.
        joint_rate: JointRateLimitSpec;
        /// Limits of the stretch of a muscle.
        stretch: StretchLimitSpec;
        /// Limits of the tension of lumped muscles.
        tension: TensionLimitSpec;
        /// Breakdown field of muscles or elastic blocks.
        electric_field: ElectricFieldLimitSpec;
        /// Region of a marker.
        marker: MarkerLimitSpec;
        /// Limits of the force that a joint transmits.
        reaction_force: ReactionForceLimitSpec;
        /// Limits of the torque that a joint transmits.
        reaction_torque: ReactionTorqueLimitSpec;
        /// Limits of the speed of a marker.
        marker_speed: MarkerSpeedLimitSpec;
        /// Limits of the current of sources.
        current: CurrentLimitSpec;
        /// Limits of the power of sources.
        power: PowerLimitSpec;
        /// Limits of the rate of the voltage of sources.
        voltage_rate: VoltageRateLimitSpec;
        /// Limits of the volume of muscles.
        muscle_volume: MuscleVolumeLimitSpec;
        /// Limits of the mass of muscles.
        muscle_mass: MuscleMassLimitSpec;
        /// Limits of the distance of a marker from a plane that is fixed to a body or the ground.
        clearance: ClearanceLimitSpec;
        /// Limits of the gap of a contact.
        gap: GapLimitSpec;
        /// Limits of the normal force of a contact.
        contact_force: ContactForceLimitSpec;
    }
    beside {
        /// Part of the duration, above 0 and at most 1, at which alone the limit holds: at the instant nearest to it, or in the interval before
        /// that instant; 1 is the end. Where not written it holds from start to end.
        part: f64;
    }
}

one_of! {
    /// Marker or joints that follow a reference, or a measured quantity whose squared deviation from a value, times `weight`, is integrated over the
    /// time in s: exactly one of them.
    TrackSpec: Weighted<'_> = |one| (one as &dyn CostEntry, one.weight);
    keys {
        /// A marker follows a path in time.
        marker: TrackMarkerSpec;
        /// The coordinate of a joint follows a function of time.
        joint: TrackJointSpec;
        /// The coordinates of all joints follow an earlier solution.
        joints: TrackJointsSpec;
        /// The tension of muscles along the motion.
        tension: TensionCostSpec;
        /// The true electric field of muscles along the motion.
        electric_field: FieldCostSpec;
        /// The current of sources along the motion.
        current: CurrentCostSpec;
        /// The power of sources along the motion.
        power: PowerCostSpec;
        /// The rate of a joint along the motion.
        joint_rate: JointRateCostSpec;
        /// The speed of a marker along the motion.
        marker_speed: MarkerSpeedCostSpec;
        /// The distance of a marker from a plane along the motion.
        clearance: ClearanceCostSpec;
    }
    beside {}
}

one_of! {
    /// Marker or joint that ends near a place, or a measured quantity that ends near a value, in the last interval: exactly one of them.
    FinalSpec: Weighted<'_> = |one| (one as &dyn CostEntry, one.weight);
    keys {
        /// A marker ends near a place.
        marker: FinalMarkerSpec;
        /// The coordinate of a joint ends near a value.
        joint: FinalJointSpec;
        /// The tension of muscles at the end.
        tension: TensionCostSpec;
        /// The true electric field of muscles at the end.
        electric_field: FieldCostSpec;
        /// The current of sources at the end.
        current: CurrentCostSpec;
        /// The power of sources at the end.
        power: PowerCostSpec;
        /// The rate of a joint at the end.
        joint_rate: JointRateCostSpec;
        /// The speed of a marker at the end.
        marker_speed: MarkerSpeedCostSpec;
        /// The distance of a marker from a plane at the end.
        clearance: ClearanceCostSpec;
    }
    beside {}
}

/// Declares a measured quantity of recordings: names by keys, and how each is read.
macro_rules! recorded {
    ($(#[$about:meta])* $name:ident;
     keys { $($(#[$doc:meta])* $key:ident: $make:expr;)* }
     beside { $($(#[$beside_doc:meta])* $beside:ident: $other:ty;)* }) => {
        read_objects! {
            $(#[$about])*
            pub struct $name {
                $($(#[$doc])* pub $key: Option<String>,)*
                $($(#[$beside_doc])* pub $beside: Option<$other>,)*
            }
        }

        impl $name {
            /// The key that is written, its name, and how it is read.
            fn entry(&self, at: &At<'_>) -> Result<(&'static str, &str, Make)> {
                at.exactly_one([$((
                    stringify!($key),
                    self.$key.as_ref().map(|name| (stringify!($key), name.as_str(), $make as Make)),
                ),)*])
            }
        }
    };
}

/// Reads a quantity of a recording.
type Make = fn(&Named<'_>) -> Result<Recorded>;

recorded! {
    /// A measured quantity: exactly one of `joint`, `joint_rate`, `marker`, `tension`, `charge`, `current`, `power`, `voltage`, `reaction_force`,
    /// `reaction_torque` and `clearance`.
    MeasuredSpec;
    keys {
        /// Coordinate of a revolute or prismatic joint.
        joint: joint::coordinate;
        /// Rate of the coordinate of a revolute or prismatic joint.
        joint_rate: joint::rate;
        /// Place of a marker along a direction.
        marker: marker::place;
        /// Force with which a lumped muscle, a spring or a tendon pulls its ends together, of all its laws, voltage and viscosity.
        tension: muscle::tension;
        /// Charge that a source has brought to a lumped muscle, or to electrodes behind a resistor.
        charge: source::charge;
        /// Current of a source: of a lumped muscle that does not leak, or of anything behind a resistor.
        current: source::current;
        /// Electrical power of the source of a lumped muscle behind a resistor.
        power: source::power;
        /// Voltage of the electrodes behind the resistor of a source.
        voltage: source::voltage;
        /// Force from the parent of a joint on its child along a direction, as in limits; of joints in no loop.
        reaction_force: joint::reaction_force;
        /// Torque from the parent of a joint on its child about a direction, about the point of the joint.
        reaction_torque: joint::reaction_torque;
        /// Distance of a marker from a plane, on the side of its normal.
        clearance: marker::distance;
    }
    beside {
        /// The direction of a place or a force, in the ground frame; its length does not matter.
        along: [f64; 3];
        /// The direction of a torque, in the ground frame; its length does not matter.
        about: [f64; 3];
        /// The plane of a clearance.
        from: PlaneSpec;
        /// Header of the column, with or without its unit; the name of the joint, marker, part or source where not written.
        column: String;
        /// Standard deviation of the readings, in a unit of the quantity; where neither it nor `deviations` is written, the residuals tell it.
        standard_deviation: Written<MeasuredSize>;
        /// Header of a column with a standard deviation of each reading.
        deviations: String;
        /// Header of a column with a weight of each reading: the variance of a reading is in inverse proportion to it.
        weights: String;
    }
}

impl MeasuredSpec {
    /// The quantity that is written.
    pub(in crate::files::problem) fn recorded(&self, at: &At<'_>) -> Result<Recorded> {
        let (key, name, make) = self.entry(at)?;
        let (along, about) = (self.along.is_some(), self.about.is_some());
        let directed: &[&str] = &["marker", "reaction_force"];
        let beside = [
            ("along", along, "a direction", directed),
            ("about", about, "a direction", &["reaction_torque"]),
            ("from", self.from.is_some(), "a plane", &["clearance"]),
        ];
        for (other, is_written, found, of) in beside {
            refuse!(if is_written && !of.contains(&key), at.key(other);
                found found, expected format!("{found} of a {:?} alone", of[0]));
        }
        let recorded = make(&Named {
            name,
            along: self.along,
            about: self.about,
            from: self.from.as_ref(),
            place: &at.key(key),
            at,
        })?;
        Ok(match &self.column {
            None => recorded,
            Some(column) => Recorded {
                of: column.clone(),
                name: column.clone(),
                ..recorded
            },
        })
    }
}

/// The limits of a list of entries.
pub(crate) fn limits(list: &[LimitSpec], at: &At<'_>) -> Result<Vec<Limit>> {
    let mut limits = Vec::new();
    for (index, spec) in list.iter().enumerate() {
        let at = at.index(index);
        let (entry, place) = spec.entry(&at)?;
        let own = entry.limits(&place)?;
        let Some(part) = spec.part else {
            limits.extend(own);
            continue;
        };
        let is_timeless = |limit: &Limit| matches!(limit.what, What::Amount { .. });
        refuse!(if own.iter().any(is_timeless), at.key("part");
            found part, expected "no part: constants are the same at all times");
        refuse!(if !(part > 0.0 && part <= 1.0), at.key("part");
            found part, expected "a part of the duration, above 0 and at most 1, the end");
        limits.extend(own.into_iter().map(|limit| limit.at_part(part)));
    }
    Ok(limits)
}

/// The costs along the motion that one entry stands for.
pub(crate) fn track(spec: &TrackSpec, at: &At<'_>) -> Result<Vec<QuantityCost>> {
    costs(spec.entry(at)?, During::Motion)
}

/// The costs of the end that one entry stands for.
pub(crate) fn at_the_end(spec: &FinalSpec, at: &At<'_>) -> Result<Vec<QuantityCost>> {
    costs(spec.entry(at)?, During::End)
}

/// The costs of an entry, whose weight is 1 where not written.
fn costs(written: (Weighted<'_>, At<'_>), during: During) -> Result<Vec<QuantityCost>> {
    let ((entry, weight), at) = written;
    let weight = weight.unwrap_or(1.0);
    refuse!(if weight <= 0.0 || weight.is_nan(), at.key("weight");
        found weight, expected "a positive weight");
    let cost = |(quantity, function)| QuantityCost {
        quantity,
        weight,
        function,
        during,
    };
    Ok(entry.costs(&at)?.into_iter().map(cost).collect())
}
