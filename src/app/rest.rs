//! A static equilibrium from file to folder.

use std::time::Instant;

use crate::app::blocks::BlockSizes;
use crate::app::error::CommandError;
use crate::app::fields;
use crate::app::folder::make_folder;
use crate::app::foreign::refuse_foreign;
use crate::app::moved_markers::moved_markers;
use crate::app::other_task::no_equilibrium;
use crate::app::page;
use crate::app::path;
use crate::app::progress::Progress;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::rest_observed::at_rest;
use crate::app::rest_refused::refused;
use crate::app::rest_words::{describe, lost, rows, status, text};
use crate::app::summary::{MEASURED, Seconds, Summary};
use crate::control::problem::{AtRest, Task};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, EquilibriumError, StabilityLoss, observations, out_of_domain,
    stable_equilibrium,
};
use crate::files::{driven_voltages, read_problem, read_system};
use crate::ipopt::interrupt;
use crate::model::{Model, System};
use crate::report::file_set::FileSet;
use crate::report::skins::Skins;
use crate::report::{Run, write_still};
use crate::workflow::WorkflowError;
use crate::workflow::domain;
use crate::workflow::effects::Plan;
use crate::workflow::memory;
use crate::workflow::phase::phase;

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
    let _progress = Progress::of_phases(request.progress);
    phase("reading");
    refuse_foreign(request)?;
    if let Some(voltages) = voltages {
        let system = read_system(&request.input, &request.set)?;
        memory::of_elements(&system).map_err(CommandError::of(&request.input))?;
        let voltages = driven_voltages(voltages, &system)?;
        let task = AtRest {
            voltages,
            coordinates: None,
            path: None,
        };
        return at((request, &[]), &system, &task, began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    memory::of_elements(&loaded.system).map_err(CommandError::of(&request.input))?;
    match &loaded.task {
        Task::Equilibrium(task) => at(
            (request, &page::asked(&loaded)),
            &loaded.system,
            task,
            began,
        ),
        other => Err(no_equilibrium(request, other)),
    }
}

/// Finds the equilibrium under voltages, or follows the path there, and writes the folder; where it is lost on the way there,
/// the last one is kept.
pub(super) fn at(
    (request, asked): (&CommandInput, &[(String, String)]),
    system: &System,
    task: &AtRest,
    began: Instant,
) -> Result<CommandOutput, CommandError> {
    let left = |seconds| seconds - began.elapsed().as_secs_f64();
    let watch = interrupt::watch(request.max_seconds.map(left));
    if let Some(points) = task.path {
        return path::follow((request, asked), system, task, points, began);
    }
    let wrong =
        |error| CommandError::of(&request.input)(WorkflowError::boundary("equilibrium", &error));
    phase("building");
    let model = Model::answering(system.clone(), task.question(system))
        .map_err(|error| wrong(error.into()))?;
    let setup = began.elapsed().as_secs_f64();
    phase("equilibrium");
    let zero = model.coordinates_at(&vec![0.0; model.gauges.len()]);
    let (found, failure) = match stable_equilibrium(&model, &zero, &model.scalars(&task.voltages)) {
        Ok(found) => (found, None),
        Err(EquilibriumError::LimitPoint {
            fraction,
            kind,
            load,
            last,
        }) => {
            let loss = StabilityLoss {
                load,
                fraction,
                kind,
            };
            (*last, Some(loss))
        }
        Err(error) => return refused(request, &error, "no equilibrium"),
    };
    drop(watch);
    let state = DiscreteTrajectory {
        times: vec![0.0],
        z: vec![found.z.clone()],
        momenta: vec![vec![0.0; model.coordinate_count()]],
        scalars: vec![found.scalars.clone()],
        ..DiscreteTrajectory::default()
    };
    let motion = Trajectory::from_history(&model, &state);
    let observed = at_rest(observations(&model, &state));
    let mut rest = describe(&model, &state, &motion, &observed, &found, failure);
    rest.largest_nominal_field = fields::largest_nominal_field(&model, &state, 0);
    let folder = request.folder();
    make_folder(&folder)?;
    let origin = request.origin(false);
    let writing = Instant::now();
    let mut files = FileSet::of(&folder);
    let written = fields::write(&mut files, &model, &state, &origin)?;
    let status = failure.map_or("at_rest", status);
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = failure.map(|loss| lost(&rest, loss, &folder));
    summary.domain = domain::told(&out_of_domain(&model, &state));
    summary.plan = Plan::of(&model, None, MEASURED);
    summary.blocks = BlockSizes::of(&model).map(|b| b.after(&model, &observed, written));
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup,
        ..Seconds::default()
    };
    summary.notes.note("moved_marker", moved_markers(system));
    summary
        .notes
        .warn("outside_domain", domain::note(&summary.domain, false));
    let message = summary.message.iter().cloned();
    let notes = message.chain(summary.notes.lines()).collect();
    let told = match &failure {
        None => CommandOutput {
            is_solved: true,
            result: format!("{}, {}", text(&model, &rest), folder.display()),
            notes,
        },
        Some(_) => CommandOutput {
            is_solved: false,
            result: "no equilibrium".to_owned(),
            notes,
        },
    };
    let rows = rows(&rest, status);
    summary.rest = Some(rest);
    let title = match failure {
        None => "Static equilibrium",
        Some(_) => "The last equilibrium",
    };
    let mut said = page::told(title, &summary, asked);
    said.rows = rows;
    let skins = Skins::new(&model, &state);
    let run = Run {
        name: "rest",
        held: Some(&motion.voltages[0]),
        figures: request.figures,
        told: request.page.of(&said),
        ..Run::of(&model.system, &motion, &skins, &observed, &origin)
    };
    write_still(&mut files, "equilibrium.csv", &run)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    Ok(told)
}
