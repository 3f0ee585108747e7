//! Variants of one problem, solved in parallel, each in a folder of its own; variants that are solved already are not solved again.
//!
//! - `read`: the sweep file and its variants.
//! - `variant_end`: end of a variant; `table`: all of them together, and their page.

mod read;
mod table;
mod variant_end;

use crate::app::{
    Batch, CommandError, CommandInput, CommandOutput, Ended, Found, RunIn, check_run_in, found,
    make_folder, run_all,
};
use crate::report::atomic;
use crate::report::table::cells_csv;
use crate::stop;
use crate::sweep::read::{Sweep, Variant, read_sweep};
use crate::sweep::variant_end::VariantEnd;
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
    let mut ends: BTreeMap<&str, VariantEnd> = BTreeMap::new();
    let mut todo: Vec<&Variant> = Vec::new();
    let mut before = Before::default();
    for (index, variant) in sweep.variants.iter().enumerate() {
        let identity = variant.identity.as_str();
        if ends.contains_key(identity) {
            continue;
        }
        let kept = match &variant.refused {
            Some(message) => Some(VariantEnd::without_results("refused", message)),
            None => before.of(variant, &variant.folder(&folder)),
        };
        if kept.is_none() && shard.has(index) {
            todo.push(variant);
        }
        // What is to be solved has not started yet.
        let end = kept.unwrap_or_else(|| VariantEnd::without_results("not_started", ""));
        ends.insert(identity, end);
    }
    let run_in = run_in.of_tasks(sweep.run_at_once);
    solve(request, &sweep, &todo, run_in, began, &mut ends)?;

    let identities = sweep.variants.iter().map(|one| one.identity.as_str());
    let ends: Vec<&VariantEnd> = identities.map(|identity| &ends[identity]).collect();
    write(request, &sweep, &ends, &folder)?;
    Ok(command_output(shard, &sweep, &ends, before, &folder, began))
}

/// Results that the folders of the variants held before.
#[derive(Default)]
struct Before {
    /// Variants that were whole.
    found: usize,
    /// Words on those that were not.
    deviations: Vec<String>,
}

impl Before {
    /// The end of a variant, where its folder holds all of it.
    fn of(&mut self, variant: &Variant, folder: &Path) -> Option<VariantEnd> {
        let name = &variant.identity;
        match found(folder, name) {
            Found::Whole(record) => {
                self.found += 1;
                Ended::of_folder(folder, record.is_solved).map(VariantEnd::new)
            }
            Found::Deviates(words) => {
                self.deviations
                    .push(format!("variant {name} does not count as solved: {words}"));
                None
            }
            Found::Nothing => None,
        }
    }
}

/// Solves variants, each as a run that is made once.
fn solve<'a>(
    request: &CommandInput,
    sweep: &'a Sweep,
    todo: &[&'a Variant],
    run_in: RunIn,
    began: Instant,
    ends: &mut BTreeMap<&'a str, VariantEnd>,
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
        ends.insert(todo[index].identity.as_str(), VariantEnd::new(ended));
        Ok(None)
    })
}

/// Writes table and page.
fn write(
    request: &CommandInput,
    sweep: &Sweep,
    ends: &[&VariantEnd],
    folder: &Path,
) -> Result<(), CommandError> {
    let origin = request.origin(true);
    let table = table::table(sweep, ends);
    let csv = cells_csv(&table, &origin);
    atomic::write(&folder.join("sweep.csv"), csv.as_bytes())?;
    let page = table::html(sweep, ends, &table, &origin);
    Ok(atomic::write(&folder.join("report.html"), page.as_bytes())?)
}

/// Returns the numbers of variants by their ends.
fn command_output(
    shard: Shard,
    sweep: &Sweep,
    ends: &[&VariantEnd],
    before: Before,
    folder: &Path,
    began: Instant,
) -> CommandOutput {
    let solved = ends.iter().filter(|end| end.ended.is_solved).count();
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for end in ends {
        *words.entry(&end.ended.summary.status).or_default() += 1;
    }
    let words = words.iter().map(|(word, count)| format!("{count} {word}"));
    let words: Vec<String> = words.collect();
    let mut messages = BTreeSet::new();
    let mut first_messages = Vec::new();
    for (variant, end) in sweep.variants.iter().zip(ends) {
        let message = end.ended.message.as_ref();
        if let Some(message) = message.filter(|message| messages.insert(message.as_str())) {
            first_messages.push(format!("{}: {message}", variant.set.join(", ")));
        }
    }
    let mut notes = first(before.deviations);
    notes.extend(first(first_messages));
    let own = ends.iter().enumerate();
    let mut own = own.filter(|(index, _)| shard.has(*index));
    let is_complete = own.all(|(_, end)| !end.ended.summary.is_unfinished());
    if stop::requested() {
        notes.push("interrupted; the same command goes on".to_owned());
    }
    let before = match before.found {
        0 => String::new(),
        found => format!(", {found} found solved before"),
    };
    CommandOutput {
        is_solved: solved > 0 && is_complete,
        result: format!(
            "{} variants: {}{before}, {:.1} s, {}",
            ends.len(),
            words.join(", "),
            began.elapsed().as_secs_f64(),
            folder.display()
        ),
        notes,
    }
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
