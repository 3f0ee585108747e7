//! Waypoints: what a motion reaches at an instant on its way.

use crate::control::goal::{Orientation, Place};
use crate::control::quantity_cost::{CostFunction, During, QuantityCost};
use crate::math::Signal;
use crate::model::Quantity;
use std::collections::BTreeMap;

/// Places, orientations and joint coordinates at one instant on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waypoint {
    /// Part of the duration at which they are reached, above 0 and at most 1: at the instant nearest to it.
    pub part: f64,
    /// Name in messages.
    pub name: String,
    /// Places of markers.
    pub places: BTreeMap<usize, Place>,
    /// Orientations of bodies.
    pub orientations: BTreeMap<usize, Orientation>,
    /// Coordinates of joints in rad or mm.
    pub angles: BTreeMap<usize, f64>,
}

impl Waypoint {
    /// The squared distances from its places and coordinates at its instant, as costs with a weight.
    pub fn costs(&self, weight: f64) -> Vec<QuantityCost> {
        let cost = |(quantity, value): (Quantity, f64)| QuantityCost {
            quantity,
            weight,
            function: CostFunction::Square {
                reference: Signal::Constant(value),
            },
            during: During::At(self.part),
        };
        let places = self.places.iter().flat_map(|(&marker, place)| {
            let given = place.given();
            given.map(move |(axis, value)| (Quantity::marker_place(marker, axis), value))
        });
        let angles = self.angles.iter();
        let angles = angles.map(|(&joint, &value)| (Quantity::Joint { joint, near: 0.0 }, value));
        places.chain(angles).map(cost).collect()
    }
}

/// The instant nearest to a part of the duration, of a motion of this number of intervals; never the first one.
pub fn instant_at(part: f64, intervals: usize) -> usize {
    ((part * intervals as f64).round() as usize).clamp(1, intervals)
}
