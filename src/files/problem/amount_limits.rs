//! Conversion of limits of the volume and mass of muscles to path constraints.

use crate::control::problem::{CostFunction, During, PathConstraint, QuantityCost};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::source_limits::bounds;
use crate::files::problem::spec_control::ObjectiveSpec;
use crate::files::problem::spec_limits::LimitSpec;
use crate::files::scene::names::names;
use crate::model::system::{Fidelity, System};
use crate::model::{Amount, Quantity};

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
