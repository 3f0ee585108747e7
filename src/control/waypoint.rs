//! Waypoints: what a motion reaches at an instant on its way.

use crate::control::goal::{Orientation, Place};
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

/// The instant nearest to a part of the duration, of a motion of this number of intervals; never the first one.
pub fn instant_at(part: f64, intervals: usize) -> usize {
    ((part * intervals as f64).round() as usize).clamp(1, intervals)
}
