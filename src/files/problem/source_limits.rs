//! Conversion of limits of currents, powers and voltage rates of sources to path constraints.

use crate::control::problem::PathConstraint;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::bounds::check_bounds;
use crate::files::problem::spec_limits::LimitSpec;
use crate::files::problem::spec_source_limits::All;
use crate::files::problem::state::driven;
use crate::files::units::quantity::{PhysicalQuantity, Quantity};
use crate::model::system::{Source, System};

/// Sources of which a limit speaks.
pub(super) type Chosen<'s> = (&'s Option<String>, Option<All>);

/// The limits of sources that one entry stands for; `scope` is that of its key.
pub(super) fn source_limits(
    spec: &LimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<PathConstraint>, SceneError> {
    let mut limits = Vec::new();
    if let Some(spec) = &spec.current {
        let [min, max] = bounds([&spec.min, &spec.max], scope)?;
        let limit = |muscle| PathConstraint::Current { muscle, min, max };
        let muscles = measured((&spec.source, spec.sources), system, scope)?;
        limits.extend(muscles.into_iter().map(limit));
    }
    if let Some(spec) = &spec.power {
        let [min, max] = bounds([&spec.min, &spec.max], scope)?;
        let limit = |muscle| PathConstraint::Power { muscle, min, max };
        let muscles = measured((&spec.source, spec.sources), system, scope)?;
        limits.extend(muscles.into_iter().map(limit));
    }
    if let Some(spec) = &spec.voltage_rate {
        let [min, max] = bounds([&spec.min, &spec.max], scope)?;
        let limit = |source| PathConstraint::VoltageRate { source, min, max };
        let (sources, place) = chosen((&spec.source, spec.sources), &system.sources(), scope)?;
        if sources.is_empty() {
            return Err(place.wrong("no source", "a source of a voltage"));
        }
        limits.extend(sources.into_iter().map(limit));
    }
    Ok(limits)
}

/// Both bounds, of which one at least is written.
pub(super) fn bounds<M: PhysicalQuantity>(
    [min, max]: [&Option<Quantity<M>>; 2],
    scope: &Scope<'_>,
) -> Result<[f64; 2], SceneError> {
    let of =
        |bound: &Option<Quantity<M>>, absent: f64| bound.as_ref().map_or(absent, Quantity::value);
    let bounds = [of(min, f64::NEG_INFINITY), of(max, f64::INFINITY)];
    check_bounds(bounds[0], bounds[1], min.is_some() || max.is_some(), scope)?;
    Ok(bounds)
}

/// One source, or all that take a voltage, each with the place where it is chosen.
fn chosen<'s>(
    (name, all): Chosen<'_>,
    sources: &[Source],
    scope: &Scope<'s>,
) -> Result<(Vec<usize>, Scope<'s>), SceneError> {
    let one = name.as_ref().map(Some);
    match scope.exactly_one([("source", one), ("sources", all.map(|_| None))])? {
        Some(name) => {
            let place = scope.key("source");
            Ok((vec![driven(name, sources, &place)?], place))
        }
        None => {
            let takes = |&s: &usize| sources[s].takes_voltage;
            Ok((
                (0..sources.len()).filter(takes).collect(),
                scope.key("sources"),
            ))
        }
    }
}

/// Muscles of whose sources current and power are known: all of them without such a muscle is none.
pub(super) fn measured(
    of: Chosen<'_>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<usize>, SceneError> {
    const EXPECTED: &str = "sources of lumped muscles with a permittivity: without a \"circuit\", or with a \"resistance\" in it";
    let sources = system.sources();
    let (chosen, place) = chosen(of, &sources, scope)?;
    let obstacle = |s: usize| match system.muscles.get(s) {
        Some(muscle) if muscle.has_measured_current() => None,
        Some(muscle) if muscle.circuit.is_some() => Some("which leaks and has no resistor"),
        Some(_) => Some("a muscle of finite elements"),
        None => Some("which drives finite elements"),
    };
    if let Some((source, why)) = chosen.iter().find_map(|&s| Some((s, obstacle(s)?))) {
        let found = format!("{:?}, {why}", sources[source].name);
        return Err(place.wrong(found, EXPECTED));
    }
    match chosen.is_empty() {
        true => Err(place.wrong("no source", EXPECTED)),
        false => Ok(chosen),
    }
}
