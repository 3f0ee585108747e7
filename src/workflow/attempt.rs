//! A control problem solved from one start: boundary, guess, program, solver.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::Control;
use crate::control::{Costates, Solution, Transcription};
use crate::dynamics::reversed_muscle;
use crate::ipopt::{Iteration, Options, Reached, Solver, Start, StartingPoint, interrupt};
use crate::model::System;
use crate::nlp::Nlp;
use crate::workflow::active::active;
use crate::workflow::combined::one_of_both;
use crate::workflow::error::WorkflowError;
use crate::workflow::gap;
use crate::workflow::iterate::Iterate;
use crate::workflow::motion::solved;
use crate::workflow::optimum::{Optimum, Shortest, SolveLimits};
use crate::workflow::ordering::ordering;
use crate::workflow::phase::phase;
use crate::workflow::prepare::{Counted, Prepared, prepare};
use crate::workflow::recentre::recentred;
use crate::workflow::resimulate::resimulate;
use crate::workflow::resolve::{resolve, with_found};
use crate::workflow::violations::violations;

/// Maximum number of rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;

/// Maximum numbers of repeated solves with other charts of its rotations, and to a smaller tolerance.
const CHARTS: usize = 4;
const TIGHTENED: usize = 3;
/// Iterations of a solve to a smaller tolerance.
const AGAIN: usize = 100;

/// Solves a control problem from one start: an `earlier` solution where one is given, or the guess of the problem; `observer` sees every iterate.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong. A problem without a solution is no error: see the status.
pub(crate) fn attempt(
    system: &System,
    control: &Control,
    earlier: Option<&Solution>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Optimum, WorkflowError> {
    let began = Instant::now();
    let watch = interrupt::watch(allowed.seconds);
    phase("building the model, finding start and goal");
    let (model, boundary) = resolve(system, control)?;
    phase("building the program");
    let Prepared {
        program,
        point,
        start,
        carried,
    } = prepare(&model, &boundary, control, earlier, Counted::Yes)?;
    let setup = began.elapsed().as_secs_f64();
    let options = Options {
        tolerance: control.solver.tolerance,
        max_iterations: allowed.iterations.unwrap_or(control.solver.max_iterations),
        max_seconds: allowed.seconds.map(|s| (s - setup).max(0.0)),
        start,
        linear_solver: control.solver.linear_solver,
        extra: ordering(&model, control),
    };
    phase("ordering and first factorisation");
    tracing::info!(?start, variables = point.x.len(), "solve");
    let mut solver = Solver::new(program, options.clone());
    let mut solve = |solver: &mut Solver<Transcription<'_>>, point: &StartingPoint| {
        let decoder = solver.program().decoder();
        let mut observer = |report: &Iteration, reached: &Reached<'_>| {
            let at = |report: &Iteration, x: &[f64], costates: Option<Costates>| Solution {
                barrier: Some(report.mu),
                ..solved(&model, &decoder.decode(x), costates)
            };
            let motion = || at(report, reached.x, None);
            let before = reached.before.as_ref();
            let earlier = before.map(|before| {
                let costates = || decoder.costates(&before.multipliers());
                move || at(before.report, before.x, Some(costates()))
            });
            let earlier = earlier
                .as_ref()
                .map(|motion| motion as &dyn Fn() -> Solution);
            observer(&Iterate {
                report,
                model: &model,
                motion: &motion,
                before: before.map(|before| before.report).zip(earlier),
            })
        };
        let found = solver.solve(point, &mut observer);
        found.cloned().map_err(|error| WorkflowError::ipopt(&error))
    };
    let left = |limit: f64| (limit - began.elapsed().as_secs_f64()).max(0.0);
    let mut solution = solve(&mut solver, &point)?;
    for _ in 0..CHARTS {
        let far = recentred(&model, &solver.program().decode(&solution.x));
        let Some(initial) = far.filter(|_| interrupt::stop().is_none()) else {
            break;
        };
        phase("solving again, from the state that the first solution reached");
        // What cannot be built in the time that is left leaves the solution as it is.
        let Ok(program) = Transcription::of_any(&model, &boundary, control, &initial) else {
            break;
        };
        let options = Options {
            max_seconds: allowed.seconds.map(left),
            start: Start::PRIMAL,
            ..options.clone()
        };
        let point = program.start(&initial);
        solver = Solver::new(program, options);
        solution = solve(&mut solver, &point)?;
    }
    let mut tolerance = options.tolerance;
    for _ in 0..TIGHTENED {
        let tighter = gap::tighter(solver.program(), &solution, tolerance);
        let Some(tighter) = tighter.filter(|_| interrupt::stop().is_none()) else {
            break;
        };
        phase("solving again, to a smaller tolerance");
        tolerance = tighter;
        let mu_init = solution.iterations.last().map_or(1e-9, |last| last.mu);
        solver.set_options(Options {
            tolerance,
            max_iterations: options.max_iterations.min(AGAIN),
            max_seconds: allowed.seconds.map(left),
            start: Start::Resumed { mu_init },
            ..options.clone()
        });
        let again = solve(&mut solver, &solution.to_point())?;
        let failed = !again.status.is_solved();
        solution = one_of_both(solution, again);
        if failed {
            break;
        }
    }
    let is_solved = solution.status.is_solved();
    let mut program = solver.into_program();
    drop(watch);
    let gap = gap::gap(&program, &solution);
    let wide = gap::warning(gap, &solution, program.objective_scale());
    let history = program.decode(&solution.x);
    let motion = Solution {
        hold: boundary.rest[1].clone(),
        barrier: match is_solved {
            true => None,
            false => solution.iterations.last().map(|last| last.mu),
        },
        ..solved(&model, &history, Some(program.costates(&solution.costates)))
    };
    let (violated, active) = match is_solved {
        true => (Vec::new(), Vec::new()),
        false => (
            violations(&mut program, &solution.x, HOLDS, NAMED),
            active(&mut program, &solution.x, &model, control),
        ),
    };
    let infeasibility = program.violation(&solution.x);
    let constraints = program.constraints().lower.len();
    let jacobian_nonzeros = program.jacobian_structure().rows.len();
    let hessian_nonzeros = program.hessian_structure().rows.len();
    drop(program);
    let (model, boundary, sought) = match control.parameters.is_empty() {
        true => (model, boundary, None),
        false => {
            let (found, boundary) = with_found(system, control, &model, &motion)?;
            (found, boundary, Some(model))
        }
    };
    let reversed = match is_solved {
        true => reversed_muscle(&model, &history),
        false => None,
    };
    let is_motion = is_solved && reversed.is_none();
    if is_motion {
        phase("simulating under the optimal voltages");
    }
    let solved = Instant::now();
    let resimulation =
        is_motion.then(|| resimulate(&model, &boundary.start, &motion, control.solver.tolerance));
    let tested = solved.elapsed().as_secs_f64();
    Ok(Optimum {
        model,
        sought,
        boundary,
        motion,
        solution,
        reversed,
        violated,
        infeasibility,
        constraints,
        jacobian_nonzeros,
        hessian_nonzeros,
        setup,
        carried,
        resimulation,
        tested,
        restarted: None,
        shortest: Shortest::Unknown,
        active,
        gap,
        wide,
        afterwards: None,
    })
}
