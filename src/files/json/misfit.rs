//! Values that do not fit a type, as serde tells them, in the words of this project: the value found, the value expected, the nearest name.

use serde::de::{Error, Expected, Unexpected};
use serde_json::Value;
use std::fmt::{self, Display};

use crate::files::json::error::nearest;
use crate::files::json::path::{JsonPath, Step};

/// A value or key that does not fit.
#[derive(Debug)]
pub(crate) struct Misfit {
    /// Steps to it, the last one first.
    steps: Vec<Step>,
    pub(crate) found: String,
    pub(crate) expected: String,
    pub(crate) nearest: Option<String>,
    kind: Kind,
}

/// Kind of what is wrong.
#[derive(Debug, PartialEq)]
enum Kind {
    Value,
    /// A word that is none of those of a type.
    Word,
    /// A key that is none of those of a type.
    Key,
}

impl Misfit {
    fn of(found: String, expected: String) -> Self {
        Self {
            steps: Vec::new(),
            found,
            expected,
            nearest: None,
            kind: Kind::Value,
        }
    }

    /// Of a name that is none of those `known`.
    fn of_name(kind: Kind, name: &str, known: &[&str]) -> Self {
        let names = known.iter().filter(|name| !name.starts_with('$'));
        let quoted: Vec<String> = names.clone().map(|name| format!("{name:?}")).collect();
        let expected = match quoted.as_slice() {
            [] => "no key here".to_owned(),
            [name] => name.clone(),
            names => format!("one of {}", names.join(", ")),
        };
        let what = if kind == Kind::Key { "the key " } else { "" };
        let said = not_offered(name);
        let found = format!("{what}{name:?}{}", said.as_deref().unwrap_or_default());
        Self {
            nearest: nearest(name, names.copied()).filter(|_| said.is_none()),
            kind,
            ..Self::of(found, expected)
        }
    }

    /// The same, one step further inside.
    pub(crate) fn inside(mut self, step: Step) -> Self {
        self.steps.push(step);
        self
    }

    /// Its place.
    pub(crate) fn place(&self) -> JsonPath {
        JsonPath(self.steps.iter().rev().cloned().collect())
    }

    /// The same, where other kinds of value may stand too: of a word alone that is none of its kind.
    pub(crate) fn beside(mut self, expected: String) -> Self {
        if self.is_of_word() && self.steps.is_empty() {
            self.expected = expected;
        }
        self
    }

    /// Returns true if a word is wrong.
    pub(crate) fn is_of_word(&self) -> bool {
        self.kind == Kind::Word
    }

    /// Returns true if the key is wrong, not its value.
    pub(crate) fn is_of_key(&self) -> bool {
        self.kind == Kind::Key
    }
}

impl Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found {}, expected {}", self.found, self.expected)
    }
}

impl std::error::Error for Misfit {}

impl Error for Misfit {
    fn custom<T: Display>(message: T) -> Self {
        let message = message.to_string();
        let (found, expected) = message.rsplit_once(", expected ").unwrap_or((&message, ""));
        Self::of(json_word(found), json_word(expected))
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::of(json_kind(found), json_word(expected))
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Self::of(json_kind(found), json_word(expected))
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Self::of(format!("a list of length {length}"), json_word(expected))
    }

    fn unknown_variant(word: &str, known: &'static [&'static str]) -> Self {
        Self::of_name(Kind::Word, word, known)
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        Self::of_name(Kind::Key, key, known)
    }

    fn missing_field(key: &'static str) -> Self {
        Self::of(format!("no key {key:?}"), format!("the key {key:?}"))
    }
}

/// The value found as JSON has it.
fn json_kind(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Unit => "null".to_owned(),
        Unexpected::Float(number) => format!("floating point {}", Value::from(number)),
        other => json_word(other),
    }
}

/// Words of JSON for words of Rust.
fn json_word(text: impl Display) -> String {
    let text = text.to_string();
    if let Some(length) = text.strip_prefix("an array of length ") {
        return format!("a list of {length} values");
    }
    let word = match text.as_str() {
        "usize" | "u32" | "u64" => "a whole number, 0 or more",
        "f64" => "a number",
        "a map" | "map" => "an object",
        "a sequence" | "sequence" => "a list",
        "a boolean" => "true or false",
        "a string" | "a borrowed string" => "a text",
        "string or map" => "a text or an object",
        "null" => "null",
        "unit variant" => "a word alone",
        "newtype variant" => "an object with this key",
        _ if text.starts_with("struct ") => "an object",
        text => text,
    };
    let word = word.strip_prefix("string ").unwrap_or(word);
    word.replace('`', "")
}

/// Place of the list of the limits.
const LIMITS: &str = "docs/accuracy.md#limits-of-validity";

/// Words in the singular, in lower case with underscores, and what is said of them.
const TABLE: [(&[&str], &str); 6] = [
    (
        &["collision", "impact", "obstacle"],
        "\"contacts\" are pairs that a scene names; \"limits\" of a \"control\" keep markers out of regions",
    ),
    (
        &["coulomb_friction", "stiction"],
        "\"contacts\" have a \"friction\", which creeps where it sticks without \"stick\"; joints have a viscous \"damping\"",
    ),
    (
        &["fluid", "drag", "aerodynamics", "buoyancy"],
        "there is no fluid",
    ),
    (
        &["temperature", "thermal_expansion", "heat"],
        "there is no temperature",
    ),
    (
        &[
            "plasticity",
            "yield_stress",
            "damage",
            "fatigue",
            "fracture",
        ],
        "materials are elastic and viscous; they neither yield nor break",
    ),
    (
        &["shell", "beam", "cloth"],
        "elements are hexahedra, tetrahedra and membranes, which are solids with a thickness",
    ),
];

/// Returns the end of a message about a word that stands for a feature that is not offered.
fn not_offered(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace([' ', '-'], "_");
    let is_meant = |known: &&str| *known == word || word.strip_suffix('s') == Some(known);
    let (_, said) = TABLE.iter().find(|(words, _)| words.iter().any(is_meant))?;
    Some(format!(", which is not offered ({said}: {LIMITS})"))
}
