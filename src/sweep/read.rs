//! A sweep file, and the variants that it asks for.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::app::{CommandInput, identity, identity_of_words, task_runs_at_once};
use crate::files::changes::Changes;
use crate::files::sweep::{CombineSpec, RangeSpec, SpacingSpec, SweepSpec, VarySpec};
use crate::files::{
    Columns, Document, SceneError, Scope, each_entry_once, each_once, number_and_unit, read_problem,
};
use crate::math::{Random, refuse};

/// Most variants of a sweep, and values of a range.
const MOST: usize = 100_000;

/// A sweep and its variants, read and checked.
#[derive(Debug)]
pub(super) struct Sweep {
    pub(super) title: String,
    /// The problem file.
    pub(super) problem: PathBuf,
    /// Entries that vary, by their places in the problem.
    pub(super) places: Vec<String>,
    pub(super) variants: Vec<Variant>,
    /// True if several variants may be solved in parallel in one process.
    pub(super) run_at_once: bool,
}

/// A variant of the problem.
#[derive(Debug)]
pub(super) struct Variant {
    /// Values at the places that vary.
    pub(super) values: Vec<Value>,
    /// All overrides, as they are typed after `--set`.
    pub(super) set: Vec<String>,
    /// Of the problem that it asks for; of the overrides where that is refused.
    pub(super) identity: String,
    /// Reason why its problem is refused.
    pub(super) refused: Option<String>,
}

impl Variant {
    /// Its folder within that of the results.
    pub(super) fn folder(&self, results: &Path) -> PathBuf {
        results.join("variants").join(&self.identity)
    }
}

fn is_refused(variant: &Variant) -> bool {
    variant.refused.is_some()
}

/// Reads a sweep and the problems of all its variants.
///
/// # Errors
/// The sweep is wrong, or the problem of every variant is.
pub(super) fn read_sweep(path: &Path) -> Result<Sweep, SceneError> {
    let document = Document::read(path)?;
    let spec: SweepSpec = document.parse()?;
    let scope = Scope::of(&document);
    let problem = scope
        .key("problem")
        .file(&spec.problem, "the path of a problem file")?;
    let (places, rows) = match &spec.table {
        None => varied(&spec, &scope.key("vary"))?,
        Some(table) => of_table(&spec, table, &scope)?,
    };
    let place_of = |place: &str| match &spec.table {
        None => scope.key("vary").key(place),
        Some(_) => scope.key("table"),
    };
    let mut fixed = Changes::default();
    fixed.extend(&spec.set, &scope.key("set"))?;
    let mut first_error = None;
    let mut run_at_once = true;
    let mut variants = Vec::with_capacity(rows.len());
    let changes_of = |values: &[Value]| -> Result<Changes<'_>, SceneError> {
        let mut changes = fixed.clone();
        for (place, value) in places.iter().zip(values) {
            changes.push(place, value, place_of(place))?;
        }
        Ok(changes)
    };
    // All variants set the same places.
    if let Some(values) = rows.first() {
        let changes = changes_of(values)?;
        each_once(&changes.words).map_err(|error| changes.at_fault(error, &problem))?;
    }
    for values in rows {
        let changes = changes_of(&values)?;
        let (identity, refused) = match read_problem(&problem, &changes.words) {
            Ok(loaded) => {
                // The same, with names of entries by their indices.
                if variants.iter().all(is_refused) {
                    let found = each_entry_once(&changes.words, &loaded);
                    found.map_err(|error| changes.at_fault(error, &problem))?;
                }
                run_at_once &= task_runs_at_once(&loaded);
                (identity(&loaded, &CommandInput::default()), None)
            }
            Err(error) => {
                let told = error.to_string();
                first_error.get_or_insert_with(|| changes.at_fault(error, &problem));
                (identity_of_words(&changes.words), Some(told))
            }
        };
        variants.push(Variant {
            values,
            set: changes.words,
            identity,
            refused,
        });
    }
    match first_error {
        Some(error) if variants.iter().all(is_refused) => Err(error),
        _ => Ok(Sweep {
            title: spec.title.unwrap_or_else(|| name(path)),
            problem,
            places,
            variants,
            run_at_once,
        }),
    }
}

/// Places and values of the entries under `vary`.
fn varied(
    spec: &SweepSpec,
    scope: &Scope<'_>,
) -> Result<(Vec<String>, Vec<Vec<Value>>), SceneError> {
    refuse!(if spec.vary.is_empty(), scope;
        found "nothing that varies",
        expected "places with values, or a \"table\" beside \"problem\"");
    let values = |_: &str, written: &VarySpec, at: &Scope<'_>| Values::from_spec(written, at);
    let values: Vec<Values> = scope.each_named(&spec.vary, values)?;
    let lists = || -> Result<Vec<Vec<Value>>, SceneError> {
        let each = spec.vary.keys().zip(&values);
        scope.each_named(each, |_, values, at| values.all(at))
    };
    let limited = |count: Option<usize>| match count {
        Some(count) if (1..=MOST).contains(&count) => Ok(()),
        _ => {
            let found = count.map_or("more variants than can be counted".to_owned(), |n| {
                format!("{n} variants")
            });
            Err(scope.wrong(found, format!("1 to {MOST} variants")))
        }
    };
    let rows = match spec.combine {
        CombineSpec::Grid => {
            let lists = lists()?;
            let count = lists
                .iter()
                .try_fold(1_usize, |n, list| n.checked_mul(list.len()));
            limited(count)?;
            grid(&lists)
        }
        CombineSpec::Together => {
            let lists = lists()?;
            let first = lists[0].len();
            for (place, list) in spec.vary.keys().zip(&lists) {
                refuse!(if list.len() != first, scope.key(place);
                    found format!("{} values", list.len()),
                    expected format!("{first}, as in the first list"));
            }
            limited(Some(first))?;
            let row = |i: usize| lists.iter().map(|list| list[i].clone()).collect();
            (0..first).map(row).collect()
        }
        CombineSpec::Random(asked) => {
            limited(Some(asked.count))?;
            let mut random = Random::new(asked.seed);
            let mut row = || values.iter().map(|one| one.draw(&mut random)).collect();
            (0..asked.count).map(|_| row()).collect()
        }
    };
    Ok((spec.vary.keys().cloned().collect(), rows))
}

/// Each value of each list with each of all others; the last list runs fastest.
fn grid(lists: &[Vec<Value>]) -> Vec<Vec<Value>> {
    lists.iter().fold(vec![Vec::new()], |rows, list| {
        let extended = rows.iter().flat_map(|row| {
            list.iter()
                .map(|value| row.iter().chain([value]).cloned().collect())
        });
        extended.collect()
    })
}

/// Places and values of a CSV file.
fn of_table(
    spec: &SweepSpec,
    table: &str,
    scope: &Scope<'_>,
) -> Result<(Vec<String>, Vec<Vec<Value>>), SceneError> {
    refuse!(if !spec.vary.is_empty(), scope.key("vary");
        found "places with values", expected "either \"vary\" or \"table\"");
    let scope = scope.key("table");
    let columns = Columns::read(table, &scope)?;
    let (headers, rows) = columns.written();
    refuse!(if rows.is_empty() || rows.len() > MOST, scope;
        found format!("{} lines below the headers", rows.len()),
        expected format!("1 to {MOST} variants"));
    let value = |cell: &str| serde_json::from_str(cell).unwrap_or_else(|_| cell.into());
    let row = |record: &csv::StringRecord| record.iter().map(value).collect();
    Ok((
        headers.iter().map(str::to_owned).collect(),
        rows.iter().map(row).collect(),
    ))
}

fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// The values that an entry takes.
enum Values {
    List(Vec<Value>),
    Range(Range),
}

/// A range of quantities of one unit.
struct Range {
    ends: [f64; 2],
    /// None of plain numbers.
    unit: Option<String>,
    spacing: SpacingSpec,
    count: Option<usize>,
}

impl Values {
    /// Reads the values of an entry.
    fn from_spec(written: &VarySpec, scope: &Scope<'_>) -> Result<Self, SceneError> {
        match written {
            VarySpec::Values(values) if values.is_empty() => {
                Err(scope.wrong("an empty list", "1 value or more"))
            }
            VarySpec::Values(values) => Ok(Self::List(values.clone())),
            VarySpec::Range(range) => Range::from_spec(range, scope).map(Self::Range),
        }
    }

    /// All of them, in their order.
    fn all(&self, scope: &Scope<'_>) -> Result<Vec<Value>, SceneError> {
        match self {
            Self::List(values) => Ok(values.clone()),
            Self::Range(range) => {
                let Some(count) = range.count else {
                    let expected = "\"count\", unless values are drawn at random";
                    return Err(scope.wrong("no key \"count\"", expected));
                };
                let at = |i: usize| range.at(i as f64 / (count - 1) as f64);
                Ok((0..count).map(at).collect())
            }
        }
    }

    /// One of them at random.
    fn draw(&self, random: &mut Random) -> Value {
        let part = random.between(0.0, 1.0);
        match self {
            Self::List(values) => {
                let index = (part * values.len() as f64) as usize;
                values[index.min(values.len() - 1)].clone()
            }
            Self::Range(range) => range.at(part),
        }
    }
}

impl Range {
    fn from_spec(written: &RangeSpec, scope: &Scope<'_>) -> Result<Self, SceneError> {
        let expected = "a number, or a text such as \"50 kPa\"";
        let wrong = |name, value: &Value| scope.key(name).wrong(value.to_string(), expected);
        let (from, to) = (&written.from, &written.to);
        let (from, unit) = number_and_unit(from).ok_or_else(|| wrong("from", from))?;
        let (to, other) = number_and_unit(to).ok_or_else(|| wrong("to", to))?;
        refuse!(if unit != other, scope.key("to");
            found written.to, expected "the unit of \"from\"");
        let is_logarithmic = written.spacing == SpacingSpec::Logarithmic;
        refuse!(if is_logarithmic && !(from > 0.0 && to > 0.0), scope;
            found format!("{from} to {to}"),
            expected "values above zero for logarithmic spacing");
        let wrong = written.count.filter(|count| !(2..=MOST).contains(count));
        refuse!(if let Some(count) = wrong, scope.key("count");
            found count, expected format!("a number of values from 2 to {MOST}"));
        Ok(Self {
            ends: [from, to],
            unit: unit.map(str::to_owned),
            spacing: written.spacing,
            count: written.count,
        })
    }

    /// The value at a part of the way.
    fn at(&self, part: f64) -> Value {
        let [from, to] = self.ends;
        let number = match self.spacing {
            _ if part == 0.0 => from,
            _ if part == 1.0 => to,
            SpacingSpec::Linear => from + part * (to - from),
            SpacingSpec::Logarithmic => from * (to / from).powf(part),
        };
        match &self.unit {
            Some(unit) => json!(format!("{number} {unit}")),
            None => json!(number),
        }
    }
}
