//! Similar problems: masses, lengths, times and voltages of a scene or problem file multiplied so that all dimensionless groups stay.
//!
//! The JSON Schema says which number has which unit; a text has its own. Plain numbers of joints count as angles, and their weights as
//! weights of angles; a load or a free parameter is written with its unit. The permittivity of vacuum is no number of a file: with
//! [`Scales::in_vacuum`] it stays; with a voltage of its own the materials are `ideal`, and their `relative_permittivity` takes the factor.

use proboscis::files::schema;
use serde_json::{Map, Value};
use std::fs;
use std::path::Path;

/// Factors of the four base units.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    pub mass: f64,
    pub length: f64,
    pub time: f64,
    pub voltage: f64,
}

/// Exponents of mass, length, time and voltage.
type Exponents = [i32; 4];

/// Units of the measures of the schema, by their names there.
const MEASURES: [(&str, &str); 34] = [
    ("Acceleration", "m/s^2"),
    ("Angle", "rad"),
    ("AngularVelocity", "rad/s"),
    ("Current", "A"),
    ("Damping", "N s/m"),
    ("Density", "kg/m^3"),
    ("ElectricField", "V/m"),
    ("Force", "N"),
    ("Frequency", "1/s"),
    ("JointCoordinate", "rad"),
    ("JointDamping", "N m s/rad"),
    ("JointRate", "rad/s"),
    ("JointStiffness", "N m/rad"),
    ("Length", "m"),
    ("Mass", "kg"),
    ("MomentOfInertia", "kg m^2"),
    ("Permittivity", "F/m"),
    ("Power", "W"),
    ("Rate", "1/s"),
    ("Ratio", ""),
    ("Resistance", "Ohm"),
    ("Stiffness", "N/m"),
    ("Stress", "Pa"),
    ("Time", "s"),
    ("Torque", "N m"),
    ("Velocity", "m/s"),
    ("Viscosity", "Pa s"),
    ("Voltage", "V"),
    ("VoltageRate", "V/s"),
    ("Volume", "m^3"),
    ("LoadSize", UNKNOWN),
    ("MeasuredSize", UNKNOWN),
    ("SoughtConstant", UNKNOWN),
    ("ToleranceSpec", UNKNOWN),
];

/// The unit of a plain number that follows from a place elsewhere.
const UNKNOWN: &str = "?";

/// Units of what a weight multiplies, by definition and key.
const WEIGHTS: [(&str, &str, &str); 21] = [
    ("ObjectiveSpec", "effort", "V^2 s"),
    ("ObjectiveSpec", "rate", "V^2/s"),
    ("ObjectiveSpec", "duration", "s"),
    ("ObjectiveSpec", "peak_voltage", "V^2"),
    ("ObjectiveSpec", "electrical_energy", "J"),
    ("ObjectiveSpec", "mechanical_work", "J"),
    ("ObjectiveSpec", "muscle_volume", "m^3"),
    ("ObjectiveSpec", "muscle_mass", "kg"),
    ("SourceEnergySpec", "weight", "J"),
    ("TrackMarkerSpec", "weight", "m^2 s"),
    ("TrackJointSpec", "weight", "s"),
    ("TrackJointsSpec", "weight", "s"),
    ("FinalMarkerSpec", "weight", "m^2"),
    ("FinalJointSpec", "weight", ""),
    ("WaypointSpec", "weight", "m^2"),
    // At the end; along the motion they are integrated over time.
    ("TensionCostSpec", "weight", "N^2"),
    ("FieldCostSpec", "weight", "V^2/m^2"),
    ("CurrentCostSpec", "weight", "A^2"),
    ("PowerCostSpec", "weight", "W^2"),
    ("JointRateCostSpec", "weight", "1/s^2"),
    ("MarkerSpeedCostSpec", "weight", "m^2/s^2"),
];

impl Scales {
    /// With the voltage that leaves the permittivity as it is.
    pub fn in_vacuum(mass: f64, length: f64, time: f64) -> Self {
        let voltage = (mass * length).sqrt() / time;
        Self {
            mass,
            length,
            time,
            voltage,
        }
    }

    /// Factor of a quantity in a unit such as `N mm` or `rad/s`.
    pub fn of_unit(&self, unit: &str) -> f64 {
        let exponents = exponents(unit).unwrap_or_else(|| panic!("{unit:?} is no unit"));
        let bases = [self.mass, self.length, self.time, self.voltage];
        let powers = bases.iter().zip(exponents);
        powers.map(|(base, power)| base.powi(power)).product()
    }

    /// Returns true if the unit of a definition of the schema is known.
    pub fn knows(&self, definition: &str) -> bool {
        MEASURES.iter().any(|(name, _)| *name == definition)
    }

    /// A problem that is similar to this one.
    pub fn problem(&self, problem: &Value) -> Value {
        Scaler::new(*self, schema().1).root(problem)
    }

    /// A scene that is similar to this one.
    pub fn scene(&self, scene: &Value) -> Value {
        Scaler::new(*self, schema().0).root(scene)
    }
}

/// Exponents of the product of units; `None` where one is unknown.
fn exponents(unit: &str) -> Option<Exponents> {
    let mut total = [0; 4];
    let mut sign = 1;
    let spaced = unit.replace('/', " / ");
    for word in spaced
        .split([' ', '·', '*'])
        .filter(|word| !word.is_empty())
    {
        if word == "/" {
            sign = -1;
            continue;
        }
        let end = word.find(|c: char| c == '^' || c == '-' || c.is_ascii_digit());
        let (symbol, power) = word.split_at(end.unwrap_or(word.len()));
        let power: i32 = match power.trim_start_matches('^') {
            "" => 1,
            digits => digits.parse().ok()?,
        };
        let of = if symbol.is_empty() {
            [0; 4]
        } else {
            of_symbol(symbol)?
        };
        for (sum, exponent) in total.iter_mut().zip(of) {
            *sum += sign * power * exponent;
        }
        sign = 1;
    }
    Some(total)
}

/// Exponents of a symbol with or without a prefix.
fn of_symbol(symbol: &str) -> Option<Exponents> {
    let named = |symbol: &str| {
        Some(match symbol {
            "g" | "t" => [1, 0, 0, 0],
            "m" => [0, 1, 0, 0],
            "s" | "min" => [0, 0, 1, 0],
            "V" => [0, 0, 0, 1],
            "rad" | "deg" | "°" => [0; 4],
            "N" => [1, 1, -2, 0],
            "Pa" | "bar" => [1, -1, -2, 0],
            "J" => [1, 2, -2, 0],
            "W" => [1, 2, -3, 0],
            "C" => [1, 2, -2, -1],
            "A" => [1, 2, -3, -1],
            "F" => [1, 2, -2, -2],
            "Ohm" | "Ω" => [-1, -2, 3, 2],
            _ => return None,
        })
    };
    named(symbol).or_else(|| {
        let mut letters = symbol.chars();
        letters
            .next()
            .filter(|prefix| "TGMkhdcmuµnp".contains(*prefix))?;
        named(letters.as_str())
    })
}

struct Scaler {
    scales: Scales,
    schema: Value,
}

impl Scaler {
    fn new(scales: Scales, schema: Value) -> Self {
        Self { scales, schema }
    }

    fn root(&self, value: &Value) -> Value {
        self.scaled(&self.schema, "", value)
    }

    /// A value at a place of the schema, within the definition of this name.
    fn scaled(&self, schema: &Value, within: &str, value: &Value) -> Value {
        if let Some(text) = value.as_str() {
            return self.text(text).unwrap_or_else(|| value.clone());
        }
        if let Some((name, definition)) = self.definition(schema) {
            let measure = MEASURES.iter().find(|(measure, _)| *measure == name);
            return match (measure, value.as_f64()) {
                (Some((_, unit)), Some(number)) => self.number(number, unit, name),
                _ => self.scaled(definition, name, value),
            };
        }
        if let Some(variant) = self.variant(schema, value) {
            return self.scaled(variant, within, value);
        }
        match value {
            Value::Object(object) => self.object(schema, within, object),
            Value::Array(list) => {
                let of = |k: usize| {
                    let places = schema.get("prefixItems").and_then(|items| items.get(k));
                    places.or(schema.get("items")).unwrap_or(&Value::Null)
                };
                let each = list.iter().enumerate();
                each.map(|(k, entry)| self.scaled(of(k), within, entry))
                    .collect()
            }
            _ => value.clone(),
        }
    }

    fn object(&self, schema: &Value, within: &str, object: &Map<String, Value>) -> Value {
        let of = |key: &str| {
            let named = schema.get("properties").and_then(|of| of.get(key));
            named.or(schema.get("additionalProperties"))
        };
        let entries = object.iter().map(|(key, value)| {
            let weight = WEIGHTS.iter().find(|of| (of.0, of.1) == (within, key));
            let scaled = match (weight, value.as_f64()) {
                (Some((.., unit)), Some(weight)) => Value::from(weight / self.scales.of_unit(unit)),
                _ if key == "relative_permittivity" => self.permittivity(object),
                _ if key.ends_with(".relative_permittivity") => self.in_vacuum(value),
                _ if key == "columns" => self.columns(value),
                _ => self.scaled(of(key).unwrap_or(&Value::Null), within, value),
            };
            (key.clone(), scaled)
        });
        Value::Object(entries.collect())
    }

    fn number(&self, number: f64, unit: &str, name: &str) -> Value {
        assert!(
            unit != UNKNOWN || number == 0.0,
            "a {name} has a unit: {number}"
        );
        match unit {
            UNKNOWN => Value::from(number),
            _ => Value::from(number * self.scales.of_unit(unit)),
        }
    }

    /// A number with a unit; `None` of other texts.
    fn text(&self, text: &str) -> Option<Value> {
        let ends = (1..=text.len())
            .rev()
            .filter(|&end| text.is_char_boundary(end));
        let (number, end) = ends
            .filter_map(|end| Some((text[..end].trim().parse::<f64>().ok()?, end)))
            .next()?;
        let unit = text[end..].trim();
        exponents(unit).filter(|_| !unit.is_empty() && number.is_finite())?;
        let number = number * self.scales.of_unit(unit);
        Some(Value::from(format!("{number:e} {unit}")))
    }

    /// Relative permittivity of a material.
    fn permittivity(&self, material: &Map<String, Value>) -> Value {
        let value = material["relative_permittivity"].as_f64().unwrap();
        let factor = self.scales.of_unit("F/m");
        let stays = (factor - 1.0).abs() < 1e-14;
        let is_ideal = material.get("dielectric").is_some_and(|law| law == "ideal");
        assert!(
            stays || is_ideal,
            "the law of first order has the permittivity of vacuum"
        );
        assert!(
            stays || value * factor >= 1.0,
            "a permittivity below that of vacuum"
        );
        if stays {
            Value::from(value)
        } else {
            Value::from(value * factor)
        }
    }

    /// What stays where the permittivity of vacuum does, such as bounds of a relative one.
    fn in_vacuum(&self, value: &Value) -> Value {
        let factor = self.scales.of_unit("F/m");
        assert!(
            (factor - 1.0).abs() < 1e-14,
            "{value} is relative to vacuum"
        );
        value.clone()
    }

    /// Columns of numbers by headers with units in brackets.
    fn columns(&self, columns: &Value) -> Value {
        let of = |(header, values): (&String, &Value)| {
            let unit = header
                .split_once('[')
                .map(|(_, unit)| unit.trim_end_matches(']'));
            let unit = unit.unwrap_or_else(|| panic!("{header:?} has no unit"));
            let values = values
                .as_array()
                .unwrap()
                .iter()
                .map(|value| match value.as_f64() {
                    Some(number) => Value::from(number * self.scales.of_unit(unit)),
                    None => value.clone(),
                });
            (header.clone(), values.collect())
        };
        Value::Object(columns.as_object().unwrap().iter().map(of).collect())
    }

    /// Name and content of the definition that a place refers to.
    fn definition<'a>(&'a self, schema: &'a Value) -> Option<(&'a str, &'a Value)> {
        let name = schema.get("$ref")?.as_str()?.strip_prefix("#/$defs/")?;
        Some((name, &self.schema["$defs"][name]))
    }

    /// The variant of a place that a value is.
    fn variant<'a>(&'a self, schema: &'a Value, value: &Value) -> Option<&'a Value> {
        let all = schema.get("anyOf").or(schema.get("oneOf"))?.as_array()?;
        all.iter().find(|variant| self.permits(variant, value))
    }

    fn permits(&self, schema: &Value, value: &Value) -> bool {
        if let Some((_, definition)) = self.definition(schema) {
            return self.permits(definition, value);
        }
        if schema.get("anyOf").or(schema.get("oneOf")).is_some() {
            return self.variant(schema, value).is_some();
        }
        let kind = match value {
            Value::Null => "null",
            Value::Bool(_) => "boolean",
            Value::Number(_) => "number",
            Value::String(_) => "string",
            Value::Array(_) => "array",
            Value::Object(_) => "object",
        };
        let is_kind = |name: &Value| name == kind || (kind == "number" && name == "integer");
        let has_kind = match schema.get("type") {
            None => true,
            Some(Value::Array(kinds)) => kinds.iter().any(is_kind),
            Some(name) => is_kind(name),
        };
        let names = |object: &Map<String, Value>| {
            let properties = schema.get("properties");
            let is_known = |key: &String| properties.is_some_and(|of| of.get(key).is_some());
            let others = schema.get("additionalProperties");
            others.is_some_and(Value::is_object) || object.keys().all(is_known)
        };
        has_kind && value.as_object().is_none_or(names)
    }
}

/// Columns of a CSV file by their headers.
fn columns_of(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().unwrap().split(',');
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let values = |j: usize| -> Value {
        let cells = rows.iter().map(|row| row[j].parse::<f64>().ok());
        cells.map(Value::from).collect()
    };
    let columns = header
        .enumerate()
        .map(|(j, name)| (name.to_owned(), values(j)));
    Value::Object(columns.collect())
}

/// A problem of a file of this repository with its scene and recordings, without references to schemas.
pub fn problem_of(path: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let read = |path: &Path| -> Value {
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    };
    let mut problem = read(&path);
    if let Some(scene) = problem["scene"].as_str() {
        problem["scene"] = read(&path.parent().unwrap().join(scene));
    }
    let recordings = problem.pointer_mut("/identify/recordings");
    for recording in recordings
        .and_then(Value::as_array_mut)
        .into_iter()
        .flatten()
    {
        let recording = recording.as_object_mut().unwrap();
        if let Some(file) = recording.remove("file") {
            let table = columns_of(&path.parent().unwrap().join(file.as_str().unwrap()));
            recording.insert("columns".into(), table);
        }
    }
    problem.as_object_mut().unwrap().remove("$schema");
    problem["scene"].as_object_mut().unwrap().remove("$schema");
    problem
}
