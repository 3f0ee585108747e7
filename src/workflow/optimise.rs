//! A control problem solved in memory: boundary, guess, program, solver.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::{Control, Guess};
use crate::control::{BoundaryConditions, Carried, Costates, Solution, Transcription, guess};
use crate::dynamics::reversed_muscle;
use crate::ipopt::{
    Iteration, Options, Reached, Solver, SolverResult, Start, StartingPoint, Status, interrupt,
};
use crate::model::{Model, System};
use crate::nlp::Nlp;
use crate::workflow::active::{Active, active};
use crate::workflow::afterwards::{Afterwards, afterwards};
use crate::workflow::cause::Cause;
use crate::workflow::error::WorkflowError;
use crate::workflow::gap;
use crate::workflow::iterate::Iterate;
use crate::workflow::memory;
use crate::workflow::motion::solved;
use crate::workflow::ordering::ordering;
use crate::workflow::phase::phase;
use crate::workflow::recentre::recentred;
use crate::workflow::resimulate::{Resimulation, resimulate};
use crate::workflow::resolve::{interval, resolve, with_found};
use crate::workflow::second_start::{ITERATIONS, displaced, is_infeasible, one_of_both};
use crate::workflow::violations::{Violation, violations};

/// Rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;
/// Start from an earlier solution that was resampled and has no costates.
const RESAMPLED: Start = Start::Primal { mu_init: 1e-2 };

/// An earlier solution that violates the equations of another grid or duration by less lies on the right bounds: smooth voltages
/// violate them by 1e-6 to 1e-4, those that jump at other instants by 4e-4 to 4e-2.
const FITS: f64 = 2e-4;

/// Largest number of times that it is solved again with other charts of its rotations, and to a smaller tolerance.
const CHARTS: usize = 4;
const TIGHTENED: usize = 3;

/// Limits of a solve, in place of those of its problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveLimits {
    /// Iterations of the solver.
    pub iterations: Option<usize>,
    /// Seconds, set-up included.
    pub seconds: Option<f64>,
}

/// A control problem and how its solve ended.
#[derive(Debug)]
pub struct Optimum {
    /// The model, with the parameters that were found put in.
    pub model: Model,
    /// The model of the program, where it has sought parameters.
    pub sought: Option<Model>,
    /// Start and goal.
    pub boundary: BoundaryConditions,
    /// The motion: the optimal one, or the last iterate.
    pub motion: Solution,
    /// Result of the solver.
    pub solution: SolverResult,
    /// Interval in which the span of a muscle turns by a right angle or more, and the muscle: the discrete equations hold, but
    /// describe no motion.
    pub reversed: Option<(usize, usize)>,
    /// The worst rows that do not hold; none of a solution.
    pub violated: Vec<Violation>,
    /// Greatest violation of an equation or limit, as the solver measures it.
    pub infeasibility: f64,
    /// Number of equations and limits.
    pub constraints: usize,
    /// Nonzeros of the Jacobian.
    pub jacobian_nonzeros: usize,
    /// Nonzeros of the lower triangle of the Hessian.
    pub hessian_nonzeros: usize,
    /// Seconds before the solver began.
    pub setup: f64,
    /// Changes of the solution that it started from.
    pub carried: Carried,
    /// The verification of its voltages, where the solver found a solution.
    pub resimulation: Option<Resimulation>,
    /// Seconds that the test took.
    pub tested: f64,
    /// Status of the first start, where a displaced second one found the optimum.
    pub restarted: Option<Status>,
    /// Bounds and limits that the motion reaches, the most frequent first; none of a solution.
    pub active: Vec<Active>,
    /// Bound of the objective above its least value, in its unit.
    pub gap: f64,
    /// Warning that this is large relative to the objective, where it is.
    pub(crate) wide: Option<String>,
    /// Motion after a goal that no known voltages hold.
    pub afterwards: Option<Afterwards>,
}

impl Optimum {
    /// Returns true if it is an optimal motion: the solver found it, and a simulation under its voltages reproduces it.
    pub fn is_solved(&self) -> bool {
        self.meets_equations() && self.cause().is_none()
    }

    /// Holds the voltages of the goal after its end, or those of the last interval where none are known, if it is reproduced.
    pub(crate) fn hold(&mut self, control: &Control) {
        if self.is_solved() {
            self.afterwards = afterwards(&self.model, control, &self.motion);
        }
        let Self {
            model,
            boundary,
            motion,
            resimulation: Some(tested),
            ..
        } = self
        else {
            return;
        };
        if tested.cause.is_none() {
            tested.hold(model, boundary, motion);
        }
    }

    /// Returns true if it meets the discrete equations, reproduced or not.
    pub(crate) fn meets_equations(&self) -> bool {
        self.solution.status.is_solved() && self.reversed.is_none()
    }

    /// Returns the reason why a simulation does not reproduce it, where it does not.
    pub fn cause(&self) -> Option<&Cause> {
        self.resimulation.as_ref()?.cause.as_ref()
    }

    /// Returns its status, in a word.
    pub fn word(&self) -> &'static str {
        match self.cause() {
            _ if self.reversed.is_some() => "unresolved",
            Some(_) => "not_reproduced",
            None => self.solution.status.word(),
        }
    }
}

/// Solves a control problem, from an `earlier` solution where one is given; `observer` sees every iterate.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong. A problem without a solution is no error: see the status.
pub fn optimise(
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
    let mut restarted = None;
    if is_infeasible(solution.status) && matches!(start, Start::Cold | Start::Simulated) {
        phase("a second, displaced initial guess");
        let displaced = displaced(control, &boundary, model.sources.len());
        let initial = guess(&model, &boundary, &displaced, interval(control), None);
        solver.set_options(Options {
            max_iterations: options.max_iterations.min(ITERATIONS),
            max_seconds: allowed.seconds.map(left),
            ..options.clone()
        });
        let point = solver.program().start(&initial);
        let second = solve(&mut solver, &point)?;
        restarted = second.status.is_solved().then_some(solution.status);
        solution = one_of_both(solution, second);
    }
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
            max_iterations: options.max_iterations.min(ITERATIONS),
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
    let mut program = solver.into_program();
    drop(watch);
    let gap = gap::gap(&program, &solution);
    let wide = gap::warning(gap, &solution, program.objective_scale());
    let history = program.decode(&solution.x);
    let last = solution.iterations.last();
    let last = last.filter(|_| !solution.status.is_solved());
    let motion = Solution {
        hold: boundary.rest[1].clone(),
        barrier: last.map(|last| last.mu),
        ..solved(&model, &history, Some(program.costates(&solution.costates)))
    };
    let (violated, active) = match solution.status.is_solved() {
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
    let is_solved = solution.status.is_solved();
    let reversed = reversed_muscle(&model, &history).filter(|_| is_solved);
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
        restarted,
        active,
        gap,
        wide,
        afterwards: None,
    })
}

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
