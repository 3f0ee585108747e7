//! A solve on the grid of its problem, or on finer ones where an accuracy is wanted or the optimum is not reproduced.

use std::ops::ControlFlow;

use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget, Refined};
use crate::workflow::grids::optimise_to;
use crate::workflow::optimum::{Optimum, SolveLimits};
use crate::workflow::refine_until_reproduced::{RefinedOptimum, reproduced};
use crate::workflow::verified::{ACCURACY, verified};
use crate::workflow::{Iterate, WorkflowError};

/// Options of a solve in addition to its problem.
#[derive(Clone, Copy, Debug, Default)]
pub struct SolveRequest {
    /// Accuracy of the grid; nothing takes that of the problem.
    pub wanted: Option<AccuracyTarget>,
    /// Limits of the solver.
    pub limits: SolveLimits,
}

/// The optimum, and the way to it.
pub(super) struct Found {
    pub(super) optimum: Optimum,
    pub(super) iterations: usize,
    pub(super) accuracy: Option<Accuracy>,
    /// Reason for another grid than that of the problem.
    pub(super) note: Option<String>,
}

/// Solves on the grid of the problem, or on finer ones where an accuracy is wanted.
pub(super) fn find(
    system: &System,
    control: &Control,
    SolveRequest { wanted, limits }: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Found, WorkflowError> {
    if let (false, Some(wanted)) = (control.is_refined, wanted) {
        let Refined {
            run: optimum,
            iterations,
            accuracy,
            ..
        } = optimise_to(system, control, wanted, limits, observer)?;
        return Ok(Found {
            optimum,
            iterations,
            accuracy: Some(accuracy),
            note: None,
        });
    }
    let RefinedOptimum {
        optimum,
        iterations,
        note,
    } = match (control.is_refined, wanted) {
        (true, Some(AccuracyTarget::Below(part))) => {
            verified(system, control, part, limits, observer)
        }
        (true, _) => verified(system, control, ACCURACY, limits, observer),
        (false, _) => reproduced(system, control, limits, observer),
    }?;
    Ok(Found {
        optimum,
        iterations,
        accuracy: None,
        note,
    })
}
