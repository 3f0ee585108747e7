//! A control problem in `summary.json` and in the answer of its command: verdict, program, notes, times.

use std::path::Path;
use std::time::Instant;

use crate::app::linear_systems::LinearSystems;
use crate::app::messages::counted;
use crate::app::moved_markers::moved_markers;
use crate::app::request::CommandOutput;
use crate::app::solve_messages::{
    carried, meaning, redundancy, restarted, stopped_after, unresolved,
};
use crate::app::solve_page::describe;
use crate::app::summary::{Evaluations, PerInterval, Program, Seconds, SoughtValue, Summary};
use crate::control::problem::{Control, Hold};
use crate::model::System;
use crate::workflow::cause::Cause;
use crate::workflow::hold_check;
use crate::workflow::optimum::Optimum;
use crate::workflow::solve_remarks::add_remarks;
use crate::workflow::violations::Violation;

/// The verdict on an optimum.
pub(super) struct Verdict {
    /// Its status.
    pub(super) word: &'static str,
    pub(super) is_solved: bool,
    /// Reason why it is none, in words.
    pub(super) message: Option<String>,
    /// Reason why its end is not kept.
    not_kept: Option<String>,
}

impl Verdict {
    /// The verdict by verification, by the end where it has to be held, and by the solver.
    pub(super) fn from_optimum(control: &Control, optimum: &Optimum) -> Self {
        let Optimum {
            model, boundary, ..
        } = optimum;
        let refuted = optimum.reversed.map(|(k, m)| unresolved(model, k, m));
        let refuted = refuted.or_else(|| optimum.cause().map(Cause::message));
        let tested = optimum.resimulation.as_ref();
        let not_kept = hold_check::warning(control, model, boundary, tested);
        let mut is_solved = optimum.is_solved();
        let mut word = optimum.word();
        let has_to_hold = is_solved && control.hold == Hold::Required;
        let not_held = not_kept.clone().filter(|_| has_to_hold);
        if not_held.is_some() {
            (is_solved, word) = (false, "not_held");
        }
        let mut message = refuted.or(not_held);
        if message.is_none() && !is_solved {
            let status = optimum.solution.status;
            message = Some(match optimum.stopped {
                Some(stopped) => stopped_after(status, stopped),
                None => meaning(status).to_owned(),
            });
        }
        if let (Some(message), false) = (&mut message, optimum.meets_equations()) {
            message.push_str(&redundancy(&model.redundant_constraints(&boundary.start.z)));
        }
        Self {
            word,
            is_solved,
            message,
            not_kept,
        }
    }
}

/// The program of an optimum in numbers.
pub(super) fn program(
    system: &System,
    control: &Control,
    optimum: &Optimum,
    iterations: usize,
    is_solved: bool,
) -> Program {
    let Optimum {
        solution,
        motion: kept,
        ..
    } = optimum;
    let intervals = kept.intervals();
    let per_interval = |seconds: f64, evaluations: usize| {
        (evaluations > 0).then(|| 1e6 * seconds / (evaluations * intervals) as f64)
    };
    let seconds = &solution.seconds;
    Program {
        objective: solution.objective,
        objective_units: control.objective_units(system),
        iterations,
        intervals,
        duration: kept.times[intervals] / 1e3,
        variables: solution.x.len(),
        constraints: optimum.constraints,
        jacobian_nonzeros: optimum.jacobian_nonzeros,
        hessian_nonzeros: optimum.hessian_nonzeros,
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
        gap: Some(optimum.gap).filter(|gap| is_solved && gap.is_finite()),
        afterwards: optimum.afterwards.clone(),
    }
}

/// Adds the notes on an optimum and on the way to it; `refined` tells why another grid was taken.
pub(super) fn add_notes(
    summary: &mut Summary,
    system: &System,
    control: &Control,
    optimum: &Optimum,
    refined: Option<String>,
    verdict: &Verdict,
) {
    let notes = &mut summary.notes;
    notes.note("start", control.start.notes().iter().cloned());
    notes.note("goal", optimum.boundary.notes.iter().cloned());
    notes.note("moved_marker", moved_markers(system));
    notes.warn("singular_loops", optimum.model.loops.warning.clone());
    let not_kept = verdict.not_kept.clone().filter(|_| verdict.is_solved);
    add_remarks(notes, control, optimum, refined, not_kept);
    notes.note("earlier_solution", carried(&optimum.carried));
    notes.note("second_start", optimum.restarted.map(restarted));
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
    let grid = match is_refined || summary.accuracy.is_some() {
        true => format!(
            ", {}",
            counted(program.map_or(0, |p| p.intervals), "interval")
        ),
        false => String::new(),
    };
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective:.7}{grid}, {}, {:.2} s, {}",
            counted(iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}
