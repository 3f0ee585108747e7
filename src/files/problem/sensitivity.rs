//! Conversion of the numbers by which the optimum of a problem is differentiated.

use crate::control::problem::{BoundaryState, Control, Duration, Varied, VariedOf, WeightOf};
use crate::files::json::error::Result;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::Scope;
use crate::files::problem::state::A_SOURCE;
use crate::files::scene::constants::{SceneConstant, WrittenScene};
use crate::files::scene::names::names;
use crate::files::units::quantity::{
    Angle, AngularVelocity, Kind, Length, Quantity, SoughtConstant, Time, Velocity, Voltage,
};
use crate::model::system::{InputKind, System};
use crate::model::{NotSought, Parameter, SiUnit, check_parameters, unit_of};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

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

/// The problem with the numbers by which its optimum is differentiated.
pub(crate) fn with_varied(
    control: Control,
    map: &SensitivityMap,
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Control> {
    Ok(Control {
        varied: varied(map, &control, scene, scope)?,
        ..control
    })
}

/// The numbers by which the optimum of a problem is differentiated.
fn varied(
    map: &SensitivityMap,
    control: &Control,
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Vec<Varied>> {
    let mut out = Vec::new();
    for (path, spec) in map {
        let scope = scope.key(path);
        let place = JsonPath::parse(path).unwrap_or_default();
        let is_of_problem =
            matches!(place.0.first(), Some(Step::Key(key)) if OF_PROBLEM.contains(&&**key));
        out.push(match is_of_problem {
            true => of_problem(path, &place, spec, control, scene.system, &scope)?,
            false => of_scene((path, &place), spec, scene, &scope)?,
        });
    }
    let held = out.iter().filter_map(Varied::parameter);
    let all: Vec<Parameter> = control.parameters.iter().chain(held).cloned().collect();
    check_parameters(scene.system, &all).map_err(|NotSought { parameter, reason }| {
        let place = scope.key(&all[parameter].name);
        place.wrong(reason, "a constant that can be differentiated by")
    })?;
    Ok(out)
}

/// A number of the scene.
fn of_scene(
    (path, place): (&str, &JsonPath),
    spec: &SensitivitySpec,
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Varied> {
    let wrong = |found: String| scope.wrong(found, OFFERED);
    let written = scene.written(place);
    let number =
        written.and_then(|value| serde_json::from_value::<Quantity<SoughtConstant>>(value).ok());
    let number =
        number.ok_or_else(|| wrong(format!("{path:?}, which is no number of the scene")))?;
    let ends = beside(number.si());
    let SceneConstant {
        mut followers,
        from_si,
        value,
    } = scene
        .constant(
            path,
            ends.each_ref().map(|(value, _)| value),
            ends.each_ref().map(|(_, si)| *si),
        )
        .map_err(|reason| scope.wrong(reason.found, reason.expected))?;
    for (path, &factor) in &spec.also {
        let place = scope.key("also").key(path);
        let ends = ends.each_ref().map(|(_, si)| factor * si);
        let values = ends.map(Value::from);
        let other = scene
            .constant(path, [&values[0], &values[1]], ends)
            .map_err(|reason| place.wrong(reason.found, reason.expected))?;
        let lists = [&followers, &other.followers];
        let [own, others] = lists.map(|list| unit_of(list, scene.system).symbol);
        if own != others {
            let found = format!("a number in {others:?}");
            return Err(place.wrong(
                found,
                format!("one in {own:?}, as the number that it follows"),
            ));
        }
        let multiple = factor * other.from_si / from_si;
        followers.extend(other.followers.into_iter().map(|f| f.of_multiple(multiple)));
    }
    let [lower, upper] = ends.map(|(_, si)| si * from_si);
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
            of.map_err(|reason| scope.key("tolerance").wrong(reason.found, reason.expected))?;
            Some(size.si() * from_si)
        }
        Some(ToleranceSpec::Part(part)) => Some(part * value.abs()),
        None => None,
    };
    check_tolerance(tolerance, scope)?;
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

fn check_tolerance(tolerance: Option<f64>, scope: &Scope<'_>) -> Result<()> {
    match tolerance {
        Some(size) if size <= 0.0 => {
            let found = "a tolerance that is not positive";
            Err(scope.key("tolerance").wrong(found, A_TOLERANCE))
        }
        _ => Ok(()),
    }
}

/// Symbol and kind of a unit, and its size in the unit inside.
struct Unit {
    kind: Option<Kind>,
    si: SiUnit,
}

impl Unit {
    fn new(kind: Kind, symbol: &'static str, factor: f64) -> Self {
        Self {
            kind: Some(kind),
            si: SiUnit { symbol, factor },
        }
    }

    /// That of a joint coordinate.
    fn of_joint(joint: usize, system: &System) -> Self {
        match crate::model::joint_unit(system, joint) {
            "mm" => Self::new(Length::kind(), "m", 1e-3),
            _ => Self::new(Angle::kind(), "rad", 1.0),
        }
    }

    fn of_rate(joint: usize, system: &System) -> Self {
        match crate::model::joint_unit(system, joint) {
            "mm" => Self::new(Velocity::kind(), "m/s", 1.0),
            _ => Self::new(AngularVelocity::kind(), "rad/s", 1e3),
        }
    }

    fn of_source(source: usize, system: &System) -> Self {
        match system.sources()[source].kind {
            InputKind::Voltage => Self::new(Voltage::kind(), "V", 1.0),
            other => {
                let (symbol, size) = other.si();
                Self {
                    kind: None,
                    si: SiUnit {
                        symbol,
                        factor: size.recip(),
                    },
                }
            }
        }
    }
}

/// A number of the problem.
fn of_problem(
    path: &str,
    place: &JsonPath,
    spec: &SensitivitySpec,
    control: &Control,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Varied> {
    if !spec.also.is_empty() {
        let found = "other constants of a number of the problem";
        return Err(scope
            .key("also")
            .wrong(found, "it beside a number of the scene only"));
    }
    let place = Place {
        path: place,
        control,
        system,
        scope,
    };
    let (of, value, unit) = place.number()?.ok_or_else(|| {
        let found = format!("{path:?}, which is no number of the problem that is offered");
        scope.wrong(found, OFFERED)
    })?;
    let tolerance = match &spec.tolerance {
        None => None,
        Some(ToleranceSpec::Part(part)) => Some(part * value.abs()),
        Some(ToleranceSpec::Size(size)) => Some(match &unit.kind {
            Some(kind) => size
                .value_as(kind)
                .map_err(|found| scope.key("tolerance").wrong(found, kind.expected()))?,
            None => size.si() / unit.si.factor,
        }),
    };
    check_tolerance(tolerance, scope)?;
    Ok(Varied {
        name: path.to_owned(),
        of,
        value,
        tolerance,
        unit: unit.si,
    })
}

/// Kind, value and unit of a number of the problem.
type Number = (VariedOf, f64, Unit);

/// A path in `control`, and what it may lead to.
struct Place<'a> {
    path: &'a JsonPath,
    control: &'a Control,
    system: &'a System,
    scope: &'a Scope<'a>,
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

    fn joint(&self) -> Result<usize> {
        let names = names(&self.system.joints, |joint| &joint.name);
        self.scope.find(&self.name(), &names, "the name of a joint")
    }

    fn source(&self, name: &str, expected: &str) -> Result<usize> {
        let sources = self.system.sources();
        let names = names(&sources, |source| &source.name);
        self.scope.find(name, &names, expected)
    }

    fn number(&self) -> Result<Option<Number>> {
        let objective = &self.control.objective;
        Ok(match (self.key(0), self.key(1)) {
            ("duration", "") => match self.control.duration {
                Duration::Given(given) => Some((
                    VariedOf::Duration,
                    given,
                    Unit::new(Time::kind(), "s", 1e-3),
                )),
                Duration::Free { .. } => None,
            },
            ("objective", "effort") => weight(objective.effort, WeightOf::Effort),
            ("objective", "rate") => weight(objective.rate, WeightOf::Rate),
            ("objective", "duration") => weight(objective.duration, WeightOf::Duration),
            ("voltage_bounds", "") => self.index().filter(|side| *side < 2).map(|side| {
                let unit = Unit::new(Voltage::kind(), "V", 1.0);
                let bound = self.control.voltage_bounds[side];
                (VariedOf::VoltageBound(side), bound, unit)
            }),
            ("load_bounds", name) => {
                let source = self.source(name, "the name of a load")?;
                let bounds = self.control.load_bounds.get(&source);
                let side = self.index().filter(|side| *side < 2);
                bounds.zip(side).map(|(bounds, side)| {
                    let unit = Unit::of_source(source, self.system);
                    (VariedOf::LoadBound(source, side), bounds[side], unit)
                })
            }
            ("goal", key) => self.of_goal(key)?,
            ("start", key) => self.of_start(key)?,
            _ => None,
        })
    }

    fn of_goal(&self, key: &str) -> Result<Option<Number>> {
        Ok(match (key, &self.control.goal) {
            ("joint_angles", BoundaryState::JointAngles { angles, .. }) => {
                let joint = self.joint()?;
                let unit = Unit::of_joint(joint, self.system);
                let value = angles.get(&joint);
                value.map(|value| (VariedOf::GoalJoint(joint), *value, unit))
            }
            ("rest_at_voltages", BoundaryState::RestAtVoltages(voltages, _)) => {
                let source = self.source(&self.name(), A_SOURCE)?;
                let unit = Unit::of_source(source, self.system);
                Some((VariedOf::GoalVoltage(source), voltages[source], unit))
            }
            ("markers", BoundaryState::Markers { places, .. }) => {
                let all = names(&self.system.markers, |marker| &marker.name);
                let expected = "the name of a marker";
                let marker = self.scope.find(&self.name(), &all, expected)?;
                let given = places.get(&marker).into_iter();
                let mut given = given.flat_map(|place| place.given());
                let given = given.find(|(axis, _)| Some(*axis) == self.index());
                given.map(|(axis, value)| {
                    let unit = Unit::new(Length::kind(), "m", 1e-3);
                    (VariedOf::GoalPlace { marker, axis }, value, unit)
                })
            }
            _ => None,
        })
    }

    fn of_start(&self, key: &str) -> Result<Option<Number>> {
        Ok(match (key, &self.control.start) {
            ("joint_angles", BoundaryState::JointAngles { angles, .. }) => {
                let joint = self.joint()?;
                let value = angles.get(&joint).copied().unwrap_or(0.0);
                let unit = Unit::of_joint(joint, self.system);
                Some((VariedOf::StartJoint(joint), value, unit))
            }
            ("joint_rates", BoundaryState::JointAngles { rates, .. }) => {
                let joint = self.joint()?;
                let value = rates.get(&joint).copied().unwrap_or(0.0);
                let unit = Unit::of_rate(joint, self.system);
                Some((VariedOf::StartRate(joint), value, unit))
            }
            ("rest_at_voltages", BoundaryState::RestAtVoltages(voltages, _)) => {
                let source = self.source(&self.name(), A_SOURCE)?;
                let unit = Unit::of_source(source, self.system);
                Some((VariedOf::StartVoltage(source), voltages[source], unit))
            }
            _ => None,
        })
    }
}

/// A weight of the objective.
fn weight(value: f64, of: WeightOf) -> Option<Number> {
    let si = SiUnit {
        symbol: "",
        factor: 1.0,
    };
    Some((VariedOf::Weight(of), value, Unit { kind: None, si }))
}

/// A number by which the optimum is differentiated.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensitivitySpec {
    /// Tolerance of the number, which may be so much smaller or larger: a part of it such as `"5 %"`, or a size in its unit such as `"1 mm"`.
    #[serde(default)]
    pub tolerance: Option<ToleranceSpec>,
    /// Other constants of the scene by their paths that are this one times a number.
    #[serde(default)]
    pub also: BTreeMap<String, f64>,
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

/// Reads tolerances.
struct ToleranceVisitor;

/// Tolerances, for messages.
pub(crate) const A_TOLERANCE: &str = "a positive part such as \"5 %\", or a positive size in the unit of the number such as \"1 mm\"";

impl Visitor<'_> for ToleranceVisitor {
    type Value = ToleranceSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(A_TOLERANCE)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        let size = Quantity::try_from_number(number);
        let size = size.map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))?;
        Ok(ToleranceSpec::Size(size))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Self::Value, E> {
        self.visit_f64(number as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        if let Some(number) = text.trim_end().strip_suffix('%') {
            let part = number
                .trim()
                .parse::<f64>()
                .ok()
                .filter(|part| part.is_finite());
            let wrong = || E::invalid_value(Unexpected::Str(text), &self);
            return part
                .map(|part| ToleranceSpec::Part(part / 100.0))
                .ok_or_else(wrong);
        }
        let size = Quantity::try_from_text(text);
        let size = size.map_err(|found| E::invalid_value(Unexpected::Other(&found), &self))?;
        Ok(ToleranceSpec::Size(size))
    }
}

impl<'de> Deserialize<'de> for ToleranceSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ToleranceVisitor)
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
