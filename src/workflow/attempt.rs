//! A control problem solved from one start: boundary, guess, program, solver.

use crate::control::problem::{Control, ControlTask, Duration, MotionTask};
use crate::control::{BoundaryConditions, Carried, Costates, Solution, Transcription};
use crate::dynamics::{DiscreteTrajectory, reversed_muscle};
use crate::ipopt::{OptionValue, Options, Solver, SolverResult};
use crate::kinematics::Pose;
use crate::model::{Coordinates, Model, System};
use crate::nlp::joined::Places;
use crate::nlp::{Nlp, Status};
use crate::stop;
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::{Iterate, solved};
use crate::workflow::optimum::{
    Active, Budget, Optimum, Shortest, SolveLimits, Violation, WholeProgram, active, violations,
};
use crate::workflow::program::{
    Counted, PreparedTogether, multipliers_of, prepare_together, program_motions, resolve_each,
    with_found,
};
use crate::workflow::remark::phase;
use crate::workflow::resimulate::{Resimulation, resimulate};
use crate::workflow::solves::Solves;
use crate::workflow::{gap, hold_check};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

/// Maximum number of rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;

/// Motions that were found by one program.
pub(crate) struct FoundTogether {
    /// The motions, each with its part of the result of the solver.
    pub(crate) optima: Vec<Optimum>,
    pub(crate) whole: WholeProgram,
}

impl FoundTogether {
    /// Returns true if all of them meet the discrete equations.
    pub(crate) fn meets_equations(&self) -> bool {
        self.optima.iter().all(Optimum::meets_equations)
    }

    /// Returns true if simulations reproduce all of them.
    pub(crate) fn is_solved(&self) -> bool {
        self.optima.iter().all(Optimum::is_solved)
    }

    /// The objective of all of them.
    pub(crate) fn objective(&self) -> f64 {
        match &self.optima[..] {
            [only] => only.solution.objective,
            _ => self.whole.objective,
        }
    }

    /// Takes over what became of the solutions that the motions of a grid before started from.
    pub(crate) fn carry(&mut self, before: &Self) {
        for (new, old) in self.optima.iter_mut().zip(&before.optima) {
            new.carried = old.carried;
        }
    }
}

/// Solves a task from one start: the earlier solution of each motion where one is given, or the guess of its problem; `observer` sees every
/// iterate. Free parameters and the named inputs are shared; the options of the solver are those of the first motion.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong. A problem without a solution is no error: see the status.
///
/// # Panics
/// If there is no motion.
pub(crate) fn attempt(
    task: &ControlTask<'_>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<FoundTogether, WorkflowError> {
    let (began, budget) = (Instant::now(), Budget::new(allowed));
    let watch = stop::watch(allowed.seconds);
    phase("building the model, finding start and goal");
    let resolved = resolve_each(task).map_err(stop::unless_stopped)?;
    phase("building the program");
    let motions = program_motions(task, &resolved);
    let PreparedTogether {
        program,
        shared,
        point,
        start,
        carried,
    } = prepare_together(&motions, task, Counted::Yes).map_err(stop::unless_stopped)?;
    let setup = began.elapsed().as_secs_f64();
    let first = motions[0];
    let options = Options {
        start,
        max_seconds: budget.left(),
        ..options(first.model, first.task.control, allowed)
    };
    phase("ordering and first factorisation");
    tracing::info!(?start, variables = point.x.len(), "solve");
    let mut solves = Solves {
        motions: &motions,
        shared: &shared,
        combined: task.combined,
        solver: Solver::new(program, options.clone()),
        options,
        budget,
        observer,
    };
    let solution = solves.solve(&point)?;
    let solution = solves.recentre(solution)?;
    let (solution, gap) = solves.confirm(solution)?;
    let program = solves.solver.into_program();
    let cut_short = stop::reason().filter(|_| solution.status == Status::Acceptable);
    drop(watch);
    let whole = WholeProgram {
        weights: program.weights(&solution.costates.constraints),
        wide: gap.warning(&solution),
        ..WholeProgram::new(&program, &solution, gap.left)
    };
    let places = program.places().clone();
    let mut ends = Vec::new();
    for (number, (motion, mut part)) in motions.iter().zip(program.into_parts()).enumerate() {
        let own = part_of(&places, number, &solution, &mut part);
        let discrete = part.decode(&own.x);
        let costates = part.costates(&own.costates);
        let found = final_motion(motion.model, motion.boundary, &discrete, costates, &own);
        let point = FinalPoint::new(&mut part, &own, motion.model, motion.task.control);
        ends.push((own, discrete, found, point));
    }
    let mut optima = verified_optima(task, resolved, ends, setup, carried)?;
    for optimum in &mut optima {
        optimum.cut_short = cut_short;
    }
    // A part of an objective may vanish: the gap of the whole counts.
    if let [only] = &mut optima[..] {
        (only.program.gap, only.program.wide) = (whole.gap, whole.wide.clone());
    }
    Ok(FoundTogether { optima, whole })
}

/// Motions with their verifications.
fn verified_optima(
    task: &ControlTask<'_>,
    resolved: Vec<(Model, BoundaryConditions)>,
    ends: Vec<End>,
    setup: f64,
    carried: Vec<Carried>,
) -> Result<Vec<Optimum>, WorkflowError> {
    let all = task.motions.iter().zip(resolved).zip(ends).zip(carried);
    let optima = all.map(|(((one, resolved), end), carried)| {
        let optimum = verified_optimum(*one, resolved, end, (setup, carried));
        optimum.map_err(|error| error.of_motion(one.name))
    });
    optima.collect()
}

/// The end of the last solve for one motion: its part of the result, its motion in unknowns and as it is kept, and the point of its program.
type End = (SolverResult, DiscreteTrajectory, Solution, FinalPoint);

/// A motion with its verification.
fn verified_optimum(
    task: MotionTask<'_>,
    resolved: (Model, BoundaryConditions),
    (solution, discrete, motion, point): End,
    (setup, carried): (f64, Carried),
) -> Result<Optimum, WorkflowError> {
    let MotionTask {
        system, control, ..
    } = task;
    let (model, mut boundary, sought) = of_motion(system, control, resolved, &motion)?;
    let motion = match &sought {
        None => motion,
        // Places of joints may be sought.
        Some(_) => Solution {
            poses: motion.z.iter().map(|z| poses(&model, z)).collect(),
            ..motion
        },
    };
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
        program: point.program,
        setup,
        carried,
        resimulation: verified.resimulation,
        tested: verified.tested,
        restarted: None,
        shortest: Shortest::Unknown,
        half_period: None,
        stopped: None,
        cut_short: None,
        active: point.active,
        afterwards: None,
        repeated: None,
    })
}

/// The part of a result that is of one motion; the whole of a single one.
fn part_of(
    places: &Places,
    number: usize,
    whole: &SolverResult,
    program: &mut Transcription<'_>,
) -> SolverResult {
    if places.programs() == 1 {
        return whole.clone();
    }
    let x = places.values_of(number, &whole.x);
    SolverResult {
        objective: program.objective(&x),
        x,
        constraints: whole.constraints[places.rows(number)].to_vec(),
        costates: multipliers_of(places, number, &whole.costates),
        ..whole.clone()
    }
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
    discrete: &DiscreteTrajectory,
    costates: Costates,
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

/// Poses of the bodies at coordinates.
fn poses(model: &Model, z: &[f64]) -> Vec<Pose> {
    model.poses(&model.action.map.placed(z))
}

/// The point of a program at which its last solve ended.
struct FinalPoint {
    violated: Vec<Violation>,
    active: Vec<Active>,
    infeasibility: f64,
    program: WholeProgram,
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
        let gap = gap::bound(program, solution);
        Self {
            violated,
            active,
            infeasibility: program.violation(x),
            program: WholeProgram::new(program, solution, gap),
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
        hold_check::keep_found(model, boundary, discrete);
        hold_check::begin_periodic(control, boundary, motion);
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
        let resimulation = resimulate(model, control, &boundary.start, motion, tolerance);
        Self {
            reversed,
            resimulation: Some(resimulation),
            tested: began.elapsed().as_secs_f64(),
        }
    }
}

/// Options of Ipopt, with the ordering of MUMPS that was fastest for the kind of program, unless the problem names one.
///
/// Approximate minimum degree (0) where each instant is a small dense block or the duration is given; minimum fill (2)
/// where a free duration couples all instants of a redundant program; nested dissection of SCOTCH (3) for the meshes of elastic
/// blocks. Measurements: `benches/README.md`.
pub(super) fn ordering(model: &Model, control: &Control) -> BTreeMap<String, OptionValue> {
    let free = matches!(control.duration, Duration::Free { .. });
    let ordering = if !model.action.map.of_nodes.is_empty() {
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
