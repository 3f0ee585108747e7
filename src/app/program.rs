//! A problem in memory: its validation, and its nonlinear program for a solver of one's own.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::app::error::CommandError;
use crate::app::messages::key;
use crate::app::task::read;
use crate::control::problem::{ControlTask, MotionTask, Task};
use crate::nlp::Nlp;
use crate::workflow::program::{
    Counted, PreparedTogether, prepare_together, program_motions, resolve_each,
};

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
    let task = match &loaded.task {
        Task::Control(control) => MotionTask::alone(&loaded.system, control).into(),
        Task::Motions(motions) => motions.task(),
        Task::Simulate(_) | Task::Equilibrium(_) | Task::Identify(_) => {
            return Err(CommandError::Problem {
                file: input.to_owned(),
                place: key(&loaded.task).to_owned(),
                reason: "only \"control\" is a nonlinear program".to_owned(),
            });
        }
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
    let resolved = resolve_each(&task).map_err(CommandError::in_file(input))?;
    let motions = program_motions(&task, &resolved);
    let PreparedTogether {
        mut program, point, ..
    } = prepare_together(&motions, &task, Counted::Yes).map_err(CommandError::in_file(input))?;
    Ok(read_program(&mut program, &point.x))
}
