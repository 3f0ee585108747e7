//! A control problem in `summary.json` and in the answer of its command: program, notes, times.

use std::path::Path;
use std::time::Instant;

use crate::app::linear_systems::LinearSystems;
use crate::app::messages::counted;
use crate::app::partial_result::STOPPED;
use crate::app::request::CommandOutput;
use crate::app::solve_page::describe;
use crate::app::summary::{Evaluations, PerInterval, Program, Seconds, SoughtValue, Summary};
use crate::control::problem::Control;
use crate::math::significant;
use crate::model::System;
use crate::tasks::SolveResult;
use crate::workflow::optimum::Optimum;
use crate::workflow::optimum::Violation;

/// The program of an optimum in numbers.
pub(super) fn program(system: &System, control: &Control, result: &SolveResult) -> Program {
    let optimum = &result.optimum;
    let Optimum {
        solution,
        motion: kept,
        ..
    } = optimum;
    let is_solved = result.verdict.is_solved;
    let intervals = kept.intervals();
    let per_interval = |seconds: f64, evaluations: usize| {
        (evaluations > 0).then(|| 1e6 * seconds / (evaluations * intervals) as f64)
    };
    let seconds = &solution.seconds;
    Program {
        objective: solution.objective,
        objective_units: control.objective_units(system),
        iterations: result.iterations,
        intervals,
        duration: kept.times[intervals] / 1e3,
        variables: solution.x.len(),
        constraints: optimum.program.constraints,
        jacobian_nonzeros: optimum.program.jacobian_nonzeros,
        hessian_nonzeros: optimum.program.hessian_nonzeros,
        linear_solver: LinearSystems::new(&solution.linear),
        evaluations: Evaluations::new(&solution.evaluations),
        interval_microseconds: PerInterval {
            jacobian: per_interval(seconds.jacobian, solution.evaluations.jacobian),
            hessian: per_interval(seconds.hessian, solution.evaluations.hessian),
        },
        infeasibility: Some(optimum.infeasibility).filter(|value| value.is_finite()),
        violations: optimum.violated.clone(),
        resimulation: optimum.resimulation.clone(),
        parameters: kept.parameters.iter().map(SoughtValue::new).collect(),
        gap: Some(optimum.program.gap).filter(|gap| is_solved && gap.is_finite()),
        afterwards: optimum.afterwards.clone(),
        repeated: optimum.repeated.clone(),
    }
}

/// Times of a solve whose files were read in `read` seconds.
pub(super) fn seconds(optimum: &Optimum, read: f64, began: Instant) -> Seconds {
    let seconds = &optimum.solution.seconds;
    Seconds {
        total: began.elapsed().as_secs_f64(),
        setup: read + optimum.setup,
        solver: seconds.solver,
        objective: seconds.objective,
        gradient: seconds.gradient,
        constraints: seconds.constraints,
        jacobian: seconds.jacobian,
        hessian: seconds.hessian,
        ..Seconds::default()
    }
}

/// The answer of the command.
pub(super) fn command_output(
    summary: &Summary,
    is_refined: bool,
    violated: &[Violation],
    folder: &Path,
) -> CommandOutput {
    let program = summary.program.as_ref();
    let (objective, iterations) = program.map_or((f64::NAN, 0), |p| (p.objective, p.iterations));
    let mut is_solved = summary.message.is_none();
    let solved = if is_solved { "solved" } else { "not solved" };
    let mut word = match summary.status.as_str() {
        "solved" => solved.to_owned(),
        word => format!("{solved} ({})", word.replace('_', " ")),
    };
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    notes.extend(violated.iter().map(describe));
    notes.extend(summary.notes.lines());
    let parameters = program.iter().flat_map(|program| &program.parameters);
    notes.extend(parameters.map(|found| format!("{}: {}", found.name, found.text())));
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    // An optimum of which not all is written.
    is_solved &= !STOPPED.contains(&&*summary.status);
    let grid = match is_refined || summary.accuracy.is_some() {
        true => format!(
            ", {}",
            counted(program.map_or(0, |p| p.intervals), "interval")
        ),
        false => String::new(),
    };
    let objective = significant(objective, 8);
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective}{grid}, {}, {:.2} s, {}",
            counted(iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}
