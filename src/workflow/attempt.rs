//! A control problem solved from one start: boundary, guess, program, solver.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::Control;
use crate::control::{BoundaryConditions, Costates, Solution, Transcription};
use crate::dynamics::{DiscreteTrajectory, reversed_muscle};
use crate::ipopt::{Options, Solver, SolverResult, interrupt};
use crate::model::{Model, System};
use crate::nlp::Nlp;
use crate::workflow::active::{Active, active};
use crate::workflow::error::WorkflowError;
use crate::workflow::found_hold;
use crate::workflow::gap;
use crate::workflow::iterate::Iterate;
use crate::workflow::motion::solved;
use crate::workflow::optimum::{Optimum, Shortest, SolveLimits};
use crate::workflow::ordering::ordering;
use crate::workflow::period;
use crate::workflow::phase::phase;
use crate::workflow::prepare::{Counted, Prepared, prepare};
use crate::workflow::resimulate::{Resimulation, resimulate};
use crate::workflow::resolve::{resolve, with_found};
use crate::workflow::solves::Solves;
use crate::workflow::violations::{Violation, violations};

/// Maximum number of rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;

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
        start,
        max_seconds: allowed.seconds.map(|s| (s - setup).max(0.0)),
        ..options(&model, control, allowed)
    };
    phase("ordering and first factorisation");
    tracing::info!(?start, variables = point.x.len(), "solve");
    let mut solves = Solves {
        model: &model,
        boundary: &boundary,
        control,
        solver: Solver::new(program, options.clone()),
        options,
        began,
        seconds: allowed.seconds,
        observer,
    };
    let solution = solves.solve(&point)?;
    let solution = solves.recentre(solution)?;
    let solution = solves.tighten(solution)?;
    let mut program = solves.solver.into_program();
    drop(watch);
    let discrete = program.decode(&solution.x);
    let costates = program.costates(&solution.costates);
    let motion = final_motion(&model, &boundary, (&discrete, costates), &solution);
    let point = FinalPoint::new(&mut program, &solution, &model, control);
    drop(program);
    let (model, mut boundary, sought) = of_motion(system, control, (model, boundary), &motion)?;
    let verified = match solution.status.is_solved() {
        true => Verification::new(&model, &mut boundary, control, (&discrete, &motion)),
        false => Verification::default(),
    };
    Ok(Optimum {
        model,
        sought,
        boundary,
        motion,
        solution,
        reversed: verified.reversed,
        violated: point.violated,
        infeasibility: point.infeasibility,
        constraints: point.constraints,
        jacobian_nonzeros: point.jacobian_nonzeros,
        hessian_nonzeros: point.hessian_nonzeros,
        setup,
        carried,
        resimulation: verified.resimulation,
        tested: verified.tested,
        restarted: None,
        shortest: Shortest::Unknown,
        half_period: None,
        stopped: None,
        active: point.active,
        gap: point.gap,
        wide: point.wide,
        afterwards: None,
        repeated: None,
    })
}

/// Options of the solver for a problem, without those of its start and its time.
fn options(model: &Model, control: &Control, allowed: SolveLimits) -> Options {
    Options {
        tolerance: control.solver.tolerance,
        max_iterations: allowed.iterations.unwrap_or(control.solver.max_iterations),
        linear_solver: control.solver.linear_solver,
        extra: ordering(model, control),
        ..Options::default()
    }
}

/// The motion at the end of the last solve: a solution, or an iterate with its barrier parameter.
fn final_motion(
    model: &Model,
    boundary: &BoundaryConditions,
    (discrete, costates): (&DiscreteTrajectory, Costates),
    solution: &SolverResult,
) -> Solution {
    let motion = solved(model, discrete, Some(costates));
    Solution {
        hold: boundary.rest[1].clone().or(motion.hold.clone()),
        barrier: match solution.status.is_solved() {
            true => None,
            false => solution.iterations.last().map(|last| last.mu),
        },
        ..motion
    }
}

/// Model and boundary of a motion, with its parameters put in, and the model of the program, where that has free parameters.
fn of_motion(
    system: &System,
    control: &Control,
    (model, boundary): (Model, BoundaryConditions),
    motion: &Solution,
) -> Result<(Model, BoundaryConditions, Option<Model>), WorkflowError> {
    if control.parameters.is_empty() {
        return Ok((model, boundary, None));
    }
    let (found, boundary) = with_found(system, control, &model, motion)?;
    Ok((found, boundary, Some(model)))
}

/// The point of a program at which its last solve ended.
struct FinalPoint {
    violated: Vec<Violation>,
    active: Vec<Active>,
    infeasibility: f64,
    constraints: usize,
    jacobian_nonzeros: usize,
    hessian_nonzeros: usize,
    gap: f64,
    wide: Option<String>,
}

impl FinalPoint {
    fn new(
        program: &mut Transcription<'_>,
        solution: &SolverResult,
        model: &Model,
        control: &Control,
    ) -> Self {
        let x = &solution.x;
        let (violated, active) = match solution.status.is_solved() {
            true => (Vec::new(), Vec::new()),
            false => (
                violations(program, x, HOLDS, NAMED),
                active(program, x, model, control),
            ),
        };
        let gap = gap::gap(program, solution);
        Self {
            violated,
            active,
            infeasibility: program.violation(x),
            constraints: program.constraints().lower.len(),
            jacobian_nonzeros: program.jacobian_structure().rows.len(),
            hessian_nonzeros: program.hessian_structure().rows.len(),
            gap,
            wide: gap::warning(gap, solution, program.objective_scale()),
        }
    }
}

/// The verification of a solution: muscles that turn around within an interval, and a simulation under its voltages.
#[derive(Default)]
struct Verification {
    reversed: Option<(usize, usize)>,
    /// The simulation, where no muscle turns around.
    resimulation: Option<Resimulation>,
    /// Seconds that it took.
    tested: f64,
}

impl Verification {
    /// Completes start and goal by what was found with the motion, and verifies it from there.
    fn new(
        model: &Model,
        boundary: &mut BoundaryConditions,
        control: &Control,
        (discrete, motion): (&DiscreteTrajectory, &Solution),
    ) -> Self {
        found_hold::keep(model, boundary, discrete);
        period::begin(control, boundary, motion);
        let reversed = reversed_muscle(model, discrete);
        if reversed.is_some() {
            return Self {
                reversed,
                ..Self::default()
            };
        }
        phase("simulating under the optimal inputs");
        let began = Instant::now();
        let tolerance = control.solver.tolerance;
        let resimulation = resimulate((model, control), &boundary.start, motion, tolerance);
        Self {
            reversed,
            resimulation: Some(resimulation),
            tested: began.elapsed().as_secs_f64(),
        }
    }
}
