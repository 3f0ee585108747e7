//! Entry points for other languages in place of files: the validation of a problem, the check of its derivatives, its nonlinear program for a solver of
//! one's own, and the controller of a receding horizon in SI units.

use crate::app::error::CommandError;
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::app::task::read;
use crate::control::problem::{Ahead, ControlTask, Task};
use crate::feedback::{Measured, Reading};
use crate::files::Entries;
use crate::files::feedback::{factor_of, unit_of};
use crate::model::System;
use crate::nlp::Nlp;
use crate::tasks::{self, CheckResult};
use crate::workflow::program::with_joined;
use crate::workflow::receding::{Horizon, RecedingHorizon, Source};
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Checks the text of a problem as if it stood in the file `input`, which need not exist: paths in it are relative to that file. Returns what it asks
/// for: `control`, `simulate` or `equilibrium`.
///
/// # Errors
/// The problem is wrong.
pub fn check_text(input: &Path, text: &str, set: &[String]) -> Result<&'static str, CommandError> {
    Ok(key(&read(input, Some(text), set)?.task))
}

/// The text of a problem with other entries, such as `control.intervals=80`; it holds the scene of its file where an entry of that is
/// another one.
///
/// # Errors
/// The problem that it then is is wrong.
pub fn changed_text(input: &Path, text: &str, set: &[String]) -> Result<String, CommandError> {
    let loaded = read(input, Some(text), set)?;
    let value = |text: &str| serde_json::from_str::<Value>(text).unwrap_or_default();
    let mut problem = value(&loaded.problem);
    let is_of_scene = |change: &String| change.trim_start().starts_with("scene.");
    let file = problem["scene"].as_str().map(PathBuf::from);
    if let Some(file) = file.filter(|_| set.iter().any(is_of_scene)) {
        let mut scene = value(&loaded.scene);
        let folder = file.parent().unwrap_or(Path::new(""));
        // Paths in a scene are relative to its file.
        for (parts, place) in [("solids", "/mesh"), ("bodies", "/mesh/file")] {
            let parts = scene.get_mut(parts).and_then(Value::as_array_mut);
            let meshes = parts.into_iter().flatten();
            let meshes = meshes.filter_map(|part| part.pointer_mut(place));
            for mesh in meshes.filter(|mesh| mesh.is_string()) {
                let beside = folder.join(mesh.as_str().unwrap_or_default());
                *mesh = beside.display().to_string().into();
            }
        }
        problem["scene"] = scene;
    }
    Ok(problem.to_string())
}

/// Hands the nonlinear program of a control problem to `read`, with the point where the solver would start: in the units inside, g, mm, ms, N
/// and V.
///
/// # Errors
/// The problem is wrong, or asks for something else.
pub fn with_program<R>(
    input: &Path,
    text: &str,
    read_program: impl FnOnce(&mut dyn Nlp, &[f64]) -> R,
) -> Result<R, CommandError> {
    let loaded = read(input, Some(text), &[])?;
    let Some(task) = loaded.task.motions(&loaded.system) else {
        let reason = "only \"control\" is a nonlinear program";
        return Err(CommandError::problem(input, key(&loaded.task), reason));
    };
    joined(input, &task, read_program)
}

/// Hands the program of a task to `read_program`, with the point where the solver would start.
pub(super) fn joined<R>(
    input: &Path,
    task: &ControlTask<'_>,
    read_program: impl FnOnce(&mut dyn Nlp, &[f64]) -> R,
) -> Result<R, CommandError> {
    let once = task.with_limits_once();
    let task = task.with(once.iter().map(|control| &**control));
    with_joined(&task, read_program).map_err(CommandError::in_file(input))
}

/// Compares gradient, Jacobian and Hessian with differences; not solved where an entry is wrong.
///
/// # Errors
/// The input is wrong.
pub fn check(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let found = checked(request, None)?;
    Ok(CommandOutput {
        is_solved: found.agrees,
        result: found.message,
        notes: found.notes,
    })
}

/// Returns the same as numbers. The problem may be given as `text`; the path is then used for messages and relative paths.
///
/// # Errors
/// As of [`check`].
pub fn checked(request: &CommandInput, text: Option<&str>) -> Result<CheckResult, CommandError> {
    let began = Instant::now();
    let loaded = read(&request.input, text, &request.set)?;
    let left = |seconds| seconds - began.elapsed().as_secs_f64();
    tasks::check(&loaded.system, loaded.task, request.max_seconds.map(left))
        .map_err(CommandError::in_file(&request.input))
}

impl Serialize for CheckResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = &self.report;
        let wrong = report.wrong.iter().zip(&self.effects);
        let wrong = wrong.map(|(entry, effects)| {
            Entries::default()
                .with("matrix", format!("{:?}", entry.matrix).to_lowercase())
                .with("row", &entry.row)
                .with("column", &entry.column)
                .with("analytic", entry.analytic)
                .with("difference", entry.difference)
                .with("error", entry.error)
                .with("effects", effects)
        });
        let errors = Entries::default()
            .with("gradient", report.gradient)
            .with("jacobian", report.jacobian)
            .with("hessian", report.hessian);
        let all = Entries::default()
            .with("agrees", self.agrees)
            .with("message", &self.message)
            .with("errors", errors)
            .with("checked", report.checked)
            .with("variables", self.variables)
            .with("unchecked", &report.unchecked)
            .with_each("wrong", wrong);
        all.serialize(serializer)
    }
}

/// A horizon of a problem file, with its system.
#[derive(Debug)]
pub struct FileHorizon {
    horizon: Horizon,
    system: System,
}

impl FileHorizon {
    /// Solves the control problem of a file, of its text where that is given, for a horizon of a number of its intervals. The costs of deviations are
    /// those of its `feedback`.
    ///
    /// # Errors
    /// The problem is wrong, asks for something else, or has no horizon.
    pub fn new(input: &Path, text: Option<&str>, intervals: usize) -> Result<Self, CommandError> {
        let loaded = read(input, text, &[])?;
        let wrong = |place: &str, reason: String| CommandError::problem(input, place, reason);
        let expected = match intervals {
            0 => Some("1 or more".to_owned()),
            _ if intervals > Ahead::MOST_INTERVALS => {
                Some(format!("no more than {} intervals", Ahead::MOST_INTERVALS))
            }
            _ => None,
        };
        if let Some(expected) = expected {
            let reason = format!("found a horizon of {intervals} intervals, expected {expected}");
            return Err(wrong("", reason));
        }
        let Task::Control(control) = loaded.task else {
            let reason = "only \"control\" is planned anew".to_owned();
            return Err(wrong(key(&loaded.task), reason));
        };
        let ahead = Ahead {
            system: loaded.system,
            control: *control,
            regulator: loaded.feedback.unwrap_or_default(),
            intervals,
        };
        let horizon = Horizon::solved(&ahead);
        let horizon =
            horizon.map_err(|error| CommandError::in_file(input)(error.at("control", "")))?;
        Ok(Self {
            horizon,
            system: ahead.system,
        })
    }

    /// Names of all that is measured, the state or the readings of its observer, with their units: rad, m, rad/s, m/s.
    pub fn measured(&self) -> Vec<(String, &'static str)> {
        let all = self.readings().into_iter();
        all.map(|(name, (unit, _))| (name, unit)).collect()
    }

    /// The same with the factors of units from those inside.
    fn readings(&self) -> Vec<(String, (&'static str, f64))> {
        let law = self.horizon.law();
        let of_state = |one: &Measured| match one.is_rate {
            true => (format!("rate of {}", one.name), unit_of(one)),
            false => (one.name.clone(), unit_of(one)),
        };
        let reading = |one: &Reading| match one {
            Reading::State(place) => of_state(&law.measured[*place]),
            Reading::Marker(name, axis) => {
                let factor = factor_of(one, &law.measured);
                (format!("{name}.{}", ["x", "y", "z"][*axis]), ("m", factor))
            }
        };
        match &law.observer {
            Some(observer) => observer.readings.iter().map(reading).collect(),
            None => law.measured.iter().map(of_state).collect(),
        }
    }

    /// Names of the inputs, with their units.
    pub fn inputs(&self) -> Vec<(String, &'static str)> {
        let names = self.horizon.law().inputs.iter().map(|one| one.name.clone());
        names
            .zip(self.units())
            .map(|(name, (unit, _))| (name, unit))
            .collect()
    }

    /// Length of the intervals in s.
    pub fn interval(&self) -> f64 {
        self.horizon.law().h / 1e3
    }

    /// Units of the inputs, with their factors from those inside.
    fn units(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let sources = self.system.sources();
        let inputs = self.horizon.law().inputs.iter();
        inputs.map(move |input| {
            let source = sources.iter().find(|source| source.name == input.name);
            source.map_or(("V", 1.0), |source| {
                let (unit, size) = source.kind.si();
                (unit, 1.0 / size)
            })
        })
    }
}

/// A controller in SI units.
#[derive(Debug)]
pub struct SiController<'h> {
    controller: RecedingHorizon<'h>,
    /// Factors to the units inside of what is measured, and of inputs from them.
    measured: Vec<f64>,
    inputs: Vec<f64>,
    /// Values of both.
    state: Vec<f64>,
    out: Vec<f64>,
}

impl<'h> SiController<'h> {
    /// A controller at the start of the motion.
    pub fn new(of: &'h FileHorizon) -> Self {
        let readings = of.readings().into_iter();
        let measured: Vec<f64> = readings.map(|(_, (_, factor))| 1.0 / factor).collect();
        let inputs: Vec<f64> = of.units().map(|(_, factor)| factor).collect();
        Self {
            controller: RecedingHorizon::new(&of.horizon),
            state: vec![0.0; measured.len()],
            out: vec![0.0; inputs.len()],
            measured,
            inputs,
        }
    }

    /// The inputs that act from a time in s on, or the delay of the feedback later, with what is measured there; `None` where the measurement did
    /// not come in time. A call in the same interval, or at a time that is no finite number, gives the same inputs.
    ///
    /// # Panics
    /// If there are more or fewer numbers than are measured.
    pub fn step(&mut self, time: f64, measured: Option<&[f64]>) -> (Source, &[f64]) {
        if let Some(measured) = measured {
            assert_eq!(measured.len(), self.state.len(), "all that is measured");
            let all = measured.iter().zip(&self.measured);
            let all = self.state.iter_mut().zip(all);
            all.for_each(|(to, (value, factor))| *to = value * factor);
        }
        let state = measured.map(|_| &*self.state);
        let answer = self.controller.step(1e3 * time, state);
        let all = answer.inputs.iter().zip(&self.inputs);
        let all = self.out.iter_mut().zip(all);
        all.for_each(|(to, (value, factor))| *to = value * factor);
        (answer.source, &self.out)
    }

    /// Prepares the next step, when the inputs went out.
    pub fn prepare(&mut self) {
        self.controller.prepare();
    }
}
