//! Places in a JSON document: paths such as `muscles[1].from.body`, and the bytes of their values.

use rustc_hash::FxHashSet;
use std::borrow::Cow;
use std::fmt;
use std::ops::Range;

use crate::files::json::scan::{Entry, Scanner, string};

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Step {
    Key(String),
    Index(usize),
}

/// A path from the root of a JSON document.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct JsonPath(pub(crate) Vec<Step>);

impl JsonPath {
    /// The entry under a key.
    pub(crate) fn key(&self, key: &str) -> Self {
        self.then(Step::Key(key.to_owned()))
    }

    /// The entry at an index.
    pub(crate) fn index(&self, index: usize) -> Self {
        self.then(Step::Index(index))
    }

    /// One step further.
    pub(crate) fn then(&self, step: Step) -> Self {
        Self(self.0.iter().cloned().chain([step]).collect())
    }

    /// The place that contains this one.
    pub(crate) fn parent(&self) -> Option<Self> {
        let (_, parents) = self.0.split_last()?;
        Some(Self(parents.to_vec()))
    }

    /// The last key, where the last step is one.
    pub(crate) fn last_key(&self) -> Option<&str> {
        match self.0.last() {
            Some(Step::Key(key)) => Some(key),
            _ => None,
        }
    }

    /// Returns true if this place is the other one or lies inside it.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.0.starts_with(&other.0)
    }

    /// Reads a path such as `control.goal` or `muscles[0].material`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut steps = Vec::new();
        for part in text.split('.') {
            let (key, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
            if key.is_empty() {
                return None;
            }
            steps.push(Step::Key(key.to_owned()));
            while !rest.is_empty() {
                let (index, tail) = rest.strip_prefix('[')?.split_once(']')?;
                steps.push(Step::Index(index.parse().ok()?));
                rest = tail;
            }
        }
        Some(Self(steps))
    }
}

impl fmt::Display for JsonPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (position, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if position == 0 => write!(f, "{key}")?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// Returns the bytes of the value at a place, with its key.
pub(crate) fn find(text: &str, place: &JsonPath) -> Option<Entry> {
    let value = Scanner::of(text).value()?;
    let whole = Entry { key: None, value };
    place.0.iter().try_fold(whole, |here, step| {
        let inside = Scanner::from(text, here.value.start);
        match step {
            Step::Key(key) => inside.entry(key),
            Step::Index(_) if inside.peek() != Some(b'[') => None,
            Step::Index(index) => inside.entries().nth(*index),
        }
    })
}

/// The string, number or word around a byte of the text, with its place; the text may be no JSON behind it.
pub(crate) fn around(text: &str, at: usize) -> Option<(JsonPath, Range<usize>)> {
    let mut found = None;
    walk(text, &mut |walk, met| match met {
        Met::Scalar(range) if range.start <= at && at <= range.end => {
            found = Some((walk.place(), range));
            None
        }
        _ => Some(()),
    });
    found
}

/// A key that stood in the same object before, with its place.
pub(crate) fn repeated(text: &str) -> Option<(JsonPath, Range<usize>)> {
    let mut open: Vec<FxHashSet<Cow<'_, str>>> = Vec::new();
    let mut found = None;
    walk(text, &mut |walk, met| {
        match met {
            Met::Open => open.push(FxHashSet::default()),
            Met::Close => {
                open.pop();
            }
            Met::Key(range) => {
                let key = string(text, range.clone())?;
                if !open.last_mut()?.insert(key) {
                    found = Some((walk.place(), range));
                    return None;
                }
            }
            Met::Scalar(_) => {}
        }
        Some(())
    });
    found
}

/// The first string, key or value, that has an unexpected character.
pub(crate) fn wrong_string(text: &str, belongs: impl Fn(char) -> bool) -> Option<WrongString> {
    let mut found = None;
    walk(text, &mut |walk, met| {
        let (range, is_key) = match met {
            Met::Key(range) => (range, true),
            Met::Scalar(range) => (range, false),
            Met::Open | Met::Close => return Some(()),
        };
        match string(text, range) {
            Some(says) if !says.chars().all(&belongs) => {
                found = Some(WrongString {
                    place: walk.place(),
                    says: says.into_owned(),
                    is_key,
                });
                None
            }
            _ => Some(()),
        }
    });
    found
}

/// A string that is not as expected.
#[derive(Debug)]
pub(crate) struct WrongString {
    pub(crate) place: JsonPath,
    /// Its text.
    pub(crate) says: String,
    /// True if it is a key.
    pub(crate) is_key: bool,
}

/// Nesting that is followed, as deep as serde_json reads.
const DEEPEST: usize = 128;

/// Token on the way through a text.
enum Met {
    /// An object or list begins.
    Open,
    /// It ends.
    Close,
    /// The bytes of a key, which is the last step of the place.
    Key(Range<usize>),
    /// The bytes of a string, number or word.
    Scalar(Range<usize>),
}

/// One step of the way, by the bytes of its key.
enum Way {
    Key(Range<usize>),
    Index(usize),
}

/// A way through all values of a text in their order.
struct Walk<'a> {
    scanner: Scanner<'a>,
    way: Vec<Way>,
}

/// Calls back with each token, until the callback answers `None`, or the text is no JSON.
fn walk(text: &str, visit: &mut dyn FnMut(&Walk<'_>, Met) -> Option<()>) {
    let mut walk = Walk {
        scanner: Scanner::of(text),
        way: Vec::new(),
    };
    walk.value(visit);
}

impl Walk<'_> {
    /// The present place.
    fn place(&self) -> JsonPath {
        let step = |way: &Way| match way {
            Way::Key(key) => {
                let key = string(self.scanner.text, key.clone()).unwrap_or_default();
                Step::Key(key.into_owned())
            }
            Way::Index(index) => Step::Index(*index),
        };
        JsonPath(self.way.iter().map(step).collect())
    }

    fn value(&mut self, visit: &mut dyn FnMut(&Walk<'_>, Met) -> Option<()>) -> Option<()> {
        let open = self.scanner.peek()?;
        let close = match open {
            b'{' => b'}',
            b'[' => b']',
            _ => {
                let scalar = self.scanner.scalar()?;
                visit(self, Met::Scalar(scalar))?;
                self.scanner.blanks();
                return Some(());
            }
        };
        if self.way.len() > DEEPEST {
            return None;
        }
        visit(self, Met::Open)?;
        self.scanner.expect(open)?;
        for index in 0.. {
            if self.scanner.peek()? == close {
                break;
            }
            if index > 0 {
                self.scanner.expect(b',')?;
            }
            if open == b'{' {
                let key = self.scanner.scalar()?;
                self.way.push(Way::Key(key.clone()));
                visit(self, Met::Key(key))?;
                self.scanner.blanks();
                self.scanner.expect(b':')?;
            } else {
                self.way.push(Way::Index(index));
            }
            self.value(visit)?;
            self.way.pop();
        }
        self.scanner.expect(close)?;
        visit(self, Met::Close)
    }
}
