//! The derivatives of a problem against differences, at its guess moved by noise.

use crate::control::problem::{
    BoundaryState, Control, Guess, Objective, Simulation, Solver, Task, Voltages,
};
use crate::control::{Column, Motion, Motions, Row, Transcription};
use crate::ipopt::LinearSolver;
use crate::math::{Random, Signal, shortest};
use crate::mesh::Mesh;
use crate::model::{Coordinates, Model, System};
use crate::nlp::Nlp;
use crate::nlp::differences::{self, Report};
use crate::stop;
use crate::stop::TimeLimit;
use crate::workflow::optimum::Budget;
use crate::workflow::program::{Counted, Prepared, prepare, resolve};
use crate::workflow::{WorkflowError, effects};
use std::collections::{BTreeMap, HashMap};

/// Noise on each variable, relative to its size.
const NOISE: f64 = 1e-2;
/// Seed of noise, factor and costates.
const SEED: u64 = 7;
/// Intervals checked where the problem has no grid of its own; all intervals are alike.
const INTERVALS: usize = 6;

/// Result of a comparison of derivatives with differences.
#[derive(Clone, Debug)]
pub struct CheckResult {
    /// True if all were compared, and none is wrong.
    pub agrees: bool,
    /// The same in words.
    pub message: String,
    /// Greatest relative errors, the entries that are wrong, and the variables along which they were compared, and were not.
    pub report: Report,
    /// Effects that couple row and column of each wrong entry.
    pub effects: Vec<Vec<String>>,
    /// Variables of the program.
    pub variables: usize,
    /// Notes on each.
    pub notes: Vec<String>,
}

/// Compares gradient, Jacobian and Hessian of a task with differences, within `seconds`; they do not agree where an entry is wrong.
///
/// Another task is converted to a control problem without a goal, so that every equation of its motion is checked.
///
/// # Errors
/// Start, goal or guess is wrong, or the machine has no room.
pub fn check(
    system: &System,
    task: Task,
    seconds: Option<f64>,
) -> Result<CheckResult, WorkflowError> {
    if let Task::Motions(motions) = task {
        return all_motions(*motions, seconds);
    }
    let watch = stop::watch(seconds);
    let control = as_control(task, system);
    let resolved = resolve(system, &control).map_err(stop::unless_stopped);
    let (model, boundary) = resolved?;
    let Prepared {
        mut program, point, ..
    } = prepare(&model, &boundary, &control, None, Counted::No).map_err(stop::unless_stopped)?;
    let sizes = sizes(&program, &model);
    let mut noise = Random::new(SEED);
    let each = point.x.iter().zip(&sizes);
    let moved = each.map(|(x, size)| x + NOISE * size * noise.between(-1.0, 1.0));
    let x: Vec<f64> = moved.collect();
    // What is evaluated while it becomes time to stop would be there in part, and seem to be wrong.
    let limit = stop::limit();
    drop(watch);
    let mut stopped = None;
    let report = differences::check_with_sizes(&mut program, &x, &sizes, SEED, || {
        stopped = limit.as_ref().and_then(TimeLimit::reached);
        stopped.is_some()
    });
    let mut notes: Vec<String> = report.to_string().lines().map(str::to_owned).collect();
    let wrong = report.wrong.iter();
    let effects = wrong.map(|entry| coupling(&program, &model, &entry.row, &entry.column));
    let effects: Vec<Vec<String>> = effects.collect();
    for (effects, note) in effects.iter().zip(&mut notes[1..]) {
        if !effects.is_empty() {
            note.push_str(&format!(" [{}]", effects.join(", ")));
        }
    }
    let worst = report.gradient.max(report.jacobian).max(report.hessian);
    let of = match report.checked == x.len() {
        true => String::new(),
        false => format!(", along {} of {} variables", report.checked, x.len()),
    };
    let message = match (report.is_consistent(), stopped) {
        (true, _) => format!("derivatives agree with differences to {worst:.1e}{of}"),
        (false, Some(status)) if report.wrong.is_empty() => {
            let why = status.word().replace('_', " ");
            format!("not all derivatives were compared ({why}): {worst:.1e}{of}")
        }
        (false, _) => format!(
            "derivatives are wrong: {} entries or more, {} variables not checked{of}",
            report.wrong.len(),
            report.unchecked.len()
        ),
    };
    Ok(CheckResult {
        agrees: report.is_consistent(),
        message,
        report,
        effects,
        variables: x.len(),
        notes,
    })
}

/// Compares those of each motion by itself: a program of several has the same.
fn all_motions(motions: Motions, seconds: Option<f64>) -> Result<CheckResult, WorkflowError> {
    let budget = Budget::of_seconds(seconds);
    let mut all: Option<CheckResult> = None;
    for Motion {
        name,
        system,
        control,
    } in motions.list
    {
        let (left, list) = (budget.left(), control.list());
        let found = check(&system, Task::Control(Box::new(control)), left);
        let mut found = found.map_err(|error| error.of_motion(list, &name))?;
        found.message = format!("motion \"{name}\": {}", found.message);
        all = Some(match all {
            None => found,
            Some(before) => before.with(found),
        });
    }
    Ok(all.expect("a list has a motion"))
}

impl CheckResult {
    /// Both as one.
    fn with(mut self, mut other: Self) -> Self {
        let (report, its) = (&mut self.report, &mut other.report);
        report.gradient = report.gradient.max(its.gradient);
        report.jacobian = report.jacobian.max(its.jacobian);
        report.hessian = report.hessian.max(its.hessian);
        report.checked += its.checked;
        report.unchecked.append(&mut its.unchecked);
        report.wrong.append(&mut its.wrong);
        self.effects.append(&mut other.effects);
        self.notes.append(&mut other.notes);
        Self {
            agrees: self.agrees && other.agrees,
            message: format!("{}\n{}", self.message, other.message),
            variables: self.variables + other.variables,
            ..self
        }
    }
}

/// The size of each variable as the solver sees it: that of an element for the coordinates of its nodes.
fn sizes(program: &Transcription<'_>, model: &Model) -> Vec<f64> {
    let blocks = model.solids.iter().map(|block| &block.solid.mesh);
    let edges = blocks.map(Mesh::shortest_edge);
    let edge = edges.fold(f64::INFINITY, f64::min);
    let size = (edge / model.length()).min(1.0);
    let nodes = model.action.map.nodes();
    let of = |column: &Column| match *column {
        Column::Instant { i, .. } if nodes.contains(&i) => size,
        _ => 1.0,
    };
    program.unknowns().columns.iter().map(of).collect()
}

/// Names of the effects that couple the unknowns of a row and a column.
fn coupling(program: &Transcription<'_>, model: &Model, row: &str, column: &str) -> Vec<String> {
    let n = model.coordinate_count();
    let of_column = |column: &Column| match *column {
        Column::Instant { i, .. } => Some(i),
        Column::Interval { s, .. } | Column::Parameter { s } => Some(n + s),
        Column::Horizon => None,
    };
    let mut entries = HashMap::new();
    for (i, column) in program.unknowns().columns.iter().enumerate() {
        entries.insert(program.variable_name(i), of_column(column));
    }
    for (r, kind) in program.unknowns().rows.iter().enumerate() {
        let entry = match *kind {
            Row::Instant { i, .. } => Some(i),
            Row::Interval { s, .. } => Some(n + s),
            Row::Time { .. } | Row::Limit { .. } => None,
        };
        entries.insert(program.constraint_name(r), entry);
    }
    let entry = |name: &str| entries.get(name).copied().flatten();
    let (Some(i), Some(j)) = (entry(row), entry(column)) else {
        return Vec::new();
    };
    effects::coupling(model, i, j)
}

/// The control problem whose program has the derivatives of a task.
fn as_control(task: Task, system: &System) -> Control {
    let at_reference = || BoundaryState::at_joints(BTreeMap::new());
    let without_goal = |start, step, voltages: Vec<f64>, coordinates: Option<Coordinates>| {
        let voltages = Voltages::constant(&voltages);
        let duration = step * INTERVALS as f64;
        Control {
            // A joint that goes on does not rest.
            goal: match system.joints.iter().any(|joint| joint.motion.is_some()) {
                true => BoundaryState::Free,
                false => at_reference(),
            },
            course: None,
            objective: Objective {
                effort: 1.0,
                rate: 1.0,
                ..Objective::default()
            },
            coordinates,
            guess: Guess::Simulate(voltages.clone()),
            solver: Solver {
                tolerance: 1e-10,
                max_iterations: 0,
                linear_solver: LinearSolver::Auto,
                ipopt: BTreeMap::new(),
            },
            ..Control::of_course(&start, &voltages, duration, INTERVALS)
        }
    };
    match task {
        Task::Control(control) => *control,
        Task::Motions(_) => unreachable!("checked motion by motion"),
        Task::Simulate(simulation) => {
            let analysis = simulation.analysis(system, simulation.step);
            let zero_inputs = analysis.zero_inputs.into_iter();
            let Simulation {
                step,
                start,
                voltages,
                coordinates,
                ..
            } = simulation;
            let row = voltages.at(0.0).to_vec();
            Control {
                given: zero_inputs
                    .map(|source| (source, Signal::Constant(0.0)))
                    .collect(),
                ..without_goal(start, step, row, coordinates)
            }
        }
        Task::Equilibrium(task) => {
            without_goal(at_reference(), 1.0, task.voltages, task.coordinates)
        }
        Task::Identify(task) => {
            let row = task.recordings[0].voltages.at(0.0).to_vec();
            Control {
                parameters: task.parameters,
                ..without_goal(at_reference(), 1.0, row, task.coordinates)
            }
        }
    }
}

/// Part of the distance of a node from the origin, or mm, within which a marker is at it.
const AT: f64 = 1e-6;

/// A line for each marker of a block that is not written at a node: it is the nearest one.
pub(crate) fn moved_markers(system: &System) -> Vec<String> {
    let of_blocks = system.markers.iter().filter_map(|marker| {
        let mesh = &system.solids[marker.solid?].mesh;
        let node = mesh.nodes[mesh.nearest_node(&marker.point.at)?];
        let distance = (node - marker.point.at).norm();
        let [x, y, z] = [node.x, node.y, node.z].map(|value| shortest(value + 0.0, 6));
        (distance > AT * node.norm().max(1.0)).then(|| {
            format!(
                "marker {} is the node at [{x} mm, {y} mm, {z} mm], {} mm from the place that is written",
                marker.name,
                shortest(distance, 3)
            )
        })
    });
    of_blocks.collect()
}
