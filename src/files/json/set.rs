//! Overrides from the command line: `control.intervals=80`, `scene.muscles[0].material=silicone`, `scene.springs.stay.stiffness=200`.

use serde_json::Value;
use std::borrow::Cow;

use crate::files::json::document::Document;
use crate::files::json::error::{Mistake, Result, SceneError};
use crate::files::json::path::{JsonPath, Step};
use crate::files::json::scope::list;
use crate::files::json::tree::{Json, Tree};

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
    pub(crate) fn parse(written: &str) -> Result<Self> {
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

    /// Reads several.
    pub(crate) fn parse_each(written: &[String]) -> Result<Vec<Self>> {
        written.iter().map(|written| Self::parse(written)).collect()
    }

    /// Refuses two overrides of one place, which `place` tells.
    pub(crate) fn check(written: &[String], place: impl Fn(&Self) -> JsonPath) -> Result<()> {
        let mut known: Vec<(JsonPath, Self)> = Vec::with_capacity(written.len());
        for next in Self::parse_each(written)? {
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
    pub(crate) fn apply(&self, document: &mut Document) -> Result<()> {
        let way = Way::to(&self.place, document.json());
        if let Some((found, expected)) = way.obstacle(&self.place) {
            let file = document.path.display().to_string();
            let found = format!("{found} in {:?}", self.written);
            return Err(Mistake {
                path: self.place.to_string(),
                overridden: Some(self.typed.clone()),
                ..Mistake::of_file(file, found, expected)
            }
            .into());
        }
        let place = way.whole();
        document.set(&place, &self.value.to_string(), &self.typed);
        Ok(())
    }
}

/// A mistake of what is typed, of an override with its place.
fn typed_wrong(place: Option<JsonPath>, found: String, expected: &str) -> SceneError {
    let mistake = Mistake {
        path: place.as_ref().map_or_else(String::new, JsonPath::to_string),
        overridden: place,
        ..Mistake::of_file("command line", found, expected)
    };
    mistake.into()
}

/// The value in a place of a text, where there is one.
pub(crate) fn value_at(text: &str, place: &JsonPath) -> Option<Value> {
    let tree = Tree::of(text.to_owned());
    let way = Way::to(place, tree.json());
    way.missing.is_empty().then(|| way.end.read().ok())?
}

/// A place of a text with the entries of lists by their indices.
pub(crate) fn resolved(text: &str, place: &JsonPath) -> JsonPath {
    Way::to(place, Tree::of(text.to_owned()).json()).whole()
}

/// Parts of a scene for which a chain stands.
const OF_CHAIN: [&str; 3] = ["bodies", "joints", "muscles"];

/// The way to a place, as far as there are values.
struct Way<'a> {
    /// The steps that are there, entries of lists by their indices.
    steps: Vec<Step>,
    /// The value to which they lead.
    end: Json<'a>,
    /// The other steps.
    missing: &'a [Step],
}

impl<'a> Way<'a> {
    fn to(place: &'a JsonPath, whole: Json<'a>) -> Self {
        let mut way = Self {
            steps: Vec::new(),
            end: whole,
            missing: &place.0,
        };
        while let Some((step, further)) = way.missing.split_first() {
            let index = step.key().and_then(|name| index_of(way.end, name));
            let step = index.map_or_else(|| step.clone(), Step::Index);
            let Some(next) = way.end.step(&step) else {
                break;
            };
            way.steps.push(step);
            (way.end, way.missing) = (next, further);
        }
        way
    }

    /// The place with entries of lists by their indices.
    fn whole(&self) -> JsonPath {
        JsonPath([&self.steps[..], self.missing].concat())
    }

    /// The value found in place of a way, and the value expected: objects that are missing are made, and a key without a meaning is found
    /// when the file is read.
    fn obstacle(&self, place: &JsonPath) -> Option<(String, String)> {
        self.missing.first()?;
        let end = self.end;
        let is_object = end.first() == Some('{');
        if let ([Step::Key(key), _, ..], true) = (self.missing, is_object)
            && OF_CHAIN.contains(&key.as_str())
            && end.entry("chain").is_some()
        {
            let found = format!("an entry of {key:?}, which a chain stands for,");
            let expected = "an entry of the chain, such as scene.chain.muscles.arm; `proboscis expand` writes its parts out";
            return Some((found, expected.to_owned()));
        }
        let missing = match is_object {
            true => self.missing.iter().position(|step| step.key().is_none())?,
            false => 0,
        };
        let parent = match (missing, &place.0[..self.steps.len()]) {
            (0, []) => "the file".to_owned(),
            (0, there) => JsonPath(there.to_vec()).to_string(),
            _ => JsonPath(self.missing[..missing].to_vec()).to_string(),
        };
        let is_list = end.first() == Some('[');
        Some(match &self.missing[missing] {
            Step::Key(key) if is_list => {
                let names: Vec<_> = end.parts().filter_map(name_of).take(NAMES).collect();
                let expected = match names.is_empty() {
                    true => format!("no key, as {parent} is a list without names"),
                    false => format!(
                        "an index from 0 to {}, or a name in {parent}, such as {}",
                        end.parts().len() - 1,
                        list(names.iter())
                    ),
                };
                (format!("the name {key:?}"), expected)
            }
            Step::Key(key) => {
                let expected = format!("no key, as {parent} is no object");
                (format!("the key {key:?}"), expected)
            }
            Step::Index(index) => {
                let expected = match is_list {
                    true => {
                        let length = end.parts().len();
                        format!("an index below {length}, the length of {parent}")
                    }
                    false => format!("no index, as {parent} is no list"),
                };
                (format!("the index {index}"), expected)
            }
        })
    }
}

/// Maximum number of names of a list that are shown.
const NAMES: usize = 20;

/// The name of an object in a list.
fn name_of(object: Json<'_>) -> Option<Cow<'_, str>> {
    object.entry("name")?.string()
}

/// Index of the entry of a list that has a name.
fn index_of(list: Json<'_>, name: &str) -> Option<usize> {
    let mut parts = list.parts().filter(|_| list.first() == Some('['));
    parts.position(|part| name_of(part).as_deref() == Some(name))
}
