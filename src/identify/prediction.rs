//! Prediction of all readings: on two grids, extrapolated to steps of zero length.
//!
//! The error of the midpoint rule is an even function of the step h, `y(h) = y + a h² + O(h⁴)`, so that `(4 y(h/2) − y(h))/3` is of
//! fourth order, and so are its derivatives.

use crate::control::problem::{Identification, Prior, Recording, Regime, SoughtStart};
use crate::identify::error::IdentifyError;
use crate::identify::readout::Values;
use crate::identify::setup::Setup;
use crate::identify::simulated::{Point, readings};
use crate::identify::unknowns::Unknowns;
use crate::math::{cores, has_pool};
use crate::model::{Constant, System};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Least number of intervals of the first grid.
const LEAST: usize = 16;
/// Part of an interval by which a time may miss an instant.
const OFF: f64 = 1e-6;
/// Part of an interval by which corners may differ that count as one.
const NEAR: f64 = 1e-3;
/// Most intervals of the first grid where the problem gives no step.
const MOST: usize = 400;

/// Numbers of intervals of the recordings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Intervals of the coarser one of the two grids of each recording.
    pub intervals: Vec<usize>,
    /// Recordings of which the instants lie at all corners of voltages.
    pub meets_corners: Vec<bool>,
}

impl Grid {
    /// The first grid: with the step of the problem, or as many intervals as there are times of readings; a few more where readings and
    /// corners of voltages lie at its instants then.
    pub fn first(task: &Identification, recordings: &[Recording]) -> Self {
        let mut constants = task.parameters.iter().flat_map(|one| &one.constants);
        // Delayed corners lie somewhere.
        let is_delayed = constants.any(|one| matches!(one.constant, Constant::Delay(_)));
        let of = |recording: &Recording| match (recording.regime, task.step) {
            (Regime::Rest, _) => (1, true),
            (_, Some(step)) => {
                let least = (recording.duration() / step - 1e-9).ceil().max(4.0);
                meeting(recording, least as usize)
            }
            (_, None) => {
                let lengths = recording.channels.iter().map(|one| one.readings.len());
                meeting(recording, lengths.max().unwrap_or(0).clamp(LEAST, MOST))
            }
        };
        let met = |(intervals, meets)| (intervals, meets && !is_delayed);
        let (intervals, meets_corners) = recordings.iter().map(of).map(met).unzip();
        Self {
            intervals,
            meets_corners,
        }
    }

    /// The grid of half the steps; of a little less where instants miss a corner, which would lie in the same part of an interval again,
    /// with the same error.
    #[must_use]
    pub fn halved(&self) -> Self {
        Self {
            intervals: self
                .intervals
                .iter()
                .zip(&self.meets_corners)
                .map(|(n, meets)| 2 * n + usize::from(!meets))
                .collect(),
            meets_corners: self.meets_corners.clone(),
        }
    }
}

/// The least number of intervals at whose instants all readings and corners of voltages lie, or all corners, or some number where there is
/// none near it: interpolation is exact at instants, and between corners the motion is smooth. Corners that hardly differ count as one.
/// Returns true if instants lie at all corners.
fn meeting(recording: &Recording, least: usize) -> (usize, bool) {
    let duration = recording.duration();
    let corners: Vec<f64> = recording.voltages.switches().to_vec();
    let mut corners: Vec<f64> = corners.into_iter().filter(|t| *t < duration).collect();
    let near = NEAR * duration / least as f64;
    corners.dedup_by(|next, before| *next - *before < near);
    let readings = recording.readings().map(|reading| reading.time);
    let all: Vec<f64> = readings.chain(corners.iter().copied()).collect();
    let meets = |times: &[f64]| {
        let is_met = |n: &usize| {
            let place = |time: &f64| time / duration * *n as f64;
            let mut places = times.iter().map(place);
            places.all(|place| (place - place.round()).abs() < OFF)
        };
        (least..=4 * least).find(is_met)
    };
    let found = meets(&all).or_else(|| meets(&corners));
    (found.unwrap_or(least), found.is_some())
}

/// Values and derivatives of all readings of some recordings by all unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Values, recording by recording, channel by channel.
    pub values: DVector<f64>,
    /// Derivatives.
    pub derivatives: DMatrix<f64>,
}

impl Prediction {
    /// The same with constants that are known beside the recordings, as readings behind all others.
    #[must_use]
    pub(super) fn with_priors(self, priors: &[Prior], constants: &[f64]) -> Self {
        let (count, columns) = self.derivatives.shape();
        let rows = count + priors.len();
        let mut out = Self {
            values: self.values.resize_vertically(rows, 0.0),
            derivatives: self.derivatives.resize(rows, columns, 0.0),
        };
        for (row, prior) in (count..).zip(priors) {
            out.values[row] = constants[prior.constant];
            out.derivatives[(row, prior.constant)] = 1.0;
        }
        out
    }
}

/// Number of unknowns of the start of a recording.
pub(super) fn count_of_start(
    system: &System,
    task: &Identification,
    recording: &Recording,
) -> Result<usize, IdentifyError> {
    if recording.sought_start == SoughtStart::Nothing {
        return Ok(0);
    }
    let guesses: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
    let setup = Setup::new(
        system,
        task,
        recording,
        &guesses,
        [recording.duration(), 4.0],
    )?;
    setup.count_of_start()
}

/// The prediction of one recording, extrapolated.
fn of_recording(
    system: &System,
    task: &Identification,
    recording: &Recording,
    point: Point<'_>,
    intervals: usize,
) -> Result<Values, IdentifyError> {
    let on = |intervals| readings(system, task, recording, point, intervals);
    if recording.regime == Regime::Rest {
        return on(intervals);
    }
    let (coarse, fine) = (on(intervals)?, on(2 * intervals)?);
    Ok(Values {
        values: (fine.values * 4.0 - coarse.values) / 3.0,
        derivatives: (fine.derivatives * 4.0 - coarse.derivatives) / 3.0,
    })
}

/// The recordings `which` of a task, by all unknowns, with derivatives.
///
/// # Errors
/// A recording cannot be simulated.
pub fn predict(
    (system, task): (&System, &Identification),
    which: &[usize],
    unknowns: &Unknowns,
    grid: &Grid,
) -> Result<Prediction, IdentifyError> {
    let of = |&r: &usize| {
        let point = Point {
            constants: unknowns.of_constants(),
            start: unknowns.of_start(r),
        };
        let recording = &task.recordings[r];
        of_recording(system, task, recording, point, grid.intervals[r])
    };
    let parts: Vec<_> = match which.len() > 1 && cores() > 1 && has_pool() {
        true => which.par_iter().map(of).collect(),
        false => which.iter().map(of).collect(),
    };
    let parts: Vec<Values> = parts.into_iter().collect::<Result<_, _>>()?;
    let rows = parts.iter().map(|part| part.values.len()).sum();
    let mut out = Prediction {
        values: DVector::zeros(rows),
        derivatives: DMatrix::zeros(rows, unknowns.values.len()),
    };
    let (mut row, constants) = (0, unknowns.constants);
    for (&r, part) in which.iter().zip(&parts) {
        let (count, of_start) = (part.values.len(), unknowns.starts[r].clone());
        out.values.rows_mut(row, count).copy_from(&part.values);
        let mut rows = out.derivatives.rows_mut(row, count);
        let by = &part.derivatives;
        rows.columns_mut(0, constants)
            .copy_from(&by.columns(0, constants));
        let own = by.columns(constants, of_start.len());
        rows.columns_mut(of_start.start, of_start.len())
            .copy_from(&own);
        row += count;
    }
    Ok(out)
}
