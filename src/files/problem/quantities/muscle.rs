//! Stretches, tensions, fields and amounts of muscles in limits, costs and recordings.

use crate::control::problem::{During, Limit, QuantityCost};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::quantities::entry::{
    All, CostEntry, LimitEntry, Named, Recorded, bounds, check_bounds, itself, limits_of, square,
    weight,
};
use crate::files::problem::state::ELECTRIC_KEYS;
use crate::files::scene::names::names;
use crate::files::units::quantity::{ElectricField, Force, Mass, Quantity as Written, Volume};
use crate::model::system::{Fidelity, System};
use crate::model::{Amount, FieldPlace, PartKind, Pulling, Quantity, What};
use schemars::JsonSchema;
use serde::Deserialize;

/// Limits of the stretch of a muscle: `min`, `max` or both.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StretchLimitSpec {
    /// Name of the muscle.
    pub muscle: String,
    /// Lower bound.
    #[serde(default)]
    pub min: Option<f64>,
    /// Upper bound.
    #[serde(default)]
    pub max: Option<f64>,
}

/// Limits of the force with which one lumped muscle (`"muscle": name`), each (`"muscles": "all"`), a spring or a tendon pulls its ends
/// together, by elasticity, field, viscosity and Maxwell branches: `min`, `max` or both.
///
/// It bounds the tension in the middle of every interval, under the voltage there; the column of the table is its mean in both intervals
/// beside an instant. Of springs and tendons it bounds the mean over every interval.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TensionLimitSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Name of a spring.
    #[serde(default)]
    pub spring: Option<String>,
    /// Name of a tendon.
    #[serde(default)]
    pub tendon: Option<String>,
    /// Lower bound, SI unit N. With `0` the muscle is never slack.
    #[serde(default)]
    pub min: Option<Written<Force>>,
    /// Upper bound, SI unit N.
    #[serde(default)]
    pub max: Option<Written<Force>>,
}

/// Breakdown field of one muscle (`"muscle": name`) or all (`"muscles": "all"`), of one elastic block (`"solid": name`, or a
/// `region` of it) or all (`"solids": "all"`).
///
/// It bounds the true field at every instant and in the middle of every interval; in finite elements at their centres and Gauss
/// points.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ElectricFieldLimitSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All muscles with an electric term.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Name of the elastic block.
    #[serde(default)]
    pub solid: Option<String>,
    /// All elastic blocks that a field reaches.
    #[serde(default)]
    pub solids: Option<All>,
    /// Name of a region of the mesh of `solid`; all elements that a field reaches where not written.
    #[serde(default)]
    pub region: Option<String>,
    /// Largest true field, SI unit V/m.
    pub max: Written<ElectricField>,
}

/// Declares limits of an amount of lumped muscles, together: `min`, `max` or both.
macro_rules! amount_limits {
    ($($(#[$about:meta])* $name:ident: $measure:ident, $unit:literal;)*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Deserialize, JsonSchema)]
            #[serde(deny_unknown_fields)]
            pub struct $name {
                /// Names of lumped muscles; all of them where not written.
                #[serde(default)]
                pub muscles: Option<Vec<String>>,
                #[doc = concat!("Lower bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub min: Option<Written<$measure>>,
                #[doc = concat!("Upper bound, SI unit ", $unit, ".")]
                #[serde(default)]
                pub max: Option<Written<$measure>>,
            }

            impl LimitEntry for $name {
                fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
                    let bounds = bounds([&self.min, &self.max], scope)?;
                    amount(&self.muscles, Amount::$measure, bounds, system, scope)
                }

                fn is_timeless(&self) -> bool {
                    true
                }
            }
        )*
    };
}

amount_limits! {
    /// Limits of the volume of lumped muscles at rest, together, which follows from free parameters: `min`, `max` or both.
    MuscleVolumeLimitSpec: Volume, "m^3";
    /// Limits of the mass of lumped muscles with a density, together, which follows from free parameters: `min`, `max` or both.
    MuscleMassLimitSpec: Mass, "kg";
}

/// The tension of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TensionCostSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Tension that is asked for, SI unit N; 0 where not written.
    #[serde(default)]
    pub at: Option<Written<Force>>,
    /// Weight of the squared deviation in N²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

/// The true electric field of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals; behind a
/// resistor at the instants.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldCostSpec {
    /// Name of the muscle.
    #[serde(default)]
    pub muscle: Option<String>,
    /// All lumped muscles with an electric term.
    #[serde(default)]
    pub muscles: Option<All>,
    /// Weight of the squared field in (V/µm)²; 1 where not written.
    #[serde(default)]
    pub weight: Option<f64>,
}

const EXPECTED: &str = "a lumped muscle";

/// One lumped muscle, or all.
fn lumped_muscles(
    muscle: &Option<String>,
    muscles: Option<All>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<usize>> {
    let is_lumped = |&m: &usize| system.muscles[m].fidelity == Fidelity::Lumped;
    let one = muscle.as_ref().map(Some);
    let chosen = [("muscle", one), ("muscles", muscles.map(|_| None))];
    let muscles: Vec<usize> = match scope.exactly_one(chosen)? {
        None => (0..system.muscles.len()).filter(is_lumped).collect(),
        Some(name) => {
            let (place, names) = (scope.key("muscle"), names(&system.muscles, |m| &m.name));
            let muscle = place.find(name, &names, "the name of a muscle")?;
            if !is_lumped(&muscle) {
                let found = format!("{name:?}, a muscle of finite elements");
                return Err(place.wrong(found, EXPECTED));
            }
            vec![muscle]
        }
    };
    match muscles.is_empty() {
        true => Err(scope.key("muscles").wrong("no lumped muscle", EXPECTED)),
        false => Ok(muscles),
    }
}

/// The lumped muscles, the spring or the tendon of an entry.
fn pulling(
    muscles: (&Option<String>, Option<All>),
    others: [&Option<String>; 2],
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Pulling>> {
    let is_written = |of: &Option<String>| of.as_ref().map(|_| ());
    scope.exactly_one([
        ("muscle", is_written(muscles.0)),
        ("muscles", muscles.1.map(|_| ())),
        ("spring", is_written(others[0])),
        ("tendon", is_written(others[1])),
    ])?;
    let kinds = [
        (
            "spring",
            PartKind::Spring,
            Pulling::Spring as fn(usize) -> Pulling,
        ),
        ("tendon", PartKind::Tendon, Pulling::Tendon),
    ];
    for ((key, kind, part), name) in kinds.into_iter().zip(others) {
        if let Some(name) = name {
            let expected = format!("the name of a {key}");
            let index = scope.key(key).find(name, &kind.names(system), &expected)?;
            return Ok(vec![part(index)]);
        }
    }
    let muscles = lumped_muscles(muscles.0, muscles.1, system, scope)?;
    Ok(muscles.into_iter().map(Pulling::Muscle).collect())
}

impl LimitEntry for StretchLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let muscles = names(&system.muscles, |muscle| &muscle.name);
        let expected = "the name of a muscle";
        let muscle = scope.key("muscle").find(&self.muscle, &muscles, expected)?;
        for (key, bound) in [("min", self.min), ("max", self.max)] {
            if let Some(bound) = bound.filter(|bound| *bound <= 0.0) {
                let place = scope.key(key);
                return Err(place.wrong(bound.to_string(), "a positive stretch"));
            }
        }
        let bounds = [self.min.unwrap_or(0.0), self.max.unwrap_or(f64::INFINITY)];
        let bounds = check_bounds(bounds, self.min.is_some() || self.max.is_some(), scope)?;
        Ok(limits_of([What::Stretch(muscle)], bounds))
    }
}

impl LimitEntry for TensionLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], scope)?;
        let muscles = (&self.muscle, self.muscles);
        let parts = pulling(muscles, [&self.spring, &self.tendon], system, scope)?;
        Ok(limits_of(parts.into_iter().map(What::Tension), bounds))
    }
}

/// Error text of a field limit without a part.
const NOTHING: &str = "nothing that a field reaches";

impl LimitEntry for ElectricFieldLimitSpec {
    fn limits(&self, system: &System, scope: &Scope<'_>) -> Result<Vec<Limit>> {
        let max = scope.key("max").positive(&self.max)?;
        let one = |name: &Option<String>| name.clone().map(Some);
        let all = |all: Option<All>| all.map(|_| None);
        let chosen = [
            ("muscle", one(&self.muscle)),
            ("muscles", all(self.muscles)),
            ("solid", one(&self.solid)),
            ("solids", all(self.solids)),
        ];
        let key = chosen.iter().find(|(_, choice)| choice.is_some());
        let key = key.map_or("", |(key, _)| key);
        let name = scope.exactly_one(chosen)?;
        let place = scope.key(key);
        if self.region.is_some() && key != "solid" {
            let found = "a region without \"solid\"";
            return Err(scope.key("region").wrong(found, "a region of one block"));
        }
        let nothing = |expected: String| place.wrong(NOTHING, expected);
        if key.starts_with("muscle") {
            return muscle_fields(name.as_ref(), max, system, &place);
        }
        let (blocks, region) = match &name {
            None => ((0..system.solids.len()).collect(), None),
            Some(name) => {
                let names = names(&system.solids, |solid| &solid.name);
                let block = place.find(name, &names, "the name of an elastic block")?;
                let regions = &system.solids[block].mesh.region_names;
                let of = scope.key("region");
                let region = self.region.as_ref();
                let region = region.map(|name| of.find(name, regions, "the name of a region"));
                (vec![block], region.transpose()?)
            }
        };
        let has_field = |&block: &usize| {
            let solid = &system.solids[block];
            let mut elements = solid
                .mesh
                .regions
                .iter()
                .zip(system.elements_with_field(block));
            elements.any(|(of, has_field)| has_field && region.is_none_or(|region| *of == region))
        };
        let blocks: Vec<usize> = blocks.into_iter().filter(has_field).collect();
        if blocks.is_empty() {
            let expected = format!("elements of {ELECTRIC_KEYS} between electrodes");
            return Err(nothing(expected));
        }
        let limit = |block| Limit::below(What::Field(FieldPlace::Block { block, region }), max);
        Ok(blocks.into_iter().map(limit).collect())
    }
}

/// Limits of the fields of one muscle, or of all.
fn muscle_fields(
    name: Option<&String>,
    max: f64,
    system: &System,
    place: &Scope<'_>,
) -> Result<Vec<Limit>> {
    let muscles = match name {
        Some(name) => vec![muscle_with_field(name, system, place)?],
        None => (0..system.muscles.len())
            .filter(|&muscle| system.muscles[muscle].material.electric.is_some())
            .collect(),
    };
    if muscles.is_empty() {
        let beside = match system.solids.is_empty() {
            true => "",
            false => "; the field of elastic blocks is limited by \"solid\" or \"solids\"",
        };
        let expected = format!("a muscle of {ELECTRIC_KEYS}{beside}");
        return Err(place.wrong(NOTHING, expected));
    }
    let place = |muscle| match system.meshed_muscles().position(|m| m == muscle) {
        None => FieldPlace::Muscle(muscle),
        Some(index) => FieldPlace::Block {
            block: system.solids.len() + index,
            region: None,
        },
    };
    let limit = |muscle| Limit::below(What::Field(place(muscle)), max);
    Ok(muscles.into_iter().map(limit).collect())
}

/// Index of a muscle with an electric term.
fn muscle_with_field(name: &str, system: &System, scope: &Scope<'_>) -> Result<usize> {
    let muscles = names(&system.muscles, |muscle| &muscle.name);
    let index = scope.find(name, &muscles, "the name of a muscle")?;
    if system.muscles[index].material.electric.is_some() {
        return Ok(index);
    }
    let found = format!("{name:?}, whose material has no electric term");
    Err(scope.wrong(found, format!("a muscle of {ELECTRIC_KEYS}")))
}

impl CostEntry for TensionCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let at = self.at.as_ref().map_or(0.0, Written::value);
        let muscles = lumped_muscles(&self.muscle, self.muscles, system, scope)?;
        let tension = |muscle| Quantity::tension(Pulling::Muscle(muscle));
        let cost = |muscle| square(tension(muscle), at, weight, during);
        Ok(muscles.into_iter().map(cost).collect())
    }
}

impl CostEntry for FieldCostSpec {
    fn costs(
        &self,
        during: During,
        system: &System,
        scope: &Scope<'_>,
    ) -> Result<Vec<QuantityCost>> {
        let weight = weight(self.weight, scope)?;
        let mut muscles = lumped_muscles(&self.muscle, self.muscles, system, scope)?;
        muscles.retain(|&muscle| system.muscles[muscle].material.electric.is_some());
        if muscles.is_empty() {
            let (key, found) = match &self.muscle {
                Some(name) => (
                    "muscle",
                    format!("{name:?}, whose material has no electric term"),
                ),
                None => ("muscles", NOTHING.to_owned()),
            };
            let expected = format!("a muscle of {ELECTRIC_KEYS}");
            return Err(scope.key(key).wrong(found, expected));
        }
        let field = |muscle: usize| {
            Quantity::squared_field(muscle, system.muscles[muscle].is_behind_resistor())
        };
        let cost = |muscle| itself(field(muscle), weight, during);
        Ok(muscles.into_iter().map(cost).collect())
    }
}

/// Force with which a muscle, a spring or a tendon pulls its ends together.
pub(super) fn tension(of: &Named<'_>) -> Result<Recorded> {
    const EXPECTED: &str = "the name of a lumped muscle, a spring or a tendon";
    let (system, name) = (of.system, of.name);
    let components = &system.components;
    let muscles = system.muscles.iter().enumerate().map(|(m, muscle)| {
        let is_meshed = muscle.fidelity != Fidelity::Lumped;
        let without = is_meshed.then_some("a muscle of finite elements, whose forces act on faces");
        (&muscle.name, Pulling::Muscle(m), without)
    });
    let springs = components.springs.iter().enumerate().map(|(s, spring)| {
        let is_slack = spring.stiffness.is_none() && spring.damping.is_none();
        let without = is_slack.then_some("a spring without stiffness and damping");
        (&spring.name, Pulling::Spring(s), without)
    });
    let tendons = components.tendons.iter().enumerate();
    let tendons = tendons.map(|(t, one)| (&one.name, Pulling::Tendon(t), None));
    let parts: Vec<_> = muscles.chain(springs).chain(tendons).collect();
    let names: Vec<String> = parts.iter().map(|(name, ..)| (*name).clone()).collect();
    let (_, part, without) = parts[of.place.find(name, &names, EXPECTED)?];
    if let Some(without) = without {
        return Err(of.place.wrong(format!("{name:?}, {without}"), EXPECTED));
    }
    let unit = (Force::kind(), ("N", 1.0));
    Ok(Recorded::named(
        "tension",
        name,
        Quantity::tension(part),
        unit,
    ))
}

/// Limits of an amount of muscles.
fn amount(
    named: &Option<Vec<String>>,
    amount: Amount,
    bounds: [f64; 2],
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Limit>> {
    if bounds[1] <= 0.0 {
        let place = scope.key("max");
        return Err(place.wrong("no more than zero", "a positive bound"));
    }
    let muscles = match named {
        None => lumped(amount, system, scope)?,
        Some(list) => by_names(list, amount, system, &scope.key("muscles"))?,
    };
    let muscles = muscles.into();
    Ok(limits_of([What::Amount { muscles, amount }], bounds))
}

/// The costs of the amounts of all lumped muscles that have a weight.
pub(in crate::files::problem) fn amount_costs(
    [volume, mass]: [f64; 2],
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<QuantityCost>> {
    let weights = [
        ("muscle_volume", Amount::Volume, volume),
        ("muscle_mass", Amount::Mass, mass),
    ];
    let cost = |(key, amount, weight): (&str, Amount, f64)| {
        let muscles = lumped(amount, system, &scope.key(key))?.into();
        let quantity = Quantity::of(What::Amount { muscles, amount }).in_unit(amount.unit().1);
        Ok(itself(quantity, weight, During::End))
    };
    let weighted = weights.into_iter().filter(|(.., weight)| *weight > 0.0);
    weighted.map(cost).collect()
}

/// True if a muscle has the amount.
fn has(amount: Amount, system: &System, muscle: usize) -> bool {
    amount == Amount::Volume || system.muscles[muscle].mass().is_some()
}

/// All lumped muscles, of which one at least has the amount.
fn lumped(amount: Amount, system: &System, scope: &Scope<'_>) -> Result<Vec<usize>> {
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
    amount: Amount,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<usize>> {
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
