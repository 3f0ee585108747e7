//! The disturbance of a closed loop in parts: the same simulation with values between those of no disturbance and those that the problem has.

use crate::control::problem::{Disturbed, Task};
use crate::files::changes::{Changes, word};
use crate::files::json::document::Document;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::json::set::{Override, value_at};
use crate::files::problem::build::ProblemSpec;
use crate::files::problem::feedback::DisturbanceSpec;
use crate::model::System;
use serde_json::Value;

/// Most sizes.
const MOST: usize = 20;

/// The simulations of a problem whose controller names a disturbance, one for each of its sizes. `texts` are those of the problem and of its scene;
/// `read` reads a document with overrides of its scene.
pub(crate) fn disturbed(
    document: &Document,
    of_scene: &[Override],
    texts: [&str; 2],
    read: impl Fn(Document, &[Override]) -> Result<(System, Task)>,
) -> Result<Vec<Disturbed>> {
    let Some(spec) = written(document)? else {
        return Ok(Vec::new());
    };
    let scope = Scope::of(document).key("simulate").key("controller");
    let scope = scope.key("disturbance");
    let sizes = sizes(&spec, &scope)?;
    let place = scope.key("without");
    refuse!(if spec.without.is_empty(), place;
        found "nothing", expected "values without the disturbance, by their places");
    let mut ends = Vec::new();
    for (key, without) in &spec.without {
        ends.push((key, without, with(key, texts, &place.key(key))?));
    }
    let mut out = Vec::new();
    for size in sizes {
        let mut changes = Changes::default();
        for (key, without, with) in &ends {
            let place = place.key(key);
            let Some(value) = between(without, with, size) else {
                let expected = format!("a value like that of the problem, {}", word(with));
                return Err(place.wrong(word(without), expected));
            };
            changes.push(key, &value, place)?;
        }
        let own = changes.overrides()?;
        let (in_scene, in_problem): (Vec<_>, Vec<_>) =
            own.into_iter().partition(|one| one.in_scene().is_some());
        let none = JsonPath::parse("simulate.controller.disturbance").expect("a path");
        let mut part = document.clone();
        Override::new(none, Value::Null).apply(&mut part)?;
        let all = [of_scene, &in_scene].concat();
        let applied = in_problem.iter().try_for_each(|one| one.apply(&mut part));
        let found = applied.and_then(|()| read(part, &all));
        let found = found.map_err(|error| changes.at_fault(error, &document.path))?;
        let (system, Task::Simulate(task)) = found else {
            unreachable!("an entry \"simulate\" is that task");
        };
        out.push(Disturbed { size, system, task });
    }
    Ok(out)
}

/// The disturbance that a problem names, if it does.
fn written(document: &Document) -> Result<Option<DisturbanceSpec>> {
    if document.entry("simulate").is_none() {
        return Ok(None);
    }
    let simulate = document.parse::<ProblemSpec>()?.simulate;
    Ok(simulate.and_then(|one| one.controller?.disturbance))
}

fn sizes(spec: &DisturbanceSpec, scope: &Scope<'_>) -> Result<Vec<f64>> {
    let place = scope.key("sizes");
    let Some(sizes) = &spec.sizes else {
        return Ok(vec![0.0, 0.25, 0.5, 1.0]);
    };
    refuse!(if !(2..=MOST).contains(&sizes.len()), place;
        found sizes.len(), expected format!("2 to {MOST} sizes"));
    for (i, size) in sizes.iter().enumerate() {
        let before = i.checked_sub(1).map_or(f64::NEG_INFINITY, |i| sizes[i]);
        refuse!(if !(size.is_finite() && *size >= 0.0 && *size > before), place.index(i);
            found size,
            expected "sizes from 0 on, the smallest first, of which 1 is that of the problem");
    }
    Ok(sizes.clone())
}

/// The value that a problem has in a place.
fn with(key: &str, texts: [&str; 2], place: &Scope<'_>) -> Result<Value> {
    let wrong = || {
        let expected = "a place in the problem or its scene that has a value, such as scene.materials.silicone.shear_modulus";
        place.wrong(format!("the key {key:?}"), expected)
    };
    let path = JsonPath::parse(key).ok_or_else(wrong)?;
    let [problem, scene] = texts;
    let found = match path.0.as_slice() {
        [Step::Key(first), rest @ ..] if first == "scene" => {
            value_at(scene, &JsonPath(rest.to_vec()))
        }
        _ => value_at(problem, &path),
    };
    found.ok_or_else(wrong)
}

/// A value a part of the way from one to another: numbers, numbers with the same unit, lists of them; a number 0 has any unit.
fn between(from: &Value, to: &Value, part: f64) -> Option<Value> {
    if let (Value::Array(a), Value::Array(b)) = (from, to) {
        let each = a.iter().zip(b).map(|(a, b)| between(a, b, part));
        return (a.len() == b.len())
            .then(|| each.collect::<Option<Vec<Value>>>())?
            .map(Value::Array);
    }
    let (a, of_a) = quantity(from)?;
    let (b, of_b) = quantity(to)?;
    let unit = match (of_a, of_b) {
        (Some(a), Some(b)) if a != b => return None,
        (None, Some(_)) if a != 0.0 => return None,
        (Some(_), None) if b != 0.0 => return None,
        (a, b) => a.or(b),
    };
    let value = a + part * (b - a);
    // The ends as they are written.
    let value = if part == 1.0 { b } else { value };
    match unit {
        Some(unit) => Some(format!("{value} {unit}").into()),
        None => serde_json::Number::from_f64(value).map(Value::Number),
    }
}

/// A number and its unit.
fn quantity(value: &Value) -> Option<(f64, Option<&str>)> {
    match value {
        Value::Number(number) => Some((number.as_f64()?, None)),
        Value::String(text) => {
            let (number, unit) = text.trim().split_once(' ')?;
            Some((number.parse().ok()?, Some(unit.trim())))
        }
        _ => None,
    }
}
