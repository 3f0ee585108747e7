//! Points and vectors as they are written.

use nalgebra::Vector3;

use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope};
use crate::files::units::quantity::{Length, PhysicalQuantity, Quantity};

/// A point or a vector of lengths.
pub type Point = [Quantity<Length>; 3];

/// A point of which some coordinates are given.
pub type PartialPoint = [Option<Quantity<Length>>; 3];

objects! {
    /// A material point of a body.
    pub struct PointSpec {
        /// Name of the body, or `ground`.
        pub body: String,
        /// Place, SI unit m.
        pub at: Point,
    }
}

/// A vector of quantities in the units inside.
pub(crate) fn vector<M: PhysicalQuantity>(entries: &[Quantity<M>; 3]) -> Vector3<f64> {
    Vector3::from(entries.each_ref().map(Quantity::value))
}

objects! {
    /// Two corners of a box.
    pub struct CornersSpec {
        /// Lower corner, SI unit m.
        pub min: Point,
        /// Upper corner, SI unit m.
        pub max: Point,
    }
}

/// A direction of length one.
pub(crate) fn unit_axis(axis: &[f64; 3], scope: &Scope<'_>) -> Result<Vector3<f64>> {
    direction(axis).ok_or_else(|| {
        let found = format!("{axis:?}");
        scope.wrong(found, "a direction, such as [0, 0, 1]")
    })
}

/// The unit vector along an axis; `None` for an axis without a direction.
pub(crate) fn direction(axis: &[f64; 3]) -> Option<Vector3<f64>> {
    // Scaling by the largest entry keeps the norm of very long and very short axes in range.
    let largest = Vector3::from(*axis).amax();
    let scaled = Vector3::from(*axis) / largest;
    // Adding zero turns −0 into 0.
    let unit = scaled.normalize().map(|entry| entry + 0.0);
    unit.iter().all(|entry| entry.is_finite()).then_some(unit)
}
