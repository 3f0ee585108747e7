//! Places and orientations at the end of a motion.

use crate::control::costs::{CostFunction, During, QuantityCost};
use crate::math::{Signal, Vector};
use crate::model::Quantity;
use nalgebra::{Rotation3, Unit};
use std::collections::BTreeMap;

/// A place in mm; directions that are not given are free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place(pub [Option<f64>; 3]);

impl From<Vector> for Place {
    fn from(place: Vector) -> Self {
        Self([place.x, place.y, place.z].map(Some))
    }
}

impl Place {
    /// The components that are given.
    pub fn given(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.0.iter().enumerate();
        all.filter_map(|(axis, value)| Some((axis, (*value)?)))
    }

    /// The place, where all of it is given.
    pub fn whole(&self) -> Option<Vector> {
        let [x, y, z] = self.0;
        Some(Vector::new(x?, y?, z?))
    }

    /// Distance in mm from another place, in the directions that are given.
    pub fn distance(&self, other: &Vector) -> f64 {
        let squares = self.given().map(|(axis, value)| other[axis] - value);
        squares.map(|far| far * far).sum::<f64>().sqrt()
    }
}

/// An orientation of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// A direction fixed to the body, given in the reference configuration, points towards another one; unit vectors of the
    /// ground frame.
    Towards {
        /// Direction a in the reference configuration.
        axis: Vector,
        /// Direction to which it points.
        towards: Vector,
    },
    /// The body is turned from its reference configuration.
    Turned {
        /// Unit vector in the ground frame.
        axis: Vector,
        /// Angle in rad.
        angle: f64,
    },
}

/// A product of a direction of a body with a direction of the ground: both orthogonal, or at an acute angle.
pub(super) struct Product {
    /// Direction fixed to the body, in the reference configuration.
    pub(super) axis: Vector,
    /// Direction of the ground.
    pub(super) along: Vector,
    /// At an acute angle, instead of orthogonal.
    pub(super) is_acute: bool,
}

impl Orientation {
    /// Returns true if its directions are unit vectors and its angle is finite.
    pub fn is_sound(&self) -> bool {
        let is_unit = |v: &Vector| (v.norm() - 1.0).abs() < 1e-9;
        match self {
            Self::Towards { axis, towards } => is_unit(axis) && is_unit(towards),
            Self::Turned { axis, angle } => is_unit(axis) && angle.is_finite(),
        }
    }

    /// The conditions. Products that vanish fix a line; acute angles choose one of its ends.
    pub(super) fn products(&self) -> Vec<Product> {
        let orthogonal = |axis, along| Product {
            axis,
            along,
            is_acute: false,
        };
        let acute = |axis, along| Product {
            axis,
            along,
            is_acute: true,
        };
        match *self {
            Self::Towards { axis, towards } => {
                // The cross product is the axis of the shortest turn: a robot that turns about one axis leaves the other free.
                let across = axis.cross(&towards);
                let least = towards.iamin();
                let other = towards.cross(&Vector::ith(least, 1.0));
                let first = across
                    .try_normalize(1e-6)
                    .unwrap_or_else(|| other.normalize());
                let second = towards.cross(&first);
                vec![
                    orthogonal(axis, first),
                    orthogonal(axis, second),
                    acute(axis, towards),
                ]
            }
            Self::Turned { axis, angle } => {
                let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(axis), angle);
                let [x, y, z] = [0, 1, 2].map(|i| Vector::ith(i, 1.0));
                let turned = [x, y, z].map(|e| turn * e);
                vec![
                    orthogonal(x, turned[1]),
                    orthogonal(y, turned[2]),
                    orthogonal(z, turned[0]),
                    acute(x, turned[0]),
                    acute(y, turned[1]),
                ]
            }
        }
    }
}

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
        let cost = |quantity: Quantity, value: f64| QuantityCost {
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
        let angles = angles.map(|(&joint, &value)| (Quantity::joint(joint, 0.0), value));
        let all = places.chain(angles);
        all.map(|(quantity, value)| cost(quantity, value)).collect()
    }
}

/// The instant nearest to a part of the duration, of a motion of this number of intervals; never the first one.
pub fn instant_at(part: f64, intervals: usize) -> usize {
    ((part * intervals as f64).round() as usize).clamp(1, intervals)
}
