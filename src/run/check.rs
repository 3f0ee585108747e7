//! The derivatives of a problem against differences, at its guess moved by noise.

use std::collections::{BTreeMap, HashMap};

use crate::control::problem::{
    Control, Duration, Guess, Objective, Simulation, Solver, State, Task, Voltages,
};
use crate::control::{Row, Transcription, Variable};
use crate::model::{Coordinates, Model, System};
use crate::nlp::{Nlp, differences};
use crate::run::effects;
use crate::run::error::RunError;
use crate::run::optimise::{Prepared, prepare, resolve};
use crate::run::request::{Request, Told};
use crate::scene::read_problem;

/// Noise on each variable as the solver sees it.
const NOISE: f64 = 1e-2;
/// Seed of noise, factor and costates.
const SEED: u64 = 7;
/// Intervals looked at; all intervals are alike.
const INTERVALS: usize = 6;

/// Compares gradient, Jacobian and Hessian with differences; not solved where an entry is wrong.
///
/// What is not a control problem is made one without a goal, so that every equation of its motion is looked at.
///
/// # Errors
/// The input is wrong.
pub fn check(request: &Request) -> Result<Told, RunError> {
    let loaded = read_problem(&request.input, &request.set)?;
    let control = as_control(loaded.task, &loaded.system);
    let (model, boundary) = resolve(&request.input, &loaded.system, &control)?;
    let Prepared {
        mut program, point, ..
    } = prepare(&request.input, &model, &boundary, &control, None)?;
    let mut noise = Noise(SEED);
    let x: Vec<f64> = point.x.iter().map(|x| x + NOISE * noise.next()).collect();
    let report = differences::check(&mut program, &x, SEED);
    let mut notes: Vec<String> = report.to_string().lines().map(str::to_owned).collect();
    for (entry, note) in report.wrong.iter().zip(&mut notes[1..]) {
        let effects = coupling(&program, &model, &entry.row, &entry.column);
        if !effects.is_empty() {
            note.push_str(&format!(" [{}]", effects.join(", ")));
        }
    }
    let is_solved = report.is_consistent();
    let worst = report.gradient.max(report.jacobian).max(report.hessian);
    let result = match is_solved {
        true => format!("derivatives agree with differences to {worst:.1e}"),
        false => format!(
            "derivatives are wrong: {} entries or more, {} variables not checked",
            report.wrong.len(),
            report.unchecked.len()
        ),
    };
    Ok(Told {
        is_solved,
        result,
        notes,
    })
}

/// Names of the effects that couple the unknowns of a row and a column.
fn coupling(program: &Transcription<'_>, model: &Model, row: &str, column: &str) -> Vec<String> {
    let n = model.coordinate_count();
    let of_variable = |variable: &Variable| match *variable {
        Variable::Unknown { i, .. } => Some(i),
        Variable::Scalar { s, .. } => Some(n + s),
        Variable::Horizon => None,
    };
    let mut entries = HashMap::new();
    for (i, variable) in program.unknowns().variables.iter().enumerate() {
        entries.insert(program.variable_name(i), of_variable(variable));
    }
    for (r, kind) in program.unknowns().rows.iter().enumerate() {
        let entry = match *kind {
            Row::Equation { i, .. } => Some(i),
            Row::Gauss { s, .. } => Some(n + s),
            Row::Limit { .. } => None,
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
    let at_reference = || State::JointAngles {
        angles: BTreeMap::new(),
        rates: BTreeMap::new(),
    };
    let without_goal = |start, step, voltages, coordinates: Option<Coordinates>| Control {
        duration: Duration::Given(step * INTERVALS as f64),
        intervals: INTERVALS,
        start,
        goal: at_reference(),
        voltage_bounds: [f64::NEG_INFINITY, f64::INFINITY],
        given: BTreeMap::new(),
        objective: Objective {
            effort: 1.0,
            rate: 1.0,
            duration: 0.0,
        },
        limits: Vec::new(),
        coordinates,
        guess: Guess::Simulate(voltages),
        solver: Solver {
            tolerance: 1e-10,
            max_iterations: 0,
            ipopt: BTreeMap::new(),
        },
    };
    match task {
        Task::Control(control) => *control,
        Task::Simulate(simulation) => {
            let silent = simulation.question(system, simulation.step).silent;
            let Simulation {
                step,
                start,
                voltages,
                coordinates,
                ..
            } = simulation;
            let row = match voltages {
                Voltages::Constant(row) => row,
                Voltages::Sampled { rows, .. } => rows
                    .into_iter()
                    .next()
                    .unwrap_or_else(|| vec![0.0; system.sources().len()]),
            };
            Control {
                given: silent.into_iter().map(|source| (source, 0.0)).collect(),
                ..without_goal(start, step, row, coordinates)
            }
        }
        Task::Equilibrium(task) => {
            without_goal(at_reference(), 1.0, task.voltages, task.coordinates)
        }
    }
}

/// Numbers in [−1, 1] by the generator `splitmix64` of S. Vigna (public domain).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        2.0 * (z >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    }
}
