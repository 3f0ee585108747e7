//! Messages of serde in the words of this project: the value found, the value expected, the nearest name.

use crate::files::json::error::nearest;

/// A message of serde, taken apart.
pub(crate) struct Wording {
    pub(crate) found: String,
    pub(crate) expected: String,
    pub(crate) nearest: Option<String>,
    /// True if the key is wrong, not its value.
    pub(crate) at_key: bool,
}

/// Takes a message of serde apart; `key` is the last key of its place.
pub(crate) fn wording(key: Option<&str>, message: &str) -> Wording {
    let message = message.trim_end();
    let (problem, expected) = message
        .rsplit_once(", expected ")
        .or_else(|| message.rsplit_once(", there are "))
        .unwrap_or((message, ""));
    let plain = |found: String, expected: String| Wording {
        found,
        expected,
        nearest: None,
        at_key: false,
    };
    if problem.starts_with("unknown field ") {
        return unknown_key(key.unwrap_or_default(), expected);
    }
    if let Some(variant) = problem.strip_prefix("unknown variant ") {
        return unknown_word(variant, expected);
    }
    if let Some(field) = problem.strip_prefix("missing field ") {
        let field = field.trim_matches('`');
        return plain(format!("no key {field:?}"), format!("the key {field:?}"));
    }
    let found = ["invalid type: ", "invalid value: ", "invalid length "]
        .into_iter()
        .find_map(|prefix| problem.strip_prefix(prefix))
        .unwrap_or(problem);
    let count = if problem.starts_with("invalid length ") {
        "a list of length "
    } else {
        ""
    };
    plain(format!("{count}{}", json_word(found)), json_word(expected))
}

/// Error of a word that is none of those `expected`, which are in backticks, or next to other kinds of value: then the words are shown with the
/// wrong one.
fn unknown_word(variant: &str, expected: &str) -> Wording {
    let (variant, words) = variant.split_once(AMONG).unwrap_or((variant, expected));
    let variant = variant.trim_matches('`');
    let said = not_offered(variant);
    Wording {
        nearest: nearest(variant, quoted(words)).filter(|_| said.is_none()),
        found: found(format!("{variant:?}"), said),
        expected: match words == expected {
            true => one_of(expected),
            false => expected.to_owned(),
        },
        at_key: false,
    }
}

fn unknown_key(key: &str, expected: &str) -> Wording {
    let said = not_offered(key);
    Wording {
        nearest: nearest(key, quoted(expected)).filter(|_| said.is_none()),
        found: found(format!("the key {key:?}"), said),
        expected: one_of(expected),
        at_key: true,
    }
}

/// Describes the value found, with the message about it.
fn found(what: String, said: Option<String>) -> String {
    match said {
        Some(said) => format!("{what}, {said}"),
        None => what,
    }
}

/// Between a wrong word and the words of its kind, where other kinds of value are expected too; no text of a file has it.
const AMONG: char = '\u{1f}';

/// The message of serde of a word that is none of its kind, where a value of another `kind` may stand too.
pub(crate) fn beside(message: &str, kind: &str) -> Option<String> {
    let (problem, words) = message.rsplit_once(", expected ")?;
    problem
        .starts_with("unknown variant ")
        .then(|| format!("{problem}{AMONG}{words}, expected {kind}"))
}

/// The names between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`')
        .skip(1)
        .step_by(2)
        .filter(|name| !name.starts_with('$'))
}

fn one_of(expected: &str) -> String {
    let names: Vec<String> = quoted(expected).map(|name| format!("{name:?}")).collect();
    match names.as_slice() {
        [] => "no key here".to_owned(),
        [name] => name.clone(),
        names => format!("one of {}", names.join(", ")),
    }
}

/// Words of JSON for words of Rust.
fn json_word(text: &str) -> String {
    let word = match text {
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
        "an array of length 2" => "a list of 2 values",
        "an array of length 3" | "fewer elements in array" => "a list of 3 values",
        _ if text.starts_with("struct ") => "an object",
        _ => text,
    };
    let word = word.strip_prefix("string ").unwrap_or(word);
    word.replace('`', "")
}

/// Place of the list of the limits.
const LIMITS: &str = "docs/accuracy.md#limits-of-validity";

/// Words in the singular, in lower case with underscores, and what is said of them.
const TABLE: [(&[&str], &str); 6] = [
    (
        &["contact", "collision", "impact", "restitution", "obstacle"],
        "there is no contact; \"limits\" of a \"control\" keep markers out of regions",
    ),
    (
        &["friction", "coulomb_friction", "stiction"],
        "there is no friction; \"damping\" and \"viscosity\" are viscous",
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
        &["shell", "membrane", "beam", "cloth", "tet4", "tet10"],
        "elements are hexahedra",
    ),
];

/// Returns the message about a word that stands for a feature that is not offered.
pub(super) fn not_offered(word: &str) -> Option<String> {
    let word = word.to_lowercase().replace([' ', '-'], "_");
    let is_meant = |known: &&str| *known == word || word.strip_suffix('s') == Some(known);
    let (_, said) = TABLE.iter().find(|(words, _)| words.iter().any(is_meant))?;
    Some(format!("which is not offered ({said}: {LIMITS})"))
}
