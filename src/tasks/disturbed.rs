//! Closed loops with parts of their disturbance.

use crate::control::problem::Disturbed;
use crate::ipopt::{Status, interrupt};
use crate::tasks::simulate::{SimulationRequest, SimulationResult, simulate};
use crate::workflow::WorkflowError;
use crate::workflow::closed_loop::DisturbedLoop;
use std::ops::ControlFlow;
use std::time::Instant;

/// The part that is the problem itself.
const WHOLE: f64 = 1.0;

/// Closed loops with all parts of a disturbance, next to that of the whole, which has been simulated; reasons why some are left out; and that to stop. They
/// end after a number of seconds.
///
/// # Errors
/// A model or a start does not exist.
pub fn disturbed(
    parts: &[Disturbed],
    whole: &SimulationResult,
    seconds: Option<f64>,
) -> Result<(Vec<DisturbedLoop>, Vec<String>, Option<Status>), WorkflowError> {
    let began = Instant::now();
    let (mut loops, mut left_out, mut stopped) = (Vec::new(), Vec::new(), None);
    if whole.closed_loop.is_none() {
        return Ok((loops, left_out, stopped));
    }
    let go_on = &mut |_: usize, _: &_, _: &_| match interrupt::stop() {
        Some(_) => ControlFlow::Break(()),
        None => ControlFlow::Continue(()),
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
                    Err(WorkflowError::Stopped(status)) => {
                        left_out.push(not_whole(*size));
                        stopped = Some(status);
                        continue;
                    }
                    found => simulated = found?,
                }
                &simulated
            }
        };
        stopped = stopped.or(found.stopped);
        if let Some(failure) = &found.simulated.failure {
            left_out.push(format!(
                "the motion with {size} of the disturbance ends early: {failure}"
            ));
        }
        match &found.closed_loop {
            Some(closed) => loops.push(DisturbedLoop {
                size: *size,
                times: found.simulated.discrete.times.clone(),
                closed: closed.clone(),
            }),
            None => left_out.push(not_whole(*size)),
        }
    }
    Ok((loops, left_out, stopped))
}

fn not_whole(size: f64) -> String {
    format!("{size} of the disturbance was not simulated to the end: the run was stopped before")
}
