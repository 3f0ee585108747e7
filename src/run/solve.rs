//! A control problem from file to folder: boundary, guess, program, solve, and all that is told of it.

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use crate::control::problem::{Control, Duration, Guess};
use crate::control::{Boundary, Solved, Transcription, guess};
use crate::dynamics::{observations, reversed_muscle};
use crate::ipopt::{self, OptionValue, Options, Start, Status};
use crate::model::{Coordinates, Model, System};
use crate::nlp::Nlp;
use crate::report::atomic::WriteError;
use crate::report::skins::Skins;
use crate::report::{Run, write_run};
use crate::run::blocks::Blocks;
use crate::run::effects::effect_counts;
use crate::run::error::RunError;
use crate::run::fields;
use crate::run::motion::{history, solved, trajectory};
use crate::run::progress::Progress;
use crate::run::request::{Request, Told};
use crate::run::resimulate::{resimulate, under_constant_voltages};
use crate::run::solution_file;
use crate::run::summary::{PerInterval, Program, Seconds, Summary};
use crate::run::violations::{Violation, violations};

/// Rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;
/// Length of the motion under constant voltages that is drawn beside the optimal one, in durations.
const COMPARED: usize = 3;
/// First barrier parameter from an earlier solution that was resampled.
const RESAMPLED: Start = Start::Primal { mu_init: 1e-2 };

/// The program of a control problem with the point to start from and what that point is worth.
pub(super) struct Prepared<'m> {
    pub(super) program: Transcription<'m>,
    pub(super) point: ipopt::Point,
    pub(super) start: Start,
}

/// Model and boundary of a control problem.
pub(super) fn resolve(
    file: &Path,
    system: &System,
    control: &Control,
) -> Result<(Model, Boundary), RunError> {
    Boundary::resolve(system, control, interval(control))
        .map_err(|error| RunError::boundary(file, "control", &error))
}

/// Interval length in ms, or its guess.
fn interval(control: &Control) -> f64 {
    let (Duration::Given(duration)
    | Duration::Free {
        guess: duration, ..
    }) = control.duration;
    duration / control.intervals as f64
}

/// Guess and program.
pub(super) fn prepare<'m>(
    file: &Path,
    model: &'m Model,
    boundary: &Boundary,
    control: &Control,
) -> Result<Prepared<'m>, RunError> {
    let earlier = match &control.guess {
        Guess::Solution(path) => Some(solution_file::read(path, model)?),
        Guess::Interpolate | Guess::Simulate(_) => None,
    };
    let initial = guess(
        model,
        boundary,
        control,
        interval(control),
        earlier.as_ref(),
    );
    let program = Transcription::new(model, boundary, control, &initial)
        .map_err(|error| RunError::boundary(file, "control", &error))?;
    let point = program.start(&initial);
    let start = match &earlier {
        None => Start::Cold,
        Some(_) if point.costates.is_some() => Start::PRIMAL_DUAL,
        Some(earlier) if earlier.intervals() == control.intervals => Start::PRIMAL,
        Some(_) => RESAMPLED,
    };
    Ok(Prepared {
        program,
        point,
        start,
    })
}

/// Solves a control problem and writes its folder, solved or not.
pub(super) fn control(
    request: &Request,
    system: &System,
    control: &Control,
    began: Instant,
) -> Result<Told, RunError> {
    let (model, boundary) = resolve(&request.input, system, control)?;
    let Prepared {
        mut program,
        point,
        start,
    } = prepare(&request.input, &model, &boundary, control)?;
    let setup = began.elapsed().as_secs_f64();
    let options = Options {
        tolerance: control.solver.tolerance,
        max_iterations: request
            .max_iterations
            .unwrap_or(control.solver.max_iterations),
        max_seconds: request.max_seconds.map(|s| (s - setup).max(0.0)),
        start,
        extra: linear_solver(&model, control),
    };
    tracing::info!(?start, variables = point.x.len(), "solve");
    let folder = request.folder();
    let mut unwritable = None;
    let solution = {
        let progress = Progress::of_solve(request.progress);
        ipopt::solve(&mut program, &point, &options, &mut |iteration| {
            progress.iteration(iteration);
            // A folder that cannot be made is told before a long solve, not after it.
            if iteration.iteration == 0 {
                unwritable = make_folder(&folder).err();
            }
            match unwritable {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            }
        })
        .map_err(|error| RunError::ipopt(&request.input, &error))?
    };
    if let Some(error) = unwritable {
        return Err(error.into());
    }
    make_folder(&folder)?;

    let history = program.decode(&solution.x);
    let unresolved = match solution.status.is_solved() {
        true => reversed_muscle(&model, &history).map(|(k, m)| unresolved(&model, k, m)),
        false => None,
    };
    let is_solved = solution.status.is_solved() && unresolved.is_none();
    let kept = solved(&model, &history, Some(program.costates(&solution.costates)));
    let violated = match is_solved {
        true => Vec::new(),
        false => violations(&mut program, &solution.x, HOLDS, NAMED),
    };
    let resimulation = is_solved.then(|| resimulate(&model, &boundary, &kept));
    let sizes = [
        program.constraints().lower.len(),
        program.jacobian_structure().rows.len(),
        program.hessian_structure().rows.len(),
    ];
    let per_interval = |seconds: f64, evaluations: usize| {
        (evaluations > 0).then(|| 1e6 * seconds / (evaluations * control.intervals) as f64)
    };
    let seconds = &solution.seconds;
    let word = match unresolved {
        Some(_) => "unresolved",
        None => solution.status.word(),
    };
    let mut summary = Summary::new(request, word, model.coordinates.name());
    summary.message =
        unresolved.or_else(|| (!is_solved).then(|| meaning(solution.status).to_owned()));
    if let Some(message) = &mut summary.message {
        message.push_str(&redundancy(&model.redundant_constraints(&boundary.start.z)));
    }
    summary.program = Some(Program {
        objective: solution.objective,
        iterations: solution.iterations.len().saturating_sub(1),
        intervals: control.intervals,
        duration: history.times[control.intervals] / 1e3,
        variables: solution.x.len(),
        constraints: sizes[0],
        jacobian_nonzeros: sizes[1],
        hessian_nonzeros: sizes[2],
        interval_microseconds: PerInterval {
            jacobian: per_interval(seconds.jacobian, solution.evaluations.jacobian),
            hessian: per_interval(seconds.hessian, solution.evaluations.hessian),
        },
        infeasibility: program.violation(&solution.x),
        violations: violated.clone(),
        resimulation,
    });
    summary.effects = effect_counts(&model)
        .map_err(|error| RunError::boundary(&request.input, "control", &error.into()))?;
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup,
        solver: seconds.solver,
        objective: seconds.objective,
        gradient: seconds.gradient,
        constraints: seconds.constraints,
        jacobian: seconds.jacobian,
        hessian: seconds.hessian,
    };
    write_files(request, &folder, &model, &boundary, &kept, &mut summary)?;
    Ok(told(&summary, &violated, &folder))
}

/// Makes the folder of the results.
pub(super) fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|cause| WriteError {
        path: folder.to_owned(),
        cause,
    })
}

fn write_files(
    request: &Request,
    folder: &Path,
    model: &Model,
    boundary: &Boundary,
    kept: &Solved,
    summary: &mut Summary,
) -> Result<(), WriteError> {
    solution_file::write(&folder.join("solution.json"), model, kept)?;
    let history = history(model, kept);
    let observed = observations(model, &history);
    let origin = request.origin(true);
    let written = fields::write(folder, model, &history, &origin)?;
    summary.blocks = Blocks::of(model).map(|b| b.after(model, &observed, written));
    summary.write(folder)?;
    let motion = trajectory(model, kept);
    let is_solved = summary.message.is_none();
    let compared = is_solved
        .then(|| under_constant_voltages(model, boundary, kept, COMPARED))
        .flatten()
        .map(|(history, _)| trajectory(model, &solved(model, &history, None)));
    let rows = rows(summary);
    let run = Run {
        system: &model.system,
        trajectory: &motion,
        skins: &Skins::new(model, &history),
        name: if is_solved {
            "optimal voltages"
        } else {
            "last iterate"
        },
        observations: &observed,
        comparison: compared.as_ref().map(|c| ("constant voltages", c)),
        held: boundary.rest[1].as_deref().filter(|_| is_solved),
        origin: &origin,
        title: "Optimal control",
        summary: &rows,
    };
    write_run(folder, &run).map(|_| ())
}

/// Options of the linear solver: the ordering that was fastest for the kind of program, unless the problem names one.
///
/// Approximate minimum degree (0) where each instant is a small dense block or the duration is given; minimum fill (2)
/// where a free duration couples all instants of a redundant program; nested dissection of SCOTCH (3) for the meshes of elastic
/// blocks. Measurements: `benches/README.md`.
fn linear_solver(model: &Model, control: &Control) -> BTreeMap<String, OptionValue> {
    let free = matches!(control.duration, Duration::Free { .. });
    let ordering = if !model.action.motion.of_nodes.is_empty() {
        3
    } else if free && model.coordinates == Coordinates::Redundant {
        2
    } else {
        0
    };
    let mut options = control.solver.ipopt.clone();
    options
        .entry("mumps_pivot_order".to_owned())
        .or_insert(OptionValue::Integer(ordering));
    options
}

/// Rows of the table of the page.
fn rows(summary: &Summary) -> Vec<(String, String)> {
    let mut rows = vec![("status".to_owned(), summary.status.clone())];
    let mut row = |key: &str, value: String| rows.push((key.to_owned(), value));
    if let Some(program) = &summary.program {
        row("objective", format!("{:.9}", program.objective));
        row("iterations", program.iterations.to_string());
        row("duration", format!("{:.6} s", program.duration));
        row("intervals", program.intervals.to_string());
        row("coordinates", summary.coordinates.to_owned());
        row("variables", program.variables.to_string());
        row("constraints", program.constraints.to_string());
        row("time", format!("{:.3} s", summary.seconds.total));
        if let Some(r) = &program.resimulation {
            let of = |d: &crate::run::resimulate::Distance| {
                format!("{:.1e} rad, {:.1e} m", d.angle, d.length)
            };
            row("deviation when simulated forward", of(&r.deviation));
            if let (Some(drift), Some(held)) = (&r.drift, r.held) {
                row(&format!("drift when held for {held} s"), of(drift));
            }
        }
        for violation in &program.violations {
            row("violated", describe(violation));
        }
    }
    rows
}

/// A violated row in words.
fn describe(violation: &Violation) -> String {
    match (violation.violation, violation.scaled) {
        (Some(distance), Some(scaled)) => format!(
            "{}: violated by {distance:.4e} ({scaled:.1e} as the solver measures it)",
            violation.row
        ),
        _ => format!("{}: has no value there", violation.row),
    }
}

fn told(summary: &Summary, violated: &[Violation], folder: &Path) -> Told {
    let program = summary.program.as_ref();
    let (objective, iterations) = program.map_or((f64::NAN, 0), |p| (p.objective, p.iterations));
    let is_solved = summary.message.is_none();
    let solved = if is_solved { "solved" } else { "not solved" };
    let word = match summary.status.as_str() {
        "solved" => solved.to_owned(),
        word => format!("{solved} ({})", word.replace('_', " ")),
    };
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    notes.extend(violated.iter().map(describe));
    Told {
        is_solved,
        result: format!(
            "{word}: objective {objective:.7}, {}, {:.2} s, {}",
            counted(iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}

/// A number with its noun.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Why an optimum of the discrete equations is none of the system.
fn unresolved(model: &Model, interval: usize, muscle: usize) -> String {
    format!(
        "muscle \"{}\" turns by a right angle or more in interval {interval}: its ends meet on the way, or the intervals are \
         too long for the motion; take more intervals or another guess",
        model.system.muscles[muscle].name
    )
}

/// A further reason why a solve failed, where there is one.
fn redundancy(redundant: &[String]) -> String {
    match redundant {
        [] => String::new(),
        names => format!(
            "; constraints are redundant at the start: {} more than is needed, such as {}",
            names.len(),
            names.join(", ")
        ),
    }
}

/// What a status means for the problem.
fn meaning(status: Status) -> &'static str {
    match status {
        Status::Infeasible | Status::RestorationFailed => {
            "no motion meets the goal and the limits, or none was found from this guess; the files hold the closest one"
        }
        Status::IterationLimit => {
            "the iterations allowed were used up; the files hold the last iterate"
        }
        Status::TimeLimit => "the time allowed was used up; the files hold the last iterate",
        Status::Interrupted => "interrupted; the files hold the last iterate",
        Status::InvalidNumber => {
            "an equation has no value at the guess: the ends of a muscle meet there, or an element is turned inside out; choose another guess or number of intervals"
        }
        Status::TooFewDegreesOfFreedom => "there are more equations than unknowns",
        _ => "the solver stopped short; the files hold the last iterate",
    }
}
