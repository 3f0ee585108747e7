//! Costs of a control problem in addition to its voltages: energies of sources, squared deviations of markers and joints, along the motion of
//! tensions, fields, currents, powers and rates; waypoints; and limits. [`Control::minimise`] takes the same quantities at the end.

use crate::control::problem;
use crate::control::problem::{
    CostFunction, During, EnergyCost, Limit, Place, QuantityCost, SourceEnergy, Waypoint,
};
use crate::interface::control::Control;
use crate::interface::error::{Entry, Result};
use crate::interface::handle::{Handle, builder};
use crate::math::{Signal, Vector, refuse};
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{FieldPlace, Pulling, Quantity, Reaction, System, What};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

impl Control {
    /// The problem with the cost of the peak voltage, where it has one.
    pub(super) fn with_peak(
        &self,
        mut control: problem::Control,
        system: &System,
    ) -> Result<problem::Control> {
        let weight = self.peak_voltage;
        let is_sought = weight == 0.0 || control.minimise_peak_voltage(weight, system);
        refuse!(unless is_sought, Entry("control");
            found "a cost of the peak voltage where all voltages are given",
            expected "a voltage that is sought");
        Ok(control)
    }
}

builder! {
    impl Control;
    /// Minimises the electrical energy from the sources of lumped muscles, with a weight per J; energy that flows back is negative, and
    /// the switch to the voltages that hold the goal is counted where they are known, and behind a resistor its heat.
    electrical_energy(muscles: &[Handle<Muscle>], weight: f64) |of| {
        of.task.objective.energies.extend(energies(SourceEnergy::Electrical, muscles, weight));
    };
    /// Minimises the mechanical work of the electrical forces of lumped muscles, with a weight per J.
    mechanical_work(muscles: &[Handle<Muscle>], weight: f64) |of| {
        of.task.objective.energies.extend(energies(SourceEnergy::Mechanical, muscles, weight));
    };
    /// A marker follows functions of time in mm, in the directions x, y and z that have one: minimises ∫ |x − r|² dt in mm² s, with a
    /// weight.
    track(marker: Handle<Marker>, along: [Option<Signal>; 3], weight: f64) |of| {
        of.task.objective.quantities.extend(squares(marker, along, During::Motion, weight));
    };
    /// A marker passes near a place in mm, in the directions that have a value, at the instant nearest to a part of the duration: minimises
    /// |x − r|² there in mm², with a weight.
    marker_passes_near(marker: Handle<Marker>, place: [Option<f64>; 3], part: f64, weight: f64) |of| {
        let places = BTreeMap::from([(marker.index(), Place(place))]);
        let near = Waypoint { places, ..waypoint(part) };
        of.task.objective.quantities.extend(near.costs(weight));
    };
    /// A joint passes near a coordinate in rad or mm at the instant nearest to a part of the duration: minimises (θ − r)² there, with a
    /// weight.
    joint_passes_near(joint: Handle<Joint>, coordinate: f64, part: f64, weight: f64) |of| {
        of.task.objective.quantities.push(square(of_joint(joint), coordinate, During::At(part), weight));
    };
    /// A marker ends near a place in mm: minimises |x − r|² at the end in mm², with a weight.
    end_near(marker: Handle<Marker>, place: Vector3<f64>, weight: f64) |of| {
        let place = <[f64; 3]>::from(place).map(|at| Some(at.into()));
        of.task.objective.quantities.extend(squares(marker, place, During::End, weight));
    };
    /// A joint ends near a coordinate in rad or mm: minimises (θ − r)² at the end, with a weight.
    end_joint_near(joint: Handle<Joint>, at: f64, weight: f64) |of| {
        of.task.objective.quantities.push(square(of_joint(joint), at, During::End, weight));
    };
    /// Minimises ∫ |v|² dt of the velocity of a marker in m²/s, with a weight.
    low_speed(marker: Handle<Marker>, weight: f64) |of| {
        of.task.objective.quantities.push(low(Quantity::squared_speed(marker.index()), weight));
    };
    /// Minimises ∫ E² dt of the true electric field of a lumped muscle without a resistor in (V/µm)² s, with a weight.
    low_field(muscle: Handle<Muscle>, weight: f64) |of| {
        of.task.objective.quantities.push(low(Quantity::squared_field(muscle.index(), false), weight));
    };
    /// Minimises the square of the peak voltage in kV, the largest of all voltages that are sought, with a weight.
    peak_voltage(weight: f64) |of| of.peak_voltage = weight;
    /// A marker is at a place in mm, in the directions that have a value, at the instant nearest to a part of the duration.
    marker_passes(marker: Handle<Marker>, place: [Option<f64>; 3], part: f64) |of| {
        let places = BTreeMap::from([(marker.index(), Place(place))]);
        of.task.waypoints.push(Waypoint { places, ..waypoint(part) });
    };
    /// A joint has a coordinate in rad or mm at the instant nearest to a part of the duration.
    joint_passes(joint: Handle<Joint>, coordinate: f64, part: f64) |of| {
        let angles = BTreeMap::from([(joint.index(), coordinate)]);
        of.task.waypoints.push(Waypoint { angles, ..waypoint(part) });
    };
}

/// Declares costs of quantities that follow functions of time.
macro_rules! followed {
    ($($(#[$about:meta])* $name:ident($part:ident: $of:ty) $quantity:expr;)*) => {
        impl Control {
            $($(#[$about])*
            pub fn $name(self, $part: Handle<$of>, along: impl Into<Signal>, weight: f64) -> Self {
                let $part = $part.index();
                self.minimise(square($quantity, along, During::Motion, weight))
            })*
        }
    };
}

followed! {
    /// The coordinate of a joint follows a function of time in rad or mm: minimises ∫ (θ − r)² dt in rad² s or mm² s, with a weight.
    track_joint(joint: Joint) Quantity::joint(joint, 0.0);
    /// The tension of a lumped muscle follows a function of time in N: minimises ∫ (T − r)² dt in N² s, with a weight.
    track_tension(muscle: Muscle) Quantity::tension(Pulling::Muscle(muscle));
    /// The rate of the coordinate of a joint follows a function of time in rad/s or m/s: minimises ∫ (ω − r)² dt, with a weight.
    track_joint_rate(joint: Joint) Quantity::joint_rate(joint);
    /// The current of the source of a muscle behind a resistor follows a function of time in mA: minimises ∫ (I − r)² dt in mA² s, with a weight.
    track_current(muscle: Muscle) Quantity::current(muscle);
    /// The power of the source of a muscle behind a resistor follows a function of time in W: minimises ∫ (P − r)² dt in W² s, with a weight.
    track_power(muscle: Muscle) Quantity::power(muscle);
}

fn energies(
    energy: SourceEnergy,
    muscles: &[Handle<Muscle>],
    weight: f64,
) -> impl Iterator<Item = EnergyCost> {
    muscles.iter().map(move |muscle| EnergyCost {
        source: muscle.index(),
        energy,
        weight,
    })
}

/// The squared deviation of a quantity from a function of time.
fn square(
    quantity: Quantity,
    reference: impl Into<Signal>,
    during: During,
    weight: f64,
) -> QuantityCost {
    let reference = reference.into();
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Square { reference },
        during,
    }
}

/// Those of a marker in the directions that have a function.
fn squares(
    marker: Handle<Marker>,
    along: [Option<Signal>; 3],
    during: During,
    weight: f64,
) -> impl Iterator<Item = QuantityCost> {
    let along = along.into_iter().enumerate();
    along.filter_map(move |(axis, reference)| {
        let quantity = Quantity::marker_place(marker.index(), axis);
        Some(square(quantity, reference?, during, weight))
    })
}

/// A quantity that is small along the motion.
fn low(quantity: Quantity, weight: f64) -> QuantityCost {
    QuantityCost {
        quantity,
        weight,
        function: CostFunction::Itself,
        during: During::Motion,
    }
}

fn of_joint(joint: Handle<Joint>) -> Quantity {
    Quantity::joint(joint.index(), 0.0)
}

/// A waypoint without places so far.
fn waypoint(part: f64) -> Waypoint {
    Waypoint {
        part,
        name: format!("waypoint at {part} of the duration"),
        ..Waypoint::default()
    }
}

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

builder! {
    impl Control;
    /// Greatest true electric field of muscles in V/mm.
    field_below(muscles: &[Handle<Muscle>], max: f64) |of| {
        let place = |muscle: &Handle<Muscle>| FieldPlace::Muscle(muscle.index());
        let places = muscles.iter().map(place);
        of.task.limits.extend(places.map(|place| Limit::below(What::Field(place), max)));
    };
    /// Makes the limit that was added last hold only at a part of the duration, above 0 and at most 1, the end: at the instant nearest to it, or in
    /// the interval before that instant. Nothing without a limit.
    only_at(part: f64) |of| {
        if let Some(last) = of.task.limits.pop() {
            of.task.limits.push(last.at_part(part));
        }
    };
    /// Adds a limit of any quantity, such as the clearance of a marker from a plane.
    limited(limit: Limit) |of| of.task.limits.push(limit);
}
