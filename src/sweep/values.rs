//! The values of one entry: those of a list, or of a range of quantities.

use serde_json::{Value, json};

use crate::files::sweep::{RangeSpec, SpacingSpec, VarySpec};
use crate::files::{SceneError, Scope};
use crate::math::Random;

/// Most values of a range.
const MOST: usize = 100_000;

/// The values that an entry takes.
#[derive(Debug)]
pub(super) enum Values {
    List(Vec<Value>),
    Range(Range),
}

/// A range of quantities of one unit.
#[derive(Debug)]
pub(super) struct Range {
    ends: [f64; 2],
    /// Text after the number, with its space; nothing for plain numbers.
    unit: Option<String>,
    spacing: SpacingSpec,
    count: Option<usize>,
}

impl Values {
    /// Reads the values of an entry.
    pub(super) fn from_spec(written: &VarySpec, scope: &Scope<'_>) -> Result<Self, SceneError> {
        match written {
            VarySpec::Values(values) if values.is_empty() => {
                Err(scope.wrong("an empty list", "1 value or more"))
            }
            VarySpec::Values(values) => Ok(Self::List(values.clone())),
            VarySpec::Range(range) => Range::from_spec(range, scope).map(Self::Range),
        }
    }

    /// All of them, in their order.
    pub(super) fn all(&self, scope: &Scope<'_>) -> Result<Vec<Value>, SceneError> {
        match self {
            Self::List(values) => Ok(values.clone()),
            Self::Range(range) => {
                let Some(count) = range.count else {
                    let expected = "\"count\", unless values are drawn at random";
                    return Err(scope.wrong("no key \"count\"", expected));
                };
                let at = |i: usize| range.at(i as f64 / (count - 1) as f64);
                Ok((0..count).map(at).collect())
            }
        }
    }

    /// One of them at random.
    pub(super) fn draw(&self, random: &mut Random) -> Value {
        let part = random.between(0.0, 1.0);
        match self {
            Self::List(values) => {
                let index = (part * values.len() as f64) as usize;
                values[index.min(values.len() - 1)].clone()
            }
            Self::Range(range) => range.at(part),
        }
    }
}

impl Range {
    fn from_spec(written: &RangeSpec, scope: &Scope<'_>) -> Result<Self, SceneError> {
        let expected = "a number, or a text such as \"50 kPa\"";
        let end = |name: &str, value: &Value| {
            parts(value).ok_or_else(|| scope.key(name).wrong(value.to_string(), expected))
        };
        let (from, unit) = end("from", &written.from)?;
        let (to, other) = end("to", &written.to)?;
        if unit != other {
            let expected = "the unit of \"from\"";
            return Err(scope.key("to").wrong(written.to.to_string(), expected));
        }
        if written.spacing == SpacingSpec::Logarithmic && !(from > 0.0 && to > 0.0) {
            let found = format!("{from} to {to}");
            return Err(scope.wrong(found, "values above zero for logarithmic spacing"));
        }
        if let Some(count) = written.count.filter(|count| !(2..=MOST).contains(count)) {
            let expected = format!("a number of values from 2 to {MOST}");
            return Err(scope.key("count").wrong(count.to_string(), expected));
        }
        Ok(Self {
            ends: [from, to],
            unit,
            spacing: written.spacing,
            count: written.count,
        })
    }

    /// The value at a part of the way.
    fn at(&self, part: f64) -> Value {
        let [from, to] = self.ends;
        let number = match self.spacing {
            _ if part == 0.0 => from,
            _ if part == 1.0 => to,
            SpacingSpec::Linear => from + part * (to - from),
            SpacingSpec::Logarithmic => from * (to / from).powf(part),
        };
        match &self.unit {
            Some(unit) => json!(format!("{number}{unit}")),
            None => json!(number),
        }
    }
}

/// Number and unit of a value.
fn parts(value: &Value) -> Option<(f64, Option<String>)> {
    if let Some(number) = value.as_f64() {
        return Some((number, None));
    }
    let text = value.as_str()?;
    let end = text.find(' ').unwrap_or(text.len());
    let number: f64 = text[..end].parse().ok()?;
    number
        .is_finite()
        .then(|| (number, Some(text[end..].to_owned())))
}
