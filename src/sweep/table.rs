//! The table of all variants.

use serde_json::Value;

use crate::sweep::kept::{END, Kept};
use crate::sweep::read::Sweep;

/// Headings and rows of cells; a cell of what does not exist is empty.
pub(super) fn table(sweep: &Sweep, ends: &[Kept]) -> Vec<Vec<String>> {
    let mut names: Vec<&String> = Vec::new();
    for name in ends.iter().flat_map(|end| end.numbers.keys()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.sort_by_key(|name| name.starts_with(END));
    let fixed = ["variant", "status", "seconds [s]"].map(str::to_owned);
    let places = sweep.places.iter().cloned();
    let head = fixed.into_iter().chain(places);
    let head = head.chain(names.iter().map(|&name| name.clone())).collect();
    let rows = sweep.variants.iter().zip(ends).map(|(variant, end)| {
        let fixed = [
            end.identity.clone(),
            end.status.clone(),
            format!("{:?}", end.seconds),
        ];
        let values = variant.values.iter().map(cell);
        let numbers = names.iter().map(|&name| end.numbers.get(name));
        let numbers = numbers.map(|number| number.map_or_else(String::new, cell));
        fixed.into_iter().chain(values).chain(numbers).collect()
    });
    [head].into_iter().chain(rows).collect()
}

fn cell(value: &Value) -> String {
    value
        .as_str()
        .map_or_else(|| value.to_string(), str::to_owned)
}
