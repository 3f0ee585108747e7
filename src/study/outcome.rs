//! One run of a point: the problem solved in memory, timed, and its answer observed.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

use nalgebra::Vector3;

use crate::app::CommandError;
use crate::control::problem::{AtRest, Control, Simulation, Task};
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{EquilibriumError, observations, simulate, stable_equilibrium};
use crate::model::Model;
use crate::stop;
use crate::study::measure::StudyMeasure;
use crate::study::read::StudyPoint;
use crate::workflow::{
    Cause, Iterate, Optimum, Simulated, SolveLimits, WorkflowError, integrate, optimise, trajectory,
};

/// Refinement factor of the grid on which optimal voltages are verified.
pub const FINER: usize = 16;

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunOutcome {
    /// A word: `solved`, `simulated`, `at_rest`, or why there is no answer.
    pub status: &'static str,
    /// The same in words, where there is no answer.
    pub message: Option<String>,
    /// Seconds of set-up and solution, without reading and measuring.
    pub seconds: f64,
    /// True if there is an answer.
    pub is_solved: bool,
}

/// Observations of an answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observed {
    /// Instants as parts of the duration.
    pub instants: Vec<f64>,
    /// Places of the markers of the study at the instants, in mm.
    pub places: Vec<Vec<Vector3<f64>>>,
    /// Places of the markers in the reference configuration, in mm.
    pub reference: Vec<Vector3<f64>>,
    /// Scalar values: the objective, and errors that need no reference.
    pub numbers: BTreeMap<StudyMeasure, f64>,
    /// Iterations of the solver, or of Newton's method over all steps.
    pub iterations: usize,
    /// Equal steps that had to be halved: the motion is then one of finer steps in part.
    pub halved: usize,
}

/// The status of a run that Ctrl-C ended.
const INTERRUPTED: &str = "interrupted";

/// Outcome of a run, and what was observed of its answer.
pub type Ran = (RunOutcome, Option<Observed>);

/// Status and message of a run without an answer.
type NoAnswer = (&'static str, String);

/// Runs a point once, unless Ctrl-C was pressed before; where `markers` are named, its answer is observed after the clock has stopped.
pub fn run(point: &StudyPoint, markers: Option<&[String]>) -> Ran {
    let run = Run {
        point,
        markers,
        began: Instant::now(),
    };
    let found = match &point.loaded.task {
        _ if stop::requested() => Ok((run.outcome(INTERRUPTED, None, false), None)),
        Task::Control(task) => run.control(task),
        Task::Simulate(task) => run.motion(task),
        Task::Equilibrium(task) => run.rest(task),
        Task::Motions(_) | Task::Identify(_) => unreachable!("refused where the study is read"),
    };
    let none = |(status, message)| (run.outcome(status, Some(message), false), None);
    found.unwrap_or_else(none)
}

/// A run that has begun.
struct Run<'a> {
    point: &'a StudyPoint,
    markers: Option<&'a [String]>,
    began: Instant,
}

impl Run<'_> {
    /// The outcome of a run that ends now.
    fn outcome(
        &self,
        status: &'static str,
        message: Option<String>,
        is_solved: bool,
    ) -> RunOutcome {
        RunOutcome {
            status,
            message,
            seconds: self.began.elapsed().as_secs_f64(),
            is_solved,
        }
    }

    fn refused(&self, error: WorkflowError) -> NoAnswer {
        let error = CommandError::in_file(&self.point.problem)(error);
        (REFUSED, error.to_string())
    }

    fn control(&self, task: &Control) -> Result<Ran, NoAnswer> {
        let system = &self.point.loaded.system;
        let mut on = |_: &Iterate<'_>| ControlFlow::Continue(());
        let optimum = optimise(system, task, None, SolveLimits::default(), &mut on);
        let optimum = optimum.map_err(|error| self.refused(error))?;
        let is_solved = optimum.is_solved();
        let none = || "the solver found no solution".to_owned();
        let message = (!is_solved).then(|| optimum.cause().map_or_else(none, Cause::message));
        let mut ended = self.outcome(optimum.word(), message, is_solved);
        // Verifying voltages is no part of finding them.
        ended.seconds -= optimum.tested;
        let seen = self.markers.filter(|_| is_solved);
        Ok((ended, seen.map(|names| of_optimum(&optimum, names))))
    }

    fn motion(&self, task: &Simulation) -> Result<Ran, NoAnswer> {
        let mut interrupted = false;
        let simulated = integrate(&self.point.loaded.system, task, |_, _| {
            interrupted = stop::requested();
            match interrupted {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let simulated = simulated.map_err(|error| self.refused(error))?;
        let status = match &simulated.failure {
            Some(_) => "step_failed",
            None if interrupted => INTERRUPTED,
            None => "simulated",
        };
        let message = simulated.failure.as_ref().map(ToString::to_string);
        let ended = self.outcome(status, message, status == "simulated");
        let seen = self.markers.filter(|_| ended.is_solved);
        let seen = seen.map(|names| of_motion(&simulated, task, names));
        Ok((ended, seen))
    }

    fn rest(&self, task: &AtRest) -> Result<Ran, NoAnswer> {
        let system = self.point.loaded.system.clone();
        let analysis = task.analysis(&system);
        let model = Model::for_analysis(system, analysis);
        let model = model.map_err(|error| (REFUSED, error.to_string()))?;
        let zero = model.reference_coordinates();
        let found = stable_equilibrium(&model, &zero, &model.scalars(&task.voltages));
        let found = found.map_err(|error| match &error {
            EquilibriumError::LimitPoint { loss, .. } => {
                let status = loss.kind.map_or("limit_point", |kind| kind.key());
                (status, error.to_string())
            }
            _ => ("no_equilibrium", error.to_string()),
        })?;
        let ended = self.outcome(found.status(), None, found.is_stable() != Some(false));
        let look = |names: &[String]| Observed {
            instants: vec![0.0],
            places: vec![marks(&model, &found.z, names)],
            reference: marks(&model, &zero, names),
            iterations: found.iterations,
            ..Observed::default()
        };
        Ok((ended, self.markers.map(look)))
    }
}

fn of_optimum(optimum: &Optimum, names: &[String]) -> Observed {
    let Optimum {
        model,
        boundary,
        motion,
        solution,
        infeasibility,
        ..
    } = optimum;
    let n = motion.intervals();
    let h = motion.times[n] / n as f64;
    let mut seen = Observed {
        iterations: solution.iterations.len().saturating_sub(1),
        ..Observed::from_motion(model, &trajectory(model, motion), names)
    };
    seen.numbers.extend([
        (StudyMeasure::Objective, solution.objective),
        (StudyMeasure::Infeasibility, *infeasibility),
    ]);
    let fine = h / FINER as f64;
    let scalars = |from: f64, to: f64| {
        let k = (0.5 * (from + to) / h) as usize;
        model.scalars(&motion.voltages[k.min(n - 1)])
    };
    let (discrete, failure) = simulate(model, &boundary.start, fine, FINER * n, scalars, |_| {
        ControlFlow::Continue(())
    });
    if failure.is_none() {
        let again =
            Observed::from_motion(model, &Trajectory::from_discrete(model, &discrete), names);
        let apart = |k: usize| furthest(&seen.places[k], &again.places[FINER * k]);
        let distances: Vec<f64> = (0..=n).map(apart).collect();
        seen.numbers.extend([
            (StudyMeasure::ResimulatedEnd, distances[n]),
            (StudyMeasure::ResimulatedPath, greatest(&distances)),
        ]);
    }
    seen
}

fn of_motion(simulated: &Simulated, task: &Simulation, names: &[String]) -> Observed {
    let Simulated {
        model, discrete, ..
    } = simulated;
    let mut seen = Observed {
        iterations: discrete.report.iterations,
        // Steps by a tolerance have the length that they need.
        halved: match task.tolerance {
            None => discrete.report.halved,
            Some(_) => 0,
        },
        ..Observed::from_motion(model, &Trajectory::from_discrete(model, discrete), names)
    };
    let observed = observations(model, discrete);
    let violation = column(&observed, "constraint_violation").map(greatest);
    let violation = violation.map(|greatest| (StudyMeasure::ConstraintViolation, greatest));
    seen.numbers.extend(violation);
    if task.voltages.are_constant() {
        seen.numbers.extend(energy(&observed).into_iter().flatten());
    }
    seen
}

/// Greatest size of a value.
fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

fn column<'a>(observed: &'a Observations, name: &str) -> Option<&'a [f64]> {
    let column = observed.columns.iter().find(|c| c.name == name)?;
    Some(&column.values)
}

/// Greatest change of the energy with what was dissipated, and how much its mean over the last quarter of the instants differs
/// from that over the first, both relative to the greatest kinetic energy; none of a system that never moves.
fn energy(observed: &Observations) -> Option<[(StudyMeasure, f64); 2]> {
    let total = column(observed, "total_energy")?;
    let kinetic = column(observed, "kinetic_energy")?;
    let [dissipated, supplied] =
        ["dissipated_energy", "following_load_work"].map(|name| column(observed, name));
    let at = |values: Option<&[f64]>, k: usize| values.map_or(0.0, |values| values[k]);
    let sum = |k: usize| total[k] + at(dissipated, k) - at(supplied, k);
    let changes: Vec<f64> = (0..total.len()).map(|k| sum(k) - sum(0)).collect();
    let scale = greatest(kinetic);
    let quarter = (changes.len() / 4).max(1);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let drift = mean(&changes[changes.len() - quarter..]) - mean(&changes[..quarter]);
    (scale > 0.0).then(|| {
        [
            (StudyMeasure::EnergyBalance, greatest(&changes) / scale),
            (StudyMeasure::EnergyDrift, drift.abs() / scale),
        ]
    })
}

/// The status of a point whose model, start or goal does not exist.
const REFUSED: &str = "refused";

impl Observed {
    /// Instants and places of a motion.
    fn from_motion(model: &Model, motion: &Trajectory, names: &[String]) -> Self {
        let duration = motion.times[motion.intervals()];
        let zero = model.reference_coordinates();
        let list = markers(model, names);
        let of = |row: &Vec<Vector3<f64>>| list.iter().map(|&m| row[m]).collect();
        Self {
            instants: motion.times.iter().map(|t| t / duration).collect(),
            places: motion.marks.iter().map(of).collect(),
            reference: marks(model, &zero, names),
            ..Self::default()
        }
    }
}

/// Indices of the markers with these names.
fn markers(model: &Model, names: &[String]) -> Vec<usize> {
    let all = &model.system.markers;
    let index = |name: &String| all.iter().position(|marker| marker.name == *name);
    names.iter().filter_map(index).collect()
}

/// Places of the markers with these names at coordinates z.
fn marks(model: &Model, z: &[f64], names: &[String]) -> Vec<Vector3<f64>> {
    let instant = model.action.map.placed(z);
    let all: Vec<_> = model.markers.iter().map(|&v| instant.x[v]).collect();
    markers(model, names).into_iter().map(|m| all[m]).collect()
}

/// Greatest distance of a place from its like.
fn furthest(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |m, (a, b)| m.max((a - b).norm()))
}
