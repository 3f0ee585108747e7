//! A static equilibrium from file to folder.

use std::path::Path;
use std::time::Instant;

use crate::app::equilibrium_summary::{Rest, at_rest, status};
use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::{make_folder_of, refuse_foreign};
use crate::app::no_equilibrium::{no_equilibrium, refused};
use crate::app::progress::Progress;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::summary::{MEASURED, Seconds, Summary};
use crate::app::{blocks, fields, path};
use crate::control::problem::{AtRest, Task};
use crate::dynamics::{UNSTABLE, observations};
use crate::files::{Loaded, driven_voltages, read_problem, read_system};
use crate::model::{Response, System};
use crate::report::file_set::FileSet;
use crate::report::skins::Skins;
use crate::report::{Run, write_still};
use crate::stop;
use crate::tasks::{self, EquilibriumResult, EquilibriumTaskError};
use crate::workflow::effects::Plan;
use crate::workflow::remark::phase;

/// The equilibrium that a problem asks for; under voltages such as `muscle2=1.7kV` that of a scene, or of the scene of any
/// problem.
///
/// # Errors
/// The file or a voltage is wrong, or the problem asks for something else and no voltages are given.
pub fn equilibrium_of_file(
    request: &CommandInput,
    voltages: Option<&[String]>,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let _progress = Progress::of_solve(request.progress);
    phase("reading");
    refuse_foreign(request)?;
    if let Some(voltages) = voltages {
        // The file of an equilibrium says how branches respond; of others the scene alone is read.
        let (system, response) = match read_problem(&request.input, &request.set) {
            Ok(Loaded {
                system,
                task: Task::Equilibrium(task),
                ..
            }) => (system, task.response),
            _ => (
                read_system(&request.input, &request.set)?,
                Response::Relaxed,
            ),
        };
        let voltages = driven_voltages(voltages, &system)?;
        let task = AtRest {
            voltages,
            coordinates: None,
            response,
            path: None,
        };
        return at(request, None, &system, &task, began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    match &loaded.task {
        Task::Equilibrium(task) => at(request, Some(&loaded), &loaded.system, task, began),
        other => Err(no_equilibrium(request, other)),
    }
}

/// Finds the equilibrium under voltages, or follows the path there, and writes the folder; where it is lost on the way there,
/// the last one is kept.
pub(super) fn at(
    request: &CommandInput,
    loaded: Option<&Loaded>,
    system: &System,
    task: &AtRest,
    began: Instant,
) -> Result<CommandOutput, CommandError> {
    let read = began.elapsed().as_secs_f64();
    let watch = stop::watch(request.max_seconds.map(|seconds| seconds - read));
    if let Some(points) = task.path {
        return path::follow(request, loaded, system, task, points, began);
    }
    let result = match tasks::equilibrium(system, task) {
        Ok(result) => result,
        Err(EquilibriumTaskError::NotFound(error)) => {
            return refused(request, &error, "no equilibrium");
        }
        Err(EquilibriumTaskError::Workflow(error)) => {
            return Err(CommandError::in_file(&request.input)(error));
        }
    };
    drop(watch);
    let EquilibriumResult {
        model,
        loss,
        discrete,
        ..
    } = &result;
    let observed = at_rest(observations(model, discrete));
    let rest = Rest::new(&result, &observed);
    let folder = make_folder_of(request)?;
    let writing = Instant::now();
    let origin = request.origin(false);
    let mut files = FileSet::in_folder(&folder);
    let written = fields::write(&mut files, model, discrete, &origin)?;
    let status = loss.map_or(result.found.status(), status);
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = match loss {
        Some(loss) => Some(rest.lost_words(*loss, &folder)),
        None => (status == UNSTABLE).then(|| rest.verdict()),
    };
    summary.domain.clone_from(&result.outside);
    summary.notes.clone_from(&result.remarks);
    summary.plan = Plan::from_model(model, None, MEASURED);
    summary.blocks = blocks::entries(model, &observed, written);
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup: read + result.setup,
        ..Seconds::default()
    };
    let output = command_output(&summary, &rest, &folder);
    summary.task = rest.entries();
    let title = match loss {
        None if status == UNSTABLE => "An unstable equilibrium",
        None => "Static equilibrium",
        Some(_) => "The last equilibrium",
    };
    let mut page = summary.page(title, loaded);
    page.rows = rest.rows(status);
    let skins = Skins::new(model, discrete);
    let run = Run {
        name: "rest",
        held: Some(&result.trajectory.voltages[0]),
        figures: request.figures,
        page: request.page.of(&page),
        ..Run::from_trajectory(
            &model.system,
            &result.trajectory,
            &skins,
            &observed,
            &origin,
        )
    };
    write_still(&mut files, "equilibrium.csv", &run)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    Ok(output)
}

/// The answer of the command; an equilibrium that is unstable or was lost has a message.
fn command_output(summary: &Summary, rest: &Rest<'_>, folder: &Path) -> CommandOutput {
    let message = summary.message.iter().cloned();
    let is_solved = summary.message.is_none();
    CommandOutput {
        is_solved,
        result: match summary.status == UNSTABLE {
            _ if is_solved => format!("{}, {}", rest.text(), folder.display()),
            true => format!("unstable equilibrium, {}", folder.display()),
            false => "no equilibrium".to_owned(),
        },
        notes: message.chain(summary.notes.lines()).collect(),
    }
}
