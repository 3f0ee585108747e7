//! A place in a document from which checks report, and the checks shared by scene and problem.

use std::collections::HashSet;
use std::fmt;
use std::path::PathBuf;

use crate::files::json::document::Document;
use crate::files::json::error::SceneError;
use crate::files::json::path::JsonPath;
use crate::files::units::quantity::{PhysicalQuantity, Quantity};

/// A place in a document.
#[derive(Clone)]
pub(crate) struct Scope<'a> {
    pub(crate) document: &'a Document,
    pub(crate) place: JsonPath,
}

impl<'a> Scope<'a> {
    /// The whole document.
    pub(crate) fn of(document: &'a Document) -> Self {
        let place = JsonPath::default();
        Self { document, place }
    }

    /// The entry under a key.
    pub(crate) fn key(&self, key: &str) -> Self {
        let place = self.place.key(key);
        Self { place, ..*self }
    }

    /// The entry at an index.
    pub(crate) fn index(&self, index: usize) -> Self {
        let place = self.place.index(index);
        Self { place, ..*self }
    }

    /// Returns the error of a value here that is not the expected one.
    pub(crate) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        self.document.mistake(&self.place, found, expected)
    }

    /// Index of a name in a list.
    pub(crate) fn find(
        &self,
        name: &str,
        names: &[String],
        expected: &str,
    ) -> Result<usize, SceneError> {
        let position = names.iter().position(|other| other == name);
        position.ok_or_else(|| {
            let candidates = names.iter().map(String::as_str);
            self.document
                .wrong_name(&self.place, name, expected, candidates)
        })
    }

    /// The file that a path written here names: relative to the document.
    pub(crate) fn file(&self, path: &str, expected: &str) -> Result<PathBuf, SceneError> {
        let file = Some(self.document.beside(path)).filter(|file| file.is_file());
        file.ok_or_else(|| self.missing(path, "file", expected))
    }

    /// The same, or else in the current folder: results of earlier runs.
    pub(crate) fn file_or_result(&self, path: &str, expected: &str) -> Result<PathBuf, SceneError> {
        self.result(path, None, expected)
    }

    /// The `solution.json` that a path names, or that is in the folder that it names; in the same places.
    pub(crate) fn solution_file(&self, path: &str, expected: &str) -> Result<PathBuf, SceneError> {
        self.result(path, Some("solution.json"), expected)
    }

    /// The `feedback.json` that a path names, or that is in the folder that it names; in the same places.
    pub(crate) fn feedback_file(&self, path: &str) -> Result<PathBuf, SceneError> {
        let expected = "the path of the feedback.json of an optimum, or of its folder";
        self.result(path, Some("feedback.json"), expected)
    }

    /// A file beside the document or in the current folder, or the one of a name in a folder there.
    fn result(
        &self,
        path: &str,
        name: Option<&str>,
        expected: &str,
    ) -> Result<PathBuf, SceneError> {
        let places = [self.document.beside(path), PathBuf::from(path)];
        let mut files = places.into_iter().map(|place| match name {
            Some(name) if place.is_dir() => place.join(name),
            _ => place,
        });
        let file = files.find(|file| file.is_file());
        file.ok_or_else(|| self.missing(path, name.unwrap_or("file"), expected))
    }

    fn missing(&self, path: &str, kind: &str, expected: &str) -> SceneError {
        self.wrong(format!("{path:?}, where there is no {kind}"), expected)
    }

    /// That times in ms increase, at the first that does not.
    pub(crate) fn increasing(&self, times: &[f64]) -> Result<(), SceneError> {
        let falls = times.windows(2).position(|pair| pair[0] >= pair[1]);
        falls.map_or(Ok(()), |index| {
            let found = format!("{} s", times[index + 1] / 1e3);
            Err(self.index(index + 1).wrong(found, "increasing times"))
        })
    }

    /// A positive quantity in the units inside.
    pub(crate) fn positive<M: PhysicalQuantity>(
        &self,
        quantity: &Quantity<M>,
    ) -> Result<f64, SceneError> {
        let value = quantity.value();
        if value > 0.0 {
            return Ok(value);
        }
        let expected = format!("a positive value: {}", Quantity::<M>::expected());
        Err(self.wrong(quantity.to_string(), expected))
    }

    /// A weight that is zero or more; zero leaves no trace.
    pub(crate) fn weight(&self, weight: f64) -> Result<f64, SceneError> {
        match weight < 0.0 {
            true => Err(self.wrong(weight.to_string(), "a weight that is not negative")),
            false => Ok(weight),
        }
    }

    /// A quantity that is zero or more; zero leaves no trace.
    pub(crate) fn absent_or_positive<M: PhysicalQuantity>(
        &self,
        quantity: Option<&Quantity<M>>,
    ) -> Result<Option<f64>, SceneError> {
        match quantity {
            Some(quantity) if quantity.value() != 0.0 => self.positive(quantity).map(Some),
            _ => Ok(None),
        }
    }

    /// The one entry that is there.
    pub(crate) fn exactly_one<T, const N: usize>(
        &self,
        entries: [(&str, Option<T>); N],
    ) -> Result<T, SceneError> {
        let expected = format!(
            "exactly one of {}",
            list(entries.iter().map(|&(key, _)| key))
        );
        let mut there = entries
            .into_iter()
            .filter_map(|(key, entry)| Some((key, entry?)));
        match (there.next(), there.next()) {
            (Some((_, entry)), None) => Ok(entry),
            (None, _) => Err(self.wrong("none of them", expected)),
            (Some((first, _)), Some((second, _))) => {
                Err(self.wrong(list([first, second].into_iter()), expected))
            }
        }
    }

    /// A list without repeated, empty or reserved names; `place` gives the place of a name.
    pub(crate) fn unique(
        &self,
        names: &[String],
        reserved: &[&str],
        place: impl Fn(usize) -> Self,
    ) -> Result<(), SceneError> {
        let mut seen = HashSet::new();
        for (index, name) in names.iter().enumerate() {
            let found = format!("{name:?}");
            if name.is_empty() {
                return Err(place(index).wrong(found, "a name"));
            }
            if reserved.contains(&name.as_str()) {
                return Err(place(index).wrong(found, "a name that is not reserved"));
            }
            if !seen.insert(name) {
                let found = format!("{found} a second time");
                return Err(place(index).wrong(found, "a name that is not taken"));
            }
        }
        Ok(())
    }
}

/// Names in quotes, separated by commas.
pub(crate) fn list<T: fmt::Debug>(names: impl Iterator<Item = T>) -> String {
    names
        .map(|name| format!("{name:?}"))
        .collect::<Vec<_>>()
        .join(", ")
}
