//! Several motions from file to folder: each in a folder of its own within that of the results, and what they have in common.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::folder::{make_folder, make_folder_of};
use crate::app::left_out::{EARLIER, STOPPED};
use crate::app::messages::counted;
use crate::app::motions_summary::MotionsSummary;
use crate::app::progress::Reached;
use crate::app::request::{CommandInput, CommandOutput, PageWanted};
use crate::app::side_by_side;
use crate::app::solve::{MIGHT_GO_ON, write_result};
use crate::app::solve_page::describe;
use crate::app::summary::Summary;
use crate::app::{fields, iterates, resume_file, solution_file, unfinished};
use crate::control::Motions;
use crate::files::Loaded;
use crate::math::significant;
use crate::report::file_set::FileSet;
use crate::tasks::{MotionsResult, solve_motions};

/// Solves for several motions and writes their folders, solved or not.
pub(super) fn motions(
    (request, asked): (&CommandInput, &[(String, String)]),
    loaded: &Loaded,
    motions: &Motions,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    let read = began.elapsed().as_secs_f64();
    let results = request.folder();
    let (result, folder) = iterates::solve(
        request,
        read,
        observer,
        |_, models, found| {
            let mut each = motions.list.iter().zip(models).enumerate();
            each.try_for_each(|(number, (motion, model))| {
                let own = results.join(&motion.name);
                make_folder(&own)?;
                solution_file::replace(&own.join(solution_file::UNFINISHED), model, &found(number))
            })
        },
        |asked, observe| solve_motions(motions, asked, observe),
    )?;
    let mut each = Vec::new();
    for (motion, one) in motions.list.iter().zip(&result.list) {
        let own = CommandInput {
            output: Some(folder.join(&motion.name)),
            ..request.clone()
        };
        let folder = make_folder_of(&own)?;
        let shown = (&motion.system, &motion.control, &loaded.output);
        each.push(write_result(
            (&own, asked),
            (shown, None),
            one,
            (&folder, read),
            began,
        )?);
        unfinished::done(&folder);
    }
    let mut summary = MotionsSummary::new(request, motions, &result, &each);
    if let Some(stopped) = each.iter().find(|one| STOPPED.contains(&&*one.status)) {
        // Of the results of a motion not all was written.
        summary.status.clone_from(&stopped.status);
    }
    write(request, &mut summary, &folder, began)?;
    let mut output = command_output(motions, &result, (&summary, &each), &folder);
    output.notes.extend(loaded.note_lines());
    if MIGHT_GO_ON.contains(&&*summary.status) {
        output
            .notes
            .extend(resume_file::command(request, &loaded.task));
    }
    Ok(output)
}

/// Writes what the motions have in common: the page of all side by side, and the summary last.
fn write(
    request: &CommandInput,
    summary: &mut MotionsSummary,
    folder: &Path,
    began: Instant,
) -> Result<(), CommandError> {
    let mut files = FileSet::in_folder(folder);
    EARLIER.iter().for_each(|name| files.remove(name));
    fields::remove_from(0, &mut files);
    let pages = summary.motions.iter().map(|one| folder.join(&one.folder));
    let pages: Vec<PathBuf> = pages.collect();
    let are_written = pages
        .iter()
        .all(|folder| folder.join(side_by_side::PAGE).is_file());
    if request.page == PageWanted::Written && are_written {
        let own = summary.motions.iter();
        let own: Vec<String> = own
            .map(|one| format!("{}/{}", one.folder, side_by_side::PAGE))
            .collect();
        let page = side_by_side::html(&request.command, &pages, &own)?;
        files.add(side_by_side::PAGE, page.as_bytes())?;
    }
    summary.seconds.total = began.elapsed().as_secs_f64();
    files.add("summary.json", summary.text().as_bytes())?;
    Ok(files.finish()?)
}

/// The answer of the command.
fn command_output(
    motions: &Motions,
    result: &MotionsResult,
    (summary, each): (&MotionsSummary, &[Summary]),
    folder: &Path,
) -> CommandOutput {
    let mut is_solved = result.verdict.is_solved && !STOPPED.contains(&&*summary.status);
    let solved = if result.verdict.is_solved {
        "solved"
    } else {
        "not solved"
    };
    let mut word = match summary.status.as_str() {
        "solved" => solved.to_owned(),
        word => format!("{solved} ({})", word.replace('_', " ")),
    };
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    let of_motions = each.iter().zip(&result.list).map(|(summary, one)| {
        let violated = one.optimum.violated.iter().map(describe);
        violated
            .chain(summary.notes.lines())
            .collect::<Vec<String>>()
    });
    let of_motions: Vec<Vec<String>> = of_motions.collect();
    let mut times: BTreeMap<&String, usize> = BTreeMap::new();
    of_motions
        .iter()
        .flatten()
        .for_each(|note| *times.entry(note).or_default() += 1);
    let are_one = |note: &String| times[note] >= each.len();
    notes.extend(of_motions[0].iter().filter(|note| are_one(note)).cloned());
    for (motion, own) in motions.list.iter().zip(&of_motions) {
        let own = own.iter().filter(|note| !are_one(note));
        notes.extend(own.map(|note| format!("motion \"{}\": {note}", motion.name)));
    }
    notes.extend(summary.notes.lines());
    let constants = summary.parameters.iter();
    notes.extend(constants.map(|found| format!("{}: {}", found.name, found.text())));
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    let objective = significant(summary.objective, 8);
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective}, {}, {}, {:.2} s, {}",
            counted(motions.list.len(), "motion"),
            counted(summary.iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}
