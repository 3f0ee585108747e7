//! The types of `feedback.json`, and the factors of its units.

use crate::feedback::{Measured, Memory, Reading};
use crate::model::system::Source;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LawRecord {
    /// Name of the scene.
    pub(super) scene: String,
    /// Length of the intervals in s.
    pub(super) interval: f64,
    /// Intervals from a measurement to its effect, over which gains predict.
    #[serde(default)]
    pub(super) delay_intervals: usize,
    pub(super) measured: Vec<MeasuredRecord>,
    pub(super) inputs: Vec<InputRecord>,
    /// Places among what is measured of deviations that are integrated over time.
    pub(super) integrals: Vec<usize>,
    /// One for each interval.
    pub(super) intervals: Vec<PointRecord>,
    /// After the end, where the goal is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) held: Option<PointRecord>,
    /// The filter that finds what is measured from other readings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) observer: Option<ObserverRecord>,
    /// Places of markers in m at the instants.
    pub(super) markers: BTreeMap<String, Vec<[f64; 3]>>,
}

/// An observer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObserverRecord {
    pub(super) readings: Vec<ReadingRecord>,
    pub(super) intervals: Vec<FilterRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) held: Option<FilterRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) lasting: Option<LastingRecord>,
    /// State at the end of the motion as a deviation from the goal that is held.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) jump: Vec<f64>,
}

/// Constant disturbances that the filter finds, and what inputs change of them at the goal.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LastingRecord {
    pub(super) forces: Vec<ForceRecord>,
    /// A row for each force, over the inputs or their squares.
    pub(super) by_inputs: Vec<Vec<f64>>,
}

/// A constant disturbance on a coordinate: N m, N.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ForceRecord {
    pub(super) on: String,
    pub(super) unit: String,
}

/// A reading of an observer.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ReadingRecord {
    /// A coordinate, by its place among what is measured.
    Measured(usize),
    /// A component of the place of a marker in m, by the name of the marker and the axis, 0 to 2.
    Marker(String, usize),
}

/// The filter in an interval: readings, and the matrices A, B, C and M row by row, over what is measured and the constant disturbances.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterRecord {
    pub(super) readings: Vec<f64>,
    pub(super) by_state: Vec<Vec<f64>>,
    pub(super) by_inputs: Vec<Vec<f64>>,
    pub(super) output: Vec<Vec<f64>>,
    pub(super) gain: Vec<Vec<f64>>,
}

/// A coordinate or its rate: rad, m, rad/s, m/s; or what a muscle remembers: a number, C.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeasuredRecord {
    pub(super) name: String,
    pub(super) unit: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) is_memory: bool,
}

/// A voltage or a load: V, or the unit of the load.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InputRecord {
    pub(super) name: String,
    pub(super) unit: String,
    /// True if gains are for the square of the voltage.
    pub(super) is_squared: bool,
    pub(super) bounds: [f64; 2],
}

/// The law in an interval.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointRecord {
    pub(super) state: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    /// A row for each input, over what is measured, then constant disturbances and the changes of inputs against them, then the integrals, then the
    /// corrections of the inputs in each interval of the delay.
    pub(super) gain: Vec<Vec<f64>>,
    /// Correction of each input whatever is measured, where a delay leads behind the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) offset: Vec<f64>,
}

/// Unit of a measured quantity, and its factor from the units inside.
pub(crate) fn unit_of(measured: &Measured) -> (&'static str, f64) {
    match (measured.memory, measured.is_length, measured.is_rate) {
        (Some(Memory::Number), ..) => ("1", 1.0),
        (Some(Memory::Charge(unit)), ..) => ("C", 1e-3 * unit),
        (None, false, false) => ("rad", 1.0),
        (None, false, true) => ("rad/s", 1e3),
        (None, true, false) => ("m", 1e-3),
        (None, true, true) => ("m/s", 1.0),
    }
}

/// Unit of a constant disturbance, and its factor from the units inside.
pub(super) fn unit_of_force(is_length: bool) -> (&'static str, f64) {
    match is_length {
        true => ("N", 1.0),
        false => ("N m", 1e-3),
    }
}

/// Factor of an integral over time of a quantity with a factor.
pub(super) fn integrated(factor: f64) -> f64 {
    factor * 1e-3
}

/// Unit of an input, and its factor from the units inside.
pub(super) fn unit_of_input(source: &Source) -> (&'static str, f64) {
    let (unit, size) = source.kind.si();
    (unit, 1.0 / size)
}

/// Factor of a reading from the units inside.
pub(crate) fn factor_of(reading: &Reading, measured: &[Measured]) -> f64 {
    match reading {
        Reading::State(place) => unit_of(&measured[*place]).1,
        Reading::Marker(..) => 1e-3,
    }
}
