//! Numbers of a scene that are sought, and numbers of a scene or a problem by which an optimum is differentiated.

use crate::control::PEAK_VOLTAGE;
use crate::control::problem::{BoundaryState, Control, Duration, Varied, VariedOf, WeightOf};
use crate::files::json::document::Document;
use crate::files::json::either::Scalar;
use crate::files::json::objects::read_objects;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::{A_SOURCE, At};
use crate::files::scene::constants::{SceneConstant, WrittenScene};
use crate::files::units::quantity::{Kind, Length, Quantity, Ratio, SoughtConstant, Time, Voltage};
use crate::model::{Constant, NotSought, Parameter, SiUnit, check_parameters, unit_of};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// The parameters of a problem.
pub(crate) fn parameters(
    map: &FreeMap,
    scene: &WrittenScene<'_>,
    at: &At<'_>,
) -> Result<Vec<Parameter>> {
    let parameter = |path: &str, spec: &FreeSpec, at: &At<'_>| sought(path, spec, scene, at);
    let parameters: Vec<Parameter> = at.each_named(map, parameter)?;
    check_parameters(scene.system, &parameters).map_err(|NotSought { parameter, reason }| {
        let place = at.key(&parameters[parameter].name);
        place.wrong(reason, "a constant that can be sought")
    })?;
    Ok(parameters)
}

fn sought(
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
    let mut constant = constant.map_err(|fault| match fault.at.as_str() {
        "" => at.error_of(fault),
        bound => at.key(bound).error_of(fault),
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
        with.map_err(|fault| at.key("guess").error_of(fault))?;
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
fn add_others(
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
        let other = other.map_err(|fault| place.error_of(fault))?;
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

/// Part of a number of a scene up to which it is put in its place to find what follows it.
const BESIDE: f64 = 0.1;
/// The same of a number that is zero, in SI units.
const BESIDE_ZERO: f64 = 1e-3;

/// First keys of numbers of `control` that are offered.
const OFFERED: &str = "the path of a number of the scene such as \"materials.NAME.shear_modulus\", or of the problem: \"duration\", \
     \"goal.joint_angles.NAME\", \"goal.markers.NAME[0]\", \"goal.rest_at_voltages.NAME\", \"start.joint_angles.NAME\", \"start.joint_rates.NAME\", \
     \"start.rest_at_voltages.NAME\", \"voltage_bounds[1]\", \"load_bounds.NAME[1]\", \"objective.effort\", \"objective.rate\", \"objective.duration\"";
/// First keys of a problem that may hold such a number.
const OF_PROBLEM: [&str; 6] = [
    "duration",
    "goal",
    "start",
    "voltage_bounds",
    "load_bounds",
    "objective",
];

/// The numbers by which the optimum of a problem is differentiated.
pub(crate) fn varied(
    map: &SensitivityMap,
    control: &Control,
    scene: &WrittenScene<'_>,
    at: &At<'_>,
) -> Result<Vec<Varied>> {
    let mut out = Vec::new();
    for (path, spec) in map {
        let at = at.key(path);
        let place = JsonPath::parse(path).unwrap_or_default();
        let is_of_problem =
            matches!(place.0.first(), Some(Step::Key(key)) if OF_PROBLEM.contains(&&**key));
        out.push(match is_of_problem {
            true => of_problem(path, &place, spec, control, &at)?,
            false => of_scene(path, &place, spec, scene, &at)?,
        });
    }
    let held = out.iter().filter_map(Varied::parameter);
    let all: Vec<Parameter> = control.parameters.iter().chain(held).cloned().collect();
    check_parameters(scene.system, &all).map_err(|NotSought { parameter, reason }| {
        let place = at.key(&all[parameter].name);
        place.wrong(reason, "a constant that can be differentiated by")
    })?;
    Ok(out)
}

/// A number of the scene.
fn of_scene(
    path: &str,
    place: &JsonPath,
    spec: &SensitivitySpec,
    scene: &WrittenScene<'_>,
    at: &Scope<'_>,
) -> Result<Varied> {
    let wrong = |found: String| at.wrong(found, OFFERED);
    let written = scene.written(place);
    let number =
        written.and_then(|value| serde_json::from_value::<Quantity<SoughtConstant>>(value).ok());
    let number =
        number.ok_or_else(|| wrong(format!("{path:?}, which is no number of the scene")))?;
    let ends = beside(number.si());
    let texts = ends.each_ref().map(|(value, _)| value);
    let bounds = ends.each_ref().map(|(_, si)| *si);
    let constant = scene.constant(path, texts, bounds);
    let mut constant = constant.map_err(|fault| at.error_of(fault))?;
    add_others(&mut constant, &spec.also, bounds, scene, at)?;
    let SceneConstant {
        followers,
        from_si,
        value,
    } = constant;
    let [lower, upper] = bounds.map(|si| si * from_si);
    let parameter = Parameter {
        name: path.to_owned(),
        constants: followers,
        lower: lower.min(upper),
        upper: upper.max(lower),
        guess: value,
    };
    let tolerance = match &spec.tolerance {
        Some(ToleranceSpec::Size(size)) => {
            let text = serde_json::to_value(size).unwrap_or_default();
            let of = scene.with(place, &text);
            of.map_err(|fault| at.key("tolerance").error_of(fault))?;
            Some(size.si() * from_si)
        }
        Some(ToleranceSpec::Part(part)) => Some(part * value.abs()),
        None => None,
    };
    check_tolerance(tolerance, at)?;
    Ok(Varied::constants(parameter, tolerance, scene.system))
}

/// Two values beside a number, as they are written and in SI units.
fn beside(si: f64) -> [(Value, f64); 2] {
    let size = match si == 0.0 {
        true => BESIDE_ZERO,
        false => BESIDE * si.abs(),
    };
    [si - size, si + size].map(|value| (Value::from(value), value))
}

fn check_tolerance(tolerance: Option<f64>, at: &Scope<'_>) -> Result<()> {
    refuse!(if tolerance.is_some_and(|size| size <= 0.0), at.key("tolerance");
        found "a tolerance that is not positive", expected A_TOLERANCE);
    Ok(())
}

/// A number of the problem.
fn of_problem(
    path: &str,
    place: &JsonPath,
    spec: &SensitivitySpec,
    control: &Control,
    at: &At<'_>,
) -> Result<Varied> {
    refuse!(if !spec.also.is_empty(), at.key("also");
        found "other constants of a number of the problem",
        expected "it beside a number of the scene only");
    let place = Place {
        path: place,
        control,
        at,
    };
    let (of, value, kind) = place.number()?.ok_or_else(|| {
        let found = format!("{path:?}, which is no number of the problem that is offered");
        at.wrong(found, OFFERED)
    })?;
    let tolerance = match &spec.tolerance {
        None => None,
        Some(ToleranceSpec::Part(part)) => Some(part * value.abs()),
        Some(ToleranceSpec::Size(size)) => Some(at.key("tolerance").value_as(size, &kind)?),
    };
    check_tolerance(tolerance, at)?;
    let (symbol, factor) = kind.unit();
    Ok(Varied {
        name: path.to_owned(),
        of,
        value,
        tolerance,
        unit: SiUnit { symbol, factor },
    })
}

/// A number of the problem, its value and its kind.
type Number = (VariedOf, f64, Kind);

/// A path in `control`, and what it may lead to.
struct Place<'a> {
    path: &'a JsonPath,
    control: &'a Control,
    at: &'a At<'a>,
}

impl Place<'_> {
    /// Key of a step; none of an index.
    fn key(&self, at: usize) -> &str {
        match self.path.0.get(at) {
            Some(Step::Key(key)) => key.as_str(),
            _ => "",
        }
    }

    /// The only index of the path.
    fn index(&self) -> Option<usize> {
        self.path.0.iter().find_map(|step| match step {
            Step::Index(index) => Some(*index),
            Step::Key(_) => None,
        })
    }

    /// The name behind the first two keys, in which points may stand.
    fn name(&self) -> String {
        let keys = self.path.0.iter().skip(2).filter_map(|step| match step {
            Step::Key(key) => Some(key.as_str()),
            Step::Index(_) => None,
        });
        keys.collect::<Vec<_>>().join(".")
    }

    fn number(&self) -> Result<Option<Number>> {
        let objective = &self.control.objective;
        Ok(match (self.key(0), self.key(1)) {
            ("duration", "") => match self.control.duration {
                Duration::Given(given) => Some((VariedOf::Duration, given, Time::kind())),
                Duration::Free { .. } => None,
            },
            ("objective", "effort") => weight(objective.effort, WeightOf::Effort),
            ("objective", "rate") => weight(objective.rate, WeightOf::Rate),
            ("objective", "duration") => weight(objective.duration, WeightOf::Duration),
            ("voltage_bounds", "") => self.index().filter(|side| *side < 2).map(|side| {
                let bound = self.control.voltage_bounds[side];
                (VariedOf::VoltageBound(side), bound, Voltage::kind())
            }),
            ("load_bounds", name) => {
                let source = self.at.source(name, "the name of a load")?;
                let bounds = self.control.load_bounds.get(&source);
                let side = self.index().filter(|side| *side < 2);
                bounds.zip(side).map(|(bounds, side)| {
                    let kind = self.at.kind_of_source(source);
                    (VariedOf::LoadBound(source, side), bounds[side], kind)
                })
            }
            ("goal", key) => self.of_goal(key)?,
            ("start", key) => self.of_start(key)?,
            _ => None,
        })
    }

    /// A number of the goal.
    fn of_goal(&self, key: &str) -> Result<Option<Number>> {
        Ok(match (key, &self.control.goal) {
            ("joint_angles", BoundaryState::JointAngles { angles, .. }) => {
                let joint = self.at.joint(&self.name())?;
                let kind = self.at.kind_of(joint);
                let value = angles.get(&joint);
                value.map(|value| (VariedOf::GoalJoint(joint), *value, kind))
            }
            ("rest_at_voltages", BoundaryState::RestAtVoltages(voltages, _)) => {
                Some(self.voltage(voltages, VariedOf::GoalVoltage)?)
            }
            ("markers", BoundaryState::Markers { places, .. }) => {
                let marker = self.at.marker(&self.name())?;
                let given = places.get(&marker).into_iter();
                let mut given = given.flat_map(|place| place.given());
                let given = given.find(|(axis, _)| Some(*axis) == self.index());
                given.map(|(axis, value)| {
                    (VariedOf::GoalPlace { marker, axis }, value, Length::kind())
                })
            }
            _ => None,
        })
    }

    /// A number of the start; zero where it does not name the joint.
    fn of_start(&self, key: &str) -> Result<Option<Number>> {
        let of_joint = |values: &BTreeMap<usize, f64>, of: fn(usize) -> VariedOf| {
            let joint = self.at.joint(&self.name())?;
            let kind = match key {
                "joint_rates" => self.at.kind_of_rate(joint),
                _ => self.at.kind_of(joint),
            };
            let value = values.get(&joint).copied().unwrap_or(0.0);
            Ok(Some((of(joint), value, kind)))
        };
        match (key, &self.control.start) {
            ("joint_angles", BoundaryState::JointAngles { angles, .. }) => {
                of_joint(angles, VariedOf::StartJoint)
            }
            ("joint_rates", BoundaryState::JointAngles { rates, .. }) => {
                of_joint(rates, VariedOf::StartRate)
            }
            ("rest_at_voltages", BoundaryState::RestAtVoltages(voltages, _)) => {
                self.voltage(voltages, VariedOf::StartVoltage).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// A voltage or load at rest.
    fn voltage(&self, voltages: &[f64], of: fn(usize) -> VariedOf) -> Result<Number> {
        let source = self.at.source(&self.name(), A_SOURCE)?;
        Ok((of(source), voltages[source], self.at.kind_of_source(source)))
    }
}

/// A weight of the objective.
fn weight(value: f64, of: WeightOf) -> Option<Number> {
    Some((VariedOf::Weight(of), value, Ratio::kind()))
}

read_objects! {
    /// A number by which the optimum is differentiated.
    #[derive(Default)]
    pub struct SensitivitySpec {
        /// Tolerance of the number, which may be so much smaller or larger: a part of it such as `"5 %"`, or a size in its unit such as `"1 mm"`.
        pub tolerance: Option<ToleranceSpec>,
        /// Other constants of the scene by their paths that are this one times a number.
        pub also: BTreeMap<String, f64>,
    }
}

/// Numbers by their paths in the scene or in `control`.
pub type SensitivityMap = BTreeMap<String, SensitivitySpec>;

/// A tolerance.
#[derive(Clone, Debug, PartialEq)]
pub enum ToleranceSpec {
    /// A part of the number.
    Part(f64),
    /// A size in its unit.
    Size(Quantity<SoughtConstant>),
}

/// Tolerances, for messages.
pub(crate) const A_TOLERANCE: &str = "a positive part such as \"5 %\", or a positive size in the unit of the number such as \"1 mm\"";

impl ToleranceSpec {
    /// Reads a part such as `5 %`, or a size.
    fn of_text(text: &str) -> Result<Self, String> {
        let Some(number) = text.trim_end().strip_suffix('%') else {
            return Quantity::try_from_text(text).map(Self::Size);
        };
        let part = number.trim().parse::<f64>().ok();
        let part = part.filter(|part| part.is_finite());
        let part = part.map(|part| Self::Part(part / 100.0));
        part.ok_or_else(|| format!("{text:?}"))
    }
}

impl<'de> Deserialize<'de> for ToleranceSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Scalar {
            expected: || A_TOLERANCE.to_owned(),
            number: |number| Quantity::try_from_number(number).map(Self::Size),
            text: Self::of_text,
        })
    }
}

impl JsonSchema for ToleranceSpec {
    fn schema_name() -> Cow<'static, str> {
        "ToleranceSpec".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "type": ["number", "string"],
            "description": format!("A number in SI units or a text: {A_TOLERANCE}."),
        })
    }
}
