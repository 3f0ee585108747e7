//! Variants of one problem, solved in parallel, each in a folder of its own; variants that are solved already are not solved again.
//!
//! - `read`: the sweep file and its variants; `table`: all of them with their ends, and their page.

mod read;
mod table;

use crate::app::{
    Batch, CommandError, CommandInput, CommandOutput, Ended, RunIn, check_run_in, found,
    make_folder, run_all,
};
use crate::report::atomic;
use crate::report::table::cells_csv;
use crate::stop;
use crate::sweep::read::{Sweep, Variant, read_sweep};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::str::FromStr;
use std::time::Instant;

/// Most notes of one kind.
const NOTES: usize = 10;

/// Solves the variants of a sweep in a shard that are not solved yet, and writes the table of all.
///
/// # Errors
/// The sweep or the problems of all variants are wrong, or the results cannot be written.
pub fn sweep(
    request: &CommandInput,
    shard: Shard,
    run_in: RunIn,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let sweep = read_sweep(&request.input)?;
    check_run_in(run_in)?;
    let folder = request.folder();
    make_folder(&folder)?;

    // By identity, so that equal variants are solved once.
    let mut ends: BTreeMap<&str, Ended> = BTreeMap::new();
    let mut todo: Vec<&Variant> = Vec::new();
    let (mut found_before, mut deviations) = (0, Vec::new());
    for (index, variant) in sweep.variants.iter().enumerate() {
        let identity = variant.identity.as_str();
        if ends.contains_key(identity) {
            continue;
        }
        let of_variant = variant.folder(&folder);
        let kept = found(&of_variant, identity).unwrap_or_else(|words| {
            deviations.push(format!(
                "variant {identity} does not count as solved: {words}"
            ));
            None
        });
        let kept = kept.and_then(|output| Ended::of_folder(&of_variant, output.is_solved));
        let end = match (&variant.refused, kept) {
            (Some(message), _) => Ended::without_results("refused", message, 0.0),
            (None, Some(end)) => {
                found_before += 1;
                end
            }
            (None, None) => {
                todo.extend(shard.has(index).then_some(variant));
                Ended::without_results("not_started", "", 0.0)
            }
        };
        ends.insert(identity, end);
    }
    let run_in = run_in.of_tasks(sweep.run_at_once);
    solve(request, &sweep, &todo, run_in, began, &mut ends)?;

    let identities = sweep.variants.iter().map(|one| one.identity.as_str());
    let ends: Vec<&Ended> = identities.map(|identity| &ends[identity]).collect();
    write(request, &sweep, &ends, &folder)?;
    let mut notes = first(deviations);
    notes.extend(messages(&sweep, &ends));
    if stop::requested() {
        notes.push("interrupted; the same command goes on".to_owned());
    }
    let own = ends.iter().enumerate();
    let mut own = own.filter(|(index, _)| shard.has(*index));
    let is_complete = own.all(|(_, end)| !end.summary.is_unfinished());
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for end in &ends {
        *counts.entry(&end.summary.status).or_default() += 1;
    }
    let counts = counts.iter().map(|(word, count)| format!("{count} {word}"));
    let before = (found_before > 0).then(|| format!("{found_before} found solved before"));
    let counts: Vec<String> = counts.chain(before).collect();
    Ok(CommandOutput {
        is_solved: ends.iter().any(|end| end.is_solved) && is_complete,
        result: format!(
            "{} variants: {}, {:.1} s, {}",
            ends.len(),
            counts.join(", "),
            began.elapsed().as_secs_f64(),
            folder.display()
        ),
        notes,
    })
}

/// Solves variants, each as a run that is made once.
fn solve<'a>(
    request: &CommandInput,
    sweep: &'a Sweep,
    todo: &[&'a Variant],
    run_in: RunIn,
    began: Instant,
    ends: &mut BTreeMap<&'a str, Ended>,
) -> Result<(), CommandError> {
    let results = request.folder();
    let run = |variant: &&Variant| CommandInput {
        input: sweep.problem.clone(),
        set: variant.set.clone(),
        output: Some(variant.folder(&results)),
        progress: request.progress,
        once: true,
        ..CommandInput::default()
    };
    let runs: Vec<CommandInput> = todo.iter().map(run).collect();
    let batch = Batch {
        runs: &runs,
        text: None,
        run_in,
        folder: &results,
        max_seconds: request.max_seconds,
        began,
    };
    run_all(&batch, "variant", request.progress, &mut |index, ended| {
        ends.insert(todo[index].identity.as_str(), ended);
        Ok(None)
    })
}

/// Writes table and page.
fn write(
    request: &CommandInput,
    sweep: &Sweep,
    ends: &[&Ended],
    folder: &Path,
) -> Result<(), CommandError> {
    let origin = request.origin(true);
    let table = table::table(sweep, ends);
    let csv = cells_csv(&table, &origin);
    atomic::write(&folder.join("sweep.csv"), csv.as_bytes())?;
    let page = table::html(sweep, ends, &table, &origin);
    Ok(atomic::write(&folder.join("report.html"), page.as_bytes())?)
}

/// The messages of variants, each of them once.
fn messages(sweep: &Sweep, ends: &[&Ended]) -> Vec<String> {
    let mut known = BTreeSet::new();
    let each = sweep.variants.iter().zip(ends);
    let each = each.filter_map(|(variant, end)| Some((variant, end.message.as_ref()?)));
    let new = each.filter(|(_, message)| known.insert(*message));
    let told = new.map(|(variant, message)| format!("{}: {message}", variant.set.join(", ")));
    first(told.collect())
}

/// The first notes of one kind, and the number of further ones.
fn first(mut notes: Vec<String>) -> Vec<String> {
    if notes.len() > NOTES {
        let more = notes.len() - NOTES;
        notes.truncate(NOTES);
        notes.push(format!("and {more} more like this"));
    }
    notes
}

/// Each n-th variant, from the i-th one: what one of n machines does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// All variants.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Returns true if the variant with an index belongs to it.
    pub(crate) fn has(self, index: usize) -> bool {
        index % self.of == self.number - 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let parsed = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parsed {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("expected i/n with 1 <= i <= n, such as 2/8".to_owned()),
        }
    }
}
