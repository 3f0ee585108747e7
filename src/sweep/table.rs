//! The table of all variants, and their page.

use crate::app::Ended;
use crate::files::si;
use crate::report::origin::Origin;
use crate::report::page::Variants;
use crate::sweep::read::{Sweep, Variant};
use csv::ReaderBuilder;
use serde_json::{Map, Value};
use std::path::Path;

/// Begins the headings of numbers at the end of a motion, or at rest.
const END: &str = "end: ";

/// Headings and rows of cells; a cell without a value is empty.
pub(super) fn table(sweep: &Sweep, ends: &[&Ended]) -> Vec<Vec<String>> {
    let numbers: Vec<_> = ends.iter().map(|end| numbers(end)).collect();
    let mut names: Vec<&String> = Vec::new();
    for name in numbers.iter().flat_map(Map::keys) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.sort_by_key(|name| name.starts_with(END));
    let fixed = ["variant", "status", "seconds [s]"].map(str::to_owned);
    let columns = (0..sweep.places.len()).map(|place| varied(sweep, place));
    let (places, columns): (Vec<_>, Vec<_>) = columns.unzip();
    let head = fixed.into_iter().chain(places);
    let head = head.chain(names.iter().map(|&name| name.clone())).collect();
    let rows = ends.iter().enumerate().map(|(row, end)| {
        let fixed = [
            sweep.variants[row].identity.clone(),
            end.summary.status.clone(),
            format!("{:?}", end.summary.seconds.total),
        ];
        let values = columns.iter().map(|cells| cells[row].clone());
        let numbers = names.iter().map(|&name| numbers[row].get(name));
        let numbers = numbers.map(|number| number.map_or_else(String::new, cell));
        fixed.into_iter().chain(values).chain(numbers).collect()
    });
    [head].into_iter().chain(rows).collect()
}

/// Numbers of the results of a variant, by the headings of their columns.
fn numbers(end: &Ended) -> Map<String, Value> {
    let objective = end.summary.objective.map(Value::from);
    let iterations = end.summary.iterations.map(Value::from);
    let own = [("objective", objective), ("iterations", iterations)].into_iter();
    let own = own.filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let tables = ["trajectory.csv", "equilibrium.csv"].into_iter();
    let rows = tables.filter_map(|name| last_row(&end.folder.as_ref()?.join(name)));
    own.chain(rows.flatten()).collect()
}

/// The numbers of the last row of a table, by their headings.
fn last_row(table: &Path) -> Option<Vec<(String, Value)>> {
    let reader = ReaderBuilder::new().comment(Some(b'#')).from_path(table);
    let mut reader = reader.ok()?;
    let headers = reader.headers().ok()?.clone();
    let last = reader.records().last()?.ok()?;
    let pairs = headers.iter().zip(&last);
    let numbers = pairs.filter_map(|(name, cell)| {
        let number: f64 = cell.parse().ok()?;
        Some((format!("{END}{name}"), number.into()))
    });
    Some(numbers.collect())
}

/// Heading and cells of the entry that varies at one place.
///
/// Quantities are numbers in the International System, with their unit in the heading, if all of the place have the same, but for variants that are
/// refused; what else varies is written as in the sweep.
fn varied(sweep: &Sweep, place: usize) -> (String, Vec<String>) {
    let name = &sweep.places[place];
    let accepted = sweep.variants.iter().filter(|one| one.refused.is_none());
    let quantities: Option<Vec<_>> = accepted.map(|one| quantity(&one.values[place])).collect();
    let quantities = quantities.unwrap_or_default();
    let mut units = quantities.iter().filter_map(|(_, unit)| unit.as_ref());
    let unit = units.next();
    let unit = unit.filter(|&first| units.all(|unit| unit == first));
    let written = |variant: &Variant| match (unit, quantity(&variant.values[place])) {
        (Some(known), Some((number, unit))) if unit.as_ref().is_none_or(|one| one == known) => {
            format!("{number:?}")
        }
        _ => cell(&variant.values[place]),
    };
    let unit = unit.map_or_else(String::new, |unit| format!(" [{unit}]"));
    let cells = sweep.variants.iter().map(written).collect();
    (format!("{name}{unit}"), cells)
}

/// The number of a quantity in the International System, with its unit; none of a plain number.
fn quantity(value: &Value) -> Option<(f64, Option<String>)> {
    match value {
        Value::Number(number) => Some((number.as_f64()?, None)),
        value => si(value.as_str()?).map(|(number, unit)| (number, Some(unit))),
    }
}

fn cell(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}

/// The page; `table` has a row of headings first.
pub(super) fn html(
    sweep: &Sweep,
    ends: &[&Ended],
    table: &[Vec<String>],
    origin: &Origin,
) -> String {
    let each = sweep.variants.iter().zip(ends);
    let page = |one: &Variant| format!("variants/{}/report.html", one.identity);
    let pages = each.map(|(one, end)| end.is_solved.then(|| page(one)));
    let variants = Variants {
        kind: "Sweep",
        title: &sweep.title,
        of: format!("variants of {}", sweep.problem.display()),
        varied: 3..3 + sweep.places.len(),
        table,
        pages: pages.collect(),
    };
    variants.html(origin)
}
