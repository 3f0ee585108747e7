//! Overrides from the command line: `control.intervals=80`, `scene.muscles[0].material=silicone`.

use serde_json::{Map, Value};

use crate::files::json::document::Document;
use crate::files::json::error::{Mistake, SceneError};
use crate::files::json::locate::{JsonPath, Step};

/// Longest path of an override; files are not nested deeper.
const DEEPEST: usize = 64;

/// An override: a place and the value to put there.
#[derive(Clone, Debug)]
pub(crate) struct Override {
    pub(crate) place: JsonPath,
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
                place,
                value: serde_json::from_str(value).unwrap_or_else(|_| value.trim().into()),
                written: written.to_owned(),
            })
        };
        parts.and_then(read).ok_or_else(|| {
            let mistake = Mistake {
                file: "command line".to_owned(),
                path: String::new(),
                found: format!("{written:?}"),
                expected: "path=value, such as control.intervals=80".to_owned(),
                nearest: None,
                source: None,
                overridden: false,
            };
            mistake.into()
        })
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
        document.set.push(changed(&document.value, &self.place));
        match slot(&mut document.value, &self.place) {
            Ok(slot) => *slot = self.value.clone(),
            Err((found, expected)) => {
                let found = format!("{found} in {:?}", self.written);
                return Err(document.mistake(&self.place, found, expected));
            }
        }
        Ok(())
    }
}

/// The place itself, or the first one on the way to it that is not there yet.
fn changed(root: &Value, place: &JsonPath) -> JsonPath {
    let mut value = Some(root);
    let missing = place.0.iter().position(|step| {
        value = value.and_then(|value| match step {
            Step::Key(key) => value.get(key),
            Step::Index(index) => value.get(index),
        });
        value.is_none()
    });
    match missing {
        Some(position) => JsonPath(place.0[..=position].to_vec()),
        None => place.clone(),
    }
}

/// Where a value goes; otherwise what was found and what is expected.
fn slot<'a>(root: &'a mut Value, place: &JsonPath) -> Result<&'a mut Value, (String, String)> {
    let mut value = root;
    for (position, step) in place.0.iter().enumerate() {
        let parent = match position {
            0 => "the file".to_owned(),
            _ => JsonPath(place.0[..position].to_vec()).to_string(),
        };
        value = match (step, value) {
            // What is not there yet is made; a key that has no meaning is found when the file is read.
            (Step::Key(key), Value::Object(entries)) => {
                let next = place.0.get(position + 1);
                entries.entry(key.clone()).or_insert_with(|| match next {
                    Some(Step::Key(_)) => Value::Object(Map::new()),
                    _ => Value::Null,
                })
            }
            (Step::Index(index), Value::Array(entries)) => {
                let length = entries.len();
                entries.get_mut(*index).ok_or_else(|| {
                    let expected = format!("an index below {length}, the length of {parent}");
                    (format!("the index {index}"), expected)
                })?
            }
            (Step::Key(key), _) => {
                let found = format!("the key {key:?}");
                return Err((found, format!("no key, as {parent} is no object")));
            }
            (Step::Index(index), _) => {
                let found = format!("the index {index}");
                return Err((found, format!("no index, as {parent} is no list")));
            }
        };
    }
    Ok(value)
}
