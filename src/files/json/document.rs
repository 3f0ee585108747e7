//! A JSON file as text and as values: reading, overrides, and mistakes with their place in it.

use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fs;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::files::json::error::{Mistake, SceneError, is_printable, nearest};
use crate::files::json::locate::{JsonPath, Step, locate};
use crate::files::json::wording::wording;

/// A JSON file.
#[derive(Debug)]
pub(crate) struct Document {
    /// Where it was read.
    pub(crate) path: PathBuf,
    /// Values, with overrides applied.
    pub(crate) value: Value,
    /// Places set on the command line.
    pub(crate) set: Vec<JsonPath>,
    text: String,
}

/// Whether a file that is typed stands for standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// What came through standard input. A process reads it once: several starts have the same problem.
fn standard_input() -> io::Result<Vec<u8>> {
    static READ: Mutex<Option<Vec<u8>>> = Mutex::new(None);
    let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(bytes) = &*read {
        return Ok(bytes.clone());
    }
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(read.insert(bytes).clone())
}

impl Document {
    /// Reads a file that is typed: standard input where it is `-`.
    pub(crate) fn read_typed(path: &Path) -> Result<Self, SceneError> {
        match is_standard_input(path) {
            true => Self::from_bytes(path, standard_input),
            false => Self::read(path),
        }
    }

    /// Reads a file.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        Self::from_bytes(path, || fs::read(path))
    }

    fn from_bytes(
        path: &Path,
        bytes: impl FnOnce() -> io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        let document = Self::empty(path);
        let bytes = bytes().map_err(|error| {
            let found = format!("no readable file ({error})");
            document.mistake(&JsonPath::default(), found, "a JSON file")
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("a file that is not UTF-8 text ({})", error.utf8_error());
            document.mistake(&JsonPath::default(), found, "a JSON file")
        })?;
        Self::of_text(path, text)
    }

    fn empty(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            value: Value::Null,
            set: Vec::new(),
            text: String::new(),
        }
    }

    /// Takes a text for that of a file, which need not exist.
    pub(crate) fn of_text(path: &Path, text: String) -> Result<Self, SceneError> {
        let mut document = Self::empty(path);
        document.text = text;
        document.value = serde_json::from_str(&document.text)
            .map_err(|error| document.syntax_mistake(&error))?;
        document.refuse_repeated_keys()?;
        Ok(document)
    }

    /// A path that is relative to this file.
    pub(crate) fn beside(&self, path: &str) -> PathBuf {
        match self.path.parent() {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path),
        }
    }

    /// The values as a type, or the first mistake.
    pub(crate) fn parse<T: DeserializeOwned>(&self) -> Result<T, SceneError> {
        self.refuse_unprintable()?;
        serde_path_to_error::deserialize(&self.value).map_err(|error| {
            let steps = error.path().iter().filter_map(|segment| match segment {
                serde_path_to_error::Segment::Seq { index } => Some(Step::Index(*index)),
                serde_path_to_error::Segment::Map { key } => Some(Step::Key(key.clone())),
                // A word that stands as the key of its value, such as {"given": "5 kV"}.
                serde_path_to_error::Segment::Enum { variant } => Some(Step::Key(variant.clone())),
                _ => None,
            });
            let place = JsonPath(steps.collect());
            let wording = wording(place.last_key(), &error.inner().to_string());
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
        let overridden = self.set.iter().any(|set| place.is_within(set));
        let span = if overridden {
            None
        } else {
            self.span(place, at_key)
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

    fn error(
        &self,
        path: String,
        found: String,
        expected: String,
        nearest: Option<String>,
        span: Option<Range<usize>>,
        overridden: bool,
    ) -> SceneError {
        let file = self.path.display().to_string();
        Mistake {
            source: span.map(|span| (shown(&self.text), span)),
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
        let all = locate(&self.text);
        let mut place = place.clone();
        let mut at_key = at_key;
        loop {
            if let Some(found) = all.find(&place) {
                return match &found.key {
                    Some(key) if at_key => Some(key.clone()),
                    _ => Some(found.value.clone()),
                };
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
        if is_infinite && let Some((place, range)) = locate(&self.text).around(at) {
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
            false,
        )
    }

    /// Names are shown in messages, figures, tables and pages: what cannot be printed has no place in any text.
    fn refuse_unprintable(&self) -> Result<(), SceneError> {
        let Some(mut found) = unprintable(&self.value) else {
            return Ok(());
        };
        found.steps.reverse();
        let (place, text) = (JsonPath(found.steps), found.text);
        let expected = "a text without control characters".to_owned();
        Err(self.describe(
            &place,
            format!("the text {text:?}"),
            expected,
            None,
            found.is_key,
        ))
    }

    /// JSON readers keep the last of two equal keys without a word; here that is a mistake.
    fn refuse_repeated_keys(&self) -> Result<(), SceneError> {
        let all = locate(&self.text);
        if let Some((place, found)) = all.repeated() {
            let what = format!("the key {:?} twice", place.last_key().unwrap_or_default());
            let span = found.key.clone().unwrap_or(found.value.clone());
            let expected = "each key once".into();
            return Err(self.error(place.to_string(), what, expected, None, Some(span), false));
        }
        Ok(())
    }
}

/// The text with question marks, as many as bytes, in place of what cannot be printed, and spaces for carriage returns; places
/// in it stay where they are.
fn shown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\r' => shown.push(' '),
            '\n' | '\t' => shown.push(c),
            _ if is_printable(c) => shown.push(c),
            _ => shown.extend(std::iter::repeat_n('?', c.len_utf8())),
        }
    }
    shown
}

/// A text that cannot be printed, with the steps to it from the innermost one outwards.
struct Unprintable<'a> {
    text: &'a str,
    is_key: bool,
    steps: Vec<Step>,
}

/// The first text among keys and values that cannot be printed.
fn unprintable(value: &Value) -> Option<Unprintable<'_>> {
    let check = |text, is_key| {
        let steps = Vec::new();
        let found = Unprintable {
            text,
            is_key,
            steps,
        };
        (!found.text.chars().all(is_printable)).then_some(found)
    };
    match value {
        Value::String(text) => check(text, false),
        Value::Array(entries) => entries.iter().enumerate().find_map(|(index, entry)| {
            let mut found = unprintable(entry)?;
            found.steps.push(Step::Index(index));
            Some(found)
        }),
        Value::Object(entries) => entries.iter().find_map(|(key, entry)| {
            let mut found = check(key, true).or_else(|| unprintable(entry))?;
            found.steps.push(Step::Key(key.clone()));
            Some(found)
        }),
        _ => None,
    }
}
