//! A control problem solved from several starting points, each in a process of its own.
//!
//! Ipopt with MUMPS takes one solve at a time in a process. Each start is an ordinary `solve` of the same problem with
//! another guess in a folder of its own, `starts/03`, and can be run again alone.

mod ended;
mod files;
mod launch;
mod processes;

use std::fs::{self};
use std::path::Path;
use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::folder::make_folder;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::words::key;
use crate::control::problem::Task;
use crate::files::read_problem;
use crate::workflow::memory;
use crate::workflow::resolve::resolve;
use ended::number_optima;
use files::write;
use launch::FOLDER;
use processes::run_all;

/// Most starting points of one command; the seed of a start is that of the command times this number and its own.
const MOST: usize = 1000;
/// Solves a control problem from its own guess and from `starts − 1` random ones, as many at once as there are cores.
///
/// The files of the best solution go to the folder itself, beside `starts.csv`.
///
/// # Errors
/// The input is wrong, or the results cannot be written. A start that fails is no error as long as one succeeds.
pub fn solve_from_starts(
    request: &CommandInput,
    starts: usize,
    seed: u64,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    if !(1..MOST).contains(&starts) {
        let reason = format!(
            "expected a number of starting points from 1 to {}",
            MOST - 1
        );
        return Err(CommandError::Option {
            option: "--starts",
            reason,
        });
    }
    let loaded = read_problem(&request.input, &request.set)?;
    let Task::Control(control) = &loaded.task else {
        let task = key(&loaded.task);
        return Err(CommandError::Option {
            option: "--starts",
            reason: format!(
                "{} asks to {task}: only \"control\" has starting points",
                request.input.display()
            ),
        });
    };
    memory::of_elements(&loaded.system).map_err(CommandError::of(&request.input))?;
    resolve(&loaded.system, control).map_err(CommandError::of(&request.input))?;
    let folder = request.folder();
    make_folder(&folder)?;
    remove_older(&folder.join(FOLDER));
    make_folder(&folder.join(FOLDER))?;

    let seed_of = |start: usize| seed.wrapping_mul(MOST as u64).wrapping_add(start as u64);
    let plan: Vec<_> = (1..=starts)
        .map(|start| (start, (start > 1).then(|| seed_of(start))))
        .collect();
    let mut ended = run_all(request, &folder, plan, began)?;
    let distinct = number_optima(&mut ended);
    write(request, &folder, &ended, distinct, began)
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
