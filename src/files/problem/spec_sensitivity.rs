//! Sensitivities as they are written.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

use crate::files::units::quantity::{Quantity, SoughtConstant};

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
