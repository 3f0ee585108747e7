//! Costs of a control problem in addition to its voltages: energies of sources, squared deviations of markers and joints, along the motion of
//! tensions, fields, currents, powers and rates; and waypoints. [`Control::minimise`] takes the same quantities at the end.

use crate::control::problem::{
    self, CostFunction, During, EnergyCost, Place, QuantityCost, SourceEnergy, Waypoint,
};
use crate::interface::builder::builder;
use crate::interface::control::Control;
use crate::interface::error::{Result, require};
use crate::interface::handle::Handle;
use crate::math::Signal;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{Pulling, Quantity, System};
use nalgebra::Vector3;
use std::collections::BTreeMap;

impl Control {
    /// Minimises the electrical energy from the sources of lumped muscles, with a weight per J; energy that flows back is negative, and
    /// the switch to the voltages that hold the goal is counted where they are known, and behind a resistor its heat.
    pub fn electrical_energy(self, muscles: &[Handle<Muscle>], weight: f64) -> Self {
        self.energy(SourceEnergy::Electrical, muscles, weight)
    }

    /// Minimises the mechanical work of the electrical forces of lumped muscles, with a weight per J.
    pub fn mechanical_work(self, muscles: &[Handle<Muscle>], weight: f64) -> Self {
        self.energy(SourceEnergy::Mechanical, muscles, weight)
    }

    /// The problem with the cost of the peak voltage, where it has one.
    pub(super) fn with_peak(
        &self,
        mut control: problem::Control,
        system: &System,
    ) -> Result<problem::Control> {
        let weight = self.peak_voltage;
        let is_sought = weight == 0.0 || control.minimise_peak_voltage(weight, system);
        let found = || "a cost of the peak voltage where all voltages are given".to_owned();
        require(is_sought, "control", found, "a voltage that is sought")?;
        Ok(control)
    }

    fn energy(mut self, energy: SourceEnergy, muscles: &[Handle<Muscle>], weight: f64) -> Self {
        let cost = |muscle: &Handle<Muscle>| EnergyCost {
            source: muscle.index(),
            energy,
            weight,
        };
        self.objective.energies.extend(muscles.iter().map(cost));
        self
    }

    /// A marker follows functions of time in mm, in the directions x, y and z that have one: minimises ∫ |x − r|² dt in mm² s, with a
    /// weight.
    pub fn track(
        mut self,
        marker: Handle<Marker>,
        along: [Option<Signal>; 3],
        weight: f64,
    ) -> Self {
        let marker = marker.index();
        for (axis, reference) in along.into_iter().enumerate() {
            let quantity = Quantity::marker_place(marker, axis);
            self = self.square(quantity, reference, During::Motion, weight);
        }
        self
    }

    /// A marker passes near a place in mm, in the directions that have a value, at the instant nearest to a part of the duration: minimises
    /// |x − r|² there in mm², with a weight.
    pub fn marker_passes_near(
        mut self,
        marker: Handle<Marker>,
        place: [Option<f64>; 3],
        part: f64,
        weight: f64,
    ) -> Self {
        let near = Waypoint {
            places: BTreeMap::from([(marker.index(), Place(place))]),
            ..waypoint(part)
        };
        self.objective.quantities.extend(near.costs(weight));
        self
    }

    /// A joint passes near a coordinate in rad or mm at the instant nearest to a part of the duration: minimises (θ − r)² there, with a
    /// weight.
    pub fn joint_passes_near(
        self,
        joint: Handle<Joint>,
        coordinate: f64,
        part: f64,
        weight: f64,
    ) -> Self {
        let during = During::At(part);
        self.square(of_joint(joint), Some(coordinate.into()), during, weight)
    }

    /// A marker ends near a place in mm: minimises |x − r|² at the end in mm², with a weight.
    pub fn end_near(mut self, marker: Handle<Marker>, place: Vector3<f64>, weight: f64) -> Self {
        let marker = marker.index();
        for (axis, &at) in place.iter().enumerate() {
            let quantity = Quantity::marker_place(marker, axis);
            self = self.square(quantity, Some(at.into()), During::End, weight);
        }
        self
    }

    /// A joint ends near a coordinate in rad or mm: minimises (θ − r)² at the end, with a weight.
    pub fn end_joint_near(self, joint: Handle<Joint>, at: f64, weight: f64) -> Self {
        self.square(of_joint(joint), Some(at.into()), During::End, weight)
    }

    fn square(
        self,
        quantity: Quantity,
        reference: Option<Signal>,
        during: During,
        weight: f64,
    ) -> Self {
        let cost = |reference| QuantityCost {
            quantity,
            weight,
            function: CostFunction::Square { reference },
            during,
        };
        match reference.map(cost) {
            Some(cost) => self.minimise(cost),
            None => self,
        }
    }
}

builder! {
    impl Control;
    /// Minimises the square of the peak voltage in kV, the largest of all voltages that are sought, with a weight.
    peak_voltage(weight: f64) |of| of.peak_voltage = weight;
    /// A marker is at a place in mm, in the directions that have a value, at the instant nearest to a part of the duration.
    marker_passes(marker: Handle<Marker>, place: [Option<f64>; 3], part: f64) |of| {
        let places = BTreeMap::from([(marker.index(), Place(place))]);
        of.waypoints.push(Waypoint { places, ..waypoint(part) });
    };
    /// A joint has a coordinate in rad or mm at the instant nearest to a part of the duration.
    joint_passes(joint: Handle<Joint>, coordinate: f64, part: f64) |of| {
        let angles = BTreeMap::from([(joint.index(), coordinate)]);
        of.waypoints.push(Waypoint { angles, ..waypoint(part) });
    };
}

/// Declares costs of quantities that follow functions of time.
macro_rules! followed {
    ($($(#[$about:meta])* $name:ident($part:ident: $of:ty) $quantity:expr;)*) => {
        impl Control {
            $($(#[$about])*
            pub fn $name(self, $part: Handle<$of>, along: impl Into<Signal>, weight: f64) -> Self {
                let $part = $part.index();
                self.square($quantity, Some(along.into()), During::Motion, weight)
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

impl Control {
    /// Minimises ∫ |v|² dt of the velocity of a marker in m²/s, with a weight.
    pub fn low_speed(self, marker: Handle<Marker>, weight: f64) -> Self {
        self.low(Quantity::squared_speed(marker.index()), weight)
    }

    /// Minimises ∫ E² dt of the true electric field of a lumped muscle without a resistor in (V/µm)² s, with a weight.
    pub fn low_field(self, muscle: Handle<Muscle>, weight: f64) -> Self {
        self.low(Quantity::squared_field(muscle.index(), false), weight)
    }

    fn low(self, quantity: Quantity, weight: f64) -> Self {
        self.minimise(QuantityCost {
            quantity,
            weight,
            function: CostFunction::Itself,
            during: During::Motion,
        })
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
