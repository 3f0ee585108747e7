//! Sizes and labels of the points of a refinement.

use crate::files::study::RefineSpec;
use crate::files::{SceneError, Scope};
use serde_json::Value;

/// Labels of the points of a refinement, and lengths that fall towards zero.
pub(super) fn sizes(
    refine: &RefineSpec,
    scope: &Scope<'_>,
) -> Result<(Vec<String>, Vec<f64>), SceneError> {
    let set = scope.key("set");
    let Some((first, values)) = refine.set.iter().next() else {
        return Err(set.wrong("no override", "1 override or more"));
    };
    if values.is_empty() {
        return Err(set.key(first).wrong("an empty list", "1 value or more"));
    }
    for (key, others) in &refine.set {
        if others.len() != values.len() {
            let found = format!("{} values", others.len());
            let expected = format!("{}, as many as of {first:?}", values.len());
            return Err(set.key(key).wrong(found, expected));
        }
    }
    let (labels, numbers, place) = match (&refine.sizes, refine.set.len()) {
        (Some(sizes), _) => {
            let place = scope.key("sizes");
            if sizes.len() != values.len() {
                let found = format!("{} sizes", sizes.len());
                return Err(place.wrong(found, format!("{}, one per point", values.len())));
            }
            let labels = sizes.iter().map(|&size| label(size)).collect();
            (labels, sizes.clone(), place)
        }
        (None, 1) => {
            let place = set.key(first);
            let read = of_one_unit(values);
            let Some((labels, numbers)) = read else {
                let found = format!("values of {first:?} that are neither numbers nor of one unit");
                let expected = "\"sizes\", which tell how fine each point is";
                return Err(scope.wrong(found, expected));
            };
            (labels, numbers, place)
        }
        (None, _) => {
            let expected = "\"sizes\", which tell how fine each point is";
            return Err(scope.wrong("several overrides that are refined together", expected));
        }
    };
    if let Some(k) = numbers.iter().position(|size| *size <= 0.0) {
        return Err(place
            .index(k)
            .wrong(numbers[k].to_string(), "a positive size"));
    }
    let grows = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    let falls = numbers.windows(2).all(|pair| pair[0] > pair[1]);
    // A length or a tolerance that grows is refined the other way round.
    let are_counts = refine.sizes.is_some()
        || (numbers[0] >= 1.0 && values.iter().all(|value| value.is_number()));
    match (grows, falls) {
        (true, _) if !are_counts && numbers.len() > 1 => Err(place.wrong(
            labels.join(", "),
            "values that fall, the coarsest point first: growing ones are counts, 1 or more without a unit",
        )),
        (true, _) => Ok((labels, numbers.iter().map(|n| n.recip()).collect())),
        (_, true) => Ok((labels, numbers)),
        _ => Err(place.wrong(
            labels.join(", "),
            "sizes that only grow, or only fall: the coarsest point first",
        )),
    }
}

/// A number as it is called: `0.001`, `1e-4`.
pub(super) fn label(number: f64) -> String {
    match number.abs() {
        x if x != 0.0 && !(1e-3..1e6).contains(&x) => format!("{number:e}"),
        _ => number.to_string(),
    }
}

/// Values as they are written, and as numbers, where these are of one unit.
pub(super) fn of_one_unit(values: &[Value]) -> Option<(Vec<String>, Vec<f64>)> {
    let split = |value: &Value| -> Option<(String, f64, String)> {
        let text = match value {
            Value::Number(number) => label(number.as_f64()?),
            Value::String(text) => text.clone(),
            _ => return None,
        };
        let ends = (1..=text.len()).rev().filter(|&k| text.is_char_boundary(k));
        let mut heads = ends.filter_map(|k| Some((k, text[..k].trim().parse::<f64>().ok()?)));
        let (end, number) = heads.next()?;
        let unit = text[end..].trim().to_owned();
        Some((text, number, unit))
    };
    let parts = values.iter().map(split).collect::<Option<Vec<_>>>()?;
    let same = parts.iter().all(|(_, _, unit)| *unit == parts[0].2);
    let pair = |(text, number, _)| (text, number);
    same.then(|| parts.into_iter().map(pair).unzip())
}
