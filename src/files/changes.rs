//! Overrides that a study or a sweep writes, with the places that they are from.

use crate::files::json::error::{Result, SceneError};
use crate::files::json::path::JsonPath;
use crate::files::json::scope::{Scope, refuse};
use crate::files::study::ChangesSpec;
use serde_json::Value;
use std::path::Path;

/// Overrides with the places in their file that they are from.
#[derive(Clone, Default)]
pub(crate) struct Changes<'a> {
    pub(crate) words: Vec<String>,
    pub(crate) from: Vec<(JsonPath, Scope<'a>)>,
}

impl<'a> Changes<'a> {
    /// Changes of the scene, which stand at a place.
    pub(crate) fn of_scene<'s>(
        set: impl IntoIterator<Item = (&'s String, &'s Value)>,
        scope: &Scope<'a>,
        expected: &str,
    ) -> Result<Self> {
        let mut changes = Self::default();
        for (key, value) in set {
            let place = scope.key(key);
            refuse!(if !key.starts_with("scene."), place;
                found format!("the key {key:?}"), expected expected);
            changes.push(key, value, place)?;
        }
        Ok(changes)
    }

    pub(crate) fn extend(&mut self, set: &ChangesSpec, scope: &Scope<'a>) -> Result<()> {
        let mut each = set.iter();
        each.try_for_each(|(key, value)| self.push(key, value, scope.key(key)))
    }

    pub(crate) fn push(&mut self, key: &str, value: &Value, scope: Scope<'a>) -> Result<()> {
        let Some(place) = JsonPath::parse(key) else {
            let expected = "a place in the problem, such as control.intervals";
            return Err(scope.wrong(format!("the key {key:?}"), expected));
        };
        self.words.push(format!("{key}={}", word(value)));
        self.from.push((place, scope));
        Ok(())
    }

    /// Moves an error of an override to its place in that file; any other stays where it is.
    pub(crate) fn at_fault(&self, error: SceneError, file: &Path) -> SceneError {
        let Some(typed) = error.overridden() else {
            return error;
        };
        let mut from = self.from.iter().rev();
        let Some((_, scope)) = from.find(|(place, _)| place == typed) else {
            return error;
        };
        let found = format!(
            "{} for {} of {}",
            error.found(),
            error.path(),
            file.display()
        );
        let nearest = error.nearest();
        let hint = nearest.map_or_else(String::new, |name| format!("; did you mean {name:?}?"));
        scope.wrong(found, format!("{}{hint}", error.expected()))
    }
}

/// A value as it is typed after `path=`: a text without quotes, where that reads back as the same text.
pub(crate) fn word(value: &Value) -> String {
    match value {
        Value::String(text)
            if serde_json::from_str::<Value>(text).is_err() && text.trim() == text =>
        {
            text.clone()
        }
        value => value.to_string(),
    }
}
