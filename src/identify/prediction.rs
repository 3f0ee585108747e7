//! Prediction of all readings: on two grids, extrapolated to steps of zero length.
//!
//! The error of the midpoint rule is an even function of the step h, `y(h) = y + a h² + O(h⁴)`, so that `(4 y(h/2) − y(h))/3` is of
//! fourth order, and so are its derivatives.

use crate::control::problem::{BoundaryState, Identification, Prior, Recording, Regime, Voltages};
use crate::control::{StartDerivatives, rest_at};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start, StepError, simulate};
use crate::identify::error::IdentifyError;
use crate::identify::readout::{Course, Prediction, derivatives};
use crate::identify::setup::{Problem, Setup};
use crate::math::{cores, has_pool, in_order};
use crate::model::Constant;
use rayon::prelude::*;
use std::ops::{ControlFlow, Range};

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
    let mut corners = recording.voltages.switches();
    corners.retain(|t| *t < duration);
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

impl<'a> Problem<'a> {
    /// Number of unknowns of the start of a recording.
    pub(super) fn count_of_start(self, recording: &'a Recording) -> Result<usize, IdentifyError> {
        if !recording.seeks_start() {
            return Ok(0);
        }
        let grid = [recording.duration(), 4.0];
        self.setup(recording, &self.guesses(), grid)?
            .count_of_start()
    }

    /// The recordings `which`, by all unknowns, with derivatives.
    ///
    /// # Errors
    /// A recording cannot be simulated.
    pub fn predict(
        self,
        which: &[usize],
        unknowns: &Unknowns,
        grid: &Grid,
    ) -> Result<Prediction, IdentifyError> {
        let of = |&r: &usize| {
            let point = [unknowns.of_constants(), unknowns.of_start(r)];
            self.extrapolated(&self.task.recordings[r], point, grid.intervals[r])
        };
        let parts: Vec<_> = match which.len() > 1 && cores() > 1 && has_pool() {
            true => which.par_iter().map(of).collect(),
            false => which.iter().map(of).collect(),
        };
        let parts: Vec<Prediction> = parts.into_iter().collect::<Result<_, _>>()?;
        let rows = parts.iter().map(|part| part.values.len()).sum();
        let mut out = Prediction::zeros(rows, unknowns.values.len());
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

    /// The prediction of one recording by constants and unknowns of its start, extrapolated.
    fn extrapolated(
        self,
        recording: &'a Recording,
        point: [&[f64]; 2],
        intervals: usize,
    ) -> Result<Prediction, IdentifyError> {
        let on = |intervals| self.readings(recording, point, intervals);
        if recording.regime == Regime::Rest {
            return on(intervals);
        }
        let (coarse, fine) = (on(intervals)?, on(2 * intervals)?);
        Ok(Prediction {
            values: (fine.values * 4.0 - coarse.values) / 3.0,
            derivatives: (fine.derivatives * 4.0 - coarse.derivatives) / 3.0,
        })
    }

    /// The readings of a recording on a grid of intervals, by constants and then unknowns of the start.
    fn readings(
        self,
        recording: &'a Recording,
        [constants, start]: [&[f64]; 2],
        intervals: usize,
    ) -> Result<Prediction, IdentifyError> {
        let setup = self.on_grid(recording, constants, intervals)?;
        match recording.regime {
            Regime::Motion => in_motion(&setup, start, intervals),
            Regime::Rest => at_rest(&setup),
        }
    }

    /// The model of a recording on a grid of intervals.
    pub(super) fn on_grid(
        self,
        recording: &'a Recording,
        constants: &[f64],
        intervals: usize,
    ) -> Result<Setup<'a>, IdentifyError> {
        let duration = match recording.regime {
            Regime::Motion => recording.duration(),
            Regime::Rest => intervals as f64,
        };
        self.setup(recording, constants, [duration, intervals as f64])
    }
}

/// The motion of a recording on a grid of intervals, and why it has fewer.
pub(super) fn simulated(
    setup: &Setup<'_>,
    start: &Start,
    intervals: usize,
) -> (DiscreteTrajectory, Option<StepError>) {
    let (model, h) = (&setup.model, setup.recording.duration() / intervals as f64);
    let scalars = |from: f64, to: f64| model.scalars(&setup.inputs.within(from, to));
    let go_on = |_: &DiscreteTrajectory| ControlFlow::Continue(());
    simulate(model, start, h, intervals, scalars, go_on)
}

fn in_motion(
    setup: &Setup<'_>,
    values: &[f64],
    intervals: usize,
) -> Result<Prediction, IdentifyError> {
    let (model, recording) = (&setup.model, setup.recording);
    let (start, by_start) = start_of(setup, values)?;
    let (discrete, failure) = simulated(setup, &start, intervals);
    if let Some(failure) = failure {
        return Err(recording.refused(failure));
    }
    if discrete.intervals() < intervals {
        return Err(IdentifyError::Stopped);
    }
    let (from, count) = (Some((&start, &by_start)), setup.constants() + values.len());
    let by = derivatives(setup, from, &discrete, &setup.inputs.undelayed, count)?;
    let corners = setup.inputs.corners().into_iter();
    let course = Course {
        model,
        discrete,
        derivatives: by,
        corners: corners.filter(|t| *t < recording.duration()).collect(),
        is_still: false,
    };
    Ok(course.read(&recording.channels, count))
}

/// The start and its derivatives; a state of rest depends on the constants.
fn start_of(setup: &Setup<'_>, values: &[f64]) -> Result<(Start, StartDerivatives), IdentifyError> {
    let (start, mut out) = setup.start(values)?;
    if let BoundaryState::RestAtVoltages(voltages, _) = &setup.control.start {
        let by = of_rest(setup, voltages)?.derivatives;
        for (i, mut row) in out.coordinates.row_iter_mut().enumerate() {
            let by = by.of_coordinate(0, i).into_iter();
            by.for_each(|by| row.columns_mut(0, by.len()).copy_from(by));
        }
    }
    Ok((start, out))
}

/// The state of rest under voltages in V, by source, as a motion of two intervals, with its derivatives by the constants.
fn of_rest<'a>(setup: &'a Setup<'_>, voltages: &[f64]) -> Result<Course<'a>, IdentifyError> {
    let model = &setup.model;
    let state = rest_at(model, voltages, "rest", 0.0);
    let state = state.map_err(|error| setup.recording.refused(error))?;
    let lasting = |intervals: usize| {
        let z = vec![state.z.clone(); intervals + 1];
        DiscreteTrajectory::in_steps(1.0, z, vec![state.scalars.clone(); intervals])
    };
    let voltages = Voltages::constant(voltages);
    // What a joint transmits is read between two intervals.
    Ok(Course {
        model,
        derivatives: derivatives(setup, None, &lasting(1), &voltages, setup.constants())?,
        discrete: lasting(2),
        corners: Vec::new(),
        is_still: true,
    })
}

/// States of rest, one for each time of a reading.
fn at_rest(setup: &Setup<'_>) -> Result<Prediction, IdentifyError> {
    let (recording, count) = (setup.recording, setup.constants());
    let mut out = Prediction::zeros(recording.count(), count);
    for time in in_order(recording.readings().map(|reading| reading.time)) {
        let voltages = setup.inputs.undelayed.at(time);
        let course = of_rest(setup, &voltages)?;
        let read = course.read(&recording.channels, count);
        for (row, reading) in recording.readings().enumerate() {
            if reading.time == time {
                out.values[row] = read.values[row];
                out.derivatives.set_row(row, &read.derivatives.row(row));
            }
        }
    }
    Ok(out)
}

/// The states of rest at the times of readings.
pub(super) fn states_of_rest(setup: &Setup<'_>) -> Result<DiscreteTrajectory, IdentifyError> {
    let model = &setup.model;
    let times = in_order(setup.recording.readings().map(|reading| reading.time));
    let at = |&time: &f64| rest_at(model, &setup.inputs.undelayed.at(time), "rest", 0.0);
    let states: Result<Vec<_>, _> = times.iter().map(at).collect();
    let states = states.map_err(|error| setup.recording.refused(error))?;
    let in_turn = times.iter().copied().zip(&states);
    Ok(Equilibrium::in_turn(model, times[0], in_turn))
}

/// Values of all unknowns: constants in the units of their components, and changes of coordinates and momenta at starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknowns {
    /// Values.
    pub values: Vec<f64>,
    /// Number of constants.
    pub constants: usize,
    /// Unknowns of the start of each recording; none of those that are held out.
    pub starts: Vec<Range<usize>>,
}

impl Unknowns {
    /// Constants at their guesses, starts as they are given; `count` tells the number of unknowns of a start.
    pub(super) fn new(task: &Identification, mut count: impl FnMut(&Recording) -> usize) -> Self {
        let guesses: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
        let of_start = |recording: &Recording| match recording.is_held_out {
            true => Vec::new(),
            false => vec![0.0; count(recording)],
        };
        let starts: Vec<Vec<f64>> = task.recordings.iter().map(of_start).collect();
        let starts: Vec<&[f64]> = starts.iter().map(Vec::as_slice).collect();
        Self::of_values(&guesses, &starts)
    }

    /// Values of the constants, and of the unknowns of the start of each recording.
    pub fn of_values(constants: &[f64], starts: &[&[f64]]) -> Self {
        let mut values = constants.to_vec();
        let range = |start: &&[f64]| {
            let first = values.len();
            values.extend_from_slice(start);
            first..values.len()
        };
        Self {
            starts: starts.iter().map(range).collect(),
            constants: constants.len(),
            values,
        }
    }

    /// The constants.
    pub fn of_constants(&self) -> &[f64] {
        &self.values[..self.constants]
    }

    /// Unknowns of the start of a recording.
    pub fn of_start(&self, recording: usize) -> &[f64] {
        &self.values[self.starts[recording].clone()]
    }
}
