//! Conversion of the free parameters of a problem file to parameters.

use crate::control::PEAK_VOLTAGE;
use crate::files::json::document::Document;
use crate::files::json::objects::read_objects;
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::scene::constants::{SceneConstant, WrittenScene};
use crate::files::units::quantity::{Quantity, SoughtConstant};
use crate::model::{Constant, NotSought, Parameter, check_parameters, unit_of};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The parameters of a problem.
pub(crate) fn parameters(
    map: &FreeMap,
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<Vec<Parameter>> {
    let parameter = |path: &str, spec: &FreeSpec, at: &Scope<'_>| parameter(path, spec, scene, at);
    let parameters: Vec<Parameter> = at.each_named(map, parameter)?;
    check_parameters(scene.system, &parameters).map_err(|NotSought { parameter, reason }| {
        let place = at.key(&parameters[parameter].name);
        place.wrong(reason, "a constant that can be sought")
    })?;
    Ok(parameters)
}

fn parameter(
    path: &str,
    spec: &FreeSpec,
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<Parameter> {
    let (lower, upper) = (spec.min.si(), spec.max.si());
    refuse!(if lower >= upper, at.key("max");
        found spec.max, expected format!("a value larger than \"min\" {}", spec.min));
    let texts = [&spec.min, &spec.max].map(|bound| serde_json::to_value(bound).unwrap_or_default());
    let constant = scene.constant(path, [&texts[0], &texts[1]], [lower, upper]);
    let mut constant = constant.map_err(|reason| {
        let bound = reason.value.map(|bound| at.key(["min", "max"][bound]));
        reason.at(bound.as_ref().unwrap_or(at))
    })?;
    add_others(&mut constant, &spec.also, [lower, upper], scene, at)?;
    let SceneConstant {
        followers,
        from_si,
        value,
    } = constant;
    let guess = spec.guess.as_ref().map(|guess| guess.si() * from_si);
    let guess_or_value = guess.unwrap_or(value);
    let (lower, upper) = (lower * from_si, upper * from_si);
    if guess_or_value < lower || guess_or_value > upper {
        let (place, found) = match &spec.guess {
            Some(guess) => (at.key("guess"), guess.to_string()),
            None => (
                at.clone(),
                "a value in the scene outside the bounds".to_owned(),
            ),
        };
        let expected = format!("a guess from {} to {}", spec.min, spec.max);
        return Err(place.wrong(found, expected));
    }
    if let Some(guess) = &spec.guess {
        let text = serde_json::to_value(guess).unwrap_or_default();
        let place = JsonPath::parse(path).unwrap_or_default();
        let with = scene.with(&place, &text);
        with.map_err(|reason| reason.at(&at.key("guess")))?;
    }
    Ok(Parameter {
        name: path.to_owned(),
        constants: followers,
        lower,
        upper,
        guess: guess_or_value,
    })
}

/// Adds what follows a number by the paths of other numbers, which are that one times a factor.
pub(super) fn add_others(
    constant: &mut SceneConstant,
    others: &BTreeMap<String, f64>,
    bounds: [f64; 2],
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<()> {
    for (path, &factor) in others {
        let place = at.key("also").key(path);
        let si = bounds.map(|bound| bound * factor);
        let values = si.map(Value::from);
        let other = scene.constant(path, [&values[0], &values[1]], si);
        let other = other.map_err(|reason| reason.at(&place))?;
        let lists = [&constant.followers, &other.followers];
        let [own, others] = lists.map(|list| unit_of(list, scene.system).symbol);
        refuse!(if own != others, place;
            found format!("a number in {others:?}"),
            expected format!("one in {own:?}, as the number that it follows"));
        let multiple = factor * other.from_si / constant.from_si;
        let others = other.followers.into_iter();
        let others = others.map(|follower| follower.of_multiple(multiple));
        constant.followers.extend(others);
    }
    Ok(())
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
pub(crate) fn check_solution(path: &Path, scene: &WrittenScene<'_>, at: &Scope<'_>) -> Result<()> {
    let document = &Document::read(path)?;
    let FoundRecord { parameters } = document.parse()?;
    // The peak is a result, and no constant of a scene.
    let constants = parameters.iter().filter(|(name, _)| *name != PEAK_VOLTAGE);
    for (name, &found) in constants {
        let place = JsonPath::parse(name).unwrap_or_default();
        let mut other = scene
            .with(&place, &Value::from(found))
            .map_err(|reason| at.wrong(format!("{name:?}: {}", reason.found), reason.expected))?;
        let mut system = scene.system.clone();
        let differs = |constant: &Constant| {
            let of_solution = constant.value(&mut other);
            let of_scene = constant.value(&mut system);
            match (of_solution, of_scene) {
                (Some(a), Some(b)) => (a - b).abs() > SAME * a.abs(),
                _ => of_solution != of_scene,
            }
        };
        if let Some(constant) = Constant::all(scene.system).into_iter().find(differs) {
            let unit = constant.unit(&system);
            let of_scene = constant.value(&mut system).unwrap_or(f64::NAN) * unit.factor;
            let symbol = unit.symbol;
            let other = format!(
                "a solution with {name} = {found} {symbol}, where the scene has {of_scene} {symbol}"
            );
            return Err(at.wrong(other, "the value of the solution in the scene"));
        }
    }
    Ok(())
}

read_objects! {
    /// A free parameter between bounds.
    pub struct FreeSpec {
        /// Lower bound, in the unit of the constant.
        pub min: Quantity<SoughtConstant>,
        /// Upper bound.
        pub max: Quantity<SoughtConstant>,
        /// Value at which the solver starts; the value of the scene where not written.
        pub guess: Option<Quantity<SoughtConstant>>,
        /// Other constants by their paths that are this one times a number.
        pub also: BTreeMap<String, f64>,
    }
}

/// Free parameters by their paths in the scene.
pub type FreeMap = BTreeMap<String, FreeSpec>;
