//! A control problem solved from several starting points, in threads or in processes.
//!
//! Each start is an ordinary `solve` of the same problem with another guess in a folder of its own, `starts/03`, and can be run again
//! alone. Ipopt with MUMPS takes one solve at a time in a process, so that each start has a process of its own then.

mod ended;
mod files;
mod rank;

use std::fs;
use std::path::Path;
use std::time::Instant;

use crate::app::batch::{Batch, RunIn, run_all, task_runs_at_once};
use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::{make_folder, make_folder_of};
use crate::app::no_equilibrium;
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::app::task::{read, refuse_replacing};
use crate::control::problem::MotionTask;
use crate::files::{Loaded, is_standard_input};
use crate::workflow::program::resolve_each;
use ended::{FOLDER, Start, StartEnd, best, number_optima};
use files::write;

/// Most starting points of one command; the seed of a start is that of the command times this number and its own.
const MOST: usize = 1000;

/// Solves a control problem, of one motion or several, from its own guesses and from `starts − 1` random ones, as many at once as there are cores.
///
/// The files of the best solution go to the folder itself, next to `starts.csv`. A `text` stands for that of the problem file, which then only names
/// it and the folder that paths are relative to; it is not solved in processes, which read the file.
///
/// # Errors
/// The input is wrong, or the results cannot be written. A start that fails is no error as long as one succeeds.
pub fn solve_from_starts(
    request: &CommandInput,
    text: Option<&str>,
    starts: usize,
    seed: u64,
    wanted: RunIn,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    check_number(starts)?;
    let loaded = read(&request.input, text, &request.set)?;
    let places = check_problem(request, &loaded)?;
    let run_in = wanted.of_tasks(task_runs_at_once(&loaded));
    if run_in == RunIn::Processes && is_standard_input(&request.input) {
        return Err(wrong_option(
            "each process reads the problem anew, which standard input does not allow: give a file"
                .to_owned(),
        ));
    }
    let folder = make_folder_of(request)?;
    remove_older(&folder.join(FOLDER));
    make_folder(&folder.join(FOLDER))?;
    let plan = plan(starts, seed);
    let runs: Vec<CommandInput> = plan
        .iter()
        .map(|start| start.run(request, &folder, &places))
        .collect();
    let batch = Batch {
        runs: &runs,
        text,
        run_in,
        folder: &folder,
        max_seconds: request.max_seconds,
        began,
    };
    let mut ended: Vec<StartEnd> = Vec::new();
    run_all(&batch, "start", request.progress, &mut |index, one| {
        ended.push(StartEnd::new(plan[index], one, &folder)?);
        Ok(best(&ended).and_then(|i| ended[i].objective()))
    })?;
    ended.sort_by_key(|one| one.start.number);
    let distinct = number_optima(&mut ended);
    write(request, &batch, &ended, distinct)
}

fn wrong_option(reason: String) -> CommandError {
    CommandError::option("--starts", reason)
}

fn check_number(starts: usize) -> Result<(), CommandError> {
    match (1..MOST).contains(&starts) {
        true => Ok(()),
        false => Err(wrong_option(format!(
            "expected a number of starting points from 1 to {}",
            MOST - 1
        ))),
    }
}

/// Checks that a problem has starting points, and that its starts and goals exist; returns the places of its guesses.
fn check_problem(request: &CommandInput, loaded: &Loaded) -> Result<Vec<String>, CommandError> {
    refuse_replacing(request, loaded)?;
    let Some(task) = loaded.task.motions(&loaded.system) else {
        return Err(wrong_option(format!(
            "{} asks to {}: only \"control\" has starting points",
            request.input.display(),
            key(&loaded.task)
        )));
    };
    let ends = resolve_each(&task).map_err(CommandError::in_file(&request.input));
    no_equilibrium::kept(request, ends)?;
    let place = |(number, motion): (usize, &MotionTask<'_>)| match motion.is_alone() {
        true => "control.guess".to_owned(),
        false => format!("control.motions[{number}].guess"),
    };
    Ok(task.motions.iter().enumerate().map(place).collect())
}

/// The starts: the guess of the problem, then random ones.
fn plan(starts: usize, seed: u64) -> Vec<Start> {
    let seed_of = |start: usize| seed.wrapping_mul(MOST as u64).wrapping_add(start as u64);
    (1..=starts)
        .map(|number| Start {
            number,
            seed: (number > 1).then(|| seed_of(number)),
        })
        .collect()
}

/// Starts of an earlier command.
fn remove_older(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name
            .to_string_lossy()
            .bytes()
            .all(|byte| byte.is_ascii_digit())
        {
            fs::remove_dir_all(entry.path()).ok();
        }
    }
}
