//! Conversion of the sought constants of inputs: gains of sources, and their delay.

use crate::control::problem::Prior;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::spec_identify::{InputConstantsSpec, RangeSpec};
use crate::files::units::quantity::{PhysicalQuantity, Time};
use crate::model::system::System;
use crate::model::{Constant, Follower, Parameter};

/// Name of the delay of all inputs among the constants.
const DELAY: &str = "delay";

/// Words for what a source is.
const SOURCE: &str = "the name of a muscle, an electrode or a load";

/// Name of a gain among the constants.
fn gain(source: &str) -> String {
    format!("gain of {source}")
}

/// The gains and the delay that are sought, behind `first` other constants, and what is known of them beside the recordings.
pub(super) fn input_constants(
    spec: &InputConstantsSpec,
    (system, first): (&System, usize),
    scope: &Scope<'_>,
) -> Result<(Vec<Parameter>, Vec<Prior>), SceneError> {
    let sources: Vec<String> = system.sources().into_iter().map(|one| one.name).collect();
    let (mut out, mut priors) = (Vec::new(), Vec::new());
    for (name, range) in &spec.gains {
        let place = scope.key("gains").key(name);
        let source = place.find(name, &sources, SOURCE)?;
        let constant = vec![Constant::Gain(source).into()];
        priors.extend(prior(range, first + out.len(), &place)?);
        out.push(parameter((gain(name), constant), range, 1.0, &place)?);
    }
    let mut delays: Vec<(String, &RangeSpec<Time>, Vec<usize>, Scope<'_>)> = Vec::new();
    for (name, range) in &spec.delays {
        let place = scope.key("delays").key(name);
        let source = place.find(name, &sources, SOURCE)?;
        delays.push((format!("delay of {name}"), range, vec![source], place));
    }
    if let Some(range) = &spec.delay {
        let own: Vec<usize> = delays.iter().flat_map(|one| one.2.clone()).collect();
        let others = (0..sources.len()).filter(|source| !own.contains(source));
        delays.push((
            DELAY.to_owned(),
            range,
            others.collect(),
            scope.key("delay"),
        ));
    }
    for (name, range, sources, place) in delays {
        let least = range.min.value();
        if least < 0.0 {
            let found = range.min.to_string();
            return Err(place.key("min").wrong(found, "no negative time"));
        }
        priors.extend(prior(range, first + out.len(), &place)?);
        let constants = sources
            .into_iter()
            .map(|source| Constant::Delay(source).into());
        let of = (name, constants.collect());
        out.push(parameter(of, range, least, &place)?);
    }
    Ok((out, priors))
}

/// The prior of a constant, if it has one.
fn prior<M: PhysicalQuantity>(
    range: &RangeSpec<M>,
    constant: usize,
    scope: &Scope<'_>,
) -> Result<Option<Prior>, SceneError> {
    let Some(spec) = &range.prior else {
        return Ok(None);
    };
    let deviation = scope.key("prior").key("standard_deviation");
    Ok(Some(Prior {
        constant,
        value: spec.value.value(),
        deviation: deviation.positive(&spec.standard_deviation)?,
    }))
}

/// A constant between bounds, from its guess on or from a `usual` value.
fn parameter<M: PhysicalQuantity>(
    (name, constants): (String, Vec<Follower>),
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
        constants,
        lower,
        upper,
        guess,
    })
}
