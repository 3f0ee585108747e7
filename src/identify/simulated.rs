//! The motion of a recording on one grid, or its states of rest, read at all readings.

use crate::control::StartDerivatives;
use crate::control::problem::{BoundaryState, Identification, Recording, Regime, Voltages};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start, simulate};
use crate::identify::error::IdentifyError;
use crate::identify::readout::{Course, Values};
use crate::identify::sensitivity::{Beginning, CourseDerivatives, derivatives};
use crate::identify::setup::Setup;
use crate::model::System;
use nalgebra::DMatrix;
use std::ops::ControlFlow;

/// Values of all unknowns of one recording.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<'a> {
    pub(super) constants: &'a [f64],
    pub(super) start: &'a [f64],
}

impl Point<'_> {
    fn count(&self) -> usize {
        self.constants.len() + self.start.len()
    }
}

/// The readings of a recording on a grid of intervals, by constants and then unknowns of the start.
pub(super) fn readings(
    system: &System,
    task: &Identification,
    recording: &Recording,
    point: Point<'_>,
    intervals: usize,
) -> Result<Values, IdentifyError> {
    let duration = match recording.regime {
        Regime::Motion => recording.duration(),
        Regime::Rest => intervals as f64,
    };
    let grid = [duration, intervals as f64];
    let setup = Setup::new(system, task, recording, point.constants, grid)?;
    match recording.regime {
        Regime::Motion => in_motion(&setup, point, intervals),
        Regime::Rest => at_rest(&setup, point),
    }
}

fn in_motion(
    setup: &Setup<'_>,
    point: Point<'_>,
    intervals: usize,
) -> Result<Values, IdentifyError> {
    let (model, recording) = (&setup.model, setup.recording);
    let h = recording.duration() / intervals as f64;
    let (start, by_start) = start_of(setup, point)?;
    let scalars = |from: f64, to: f64| model.scalars(&setup.inputs.within(from, to));
    let (discrete, failure) = simulate(model, &start, h, intervals, scalars, |_| {
        ControlFlow::Continue(())
    });
    if let Some(source) = failure {
        return Err(IdentifyError::Motion {
            recording: recording.name.clone(),
            source,
        });
    }
    if discrete.intervals() < intervals {
        return Err(IdentifyError::Stopped);
    }
    let from = Beginning {
        start: &start,
        derivatives: Some(&by_start),
        unknowns: point.count(),
    };
    let by = derivatives(setup, from, &discrete, &setup.inputs.undelayed)?;
    let corners = setup.inputs.corners().into_iter();
    let course = Course {
        model,
        discrete: &discrete,
        derivatives: &by,
        corners: corners.filter(|t| *t < recording.duration()).collect(),
        is_still: false,
    };
    Ok(course.read(&recording.channels, point.count()))
}

/// The start and its derivatives; a state of rest depends on the constants.
fn start_of(
    setup: &Setup<'_>,
    point: Point<'_>,
) -> Result<(Start, StartDerivatives), IdentifyError> {
    let constants = point.constants.len();
    let (start, mut out) = setup.start((constants, point.start))?;
    if let BoundaryState::RestAtVoltages(voltages, _) = &setup.control.start {
        let state = setup.rest_under(voltages)?;
        let voltages = Voltages::Constant(voltages.clone());
        let by = of_rest(setup, &state, &voltages, constants)?.1;
        let by = &by.instants[0];
        out.coordinates.columns_mut(0, constants).copy_from(by);
    }
    Ok((start, out))
}

/// A state of rest as a motion of two intervals, and its derivatives by the constants.
fn of_rest(
    setup: &Setup<'_>,
    state: &Equilibrium,
    voltages: &Voltages,
    constants: usize,
) -> Result<(DiscreteTrajectory, CourseDerivatives), IdentifyError> {
    let model = &setup.model;
    let start = Start::at_rest(model, state.z.clone());
    let lasting = |intervals: usize| DiscreteTrajectory {
        times: (0..=intervals).map(|k| k as f64).collect(),
        z: vec![state.z.clone(); intervals + 1],
        scalars: vec![state.scalars.clone(); intervals],
        ..DiscreteTrajectory::default()
    };
    let from = Beginning {
        start: &start,
        derivatives: None,
        unknowns: constants,
    };
    let by = derivatives(setup, from, &lasting(1), voltages)?;
    // What a joint transmits is read between two intervals.
    Ok((lasting(2), by.lasting(2)))
}

/// States of rest, one for each time of a reading.
fn at_rest(setup: &Setup<'_>, point: Point<'_>) -> Result<Values, IdentifyError> {
    let recording = setup.recording;
    let mut out = Values {
        values: nalgebra::DVector::zeros(recording.count()),
        derivatives: DMatrix::zeros(recording.count(), point.count()),
    };
    let mut times: Vec<f64> = recording.readings().map(|reading| reading.time).collect();
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    for time in times {
        let voltages = setup.inputs.undelayed.at(time).to_vec();
        let state = setup.rest_under(&voltages)?;
        let voltages = Voltages::Constant(voltages);
        let (discrete, by) = of_rest(setup, &state, &voltages, point.constants.len())?;
        let course = Course {
            model: &setup.model,
            discrete: &discrete,
            derivatives: &by,
            corners: Vec::new(),
            is_still: true,
        };
        let read = course.read(&recording.channels, point.count());
        for (row, reading) in recording.readings().enumerate() {
            if reading.time == time {
                out.values[row] = read.values[row];
                out.derivatives.set_row(row, &read.derivatives.row(row));
            }
        }
    }
    Ok(out)
}
