//! Runs the task of a problem file: control, simulation, equilibrium or identification.

use std::path::Path;
use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::kept::record::{folder_within, refuse_foreign};
use crate::app::kept::resume_file;
use crate::app::progress::{Progress, Reached};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::summary::{keep_unanswered, refuse_all_but_motions};
use crate::app::{equilibrium, identification, simulation, solve};
use crate::control::problem::{BoundaryState, Guess, Task};
use crate::control::{Earlier, Motions};
use crate::files::solution::SolutionFile;
use crate::files::{Loaded, read_problem, read_problem_text};
use crate::workflow::accuracy::AccuracyTarget;
use crate::workflow::memory::{self, Occasion};
use crate::workflow::remark::phase;

/// Runs the task of a problem: optimal control, simulation, equilibrium or identification.
///
/// # Errors
/// The input is wrong, and nothing was written; or the results cannot be written.
pub fn run(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    run_observed(request, None, &mut |_| {})
}

/// Simulates what a problem asks to simulate.
///
/// # Errors
/// As of [`run`]; or it asks for something else, and nothing was written.
pub fn simulate(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    run_checked(request, None, &mut |_| {}, refuse_all_but_motions)
}

/// Like [`run`], with the problem given as `text`; the path is then used for messages and relative paths. `observer` receives every iteration of a
/// solve and every step of a simulation. To stop it, use a [request](crate::stop::StopRequest).
///
/// # Errors
/// As of [`run`].
pub fn run_observed(
    request: &CommandInput,
    text: Option<&str>,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    run_checked(request, text, observer, |_, _| Ok(()))
}

fn run_checked(
    request: &CommandInput,
    text: Option<&str>,
    observer: &mut dyn FnMut(Reached<'_>),
    check: fn(&CommandInput, &Task) -> Result<(), CommandError>,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let _progress = Progress::of_solve(request.progress);
    phase("reading");
    let mut loaded = read(&request.input, text, &request.set)?;
    check(request, &loaded.task)?;
    refuse_unused(request, &loaded.task)?;
    refuse_replacing(request, &loaded)?;
    for (name, control) in loaded.task.controls_mut() {
        if let Some(folder) = &request.from {
            let file = SolutionFile(resume_file::solution(&folder_within(folder, name))?);
            control.guess = Guess::Solution(Earlier::new(file));
        }
    }
    let answer = match &loaded.task {
        Task::Control(_) | Task::Motions(_) => solve::control(request, &loaded, began, observer),
        Task::Simulate(simulation) => {
            simulation::simulation(request, &loaded, simulation, began, observer)
        }
        Task::Equilibrium(task) => {
            equilibrium::at(request, Some(&loaded), &loaded.system, task, began)
        }
        Task::Identify(task) => identification::run(request, &loaded, task, began),
    };
    keep_unanswered(request, answer)
}

/// Reads a problem and checks that the machine has room for it.
pub(super) fn read(
    input: &Path,
    text: Option<&str>,
    set: &[String],
) -> Result<Loaded, CommandError> {
    let loaded = match text {
        Some(text) => read_problem_text(input, text, set),
        None => read_problem(input, set),
    }?;
    memory::of_elements(&loaded.system, occasion(&loaded.task))
        .map_err(CommandError::in_file(input))?;
    Ok(loaded)
}

/// The occasion at which a task solves for elements.
fn occasion(task: &Task) -> Occasion {
    match task {
        Task::Equilibrium(_) => Occasion::Rest,
        Task::Simulate(simulation) => Occasion::of_steps(simulation.solving),
        Task::Control(_) | Task::Motions(_) | Task::Identify(_) => Occasion::Factors,
    }
}

/// Refuses results in the place of those of another problem, or of the one from whose end the motion starts.
pub(super) fn refuse_replacing(
    request: &CommandInput,
    loaded: &Loaded,
) -> Result<(), CommandError> {
    refuse_foreign(request)?;
    let own = request.folder();
    if let Task::Simulate(task) = &loaded.task {
        return refuse_end(request, "simulate", &task.start, &own);
    }
    let task = loaded.task.motions(&loaded.system);
    let mut each = task.iter().flat_map(|task| &task.motions);
    each.try_for_each(|motion| {
        let place = match motion.name {
            "" => "control".to_owned(),
            name => format!("control.{}.{name}", motion.control.list()),
        };
        let own = folder_within(&own, motion.name);
        refuse_end(request, &place, &motion.control.start, &own)
    })
}

/// Refuses results in the `own` folder where that is the one from whose end the motion starts.
fn refuse_end(
    request: &CommandInput,
    place: &str,
    start: &BoundaryState,
    own: &Path,
) -> Result<(), CommandError> {
    let BoundaryState::EndOf(end) = start else {
        return Ok(());
    };
    let folders = [own, &end.source].map(|folder| folder.canonicalize().ok());
    match folders {
        [Some(to), Some(from)] if to == from => Err(CommandError::problem(
            &request.input,
            format!("{place}.start.end_of"),
            format!(
                "the results would replace {}, where the motion starts; expected another folder for them, by -o",
                end.source.display()
            ),
        )),
        _ => Ok(()),
    }
}

/// Refuses options that the task has no use for.
fn refuse_unused(request: &CommandInput, task: &Task) -> Result<(), CommandError> {
    let Some((option, asks)) = unused(request, task) else {
        return Ok(());
    };
    let file = request.input.display();
    Err(CommandError::option(
        option,
        format!("{file} asks for {asks}"),
    ))
}

/// An option that the task has no use for, and why.
fn unused(request: &CommandInput, task: &Task) -> Option<(&'static str, &'static str)> {
    let wanted = request.wanted.map(|wanted| match wanted {
        AccuracyTarget::Below(_) => "--accuracy",
        AccuracyTarget::Estimate => "--estimate-error",
    });
    let [of_wanted, of_from, of_iterations] = match task {
        Task::Control(_) => return None,
        Task::Motions(motions) if some_are_refined(motions) => {
            let asks = "several motions, and names \"intervals\" of some; expected them, or \"auto\", of all";
            return wanted.map(|option| (option, asks));
        }
        Task::Motions(motions) => {
            let asks = "several motions on \"auto\" grids, which are refined until their errors are confirmed";
            let is_unused = motions.list[0].control.is_refined
                && request.wanted == Some(AccuracyTarget::Estimate);
            return wanted.filter(|_| is_unused).map(|option| (option, asks));
        }
        Task::Equilibrium(_) => [
            "an equilibrium, which has no steps in time to refine",
            "an equilibrium, which goes on from nothing",
            "an equilibrium, for which no solver of programs iterates",
        ],
        Task::Identify(_) => [
            "an identification, whose steps are halved until their bias is small",
            "an identification, which goes on from nothing",
            "an identification, for which no solver of programs iterates",
        ],
        Task::Simulate(_) => [
            "",
            "a simulation, whose steps --accuracy and --estimate-error halve from the start",
            "a simulation, for which no solver of programs iterates",
        ],
    };
    let is_simulation = matches!(task, Task::Simulate(_));
    let figures = request.figures;
    match wanted {
        Some(option) if !is_simulation => Some((option, of_wanted)),
        _ if request.from.is_some() && (!is_simulation || wanted.is_some()) => {
            Some(("--from", of_from))
        }
        _ if request.max_iterations.is_some() => Some(("--max-iterations", of_iterations)),
        _ if matches!(task, Task::Identify(_)) && (figures.gltf || figures.parts) => {
            let asks = "an identification, whose motions are those of its recordings";
            Some(("--export", asks))
        }
        _ => None,
    }
}

/// Returns true if the grids of some motions are chosen, and those of others given.
fn some_are_refined(motions: &Motions) -> bool {
    let mut each = motions.list.iter().map(|one| one.control.is_refined);
    let first = each.next();
    each.any(|other| Some(other) != first)
}
