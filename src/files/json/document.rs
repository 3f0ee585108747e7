//! A JSON file: its bytes, if the machine has room for what is read from them, overrides, and errors with their place in it.

use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::Value;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use crate::files::json::error::{Excerpt, Mistake, Result, SceneError, is_printable, nearest};
use crate::files::json::path::JsonPath;
use crate::files::json::tree::{Json, Tree};
use crate::math::join::{available, readable};

/// A JSON file.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// Path from which it was read.
    pub(crate) path: PathBuf,
    /// Places with values that stand elsewhere in the file, and where.
    pub(crate) moved: Vec<(JsonPath, JsonPath)>,
    /// Its values, with overrides and with parts from another file.
    pub(crate) tree: Tree,
    /// Bytes of the file; what is put into its tree stands behind them.
    length: usize,
    /// Places that were set as they were typed, with the bytes where their values stand.
    set: Vec<(Range<usize>, JsonPath)>,
    /// Notes on units that were taken for granted while it was read.
    notes: RefCell<Vec<String>>,
}

impl Document {
    /// Reads a file that is typed: standard input where it is `-`.
    pub(crate) fn read_typed(path: &Path) -> Result<Self> {
        match is_standard_input(path) {
            true => Self::from_bytes(path, of_standard_input()),
            false => Self::read(path),
        }
    }

    /// Reads a file.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        Self::from_bytes(path, of_file(path))
    }

    fn from_bytes(path: &Path, bytes: Result<Vec<u8>, NoBytes>) -> Result<Self> {
        let wrong = |found: String, expected: &str| {
            Self::new(path, String::new()).mistake(&JsonPath::default(), found, expected)
        };
        let bytes = bytes.map_err(|error| match error {
            NoBytes::Unreadable(error) => {
                wrong(format!("no readable file ({error})"), "a JSON file")
            }
            NoBytes::TooLarge(found, expected) => wrong(found, &expected),
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("a file that is not UTF-8 text ({})", error.utf8_error());
            wrong(found, "a JSON file")
        })?;
        Self::of_text(path, text)
    }

    fn new(path: &Path, text: String) -> Self {
        Self {
            path: path.to_owned(),
            moved: Vec::new(),
            length: text.len(),
            tree: Tree::of(text),
            set: Vec::new(),
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
    pub(crate) fn of_text(path: &Path, text: String) -> Result<Self> {
        let document = Self::new(path, unmarked(text));
        document.refuse_broken()?;
        document.refuse_infinite()?;
        document.refuse_repeated_keys()?;
        Ok(document)
    }

    /// The whole.
    pub(crate) fn json(&self) -> Json<'_> {
        self.tree.json()
    }

    /// The value under a key.
    pub(crate) fn entry(&self, key: &str) -> Option<Json<'_>> {
        self.json().entry(key)
    }

    /// Puts a value in a place, which was typed.
    pub(crate) fn set(&mut self, place: &JsonPath, value: &str, typed: &JsonPath) {
        let bytes = self.tree.put(&place.0, value);
        self.set.push((bytes, typed.clone()));
    }

    /// A path that is relative to this file.
    pub(crate) fn beside(&self, path: &str) -> PathBuf {
        match self.path.parent() {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path),
        }
    }

    /// The values as a type, or the first error.
    pub(crate) fn parse<T: DeserializeOwned>(&self) -> Result<T> {
        self.refuse_unprintable()?;
        self.json().read().map_err(|misfit| {
            let (place, is_key) = (misfit.place(), misfit.is_of_key());
            Mistake {
                nearest: misfit.nearest,
                ..self.describe(&place, misfit.found, misfit.expected, is_key)
            }
            .into()
        })
    }

    /// A wrong value at a place.
    pub(crate) fn mistake(
        &self,
        place: &JsonPath,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        self.describe(place, found, expected, false).into()
    }

    /// A wrong name at a place, with the nearest right one.
    pub(crate) fn wrong_name<'a>(
        &self,
        place: &JsonPath,
        name: &str,
        expected: impl Into<String>,
        candidates: impl IntoIterator<Item = &'a str>,
    ) -> SceneError {
        // A name that is a key of the file is pointed at there.
        let at_key = place.last_key() == Some(name);
        Mistake {
            nearest: nearest(name, candidates),
            ..self.describe(place, format!("{name:?}"), expected, at_key)
        }
        .into()
    }

    /// Describes a wrong value, or its key.
    fn describe(
        &self,
        place: &JsonPath,
        found: impl Into<String>,
        expected: impl Into<String>,
        at_key: bool,
    ) -> Mistake {
        let (span, overridden) = self.source(place, at_key);
        Mistake {
            path: self.in_file(place).to_string(),
            source: span.map(|span| self.excerpt(span)),
            overridden: overridden.cloned(),
            ..Mistake::of_file(self.path.display().to_string(), found, expected)
        }
    }

    fn excerpt(&self, span: Range<usize>) -> Excerpt {
        Excerpt::of(&self.tree.text()[..self.length], span)
    }

    /// Bytes in the file of a value (or its key), or of the nearest value around it; the place that was typed where it is an override.
    fn source(&self, place: &JsonPath, at_key: bool) -> (Option<Range<usize>>, Option<&JsonPath>) {
        let (mut at, mut found) = (self.json(), (None, None));
        let mut steps = place.0.iter();
        loop {
            let (span, next) = (at.span(), steps.next());
            let mut set = self.set.iter();
            if span.start < self.length {
                let is_key = at_key && next.is_none() && !at.written_key().is_empty();
                found = (Some(if is_key { at.key_span() } else { span }), None);
            } else if let Some((_, typed)) = set.find(|(bytes, _)| bytes.contains(&span.start)) {
                found = (None, Some(typed));
            }
            match next.and_then(|step| at.step(step)) {
                Some(inside) => at = inside,
                None => return found,
            }
        }
    }

    /// The place in the file of a value that was moved.
    fn in_file(&self, place: &JsonPath) -> JsonPath {
        let moved = self.moved.iter().find(|(from, _)| place.is_within(from));
        moved.map_or_else(
            || place.clone(),
            |(from, to)| JsonPath([&to.0[..], &place.0[from.0.len()..]].concat()),
        )
    }

    /// A text that is no JSON has a line and a column, and the place of a number that is the reason.
    fn refuse_broken(&self) -> Result<()> {
        let text = self.tree.text();
        let Err(error) = check_json(text) else {
            return Ok(());
        };
        if error.to_string().starts_with("number out of range") {
            self.refuse_infinite()?;
        }
        let before = text
            .split_inclusive('\n')
            .take(error.line().saturating_sub(1));
        let line_start = before.map(str::len).sum::<usize>();
        let mut at = (line_start + error.column().saturating_sub(1)).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        let end = text[at..].chars().next().map_or(at, |c| at + c.len_utf8());
        let found = format!("a mistake in the JSON text ({error})");
        Err(Mistake {
            source: Some(self.excerpt(at..end)),
            ..self.describe(&JsonPath::default(), found, "JSON", false)
        }
        .into())
    }

    /// Numbers beyond all that are computed with have no place in a file.
    fn refuse_infinite(&self) -> Result<()> {
        let infinite = self.json().find_map(&|one| {
            let number = Some(one.written()).filter(|_| one.first() != Some('"'));
            number.filter(|number| number.parse().is_ok_and(f64::is_infinite))
        });
        infinite.map_or(Ok(()), |(place, written)| {
            Err(self.mistake(
                &place,
                format!("{written}, which is not finite"),
                "a finite number",
            ))
        })
    }

    /// Names are shown in messages, figures, tables and pages: what cannot be printed has no place in any text.
    fn refuse_unprintable(&self) -> Result<()> {
        let is_wrong = |text: &Cow<'_, str>| !text.chars().all(is_printable);
        let wrong = self.json().find_map(&|one| {
            let key = one.key().filter(is_wrong).map(|key| (key, true));
            key.or_else(|| Some((one.string().filter(is_wrong)?, false)))
        });
        let Some((place, (says, is_key))) = wrong else {
            return Ok(());
        };
        let found = format!("the text {says:?}");
        let expected = "a text without control characters";
        Err(self.describe(&place, found, expected, is_key).into())
    }

    /// JSON readers keep the last of two equal keys without a word; here that is an error.
    fn refuse_repeated_keys(&self) -> Result<()> {
        let repeated = self.json().find_map(&|one| {
            let mut seen = HashSet::new();
            let mut keys = one.parts().filter_map(Json::key);
            keys.find(|key| !seen.insert(key.clone()))
        });
        let Some((place, key)) = repeated else {
            return Ok(());
        };
        let (place, found) = (place.key(&key), format!("the key {key:?} twice"));
        Err(self.describe(&place, found, "each key once", true).into())
    }
}

/// Bytes of memory that reading takes for each byte of a file: its text, and for a value in a list, which has 4 bytes or more in the file, 32 bytes
/// of its node, half as many while the list grows, and 16 bytes of the number or the text that it is.
const OF_BYTE: f64 = 17.0;
/// Bytes of the largest file where the memory of the machine is not known, and where it is: places in a text are numbers of 32 bits.
const LARGEST: [u64; 2] = [1 << 30, 1 << 31];

/// Bytes from standard input. A process reads it once: several starts have the same problem.
static STANDARD_INPUT: Mutex<Option<Vec<u8>>> = Mutex::new(None);

/// Reason why there are no bytes.
#[derive(Debug)]
pub(crate) enum NoBytes {
    /// Error of the operating system.
    Unreadable(io::Error),
    /// Size that was found, and the size expected.
    TooLarge(String, String),
}

/// Returns true if a file that is typed stands for standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// The bytes of a file.
pub(crate) fn of_file(path: &Path) -> Result<Vec<u8>, NoBytes> {
    let file = File::open(path).map_err(NoBytes::Unreadable)?;
    let size = file.metadata().map_or(0, |found| found.len());
    limited(file, size)
}

/// The bytes of standard input.
fn of_standard_input() -> Result<Vec<u8>, NoBytes> {
    let mut read = STANDARD_INPUT
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    if let Some(bytes) = &*read {
        return Ok(bytes.clone());
    }
    let bytes = limited(io::stdin().lock(), 0)?;
    Ok(read.insert(bytes).clone())
}

/// Reads all, if there is room for it; a `size` that is known is checked first.
fn limited(from: impl Read, size: u64) -> Result<Vec<u8>, NoBytes> {
    let free = available();
    let most = free.map_or(LARGEST[0], |free| (free / OF_BYTE) as u64);
    let most = most.min(LARGEST[1]);
    let too_large = |found: String| {
        let of_memory = free.map_or_else(String::new, |free| {
            let free = readable(free);
            format!(": reading takes up to {OF_BYTE} bytes for each byte of a file, and {free} of memory are free")
        });
        let expected = format!("a file of at most {}{of_memory}", readable(most as f64));
        NoBytes::TooLarge(found, expected)
    };
    if size > most {
        return Err(too_large(format!("a file of {}", readable(size as f64))));
    }
    let mut bytes = Vec::with_capacity(size as usize);
    let mut from = from.take(most + 1);
    from.read_to_end(&mut bytes).map_err(NoBytes::Unreadable)?;
    match bytes.len() as u64 > most {
        true => Err(too_large("a file without a known end".to_owned())),
        false => Ok(bytes),
    }
}

/// A text without the byte-order mark that some editors write before it.
fn unmarked(mut text: String) -> String {
    if let Some(rest) = text.strip_prefix('\u{feff}') {
        text = rest.to_owned();
    }
    text
}

/// Checks that a text is JSON, whose numbers may be too large.
///
/// # Errors
/// The first error in it.
fn check_json(text: &str) -> Result<(), serde_json::Error> {
    // A value that is ignored takes less time and memory, but its escapes are not decoded, and the columns of its mistakes are other ones.
    match !text.contains("\\u") && serde_json::from_str::<IgnoredAny>(text).is_ok() {
        true => Ok(()),
        false => serde_json::from_str::<Value>(text).map(drop),
    }
}
