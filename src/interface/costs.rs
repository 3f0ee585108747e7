//! Costs of a control problem in addition to its voltages: energies of sources, squared deviations of markers and joints; and waypoints.

use crate::control::problem::{
    self, CostFunction, During, EnergyCost, Place, QuantityCost, SourceEnergy, Waypoint,
};
use crate::interface::control::Control;
use crate::interface::error::{Result, require};
use crate::interface::handle::Handle;
use crate::math::Signal;
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{Quantity, System};
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

    /// Minimises the square of the peak voltage in kV, the largest of all voltages that are sought, with a weight.
    pub fn peak_voltage(mut self, weight: f64) -> Self {
        self.peak_voltage = weight;
        self
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

    /// The coordinate of a joint follows a function of time in rad or mm: minimises ∫ (θ − r)² dt in rad² s or mm² s, with a weight.
    pub fn track_joint(self, joint: Handle<Joint>, along: impl Into<Signal>, weight: f64) -> Self {
        let quantity = of_joint(joint);
        self.square(quantity, Some(along.into()), During::Motion, weight)
    }

    /// A marker is at a place in mm, in the directions that have a value, at the instant nearest to a part of the duration.
    pub fn marker_passes(
        mut self,
        marker: Handle<Marker>,
        place: [Option<f64>; 3],
        part: f64,
    ) -> Self {
        self.waypoints.push(Waypoint {
            places: BTreeMap::from([(marker.index(), Place(place))]),
            ..waypoint(part)
        });
        self
    }

    /// A joint has a coordinate in rad or mm at the instant nearest to a part of the duration.
    pub fn joint_passes(mut self, joint: Handle<Joint>, coordinate: f64, part: f64) -> Self {
        self.waypoints.push(Waypoint {
            angles: BTreeMap::from([(joint.index(), coordinate)]),
            ..waypoint(part)
        });
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
