//! Errors of motions in steps of second order, from two refinements that agree.
//!
//! With d the distance between two motions of which the second has steps of half the length, the error left on the second is d/3 and that on
//! the first 4 d/3, where steps are short enough for their order to show: then the distance before, between the first and a motion in steps of
//! twice the length, is about 4 d. An estimate is confirmed where that ratio lies between 2.5 and 6.5, or where both distances are
//! rounding.

use std::ops::RangeInclusive;

/// Ratios of two distances that show the order two.
const OF_ORDER_TWO: RangeInclusive<f64> = 2.5..=6.5;
/// Distances below this are rounding, in rad and lengths of the system.
const ROUNDING: f64 = 1e-11;

/// The error of a motion, estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedError {
    /// Its greatest distance from the exact motion, in rad and lengths of the system.
    pub error: f64,
    /// The same of its points alone, in mm.
    pub place: f64,
    /// True if a second refinement shows the order of the method.
    pub is_confirmed: bool,
}

/// Greatest distance between two motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Apart {
    /// In rad and lengths of the system.
    pub(crate) size: f64,
    /// Of points, in mm.
    pub(crate) place: f64,
}

impl EstimatedError {
    /// Returns true if it is confirmed to be no greater than a tolerance.
    pub(crate) fn is_below(&self, tolerance: f64) -> bool {
        self.is_confirmed && self.error <= tolerance
    }

    /// Of the finest of three motions, each in steps of half the length: from the distance `before` between the first two and `last`
    /// between the last two.
    pub(crate) fn of_finest(before: Apart, last: Apart) -> Self {
        let ratio = before.size / last.size;
        let is_rounding = before.size.max(last.size) < ROUNDING;
        let part = match ratio.is_finite() {
            true => 1.0 / (ratio.clamp(1.5, 4.0) - 1.0),
            false => 1.0,
        };
        Self {
            error: part * last.size,
            place: part * last.place,
            is_confirmed: is_rounding || OF_ORDER_TWO.contains(&ratio),
        }
    }

    /// Of the first of three motions.
    pub(crate) fn of_first(before: Apart, last: Apart) -> Self {
        let finest = Self::of_finest(before, last);
        Self {
            error: finest.error + last.size + before.size,
            place: finest.place + last.place + before.place,
            ..finest
        }
    }
}
