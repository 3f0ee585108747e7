//! Stretches, tensions, fields and amounts of muscles in limits, costs and recordings.

use crate::control::problem::{CostFunction, During, Limit, QuantityCost};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::{At, ELECTRIC_KEYS};
use crate::files::problem::quantities::entry::{
    All, Cost, CostEntry, LimitEntry, Named, Recorded, bounds, bounds_by, costs, limits, limits_of,
    squares,
};
use crate::files::units::quantity::{ElectricField, Force, Mass, Quantity as Written, Volume};
use crate::model::system::Fidelity;
use crate::model::{Amount, FieldPlace, Pulling, Quantity, What};

read_objects! {
    /// Limits of the force with which one lumped muscle (`"muscle": name`), each (`"muscles": "all"`), a spring or a tendon pulls its ends
    /// together, by elasticity, field, viscosity and Maxwell branches: `min`, `max` or both.
    ///
    /// It bounds the tension in the middle of every interval, under the voltage there; the column of the table is its mean in both intervals
    /// beside an instant. Of springs and tendons it bounds the mean over every interval.
    pub struct TensionLimitSpec {
        /// Name of the muscle.
        pub muscle: Option<String>,
        /// All lumped muscles.
        pub muscles: Option<All>,
        /// Name of a spring.
        pub spring: Option<String>,
        /// Name of a tendon.
        pub tendon: Option<String>,
        /// Lower bound, SI unit N. With `0` the muscle is never slack.
        pub min: Option<Written<Force>>,
        /// Upper bound, SI unit N.
        pub max: Option<Written<Force>>,
    }

    /// Breakdown field of one muscle (`"muscle": name`) or all (`"muscles": "all"`), of one elastic block (`"solid": name`, or a
    /// `region` of it) or all (`"solids": "all"`).
    ///
    /// It bounds the true field at every instant and in the middle of every interval; in finite elements at their centres and Gauss
    /// points.
    pub struct ElectricFieldLimitSpec {
        /// Name of the muscle.
        pub muscle: Option<String>,
        /// All muscles with an electric term.
        pub muscles: Option<All>,
        /// Name of the elastic block.
        pub solid: Option<String>,
        /// All elastic blocks that a field reaches.
        pub solids: Option<All>,
        /// Name of a region of the mesh of `solid`; all elements that a field reaches where not written.
        pub region: Option<String>,
        /// Largest true field, SI unit V/m.
        pub max: Written<ElectricField>,
    }
}

limits! {
    /// Limits of the stretch of a muscle: `min`, `max` or both.
    StretchLimitSpec {
        /// Name of the muscle.
        pub muscle: String,
    } within f64, "" => |of, at| {
        let muscle = at.key("muscle").muscle(&of.muscle)?;
        let [min, max] = bounds_by([&of.min, &of.max], at, |at, &bound| match bound > 0.0 {
            true => Ok(bound),
            false => Err(at.wrong(bound.to_string(), "a positive stretch")),
        })?;
        limits_of([What::Stretch(muscle)], [min.max(0.0), max])
    };

    /// Limits of the volume of lumped muscles at rest, together, which follows from free parameters: `min`, `max` or both.
    MuscleVolumeLimitSpec {
        /// Names of lumped muscles; all of them where not written.
        pub muscles: Option<Vec<String>>,
    } within Written<Volume>, ", SI unit m^3" => |of, at| {
        amount_limits(&of.muscles, Amount::Volume, bounds([&of.min, &of.max], at)?, at)?
    };

    /// Limits of the mass of lumped muscles with a density, together, which follows from free parameters: `min`, `max` or both.
    MuscleMassLimitSpec {
        /// Names of lumped muscles; all of them where not written.
        pub muscles: Option<Vec<String>>,
    } within Written<Mass>, ", SI unit kg" => |of, at| {
        amount_limits(&of.muscles, Amount::Mass, bounds([&of.min, &of.max], at)?, at)?
    };
}

costs! {
    /// The tension of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals.
    TensionCostSpec {
        /// Name of the muscle.
        pub muscle: Option<String>,
        /// All lumped muscles.
        pub muscles: Option<All>,
        /// Tension that is asked for, SI unit N; 0 where not written.
        pub at: Option<Written<Force>>,
    } weight of "the squared deviation in N²" => |of, at| {
        let muscles = lumped_muscles(&of.muscle, of.muscles, at)?;
        let tension = |muscle| Quantity::tension(Pulling::Muscle(muscle));
        squares(muscles, tension, of.at.as_ref().map(Written::value))
    };

    /// The true electric field of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals; behind a
    /// resistor at the instants.
    FieldCostSpec {
        /// Name of the muscle.
        pub muscle: Option<String>,
        /// All lumped muscles with an electric term.
        pub muscles: Option<All>,
    } weight of "the squared field in (V/µm)²" => |of, at| field_costs(of, at)?;
}

const EXPECTED: &str = "a lumped muscle";

/// Places of the lumped muscles in the list of all: one or more.
fn all_lumped(at: &At<'_>) -> Result<Vec<usize>> {
    let is_lumped = |&m: &usize| at.system.muscles[m].fidelity == Fidelity::Lumped;
    let muscles: Vec<usize> = (0..at.system.muscles.len()).filter(is_lumped).collect();
    refuse!(if muscles.is_empty(), at; found "no lumped muscle", expected EXPECTED);
    Ok(muscles)
}

/// The lumped muscle of a name that stands here.
fn lumped_muscle(name: &str, at: &At<'_>) -> Result<usize> {
    let muscle = at.muscle(name)?;
    match at.system.muscles[muscle].fidelity {
        Fidelity::Lumped => Ok(muscle),
        Fidelity::FiniteElements(_) => {
            Err(at.wrong(format!("{name:?}, a muscle of finite elements"), EXPECTED))
        }
    }
}

/// One lumped muscle, or all.
fn lumped_muscles(
    muscle: &Option<String>,
    muscles: Option<All>,
    at: &At<'_>,
) -> Result<Vec<usize>> {
    let one = muscle.as_ref().map(Some);
    match at.exactly_one([("muscle", one), ("muscles", muscles.map(|_| None))])? {
        None => all_lumped(&at.key("muscles")),
        Some(name) => Ok(vec![lumped_muscle(name, &at.key("muscle"))?]),
    }
}

impl LimitEntry for TensionLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let bounds = bounds([&self.min, &self.max], at)?;
        let parts = the_one!(at, self;
            "muscle" muscle |at, name| vec![Pulling::Muscle(lumped_muscle(name, at)?)];
            "muscles" muscles |at, _| all_lumped(at)?.into_iter().map(Pulling::Muscle).collect();
            "spring" spring |at, name| vec![Pulling::Spring(at.spring(name)?)];
            "tendon" tendon |at, name| vec![Pulling::Tendon(at.tendon(name)?)];
        );
        Ok(limits_of(parts.into_iter().map(What::Tension), bounds))
    }
}

/// Error text of a field limit of a muscle without a field.
const NO_ELECTRIC_TERM: &str = "whose material has no electric term";

/// Error text of a field limit without a part.
const NOTHING: &str = "nothing that a field reaches";

impl LimitEntry for ElectricFieldLimitSpec {
    fn limits(&self, at: &At<'_>) -> Result<Vec<Limit>> {
        let max = at.key("max").positive(&self.max)?;
        let is_misplaced = self.region.is_some() && self.solid.is_none();
        refuse!(if is_misplaced, at.key("region");
            found "a region without \"solid\"", expected "a region of one block");
        let fields = the_one!(at, self;
            "muscle" muscle |at, name| muscle_fields(Some(name), at)?;
            "muscles" muscles |at, _| muscle_fields(None, at)?;
            "solid" solid |place, name| {
                let block = place.solid(name)?;
                let regions = &at.system.solids[block].mesh.region_names;
                let region = at.optional("region", &self.region, |at, name| {
                    at.find(name, regions, "the name of a region")
                });
                block_fields(vec![block], region?, place)?
            };
            "solids" solids |at, _| block_fields((0..at.system.solids.len()).collect(), None, at)?;
        );
        let limit = |field| Limit::below(What::Field(field), max);
        Ok(fields.into_iter().map(limit).collect())
    }
}

/// The fields of some blocks, or of a region of one.
fn block_fields(
    mut blocks: Vec<usize>,
    region: Option<usize>,
    at: &At<'_>,
) -> Result<Vec<FieldPlace>> {
    blocks.retain(|&block| {
        let regions = at.system.solids[block].mesh.regions.iter();
        let mut elements = regions.zip(at.system.elements_with_field(block));
        elements.any(|(of, has_field)| has_field && region.is_none_or(|region| *of == region))
    });
    refuse!(if blocks.is_empty(), at;
        found NOTHING, expected format!("elements of {ELECTRIC_KEYS} between electrodes"));
    let field = |block| FieldPlace::Block { block, region };
    Ok(blocks.into_iter().map(field).collect())
}

/// The fields of one muscle, or of all.
fn muscle_fields(name: Option<&String>, at: &At<'_>) -> Result<Vec<FieldPlace>> {
    let system = at.system;
    let has_field = |&muscle: &usize| system.muscles[muscle].material.electric.is_some();
    let muscles: Vec<usize> = match name {
        Some(name) => {
            let muscle = at.muscle(name)?;
            refuse!(if !has_field(&muscle), at;
                found format!("{name:?}, {NO_ELECTRIC_TERM}"),
                expected format!("a muscle of {ELECTRIC_KEYS}"));
            vec![muscle]
        }
        None => (0..system.muscles.len()).filter(has_field).collect(),
    };
    if muscles.is_empty() {
        let beside = match system.solids.is_empty() {
            true => "",
            false => "; the field of elastic blocks is limited by \"solid\" or \"solids\"",
        };
        let expected = format!("a muscle of {ELECTRIC_KEYS}{beside}");
        return Err(at.wrong(NOTHING, expected));
    }
    let place = |muscle| match system.meshed_muscles().position(|m| m == muscle) {
        None => FieldPlace::Muscle(muscle),
        Some(index) => FieldPlace::Block {
            block: system.solids.len() + index,
            region: None,
        },
    };
    Ok(muscles.into_iter().map(place).collect())
}

/// The squared fields of muscles with an electric term.
fn field_costs(of: &FieldCostSpec, at: &At<'_>) -> Result<Vec<Cost>> {
    let of_system = &at.system.muscles;
    let mut muscles = lumped_muscles(&of.muscle, of.muscles, at)?;
    muscles.retain(|&muscle| of_system[muscle].material.electric.is_some());
    let (key, found) = match &of.muscle {
        Some(name) => ("muscle", format!("{name:?}, {NO_ELECTRIC_TERM}")),
        None => ("muscles", NOTHING.to_owned()),
    };
    refuse!(if muscles.is_empty(), at.key(key);
        found found, expected format!("a muscle of {ELECTRIC_KEYS}"));
    let cost = |muscle: usize| {
        let is_behind = of_system[muscle].is_behind_resistor();
        let field = Quantity::squared_field(muscle, is_behind);
        (field, CostFunction::Itself)
    };
    Ok(muscles.into_iter().map(cost).collect())
}

/// Force with which a muscle, a spring or a tendon pulls its ends together.
pub(super) fn tension(of: &Named<'_>) -> Result<Recorded> {
    const EXPECTED: &str = "the name of a lumped muscle, a spring or a tendon";
    let (system, name) = (of.at.system, of.name);
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
    refuse!(if let Some(without) = without, of.place;
        found format!("{name:?}, {without}"), expected EXPECTED);
    Ok(of.recorded("tension", Quantity::tension(part), Force::kind()))
}

/// Limits of an amount of muscles.
fn amount_limits(
    named: &Option<Vec<String>>,
    amount: Amount,
    bounds: [f64; 2],
    at: &At<'_>,
) -> Result<Vec<Limit>> {
    refuse!(if bounds[1] <= 0.0, at.key("max");
        found "no more than zero", expected "a positive bound");
    let muscles = match named {
        None => all_with(amount, at)?,
        Some(list) => by_names(list, amount, &at.key("muscles"))?,
    };
    let muscles = muscles.into();
    Ok(limits_of([What::Amount { muscles, amount }], bounds))
}

/// The costs of the amounts of all lumped muscles that have a weight.
pub(in crate::files::problem) fn amount_costs(
    [volume, mass]: [f64; 2],
    at: &At<'_>,
) -> Result<Vec<QuantityCost>> {
    let weights = [
        ("muscle_volume", Amount::Volume, volume),
        ("muscle_mass", Amount::Mass, mass),
    ];
    let cost = |(key, amount, weight): (&str, Amount, f64)| {
        let muscles = all_with(amount, &at.key(key))?.into();
        Ok(QuantityCost {
            quantity: Quantity::of(What::Amount { muscles, amount }).in_unit(amount.unit().1),
            weight,
            function: CostFunction::Itself,
            during: During::End,
        })
    };
    let weighted = weights.into_iter().filter(|(.., weight)| *weight > 0.0);
    weighted.map(cost).collect()
}

/// True if a muscle has the amount.
fn has(amount: Amount, muscle: usize, at: &At<'_>) -> bool {
    amount == Amount::Volume || at.system.muscles[muscle].mass().is_some()
}

/// All lumped muscles, of which one at least has the amount.
fn all_with(amount: Amount, at: &At<'_>) -> Result<Vec<usize>> {
    let muscles = all_lumped(at)?;
    refuse!(if !muscles.iter().any(|&m| has(amount, m, at)), at;
        found "muscles without a density",
        expected "a \"density\" of the material of a lumped muscle");
    Ok(muscles)
}

/// Lumped muscles by their names.
fn by_names(list: &[String], amount: Amount, at: &At<'_>) -> Result<Vec<usize>> {
    refuse!(if list.is_empty(), at; found "no muscle", expected EXPECTED);
    at.unique(list, &[], |index| Scope::index(at, index))?;
    let muscle = |(index, name): (usize, &String)| {
        let place = at.index(index);
        let muscle = lumped_muscle(name, &place)?;
        refuse!(if !has(amount, muscle, at), place;
            found format!("{name:?}, whose material has no density"),
            expected "a muscle with a \"density\" of its material");
        Ok(muscle)
    };
    list.iter().enumerate().map(muscle).collect()
}
