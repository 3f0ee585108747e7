//! Closed loops with parts of their disturbance.

use crate::control::problem::Disturbed;
use crate::nlp::Status;
use crate::stop::{self, Stopped};
use crate::tasks::simulate::{SimulationRequest, SimulationResult, simulate};
use crate::workflow::WorkflowError;
use crate::workflow::closed_loop::DisturbedLoop;
use std::ops::ControlFlow;
use std::time::Instant;

/// Closed loops with parts of a disturbance.
#[derive(Debug, Default)]
pub struct DisturbedLoops {
    /// Those that were simulated.
    pub loops: Vec<DisturbedLoop>,
    /// Reasons why others are left out.
    pub left_out: Vec<String>,
    /// Status of a run that was stopped before all of them ended.
    pub stopped: Option<Status>,
}

/// The part that is the problem itself.
const WHOLE: f64 = 1.0;

/// Closed loops with all parts of a disturbance, next to that of the whole, which has been simulated. They end after a number of seconds.
///
/// # Errors
/// A model or a start does not exist.
pub fn disturbed(
    parts: &[Disturbed],
    whole: &SimulationResult,
    seconds: Option<f64>,
) -> Result<DisturbedLoops, WorkflowError> {
    let began = Instant::now();
    let mut out = DisturbedLoops::default();
    if whole.closed_loop.is_none() {
        return Ok(out);
    }
    let go_on = &mut |_: usize, _: &_, _: &_| {
        stop::check().map_or(ControlFlow::Break(()), ControlFlow::Continue)
    };
    for Disturbed { size, system, task } in parts {
        let simulated;
        let found = match *size == WHOLE {
            true => whole,
            false => {
                let request = SimulationRequest {
                    seconds: seconds.map(|limit| limit - began.elapsed().as_secs_f64()),
                    ..SimulationRequest::default()
                };
                match simulate(system, task, request, go_on) {
                    Err(WorkflowError::Stopped(Stopped(status))) => {
                        out.left_out.push(not_whole(*size));
                        out.stopped = Some(status);
                        continue;
                    }
                    found => simulated = found?,
                }
                &simulated
            }
        };
        out.stopped = out.stopped.or(found.stopped);
        if let Some(failure) = &found.simulated.failure {
            out.left_out.push(format!(
                "the motion with {size} of the disturbance ends early: {failure}"
            ));
        }
        match &found.closed_loop {
            Some(closed) => out.loops.push(DisturbedLoop {
                size: *size,
                times: found.simulated.discrete.times.clone(),
                closed: closed.clone(),
            }),
            None => out.left_out.push(not_whole(*size)),
        }
    }
    Ok(out)
}

fn not_whole(size: f64) -> String {
    format!("{size} of the disturbance was not simulated to the end: the run was stopped before")
}
