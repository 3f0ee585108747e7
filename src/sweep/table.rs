//! The table of all variants, and `report.html`: scatter plot of two columns, parallel coordinates of the varied values and results, and all rows.

use crate::files::si;
use crate::report::origin::Origin;
use crate::report::page::framed;
use crate::sweep::read::{Sweep, Variant};
use crate::sweep::variant_end::{END, VariantEnd};
use serde_json::{Value, json};

/// Headings and rows of cells; a cell without a value is empty.
pub(super) fn table(sweep: &Sweep, ends: &[&VariantEnd]) -> Vec<Vec<String>> {
    let mut names: Vec<&String> = Vec::new();
    for name in ends.iter().flat_map(|end| end.numbers.keys()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.sort_by_key(|name| name.starts_with(END));
    let fixed = ["variant", "status", "seconds [s]"].map(str::to_owned);
    let columns: Vec<Varied> = (0..sweep.places.len())
        .map(|place| Varied::of(sweep, place))
        .collect();
    let places = columns.iter().map(|column| column.heading.clone());
    let head = fixed.into_iter().chain(places);
    let head = head.chain(names.iter().map(|&name| name.clone())).collect();
    let rows = ends.iter().enumerate().map(|(row, end)| {
        let fixed = [
            sweep.variants[row].identity.clone(),
            end.ended.summary.status.clone(),
            format!("{:?}", end.ended.summary.seconds.total),
        ];
        let values = columns.iter().map(|column| column.cells[row].clone());
        let numbers = names.iter().map(|&name| end.numbers.get(name));
        let numbers = numbers.map(|number| number.map_or_else(String::new, cell));
        fixed.into_iter().chain(values).chain(numbers).collect()
    });
    [head].into_iter().chain(rows).collect()
}

/// Entry that varies at one place.
struct Varied {
    heading: String,
    cells: Vec<String>,
}

impl Varied {
    /// Quantities are numbers in the International System, with their unit in the heading, if all of the place have the same, but for variants that
    /// are refused; what else varies is written as in the sweep.
    fn of(sweep: &Sweep, place: usize) -> Self {
        let name = &sweep.places[place];
        let accepted = sweep.variants.iter().filter(|one| one.refused.is_none());
        let quantities: Option<Vec<_>> = accepted.map(|one| quantity(&one.values[place])).collect();
        let quantities = quantities.unwrap_or_default();
        let mut units = quantities.iter().filter_map(|(_, unit)| unit.as_ref());
        let unit = units
            .next()
            .filter(|&first| units.all(|unit| unit == first));
        let written = |variant: &Variant| match (unit, quantity(&variant.values[place])) {
            (Some(known), Some((number, unit))) if unit.as_ref().is_none_or(|one| one == known) => {
                format!("{number:?}")
            }
            _ => cell(&variant.values[place]),
        };
        Self {
            heading: match unit {
                Some(unit) => format!("{name} [{unit}]"),
                None => name.clone(),
            },
            cells: sweep.variants.iter().map(written).collect(),
        }
    }
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

/// The page around everything, as that of a run.
const FRAME: &str = include_str!("page.html");
/// Script that draws it.
const MODULE: &str = include_str!("page.js");

/// The page; `table` has a row of headings first.
pub(super) fn html(
    sweep: &Sweep,
    ends: &[&VariantEnd],
    table: &[Vec<String>],
    origin: &Origin,
) -> String {
    let solved: Vec<bool> = ends.iter().map(|end| end.ended.is_solved).collect();
    let count = solved.iter().filter(|&&is_solved| is_solved).count();
    let problem = sweep.problem.display();
    let data = json!({
        "title": sweep.title,
        "words": format!("{count} of {} variants of {problem} have an answer.", ends.len()),
        "places": sweep.places.len(),
        "table": table,
        "solved": solved,
    });
    framed(FRAME, &sweep.title, origin, &data, &[MODULE])
}
