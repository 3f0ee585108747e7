//! A static equilibrium from file to folder.

use std::path::Path;
use std::time::Instant;

use crate::app::blocks::BlockSizes;
use crate::app::equilibrium_model::model_at_rest;
use crate::app::equilibrium_summary::at_rest;
use crate::app::equilibrium_summary::{Rest, describe, lost, rows, status, text};
use crate::app::error::CommandError;
use crate::app::fields;
use crate::app::folder::make_folder;
use crate::app::foreign::refuse_foreign;
use crate::app::moved_markers::moved_markers;
use crate::app::no_equilibrium::refused;
use crate::app::other_task::no_equilibrium;
use crate::app::page;
use crate::app::path;
use crate::app::progress::Progress;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::summary::{MEASURED, Seconds, Summary};
use crate::control::problem::{AtRest, Task};
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{
    DiscreteTrajectory, Equilibrium, EquilibriumError, StabilityLoss, observations, out_of_domain,
    stable_equilibrium,
};
use crate::files::{driven_voltages, read_problem, read_system};
use crate::ipopt::interrupt;
use crate::model::{Model, System};
use crate::report::file_set::FileSet;
use crate::report::skins::Skins;
use crate::report::{Run, write_still};
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
        memory::of_elements(&system).map_err(CommandError::in_file(&request.input))?;
        let voltages = driven_voltages(voltages, &system)?;
        let task = AtRest {
            voltages,
            coordinates: None,
            path: None,
        };
        return at((request, &[]), &system, &task, began);
    }
    let loaded = read_problem(&request.input, &request.set)?;
    memory::of_elements(&loaded.system).map_err(CommandError::in_file(&request.input))?;
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
    phase("building");
    let model = model_at_rest(request, system, task)?;
    let setup = began.elapsed().as_secs_f64();
    phase("equilibrium");
    let (found, loss) = match find(&model, &task.voltages) {
        Ok(found) => found,
        Err(error) => return refused(request, &error, "no equilibrium"),
    };
    drop(watch);
    let still = Still::new(&model, &found, loss);
    let folder = request.folder();
    make_folder(&folder)?;
    let writing = Instant::now();
    let origin = request.origin(false);
    let mut files = FileSet::in_folder(&folder);
    let written = fields::write(&mut files, &model, &still.state, &origin)?;
    let status = loss.map_or("at_rest", status);
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = loss.map(|loss| lost(&still.rest, loss, &folder));
    summary.domain = domain::records(&out_of_domain(&model, &still.state));
    summary.plan = Plan::from_model(&model, None, MEASURED);
    summary.blocks =
        BlockSizes::from_model(&model).map(|b| b.after(&model, &still.observed, written));
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup,
        ..Seconds::default()
    };
    let notes = &mut summary.notes;
    notes.note("moved_marker", moved_markers(system));
    notes.warn("singular_loops", model.loops.warning.clone());
    notes.warn("outside_domain", domain::note(&summary.domain, false));
    let output = command_output(&summary, &model, &still.rest, &folder);
    let rows = rows(&still.rest, status);
    summary.rest = Some(still.rest);
    let title = match loss {
        None => "Static equilibrium",
        Some(_) => "The last equilibrium",
    };
    let mut page = page::content(title, &summary, asked);
    page.rows = rows;
    let skins = Skins::new(&model, &still.state);
    let run = Run {
        name: "rest",
        held: Some(&still.motion.voltages[0]),
        figures: request.figures,
        page: request.page.of(&page),
        ..Run::from_trajectory(
            &model.system,
            &still.motion,
            &skins,
            &still.observed,
            &origin,
        )
    };
    write_still(&mut files, "equilibrium.csv", &run)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    Ok(output)
}

/// The equilibrium under voltages; where growing loads lose it, the last one with the way in which it is lost.
fn find(
    model: &Model,
    voltages: &[f64],
) -> Result<(Equilibrium, Option<StabilityLoss>), EquilibriumError> {
    match stable_equilibrium(
        model,
        &model.reference_coordinates(),
        &model.scalars(voltages),
    ) {
        Ok(found) => Ok((found, None)),
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
            Ok((*last, Some(loss)))
        }
        Err(error) => Err(error),
    }
}

/// An equilibrium as a motion of one instant, with what is observed of it.
struct Still {
    state: DiscreteTrajectory,
    motion: Trajectory,
    observed: Observations,
    rest: Rest,
}

impl Still {
    fn new(model: &Model, found: &Equilibrium, loss: Option<StabilityLoss>) -> Self {
        let state = DiscreteTrajectory {
            times: vec![0.0],
            z: vec![found.z.clone()],
            momenta: vec![vec![0.0; model.coordinate_count()]],
            scalars: vec![found.scalars.clone()],
            ..DiscreteTrajectory::default()
        };
        let motion = Trajectory::from_discrete(model, &state);
        let observed = at_rest(observations(model, &state));
        let mut rest = describe(model, &state, &motion, &observed, found, loss);
        rest.largest_nominal_field = fields::largest_nominal_field(model, &state, 0);
        Self {
            state,
            motion,
            observed,
            rest,
        }
    }
}

/// The answer of the command; an equilibrium that was lost has a message.
fn command_output(summary: &Summary, model: &Model, rest: &Rest, folder: &Path) -> CommandOutput {
    let message = summary.message.iter().cloned();
    let is_solved = summary.message.is_none();
    CommandOutput {
        is_solved,
        result: match is_solved {
            true => format!("{}, {}", text(model, rest), folder.display()),
            false => "no equilibrium".to_owned(),
        },
        notes: message.chain(summary.notes.lines()).collect(),
    }
}
