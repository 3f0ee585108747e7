//! Conversion of the numbers by which the optimum of a problem is differentiated.

use crate::control::problem::{BoundaryState, Control, Duration, Varied, VariedOf, WeightOf};
use crate::files::json::either::Scalar;
use crate::files::json::objects::read_objects;
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::{A_SOURCE, At};
use crate::files::problem::free::add_others;
use crate::files::scene::constants::{SceneConstant, WrittenScene};
use crate::files::units::quantity::{Kind, Length, Quantity, SoughtConstant, Time, Voltage};
use crate::model::system::{InputKind, Source};
use crate::model::{NotSought, Parameter, SiUnit, check_parameters};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;

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
    at: &At<'_>,
) -> Result<Control> {
    Ok(Control {
        varied: varied(map, &control, scene, at)?,
        ..control
    })
}

/// The numbers by which the optimum of a problem is differentiated.
fn varied(
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
    let mut constant = constant.map_err(|reason| reason.at(at))?;
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
            of.map_err(|reason| reason.at(&at.key("tolerance")))?;
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

/// Kind of a number where it has one, and its unit.
struct Unit {
    kind: Option<Kind>,
    si: SiUnit,
}

impl Unit {
    fn new(unit: (Kind, (&'static str, f64))) -> Self {
        let (kind, (symbol, factor)) = unit;
        Self {
            kind: Some(kind),
            si: SiUnit { symbol, factor },
        }
    }

    fn of_source(source: &Source) -> Self {
        match source.kind {
            InputKind::Voltage => Self::new((Voltage::kind(), ("V", 1.0))),
            other => {
                let (symbol, size) = other.si();
                let factor = size.recip();
                Self {
                    kind: None,
                    si: SiUnit { symbol, factor },
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
    let (of, value, unit) = place.number()?.ok_or_else(|| {
        let found = format!("{path:?}, which is no number of the problem that is offered");
        at.wrong(found, OFFERED)
    })?;
    let tolerance = match &spec.tolerance {
        None => None,
        Some(ToleranceSpec::Part(part)) => Some(part * value.abs()),
        Some(ToleranceSpec::Size(size)) => Some(match &unit.kind {
            Some(kind) => at.key("tolerance").value_as(size, kind)?,
            None => size.si() / unit.si.factor,
        }),
    };
    check_tolerance(tolerance, at)?;
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
                Duration::Given(given) => Some((
                    VariedOf::Duration,
                    given,
                    Unit::new((Time::kind(), ("s", 1e-3))),
                )),
                Duration::Free { .. } => None,
            },
            ("objective", "effort") => weight(objective.effort, WeightOf::Effort),
            ("objective", "rate") => weight(objective.rate, WeightOf::Rate),
            ("objective", "duration") => weight(objective.duration, WeightOf::Duration),
            ("voltage_bounds", "") => self.index().filter(|side| *side < 2).map(|side| {
                let unit = Unit::new((Voltage::kind(), ("V", 1.0)));
                let bound = self.control.voltage_bounds[side];
                (VariedOf::VoltageBound(side), bound, unit)
            }),
            ("load_bounds", name) => {
                let source = self.at.source(name, "the name of a load")?;
                let bounds = self.control.load_bounds.get(&source);
                let side = self.index().filter(|side| *side < 2);
                bounds.zip(side).map(|(bounds, side)| {
                    let unit = Unit::of_source(&self.at.sources[source]);
                    (VariedOf::LoadBound(source, side), bounds[side], unit)
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
                let unit = Unit::new(self.at.unit_of(joint));
                let value = angles.get(&joint);
                value.map(|value| (VariedOf::GoalJoint(joint), *value, unit))
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
                    let unit = Unit::new((Length::kind(), ("m", 1e-3)));
                    (VariedOf::GoalPlace { marker, axis }, value, unit)
                })
            }
            _ => None,
        })
    }

    /// A number of the start; zero where it does not name the joint.
    fn of_start(&self, key: &str) -> Result<Option<Number>> {
        let of_joint = |values: &BTreeMap<usize, f64>, of: fn(usize) -> VariedOf| {
            let joint = self.at.joint(&self.name())?;
            let unit = match key {
                "joint_rates" => self.at.unit_of_rate(joint),
                _ => self.at.unit_of(joint),
            };
            let value = values.get(&joint).copied().unwrap_or(0.0);
            Ok(Some((of(joint), value, Unit::new(unit))))
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
        let unit = Unit::of_source(&self.at.sources[source]);
        Ok((of(source), voltages[source], unit))
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
