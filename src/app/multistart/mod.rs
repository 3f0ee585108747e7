//! A control problem solved from several starting points, in threads or in processes.
//!
//! Each start is an ordinary `solve` of the same problem with another guess in a folder of its own, `starts/03`, and can be run again
//! alone. Ipopt with MUMPS takes one solve at a time in a process, so that each start has a process of its own then.

mod batch;
mod ended;
mod files;
mod launch;
mod processes;
mod threads;

use std::fs::{self};
use std::path::Path;
use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::folder::make_folder;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::words::key;
use crate::control::problem::Task;
use crate::files::{is_standard_input, read_problem};
use crate::ipopt::Options;
use crate::workflow::memory;
use crate::workflow::resolve::resolve;
use batch::Batch;
pub use batch::StartsIn;
use ended::number_optima;
use files::write;
use launch::{FOLDER, Start};

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
    wanted: StartsIn,
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
    let options = Options {
        linear_solver: control.solver.linear_solver,
        extra: control.solver.ipopt.clone(),
        ..Options::default()
    };
    let run_in = match options.run_at_once() {
        true => wanted,
        false => StartsIn::Processes,
    };
    if run_in == StartsIn::Processes && is_standard_input(&request.input) {
        return Err(CommandError::Option {
            option: "--starts",
            reason: "each process reads the problem anew, which standard input does not allow: give a file".to_owned(),
        });
    }
    let folder = request.folder();
    make_folder(&folder)?;
    remove_older(&folder.join(FOLDER));
    make_folder(&folder.join(FOLDER))?;

    let seed_of = |start: usize| seed.wrapping_mul(MOST as u64).wrapping_add(start as u64);
    let plan: Vec<Start> = (1..=starts)
        .map(|number| Start {
            number,
            seed: (number > 1).then(|| seed_of(number)),
        })
        .collect();
    let batch = Batch {
        request,
        run_in,
        folder: &folder,
        plan: &plan,
        began,
    };
    let mut ended = match batch.run_in {
        StartsIn::Threads => threads::run_all(&batch)?,
        StartsIn::Processes => processes::run_all(&batch)?,
    };
    ended.sort_by_key(|one| one.start);
    let distinct = number_optima(&mut ended);
    write(&batch, &ended, distinct)
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
