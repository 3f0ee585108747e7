//! Overrides from the command line: `control.intervals=80`, `scene.muscles[0].material=silicone`, `scene.springs.stay.stiffness=200`.

use serde_json::Value;
use std::ops::Range;

use crate::files::json::document::{Document, Set};
use crate::files::json::error::{Mistake, SceneError};
use crate::files::json::locate::{JsonPath, Step};
use crate::files::json::scan::{Scanner, string};
use crate::files::json::scope::list;

/// Longest path of an override; files are not nested deeper.
const DEEPEST: usize = 64;

/// An override: a place and the value to put there.
#[derive(Clone, Debug)]
pub(crate) struct Override {
    pub(crate) place: JsonPath,
    /// The place as it was typed.
    typed: JsonPath,
    value: Value,
    written: String,
}

impl Override {
    /// Reads `path=value`; a value that is no JSON is a text.
    pub(crate) fn parse(written: &str) -> Result<Self, SceneError> {
        let parts = written.split_once('=');
        let read = |(path, value): (&str, &str)| {
            let place = JsonPath::parse(path.trim()).filter(|place| place.0.len() <= DEEPEST)?;
            Some(Self {
                typed: place.clone(),
                place,
                value: serde_json::from_str(value).unwrap_or_else(|_| value.trim().into()),
                written: written.to_owned(),
            })
        };
        let expected = "path=value, such as control.intervals=80";
        (parts.and_then(read)).ok_or_else(|| typed_wrong(None, format!("{written:?}"), expected))
    }

    /// Refuses two overrides of one place, which `place` tells.
    pub(crate) fn check(
        written: &[String],
        place: impl Fn(&Self) -> JsonPath,
    ) -> Result<(), SceneError> {
        let mut known: Vec<(JsonPath, Self)> = Vec::with_capacity(written.len());
        for written in written {
            let next = Self::parse(written)?;
            let place = place(&next);
            if let Some((_, known)) = known.iter().find(|(known, _)| *known == place) {
                let found = format!("{:?} and {:?}", known.written, next.written);
                return Err(typed_wrong(Some(next.typed), found, "one value"));
            }
            known.push((place, next));
        }
        Ok(())
    }

    /// A value for a place.
    pub(crate) fn new(place: JsonPath, value: Value) -> Self {
        Self {
            typed: place.clone(),
            written: place.to_string(),
            place,
            value,
        }
    }

    /// The same inside the scene, where its path begins with `scene.` and goes on.
    pub(crate) fn in_scene(&self) -> Option<Self> {
        match self.place.0.as_slice() {
            [Step::Key(first), rest @ ..] if first == "scene" && !rest.is_empty() => Some(Self {
                place: JsonPath(rest.to_vec()),
                ..self.clone()
            }),
            _ => None,
        }
    }

    /// Puts the value in its place.
    pub(crate) fn apply(&self, document: &mut Document) -> Result<(), SceneError> {
        let Slot {
            place,
            bytes,
            missing,
            wrong,
        } = slot(document.text(), &self.place);
        document.set.push(Set {
            place,
            typed: self.typed.clone(),
        });
        if let Some((found, expected)) = wrong {
            let found = format!("{found} in {:?}", self.written);
            return Err(document.mistake(&self.place, found, expected));
        }
        document.replace(bytes, &missing.written(&self.value));
        Ok(())
    }
}

/// A mistake of what is typed, of an override with its place.
fn typed_wrong(place: Option<JsonPath>, found: String, expected: &str) -> SceneError {
    let mistake = Mistake {
        file: "command line".to_owned(),
        path: place.as_ref().map_or_else(String::new, JsonPath::to_string),
        found,
        expected: expected.to_owned(),
        nearest: None,
        source: None,
        overridden: place,
    };
    mistake.into()
}

/// The value in a place of a text, where there is one.
pub(crate) fn value_at(text: &str, place: &JsonPath) -> Option<Value> {
    let slot = slot(text, place);
    let is_there = slot.wrong.is_none() && slot.missing.keys.is_empty();
    is_there.then(|| serde_json::from_str(&text[slot.bytes]).ok())?
}

/// A place of a text with the entries of lists by their indices.
pub(crate) fn resolved(text: &str, place: &JsonPath) -> JsonPath {
    let mut out = slot(text, place).place;
    let known = out.0.len();
    out.0.extend(place.0[known..].iter().cloned());
    out
}

/// Parts of a scene for which a chain stands.
const OF_CHAIN: [&str; 3] = ["bodies", "joints", "muscles"];

/// Destination of a value.
struct Slot {
    /// The place itself, entries of lists by their indices, or the first place on the way to it that is not there yet.
    place: JsonPath,
    /// The bytes in whose place it is written.
    bytes: Range<usize>,
    missing: Missing,
    /// Value that was found in place of a way there, and the value expected.
    wrong: Option<(String, String)>,
}

/// Missing part of the way to a value.
#[derive(Default)]
struct Missing {
    /// Keys, one inside the other.
    keys: Vec<String>,
    /// True if there are other keys next to the first one.
    has_others: bool,
}

impl Missing {
    /// The text that makes the way, and stands for the value at its end.
    fn written(&self, value: &Value) -> String {
        let key = |key: &String| format!("{}:", Value::from(key.as_str()));
        let way: Vec<String> = self.keys.iter().map(key).collect();
        let inside = self.keys.len().saturating_sub(1);
        let comma = if self.has_others { "," } else { "" };
        format!("{}{value}{}{comma}", way.join("{"), "}".repeat(inside))
    }
}

/// Finds the destination of a value: a missing way is made, and a key that has no meaning is found when the file is read.
fn slot(text: &str, place: &JsonPath) -> Slot {
    let mut slot = Slot {
        place: JsonPath::default(),
        bytes: Scanner::of(text).value().unwrap_or_default(),
        missing: Missing::default(),
        wrong: None,
    };
    for (position, step) in place.0.iter().enumerate() {
        let inside = Scanner::from(text, slot.bytes.start);
        let opens = inside.peek();
        let parent = match position {
            0 => "the file".to_owned(),
            _ => JsonPath(place.0[..position].to_vec()).to_string(),
        };
        let (here, value) = match (step, opens) {
            (Step::Key(key), Some(b'{')) => (step.clone(), inside.entry(key)),
            (Step::Key(key), Some(b'[')) => {
                let index = index_of(text, inside, key);
                let entry = index.and_then(|index| inside.entries().nth(index));
                (index.map_or(step.clone(), Step::Index), entry)
            }
            (Step::Index(index), Some(b'[')) => (step.clone(), inside.entries().nth(*index)),
            _ => (step.clone(), None),
        };
        slot.place.0.push(here);
        match value {
            Some(entry) => slot.bytes = entry.value,
            None if opens == Some(b'{') && matches!(step, Step::Key(_)) => {
                return slot.made(text, inside, &place.0[position..]);
            }
            None => {
                slot.wrong = Some(no_way(text, inside, step, &parent));
                return slot;
            }
        }
    }
    slot
}

impl Slot {
    /// In an object without the first of these steps.
    fn made(mut self, text: &str, object: Scanner<'_>, steps: &[Step]) -> Self {
        if let [Step::Key(key), _, ..] = steps
            && OF_CHAIN.contains(&key.as_str())
            && object.entry("chain").is_some()
        {
            let found = format!("an entry of {key:?}, which a chain stands for,");
            let expected = "an entry of the chain, such as scene.chain.muscles.arm; `proboscis expand` writes its parts out";
            self.wrong = Some((found, expected.to_owned()));
            return self;
        }
        for (position, step) in steps.iter().enumerate() {
            match step {
                Step::Key(key) => self.missing.keys.push(key.clone()),
                Step::Index(index) => {
                    let parent = JsonPath(steps[..position].to_vec());
                    let expected = format!("no index, as {parent} is no list");
                    self.wrong = Some((format!("the index {index}"), expected));
                    return self;
                }
            }
        }
        self.missing.has_others = object.entries().next().is_some();
        // Behind the brace.
        let start = Scanner::from(text, self.bytes.start).at + 1;
        self.bytes = start..start;
        self
    }
}

/// The name of an object in a list.
fn name_of<'a>(text: &'a str, object: Range<usize>) -> Option<std::borrow::Cow<'a, str>> {
    let inside = Scanner::from(text, object.start);
    (inside.peek() == Some(b'{')).then_some(())?;
    string(text, inside.entry("name")?.value)
}

/// Index of the entry of a list that has a name.
fn index_of(text: &str, list: Scanner<'_>, name: &str) -> Option<usize> {
    let named = |range| name_of(text, range).as_deref() == Some(name);
    list.entries().position(|entry| named(entry.value))
}

/// Maximum number of names of a list that are shown.
const NAMES: usize = 20;

/// Returns the value that was found in place of one that goes on as a step does, and the value expected.
fn no_way(text: &str, inside: Scanner<'_>, step: &Step, parent: &str) -> (String, String) {
    let is_list = inside.peek() == Some(b'[');
    let length = inside.entries().count();
    match step {
        Step::Key(key) if is_list => {
            let names = inside.entries().filter_map(|one| name_of(text, one.value));
            let names: Vec<_> = names.take(NAMES).collect();
            let expected = match (names.is_empty(), length) {
                (true, _) => format!("no key, as {parent} is a list without names"),
                (false, length) => format!(
                    "an index from 0 to {}, or a name in {parent}, such as {}",
                    length - 1,
                    list(names.iter())
                ),
            };
            (format!("the name {key:?}"), expected)
        }
        Step::Key(key) => {
            let expected = format!("no key, as {parent} is no object");
            (format!("the key {key:?}"), expected)
        }
        Step::Index(index) if is_list => {
            let expected = format!("an index below {length}, the length of {parent}");
            (format!("the index {index}"), expected)
        }
        Step::Index(index) => {
            let expected = format!("no index, as {parent} is no list");
            (format!("the index {index}"), expected)
        }
    }
}
