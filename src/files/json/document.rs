//! A JSON file as text and as values: reading, overrides, and errors with their place in it.

use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::ops::Range;
use std::path::{Path, PathBuf};

use crate::files::json::error::{Excerpt, Mistake, SceneError, is_printable, nearest};
use crate::files::json::locate::{JsonPath, around, find, repeated, wrong_string};
use crate::files::json::reader::parse;
use crate::files::json::scan::Scanner;
use crate::files::json::source::{
    NoBytes, check_json, is_standard_input, of_file, of_standard_input, unmarked,
};
use crate::files::json::wording::wording;

/// A JSON file.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// Path from which it was read.
    pub(crate) path: PathBuf,
    /// Places set on the command line.
    pub(crate) set: Vec<Set>,
    /// Places of the text with overrides whose values stand elsewhere in the file, and where.
    pub(crate) moved: Vec<(JsonPath, JsonPath)>,
    /// As it was read.
    text: String,
    /// The same with overrides, and with parts from another file.
    changed: Option<String>,
    /// Notes on units that were taken for granted while it was read.
    notes: RefCell<Vec<String>>,
}

/// A place that was set.
#[derive(Clone, Debug)]
pub(crate) struct Set {
    /// In the document: the place itself, or the first one on the way to it that was not there.
    pub(crate) place: JsonPath,
    /// As it was typed.
    pub(crate) typed: JsonPath,
}

impl Document {
    /// Reads a file that is typed: standard input where it is `-`.
    pub(crate) fn read_typed(path: &Path) -> Result<Self, SceneError> {
        match is_standard_input(path) {
            true => Self::from_bytes(path, of_standard_input()),
            false => Self::read(path),
        }
    }

    /// Reads a file.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        Self::from_bytes(path, of_file(path))
    }

    fn from_bytes(path: &Path, bytes: Result<Vec<u8>, NoBytes>) -> Result<Self, SceneError> {
        let document = Self::empty(path);
        let whole = JsonPath::default();
        let bytes = bytes.map_err(|error| match error {
            NoBytes::Unreadable(error) => {
                let found = format!("no readable file ({error})");
                document.mistake(&whole, found, "a JSON file")
            }
            NoBytes::TooLarge(found, expected) => document.mistake(&whole, found, expected),
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("a file that is not UTF-8 text ({})", error.utf8_error());
            document.mistake(&whole, found, "a JSON file")
        })?;
        Self::of_text(path, text)
    }

    fn empty(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            set: Vec::new(),
            moved: Vec::new(),
            text: String::new(),
            changed: None,
            notes: RefCell::default(),
        }
    }

    /// Adds a note on what is taken for granted, once.
    pub(crate) fn note(&self, text: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&text) {
            notes.push(text);
        }
    }

    /// The notes.
    pub(crate) fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    /// Takes a text for that of a file, which need not exist.
    pub(crate) fn of_text(path: &Path, text: String) -> Result<Self, SceneError> {
        let mut document = Self::empty(path);
        document.text = unmarked(text);
        check_json(&document.text).map_err(|error| document.syntax_mistake(&error))?;
        document.refuse_repeated_keys()?;
        Ok(document)
    }

    /// The text, with overrides.
    pub(crate) fn text(&self) -> &str {
        self.changed.as_deref().unwrap_or(&self.text)
    }

    /// The text of the value under a key, with overrides.
    pub(crate) fn entry(&self, key: &str) -> Option<&str> {
        let entry = Scanner::of(self.text()).entry(key)?;
        Some(&self.text()[entry.value])
    }

    /// Puts a text in place of some bytes of it; positions of mistakes stay those of the text that was read.
    pub(crate) fn replace(&mut self, bytes: Range<usize>, by: &str) {
        let text = self.text();
        self.changed = Some([&text[..bytes.start], by, &text[bytes.end..]].concat());
    }

    /// Takes another text of the same document; positions of mistakes stay those of the text that was read.
    pub(crate) fn complete(&mut self, text: String) {
        self.changed = Some(text);
    }

    /// A path that is relative to this file.
    pub(crate) fn beside(&self, path: &str) -> PathBuf {
        match self.path.parent() {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path),
        }
    }

    /// The values as a type, or the first error.
    pub(crate) fn parse<T: DeserializeOwned>(&self) -> Result<T, SceneError> {
        self.refuse_unprintable()?;
        parse(self.text()).map_err(|(place, error)| {
            let wording = wording(place.last_key(), &error.to_string());
            let at_key = wording.at_key;
            self.describe(
                &place,
                wording.found,
                wording.expected,
                wording.nearest,
                at_key,
            )
        })
    }

    /// A wrong value at a place.
    pub(crate) fn mistake(
        &self,
        place: &JsonPath,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        self.describe(place, found.into(), expected.into(), None, false)
    }

    /// A wrong name at a place, with the nearest right one.
    pub(crate) fn wrong_name<'a>(
        &self,
        place: &JsonPath,
        name: &str,
        expected: impl Into<String>,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> SceneError {
        let (found, nearest) = (format!("{name:?}"), nearest(name, candidates));
        // A name that is a key of the file is pointed at there.
        let at_key = place.last_key() == Some(name);
        self.describe(place, found, expected.into(), nearest, at_key)
    }

    fn describe(
        &self,
        place: &JsonPath,
        found: String,
        expected: String,
        nearest: Option<String>,
        at_key: bool,
    ) -> SceneError {
        let place = &self.in_file(place);
        let mut set = self.set.iter().rev();
        let overridden = set.find(|set| place.is_within(&set.place));
        let overridden = overridden.map(|set| set.typed.clone());
        let span = match overridden {
            Some(_) => None,
            None => self.span(place, at_key),
        };
        self.error(
            place.to_string(),
            found,
            expected,
            nearest,
            span,
            overridden,
        )
    }

    /// The place in the file of a value that was moved.
    fn in_file(&self, place: &JsonPath) -> JsonPath {
        let moved = self.moved.iter().find(|(from, _)| place.is_within(from));
        moved.map_or_else(
            || place.clone(),
            |(from, to)| JsonPath([&to.0[..], &place.0[from.0.len()..]].concat()),
        )
    }

    fn error(
        &self,
        path: String,
        found: String,
        expected: String,
        nearest: Option<String>,
        span: Option<Range<usize>>,
        overridden: Option<JsonPath>,
    ) -> SceneError {
        let file = self.path.display().to_string();
        Mistake {
            source: span.map(|span| Excerpt::of(&self.text, span)),
            file,
            path,
            found,
            expected,
            nearest,
            overridden,
        }
        .into()
    }

    /// Bytes of a value (or its key), or of the nearest value around it.
    fn span(&self, place: &JsonPath, at_key: bool) -> Option<Range<usize>> {
        let mut place = place.clone();
        let mut at_key = at_key;
        loop {
            if let Some(found) = find(&self.text, &place) {
                return Some(found.key.filter(|_| at_key).unwrap_or(found.value));
            }
            place = place.parent()?;
            at_key = false;
        }
    }

    /// A text that is no JSON: line and column, and the path where a value is the reason.
    fn syntax_mistake(&self, error: &serde_json::Error) -> SceneError {
        let line_start = self
            .text
            .split_inclusive('\n')
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum::<usize>();
        let mut at = (line_start + error.column().saturating_sub(1)).min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        let is_infinite = error.to_string().starts_with("number out of range");
        if is_infinite && let Some((place, range)) = around(&self.text, at) {
            let written = &self.text[range];
            return self.mistake(
                &place,
                format!("{written}, which is not finite"),
                "a finite number",
            );
        }
        let end = self.text[at..]
            .chars()
            .next()
            .map_or(at, |c| at + c.len_utf8());
        let found = format!("a mistake in the JSON text ({error})");
        self.error(
            String::new(),
            found,
            "JSON".into(),
            None,
            Some(at..end),
            None,
        )
    }

    /// Names are shown in messages, figures, tables and pages: what cannot be printed has no place in any text.
    fn refuse_unprintable(&self) -> Result<(), SceneError> {
        let Some(found) = wrong_string(self.text(), is_printable) else {
            return Ok(());
        };
        let expected = "a text without control characters".to_owned();
        Err(self.describe(
            &found.place,
            format!("the text {:?}", found.says),
            expected,
            None,
            found.is_key,
        ))
    }

    /// JSON readers keep the last of two equal keys without a word; here that is an error.
    fn refuse_repeated_keys(&self) -> Result<(), SceneError> {
        let Some((place, key)) = repeated(&self.text) else {
            return Ok(());
        };
        let what = format!("the key {:?} twice", place.last_key().unwrap_or_default());
        let expected = "each key once".into();
        Err(self.error(place.to_string(), what, expected, None, Some(key), None))
    }
}
