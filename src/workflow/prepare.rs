//! The program of a control problem, and the point and the kind of start of its solver.

use crate::control::problem::{Control, Guess};
use crate::control::{BoundaryConditions, Carried, Solution, Transcription, guess};
use crate::ipopt::{Start, StartingPoint};
use crate::model::Model;
use crate::workflow::error::WorkflowError;
use crate::workflow::memory;
use crate::workflow::resolve::interval;

/// Start from an earlier solution that was resampled and has no costates.
pub(super) const RESAMPLED: Start = Start::Primal { mu_init: 1e-2 };

/// An earlier solution that violates the equations of another grid or duration by less lies on the right bounds: smooth voltages
/// violate them by 1e-6 to 1e-4, those that jump at other instants by 4e-4 to 4e-2.
const FITS: f64 = 2e-4;

/// The program of a control problem with the point to start from and what that point is worth.
pub(crate) struct Prepared<'m> {
    pub(crate) program: Transcription<'m>,
    pub(crate) point: StartingPoint,
    pub(crate) start: Start,
    /// Changes of the earlier solution.
    pub(crate) carried: Carried,
}

/// Treatment of a program with more equations than unknowns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// It has no solution.
    Yes,
    /// Its derivatives exist all the same.
    No,
}

/// Guess and program; an `earlier` solution in memory comes before the guess of the problem.
pub(crate) fn prepare<'m>(
    model: &'m Model,
    boundary: &BoundaryConditions,
    control: &Control,
    earlier: Option<&Solution>,
    counted: Counted,
) -> Result<Prepared<'m>, WorkflowError> {
    memory::of_program(model, control.intervals)?;
    let named = match (&control.guess, earlier) {
        (Guess::Solution(earlier), None) => {
            Some(earlier.solution(model).map_err(WorkflowError::Earlier)?)
        }
        _ => None,
    };
    let earlier = earlier.or(named.as_deref());
    let initial = guess(model, boundary, control, interval(control), earlier);
    let program = match counted {
        Counted::Yes => Transcription::new(model, boundary, control, &initial),
        Counted::No => Transcription::of_any(model, boundary, control, &initial),
    };
    let mut program = program.map_err(|error| WorkflowError::boundary("control", &error))?;
    let point = program.start(&initial);
    let carried = initial.carried;
    let is_same_grid = |earlier: &Solution| {
        earlier.intervals() == control.intervals && carried.stretched.is_none()
    };
    let start = match (earlier, &point.costates) {
        (None, _) if matches!(control.guess, Guess::Simulate(_)) => Start::Simulated,
        (None, _) => Start::Cold,
        (
            Some(Solution {
                barrier: Some(mu), ..
            }),
            costates,
        ) if earlier.is_some_and(is_same_grid) => match costates {
            Some(_) => Start::Resumed { mu_init: *mu },
            None => Start::Primal { mu_init: *mu },
        },
        (Some(_), _) if carried.simulated => Start::Simulated,
        (Some(earlier), Some(_)) if is_same_grid(earlier) => Start::PrimalDual,
        (Some(_), Some(_)) if program.violation(&point.x) < FITS => Start::PrimalDual,
        (Some(_), Some(_)) => Start::Centred,
        (Some(earlier), None) if is_same_grid(earlier) => Start::PRIMAL,
        (Some(_), None) => RESAMPLED,
    };
    Ok(Prepared {
        program,
        point,
        start,
        carried,
    })
}
