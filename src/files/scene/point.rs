//! Points and vectors as they are written.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::files::units::quantity::{Length, PhysicalQuantity, Quantity};

/// A point or a vector of lengths.
pub type Point = [Quantity<Length>; 3];

/// A point of which some coordinates are given.
pub type PartialPoint = [Option<Quantity<Length>>; 3];

/// A material point of a body.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointSpec {
    /// Name of the body, or `ground`.
    pub body: String,
    /// Place, SI unit m.
    pub at: Point,
}

/// A vector of quantities in the units inside.
pub(crate) fn vector<M: PhysicalQuantity>(entries: &[Quantity<M>; 3]) -> Vector3<f64> {
    Vector3::from(entries.each_ref().map(Quantity::value))
}

/// Two corners of a box.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CornersSpec {
    /// Lower corner, SI unit m.
    pub min: Point,
    /// Upper corner, SI unit m.
    pub max: Point,
}
