//! Conversion of the sought constants of a problem file to parameters.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

use crate::control::PEAK_VOLTAGE;
use crate::files::json::document::Document;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_free::{FreeMap, FreeSpec};
use crate::files::scene::constants::{NoConstant, SceneConstant, constant};
use crate::files::scene::spec::SceneSpec;
use crate::files::units::quantity::{Kind, Quantity, SoughtConstant};
use crate::model::system::System;
use crate::model::{Follower, NotSought, Parameter, check_parameters};

/// The parameters of a problem.
pub(crate) fn parameters(
    map: &FreeMap,
    written: &SceneSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Parameter>, SceneError> {
    let parameter = |(path, spec): (&String, &FreeSpec)| {
        parameter(path, spec, (written, system), &scope.key(path))
    };
    let parameters: Vec<Parameter> = map.iter().map(parameter).collect::<Result<_, _>>()?;
    check_parameters(system, &parameters).map_err(|NotSought { parameter, reason }| {
        let place = scope.key(&parameters[parameter].name);
        place.wrong(reason, "a constant that can be sought")
    })?;
    Ok(parameters)
}

fn parameter(
    path: &str,
    spec: &FreeSpec,
    (written, system): (&SceneSpec, &System),
    scope: &Scope<'_>,
) -> Result<Parameter, SceneError> {
    let find = |path: &str, scope: &Scope<'_>| {
        constant(path, written, system)
            .map_err(|NoConstant { found, expected }| scope.wrong(found, expected))
    };
    let SceneConstant {
        mut followers,
        kind,
        value,
    } = find(path, scope)?;
    for (path, &factor) in &spec.also {
        let scope = scope.key("also").key(path);
        let other = find(path, &scope)?;
        if other.kind.name != kind.name {
            let expected = format!("{}, as the constant that it follows", kind.name);
            return Err(scope.wrong(other.kind.name, expected));
        }
        followers.extend(other.followers.into_iter().map(|follower| Follower {
            factor: factor * follower.factor,
            ..follower
        }));
    }
    let read =
        |quantity: &Quantity<SoughtConstant>, key: &str| read(quantity, &kind, &scope.key(key));
    let (lower, upper) = (read(&spec.min, "min")?, read(&spec.max, "max")?);
    if lower >= upper {
        let expected = format!("a value larger than \"min\" {}", spec.min);
        return Err(scope.key("max").wrong(spec.max.to_string(), expected));
    }
    let guess = match &spec.guess {
        Some(guess) => read(guess, "guess")?,
        None => value,
    };
    if guess < lower || guess > upper {
        let (place, found) = match &spec.guess {
            Some(guess) => (scope.key("guess"), guess.to_string()),
            None => (
                scope.clone(),
                "a value in the scene outside the bounds".to_owned(),
            ),
        };
        let expected = format!("a guess from {} to {}", spec.min, spec.max);
        return Err(place.wrong(found, expected));
    }
    Ok(Parameter {
        name: path.to_owned(),
        constants: followers,
        lower,
        upper,
        guess,
    })
}

fn read(
    quantity: &Quantity<SoughtConstant>,
    kind: &Kind,
    scope: &Scope<'_>,
) -> Result<f64, SceneError> {
    quantity
        .value_as(kind)
        .map_err(|found| scope.wrong(found, kind.expected()))
}

/// Entries that are read of a solution: values that were found, in SI units, by paths in the scene.
#[derive(Debug, Deserialize)]
struct FoundRecord {
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
}

/// Two values that differ by less, relative to their size, are the same.
const SAME: f64 = 1e-9;

/// Refuses the voltages of a solution that was found with other constants than the scene has.
pub(crate) fn check_solution(
    path: &Path,
    written: &SceneSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    let document = &Document::read(path)?;
    let FoundRecord { parameters } = document.parse()?;
    // The peak is a result, and no constant of a scene.
    let constants = parameters.iter().filter(|(name, _)| *name != PEAK_VOLTAGE);
    for (name, &found) in constants {
        let scene = constant(name, written, system).map_err(|NoConstant { found, expected }| {
            scope.wrong(format!("{name:?}: {found}"), expected)
        })?;
        let unit = scene.followers[0].constant.unit(system);
        let value = scene.value * unit.factor;
        if (value - found).abs() > SAME * found.abs() {
            let symbol = unit.symbol;
            let other = format!(
                "a solution with {name} = {found} {symbol}, where the scene has {value} {symbol}"
            );
            return Err(scope.wrong(other, "the value of the solution in the scene"));
        }
    }
    Ok(())
}
