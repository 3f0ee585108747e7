//! Simulation: step after step, recorded.

use crate::dynamics::history::{History, Reading};
use crate::dynamics::solving::{Integrator, Solving};
use crate::dynamics::stepper::{Equations, Steps};
use crate::dynamics::{StepError, Stepper};
use crate::model::Model;
use std::ops::ControlFlow;

/// Where a motion starts: coordinates z and the momentum of each coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Momenta.
    pub momentum: Vec<f64>,
    /// Rates of the coordinates, where the momenta were made of them.
    pub rates: Option<Vec<f64>>,
}

impl Start {
    /// At rest.
    pub fn at_rest(model: &Model, z: Vec<f64>) -> Self {
        Self {
            z,
            momentum: vec![0.0; model.coordinate_count()],
            rates: None,
        }
    }

    /// With given rates of the coordinates.
    pub fn with_rates(model: &Model, z: Vec<f64>, rates: &[f64]) -> Self {
        let mut instant = model.action.motion.instant();
        instant.z.copy_from_slice(&z);
        model.action.motion.place(&mut instant);
        let momentum = model.action.momentum(&mut instant, rates);
        Self {
            z,
            momentum,
            rates: Some(rates.to_vec()),
        }
    }
}

/// Integrates `steps` steps of `h` ms; `voltages` gives those of the interval between two times, by scalar.
///
/// After each step `observer` sees its number and may end the motion; so may a [watch](crate::ipopt::interrupt::watch), within a
/// step too.
///
/// The history ends where a step fails; the error says why.
pub fn simulate(
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    voltages: impl Fn(f64, f64) -> Vec<f64>,
    observer: impl FnMut(usize) -> ControlFlow<()>,
) -> (History, Option<StepError>) {
    simulate_by(
        Solving::default(),
        model,
        start,
        h,
        steps,
        voltages,
        observer,
    )
}

/// Integrates like [`simulate`], by the method and with the solution of its equations that `solving` names.
pub fn simulate_by(
    solving: Solving,
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    voltages: impl Fn(f64, f64) -> Vec<f64>,
    observer: impl FnMut(usize) -> ControlFlow<()>,
) -> (History, Option<StepError>) {
    let mut history = History {
        times: vec![0.0],
        z: vec![start.z.clone()],
        momenta: vec![start.momentum.clone()],
        rates: start.rates.clone(),
        ..History::default()
    };
    let grid = Grid { h, steps };
    let failure = if solving.integrator == Integrator::Midpoint {
        let mut stepper = Stepper::new(model, &start.z, &start.momentum, solving);
        record(&mut stepper, grid, voltages, observer, &mut history)
    } else {
        history.reading = Reading::Instants;
        match Steps::stages(model, start, solving, h, &voltages(0.0, h)) {
            Ok(mut stages) => record(&mut stages, grid, voltages, observer, &mut history),
            Err(error) => Some(error),
        }
    };
    (history, failure)
}

/// So many steps of h ms.
#[derive(Clone, Copy, Debug)]
struct Grid {
    h: f64,
    steps: usize,
}

/// Takes the steps and records them; returns why they end early.
fn record<E: Equations>(
    stepper: &mut Steps<E>,
    Grid { h, steps }: Grid,
    voltages: impl Fn(f64, f64) -> Vec<f64>,
    mut observer: impl FnMut(usize) -> ControlFlow<()>,
    history: &mut History,
) -> Option<StepError> {
    let n = stepper.momentum().len();
    let mut failure = None;
    for k in 0..steps {
        let (from, to) = (k as f64 * h, (k + 1) as f64 * h);
        match stepper.step(h, &voltages(from, to)) {
            Ok(multipliers) => {
                history.z[k][n..n + multipliers.len()].copy_from_slice(&multipliers);
                history.times.push(to);
                history.z.push(stepper.coordinates().to_vec());
                history.momenta.push(stepper.momentum().to_vec());
                history.scalars.push(stepper.scalars().to_vec());
                history.works.extend(stepper.work());
            }
            Err(StepError::Stopped { .. }) => break,
            Err(error) => {
                failure = Some(error);
                break;
            }
        }
        if observer(k + 1).is_break() {
            break;
        }
    }
    history.report = stepper.report();
    history.solver = stepper.solver();
    failure
}
