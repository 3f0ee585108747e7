//! Conversion of the sought constants of inputs: gains of sources, and their delay.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_identify::{InputConstantsSpec, RangeSpec};
use crate::files::units::quantity::PhysicalQuantity;
use crate::model::system::System;
use crate::model::{Constant, Parameter};

/// Name of the delay among the constants.
const DELAY: &str = "delay";

/// Name of a gain among the constants.
fn gain(source: &str) -> String {
    format!("gain of {source}")
}

/// The gains and the delay that are sought.
pub(super) fn input_constants(
    spec: &InputConstantsSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Parameter>, SceneError> {
    let sources: Vec<String> = system.sources().into_iter().map(|one| one.name).collect();
    let mut out = Vec::new();
    for (name, range) in &spec.gains {
        let place = scope.key("gains").key(name);
        let source = place.find(
            name,
            &sources,
            "the name of a muscle, an electrode or a load",
        )?;
        let constant = Constant::Gain(source);
        out.push(parameter((gain(name), constant), range, 1.0, &place)?);
    }
    if let Some(range) = &spec.delay {
        let place = scope.key("delay");
        let delay = (DELAY.to_owned(), Constant::Delay);
        let first = range.min.value();
        if first < 0.0 {
            return Err(place
                .key("min")
                .wrong(range.min.to_string(), "no negative time"));
        }
        out.push(parameter(delay, range, first, &place)?);
    }
    Ok(out)
}

/// A constant between bounds, from its guess on or from a `usual` value.
fn parameter<M: PhysicalQuantity>(
    (name, constant): (String, Constant),
    range: &RangeSpec<M>,
    usual: f64,
    scope: &Scope<'_>,
) -> Result<Parameter, SceneError> {
    let [lower, upper] = [&range.min, &range.max].map(|bound| bound.value());
    if lower >= upper {
        let expected = format!("a value larger than \"min\" {}", range.min);
        return Err(scope.key("max").wrong(range.max.to_string(), expected));
    }
    let guess = range.guess.as_ref().map_or(usual, |guess| guess.value());
    if !(lower..=upper).contains(&guess) {
        let (place, found) = match &range.guess {
            Some(guess) => (scope.key("guess"), guess.to_string()),
            None => (scope.clone(), format!("bounds without {usual}")),
        };
        let expected = format!("a guess from {} to {}", range.min, range.max);
        return Err(place.wrong(found, expected));
    }
    Ok(Parameter {
        name,
        constants: vec![constant.into()],
        lower,
        upper,
        guess,
    })
}
