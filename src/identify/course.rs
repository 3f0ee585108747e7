//! The motion of a recording on one grid, or its states of rest, read at all readings.

use crate::control::problem::{BoundaryState, Identification, Recording, Regime, Voltages};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start, simulate};
use crate::identify::error::IdentifyError;
use crate::identify::readout::{Course, Values};
use crate::identify::sensitivity::{CourseDerivatives, StartDerivatives, derivatives};
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
    let start = setup.start(point.start)?;
    let scalars = |from: f64, to: f64| model.scalars(&setup.voltages.at(0.5 * (from + to)));
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
    let by_start = by_start(setup, point)?;
    let inputs = (&*setup.voltages, Regime::Motion);
    let by = derivatives(setup, (&start, &by_start), &discrete, inputs)?;
    let corners = setup.voltages.switches();
    let inside = |corner: &&f64| **corner < recording.duration();
    let course = Course {
        model,
        discrete: &discrete,
        derivatives: &by,
        corners: corners.iter().filter(inside).copied().collect(),
        is_still: false,
        delay: setup.drive.delay,
    };
    Ok(course.read(&recording.channels, point.count()))
}

/// Derivatives of the state at the start; a state of rest depends on the constants.
fn by_start(setup: &Setup<'_>, point: Point<'_>) -> Result<StartDerivatives, IdentifyError> {
    let (n, constants) = (setup.model.coordinate_count(), point.constants.len());
    let (coordinates, momenta) = setup.sought();
    let mut out = StartDerivatives {
        coordinates: DMatrix::zeros(n, point.count()),
        momenta: DMatrix::zeros(n, point.count()),
    };
    if let BoundaryState::RestAtVoltages(voltages, _) = &setup.control.start {
        let state = setup.rest_under(voltages)?;
        let voltages = Voltages::Constant(voltages.clone());
        let by = of_rest(setup, &state, &voltages, constants)?.1;
        let by = &by.instants[0];
        out.coordinates.columns_mut(0, constants).copy_from(by);
    }
    for (j, &i) in coordinates.iter().enumerate() {
        out.coordinates[(i, constants + j)] = 1.0;
    }
    for (j, &i) in momenta.iter().enumerate() {
        out.momenta[(i, constants + coordinates.len() + j)] = 1.0;
    }
    Ok(out)
}

/// A state of rest as a motion of two intervals, and its derivatives by the constants.
fn of_rest(
    setup: &Setup<'_>,
    state: &Equilibrium,
    voltages: &Voltages,
    constants: usize,
) -> Result<(DiscreteTrajectory, CourseDerivatives), IdentifyError> {
    let model = &setup.model;
    let none = DMatrix::zeros(model.coordinate_count(), constants);
    let by_start = StartDerivatives {
        coordinates: none.clone(),
        momenta: none,
    };
    let start = Start::at_rest(model, state.z.clone());
    let lasting = |intervals: usize| DiscreteTrajectory {
        times: (0..=intervals).map(|k| k as f64).collect(),
        z: vec![state.z.clone(); intervals + 1],
        scalars: vec![state.scalars.clone(); intervals],
        ..DiscreteTrajectory::default()
    };
    let inputs = (voltages, Regime::Rest);
    let by = derivatives(setup, (&start, &by_start), &lasting(1), inputs)?;
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
        let voltages = setup.voltages.at(time).to_vec();
        let state = setup.rest_under(&voltages)?;
        let voltages = Voltages::Constant(voltages);
        let (discrete, by) = of_rest(setup, &state, &voltages, point.constants.len())?;
        let course = Course {
            model: &setup.model,
            discrete: &discrete,
            derivatives: &by,
            corners: Vec::new(),
            is_still: true,
            delay: None,
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
