//! A control problem solved from one start: boundary, guess, program, solver.

use crate::control::problem::{Control, ControlTask, Duration, MotionTask};
use crate::control::{BoundaryConditions, Carried, Solution, Transcription};
use crate::dynamics::{DiscreteTrajectory, reversed_muscle};
use crate::ipopt::{OptionValue, Options, Solver, SolverResult};
use crate::model::{Coordinates, Model};
use crate::nlp::joined::Places;
use crate::nlp::{Nlp, Status};
use crate::stop;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::error::WorkflowError;
use crate::workflow::hold_check;
use crate::workflow::motion::{Iterate, solved};
use crate::workflow::optimum::{
    Optimum, Shortest, SolveLimits, Stages, WholeProgram, active, violations,
};
use crate::workflow::program::{
    Prepared, multipliers_of, prepare_together, program_motions, resolve_each, with_found,
};
use crate::workflow::remark::phase;
use crate::workflow::resimulate::{Verification, resimulate};
use crate::workflow::solves::{Solves, bound};
use std::collections::BTreeMap;
use std::mem;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

/// Maximum number of rows named when a problem has no solution.
const NAMED: usize = 5;
/// A row that the solver could not make smaller than this does not hold.
const HOLDS: f64 = 1e-6;

/// Motions that were optimised together, or a single one, and the way to them.
#[derive(Debug)]
pub struct Together {
    /// Each with its part of the result of the solver.
    pub optima: Vec<Optimum>,
    /// All of them as one program.
    pub whole: WholeProgram,
    /// Iterations on all grids.
    pub iterations: usize,
    /// Estimated errors, the greatest of all motions, where an accuracy was wanted of motions that name their intervals.
    pub accuracy: Option<Accuracy>,
}

impl Together {
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

    /// Takes over what became of the solutions that the motions of a grid before started from, and the stages that led there.
    pub(crate) fn carry(&mut self, before: &Self) {
        for (new, old) in self.optima.iter_mut().zip(&before.optima) {
            new.carried = old.carried;
            new.stages.solved += old.stages.solved;
            new.stages.is_simulated |= old.stages.is_simulated;
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
    verification: Verification,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Together, WorkflowError> {
    let began = Instant::now();
    let watch = stop::watch(allowed.seconds);
    phase("building the model, finding start and goal");
    let resolved = resolve_each(task).map_err(stop::unless_stopped)?;
    phase("building the program");
    let motions = program_motions(task, &resolved);
    let Prepared {
        program,
        point,
        start,
        carried,
    } = prepare_together(&motions, task).map_err(stop::unless_stopped)?;
    let setup = began.elapsed().as_secs_f64();
    let first = motions[0];
    let options = Options {
        start,
        ..options(first.model, first.task.control, allowed)
    };
    phase("ordering and first factorisation");
    tracing::info!(?start, variables = point.x.len(), "solve");
    let mut solves = Solves {
        motions: &motions,
        task,
        solver: Solver::new(program, options.clone()),
        options,
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
    let each = task.motions.iter().zip(&resolved);
    let each = each.zip(program.into_parts()).zip(carried).enumerate();
    let mut optima: Vec<Optimum> = Vec::new();
    for (number, (((one, resolved), mut part), carried)) in each {
        let own = part_of(&places, number, &solution, &mut part);
        let before = optima.last().filter(|_| one.control.continues[0]);
        let before = before.map(|phase| &phase.motion);
        let optimum = Optimum::new(one, resolved, part, own, before, verification);
        optima.push(Optimum {
            setup,
            carried,
            cut_short,
            ..optimum.map_err(|error| error.of_motion(one.control.list(), one.name))?
        });
    }
    // A part of an objective may vanish: the gap of the whole counts.
    if let [only] = &mut optima[..] {
        (only.program.gap, only.program.wide) = (whole.gap, whole.wide.clone());
    }
    Ok(Together {
        optima,
        whole,
        iterations: 0,
        accuracy: None,
    })
}

impl Optimum {
    /// The end of a solve for one motion, `before` which there may be the phase that it goes on from, with its verification; parameters that were found
    /// are put in.
    fn new(
        task: &MotionTask<'_>,
        resolved: &(Arc<Model>, BoundaryConditions),
        mut program: Transcription<'_>,
        solution: SolverResult,
        before: Option<&Solution>,
        verification: Verification,
    ) -> Result<Self, WorkflowError> {
        let MotionTask {
            system, control, ..
        } = *task;
        let (mut model, mut boundary) = resolved.clone();
        let x = &solution.x;
        let discrete = program.decode(x);
        let costates = program.costates(&solution.costates);
        let mut motion = solved(&model, &discrete, Some(costates));
        motion.hold = boundary.rest[1].clone().or(motion.hold);
        let is_solved = solution.status.is_solved();
        let (violated, active) = match is_solved {
            true => (Vec::new(), Vec::new()),
            false => {
                let last = solution.iterations.last();
                motion.barrier = last.map(|last| last.mu);
                let violated = violations(&mut program, x, HOLDS, NAMED);
                (violated, active(&mut program, x, &model, control))
            }
        };
        let gap = bound(&mut program, &solution);
        let infeasibility = program.violation(x);
        let whole = WholeProgram::new(&program, &solution, gap);
        drop(program);
        let mut sought = None;
        if !control.parameters.is_empty() {
            let (found, ends) = with_found(system, control, &model, &motion)?;
            sought = Some(mem::replace(&mut model, Arc::new(found)));
            boundary = ends;
            // Places of joints may be sought.
            let poses = motion.z.iter().map(|z| model.action.map.placed(z));
            motion.poses = poses.map(|instant| model.poses(&instant)).collect();
        }
        let mut out = Self {
            model,
            sought,
            boundary,
            motion,
            solution,
            reversed: None,
            violated,
            infeasibility,
            program: whole,
            setup: 0.0,
            carried: Carried::default(),
            resimulation: None,
            tested: 0.0,
            restarted: None,
            stages: Stages::default(),
            shortest: Shortest::Unknown,
            half_period: None,
            stopped: None,
            cut_short: None,
            active,
            afterwards: None,
            repeated: None,
            refined: None,
            not_found: None,
        };
        if is_solved {
            out.verify(control, &discrete, before, verification);
        }
        Ok(out)
    }

    /// Completes start and goal by what was found with the motion, and verifies it from there: muscles that turn around within an interval, and,
    /// where none does, a simulation under its voltages.
    fn verify(
        &mut self,
        control: &Control,
        discrete: &DiscreteTrajectory,
        before: Option<&Solution>,
        verification: Verification,
    ) {
        let Self {
            model,
            boundary,
            motion,
            ..
        } = self;
        hold_check::keep_found(model, boundary, discrete);
        hold_check::begin(control, boundary, motion, before);
        self.reversed = reversed_muscle(model, discrete);
        if self.reversed.is_some() {
            return;
        }
        phase("simulating under the optimal inputs");
        let began = Instant::now();
        let tolerance = control.solver.tolerance;
        let start = &boundary.start;
        let found = resimulate(model, control, start, motion, tolerance, verification);
        self.resimulation = Some(found);
        self.tested = began.elapsed().as_secs_f64();
    }
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
        constraints: {
            let mut rows = vec![0.0; program.constraints().count()];
            program.constraint(&x, &mut rows);
            rows
        },
        x,
        costates: multipliers_of(places, number, &whole.costates),
        ..whole.clone()
    }
}

/// Options of the solver for a problem, without that of its start; a watch keeps its time.
fn options(model: &Model, control: &Control, allowed: SolveLimits) -> Options {
    Options {
        tolerance: control.solver.tolerance,
        max_iterations: allowed.iterations.unwrap_or(control.solver.max_iterations),
        linear_solver: control.solver.linear_solver,
        extra: ordering(model, control),
        ..Options::default()
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
