//! Conversion of limits of currents, powers and voltage rates of sources to path constraints.

use crate::control::problem::{CostFunction, During, PathConstraint, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::bounds::check_bounds;
use crate::files::problem::spec_control::ObjectiveSpec;
use crate::files::problem::spec_limits::LimitSpec;
use crate::files::problem::spec_source_limits::All;
use crate::files::problem::state::driven;
use crate::files::scene::names::names;
use crate::files::units::quantity::{self, PhysicalQuantity};
use crate::model::system::{Fidelity, Source, System};
use crate::model::{Amount, Quantity};

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
    [min, max]: [&Option<quantity::Quantity<M>>; 2],
    scope: &Scope<'_>,
) -> Result<[f64; 2], SceneError> {
    let of = |bound: &Option<quantity::Quantity<M>>, absent: f64| {
        bound.as_ref().map_or(absent, quantity::Quantity::value)
    };
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

const EXPECTED: &str = "a lumped muscle";

/// The limit of an amount of muscles that one entry stands for; `scope` is that of its key.
pub(super) fn amount_limit(
    spec: &LimitSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Option<PathConstraint>, SceneError> {
    let (named, amount, [min, max]) = if let Some(spec) = &spec.muscle_volume {
        let bounds = bounds([&spec.min, &spec.max], scope)?;
        (&spec.muscles, Amount::Volume, bounds)
    } else if let Some(spec) = &spec.muscle_mass {
        let bounds = bounds([&spec.min, &spec.max], scope)?;
        (&spec.muscles, Amount::Mass, bounds)
    } else {
        return Ok(None);
    };
    if max <= 0.0 {
        return Err(scope
            .key("max")
            .wrong("no more than zero", "a positive bound"));
    }
    let muscles = match named {
        None => lumped(amount, system, scope)?,
        Some(list) => by_names(list, (amount, system), &scope.key("muscles"))?,
    };
    Ok(Some(PathConstraint::OfMuscles {
        muscles: muscles.into(),
        amount,
        min,
        max,
    }))
}

/// The costs of the amounts of all lumped muscles that have a weight.
pub(super) fn amount_costs(
    spec: &ObjectiveSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>, SceneError> {
    let weights = [
        ("muscle_volume", Amount::Volume, spec.muscle_volume),
        ("muscle_mass", Amount::Mass, spec.muscle_mass),
    ];
    let cost = |(key, amount, weight): (&str, Amount, f64)| {
        let muscles = lumped(amount, system, &scope.key(key))?.into();
        let unit = amount.unit().1;
        Ok(QuantityCost {
            quantity: Quantity::OfMuscles {
                muscles,
                amount,
                unit,
            },
            weight,
            function: CostFunction::Itself,
            during: During::End,
        })
    };
    let weighted = weights.into_iter().filter(|(.., weight)| *weight > 0.0);
    weighted.map(cost).collect()
}

/// True if a muscle has the amount.
fn has(amount: Amount, system: &System, muscle: usize) -> bool {
    amount == Amount::Volume || system.muscles[muscle].mass().is_some()
}

/// All lumped muscles, of which one at least has the amount.
fn lumped(amount: Amount, system: &System, scope: &Scope<'_>) -> Result<Vec<usize>, SceneError> {
    let is_lumped = |&m: &usize| system.muscles[m].fidelity == Fidelity::Lumped;
    let muscles: Vec<usize> = (0..system.muscles.len()).filter(is_lumped).collect();
    match muscles.iter().any(|&m| has(amount, system, m)) {
        true => Ok(muscles),
        false if muscles.is_empty() => Err(scope.wrong("no lumped muscle", EXPECTED)),
        false => Err(scope.wrong(
            "muscles without a density",
            "a \"density\" of the material of a lumped muscle",
        )),
    }
}

/// Lumped muscles by their names.
fn by_names(
    list: &[String],
    (amount, system): (Amount, &System),
    scope: &Scope<'_>,
) -> Result<Vec<usize>, SceneError> {
    if list.is_empty() {
        return Err(scope.wrong("no muscle", EXPECTED));
    }
    scope.unique(list, &[], |index| scope.index(index))?;
    let names = names(&system.muscles, |muscle| &muscle.name);
    let muscle = |(index, name): (usize, &String)| {
        let place = scope.index(index);
        let muscle = place.find(name, &names, "the name of a muscle")?;
        if system.muscles[muscle].fidelity != Fidelity::Lumped {
            return Err(place.wrong(format!("{name:?}, a muscle of finite elements"), EXPECTED));
        }
        match has(amount, system, muscle) {
            true => Ok(muscle),
            false => {
                let found = format!("{name:?}, whose material has no density");
                Err(place.wrong(found, "a muscle with a \"density\" of its material"))
            }
        }
    };
    list.iter().enumerate().map(muscle).collect()
}
