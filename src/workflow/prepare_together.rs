//! The program of several motions as one, and the point and the kind of start of its solver.

use crate::control::problem::{Control, ControlTask, Guess};
use crate::control::{BoundaryConditions, Carried, Solution, Transcription, guess};
use crate::ipopt::{Start, StartingPoint};
use crate::model::Model;
use crate::nlp::joined::{Joined, SharedVariable};
use crate::workflow::error::WorkflowError;
use crate::workflow::memory;
use crate::workflow::program_motion::{ProgramMotion, Programs, joined, states_of_rest};
use crate::workflow::resolve::{interval, resolve};
use crate::workflow::shared_variables::{Beside, shared_variables};

/// The program of motions with the point to start from.
pub(crate) struct PreparedTogether<'m> {
    pub(crate) program: Joined<Transcription<'m>>,
    pub(crate) shared: Vec<SharedVariable>,
    pub(crate) point: StartingPoint,
    pub(crate) start: Start,
    /// Changes of the earlier solution of each motion.
    pub(crate) carried: Vec<Carried>,
}

/// Model and boundary of each motion.
///
/// # Errors
/// Start or goal of one of them is wrong.
pub(crate) fn resolve_each(
    task: &ControlTask<'_>,
) -> Result<Vec<(Model, BoundaryConditions)>, WorkflowError> {
    let each = task
        .motions
        .iter()
        .map(|one| resolve(one.system, one.control).map_err(|error| error.of_motion(one.name)));
    each.collect()
}

/// The motions with their models and boundaries.
pub(crate) fn program_motions<'m>(
    task: &ControlTask<'m>,
    resolved: &'m [(Model, BoundaryConditions)],
) -> Vec<ProgramMotion<'m>> {
    let each = task.motions.iter().zip(resolved);
    let each = each.map(|(one, (model, boundary))| ProgramMotion {
        task: *one,
        model,
        boundary,
    });
    each.collect()
}

/// Guesses and programs of motions, joined.
///
/// # Errors
/// As of [`prepare`], or something cannot be shared.
pub(crate) fn prepare_together<'m>(
    motions: &[ProgramMotion<'m>],
    task: &ControlTask<'_>,
    counted: Counted,
) -> Result<PreparedTogether<'m>, WorkflowError> {
    let (mut programs, mut points) = (Vec::new(), Vec::new());
    let (mut starts, mut carried) = (Vec::new(), Vec::new());
    for motion in motions {
        let ProgramMotion {
            task: one,
            model,
            boundary,
        } = *motion;
        let prepared = prepare(model, boundary, one.control, one.earlier, counted);
        let prepared = prepared.map_err(|error| error.of_motion(one.name))?;
        let Prepared {
            program,
            point,
            start,
            carried: of_earlier,
        } = prepared;
        programs.push((one.name.to_owned(), program));
        points.push(point);
        starts.push(start);
        carried.push(of_earlier);
    }
    let rest = states_of_rest(motions, &programs)
        .map_err(|error| WorkflowError::boundary("control", &error))?;
    let list = programs.iter().map(|(_, program)| program);
    let list: Vec<&Transcription<'_>> = list.chain(rest.iter().map(|one| &one.1.program)).collect();
    let beside = rest.iter().map(|(motion, one)| Beside {
        motion: *motion,
        shared: &one.shared,
    });
    let beside: Vec<Beside<'_>> = beside.collect();
    let shared = shared_variables(&list, &beside, task.shared_inputs)?;
    let whole = Programs {
        programs,
        points,
        rest,
    };
    let (program, point) = joined(whole, &shared, task.combined);
    Ok(PreparedTogether {
        point,
        start: common(&starts),
        program,
        shared,
        carried,
    })
}

/// The start that suits all of these: where they differ, what is known of all of them counts.
fn common(starts: &[Start]) -> Start {
    let barrier = |start: &Start| match start {
        Start::Primal { mu_init } | Start::Resumed { mu_init } => Some(*mu_init),
        _ => None,
    };
    let largest = starts.iter().filter_map(barrier).fold(0.0, f64::max);
    let all = |is: fn(&Start) -> bool| starts.iter().all(is);
    let first = starts[0];
    if starts.iter().all(|start| *start == first) {
        return first;
    }
    match first {
        _ if all(|start| matches!(start, Start::Resumed { .. })) => {
            Start::Resumed { mu_init: largest }
        }
        _ if all(|start| matches!(start, Start::Primal { .. })) => {
            Start::Primal { mu_init: largest }
        }
        _ if all(|start| matches!(start, Start::PrimalDual | Start::Centred)) => Start::Centred,
        _ if all(|start| !matches!(start, Start::Cold | Start::Simulated)) => RESAMPLED,
        _ => Start::Cold,
    }
}

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
