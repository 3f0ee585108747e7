//! Places in a JSON document: paths such as `muscles[1].from.body`, and the bytes where their values stand.

use std::collections::HashSet;
use std::fmt;
use std::ops::Range;

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

    /// Whether this place is the other one or lies inside it.
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

/// Where one value stands in the text.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Index of the value that contains this one.
    parent: Option<usize>,
    /// The step from there to here.
    step: Option<Step>,
    /// Bytes of the key in front of the value, quotes included.
    pub(crate) key: Option<Range<usize>>,
    /// Bytes of the value.
    pub(crate) value: Range<usize>,
}

/// All values of a JSON text in the order of their starts; of a text that is no JSON, those that end before the mistake.
///
/// Each knows what contains it, so that long keys of deep values are held once.
#[derive(Debug, Default)]
pub(crate) struct Located(Vec<Found>);

/// Reads where the values of a text stand.
pub(crate) fn locate(text: &str) -> Located {
    let mut scanner = Scanner {
        text,
        at: 0,
        found: Vec::new(),
    };
    scanner.value(None, None, None, 0);
    Located(scanner.found)
}

impl Located {
    /// The value at a place.
    pub(crate) fn find(&self, place: &JsonPath) -> Option<&Found> {
        let mut here = self.of(None, None, 0)?;
        for step in &place.0 {
            here = self.of(Some(here), Some(step), here + 1)?;
        }
        self.ended(here)
    }

    /// The innermost value around a byte of the text, with its place.
    pub(crate) fn around(&self, at: usize) -> Option<(JsonPath, Range<usize>)> {
        let is_around = |&i: &usize| {
            let value = self.ended(i).map(|found| &found.value);
            value.is_some_and(|value| value.start <= at && at <= value.end)
        };
        let index = (0..self.0.len()).rev().find(is_around)?;
        Some((self.place(index), self.0[index].value.clone()))
    }

    /// The first value under a key that stood in the same object before, with its place.
    pub(crate) fn repeated(&self) -> Option<(JsonPath, &Found)> {
        let mut seen = HashSet::new();
        let mut all = self.0.iter();
        let index = all.position(|found| !seen.insert((found.parent, found.step.as_ref())))?;
        Some((self.place(index), &self.0[index]))
    }

    /// Index of the value one step inside another, sought from an index on.
    fn of(&self, parent: Option<usize>, step: Option<&Step>, from: usize) -> Option<usize> {
        let matches = |found: &Found| (found.parent, found.step.as_ref()) == (parent, step);
        let inside = self.0.get(from..)?;
        Some(from + inside.iter().position(matches)?)
    }

    /// A value whose end was seen.
    fn ended(&self, index: usize) -> Option<&Found> {
        self.0.get(index).filter(|found| found.value.end != OPEN)
    }

    fn place(&self, index: usize) -> JsonPath {
        let mut steps = Vec::new();
        let mut next = Some(index);
        while let Some(found) = next.map(|index| &self.0[index]) {
            steps.extend(found.step.clone());
            next = found.parent;
        }
        steps.reverse();
        JsonPath(steps)
    }
}

/// Nesting that is followed, as deep as serde_json reads.
const DEEPEST: usize = 128;

/// End of a value whose end is not known yet.
const OPEN: usize = usize::MAX;

struct Scanner<'a> {
    text: &'a str,
    at: usize,
    found: Vec<Found>,
}

impl Scanner<'_> {
    /// Moves past one value; `None` where the text is no JSON.
    fn value(
        &mut self,
        parent: Option<usize>,
        step: Option<Step>,
        key: Option<Range<usize>>,
        depth: usize,
    ) -> Option<()> {
        self.blanks();
        let first = self.peek()?;
        if depth > DEEPEST {
            return None;
        }
        let here = self.found.len();
        self.found.push(Found {
            parent,
            step,
            key,
            value: self.at..OPEN,
        });
        match first {
            b'{' => self.list(b'}', |scanner, _| {
                scanner.blanks();
                let start = scanner.at;
                let name = scanner.string()?;
                let key = start..scanner.at;
                scanner.blanks();
                scanner.expect(b':')?;
                scanner.value(Some(here), Some(Step::Key(name)), Some(key), depth + 1)
            })?,
            b'[' => self.list(b']', |scanner, index| {
                scanner.value(Some(here), Some(Step::Index(index)), None, depth + 1)
            })?,
            b'"' => {
                self.string()?;
            }
            _ => self.skip(|byte| !b",]}: \t\r\n".contains(&byte)),
        }
        self.found[here].value.end = self.at;
        Some(())
    }

    /// Moves past the brackets and what they hold.
    fn list(
        &mut self,
        close: u8,
        mut item: impl FnMut(&mut Self, usize) -> Option<()>,
    ) -> Option<()> {
        self.at += 1;
        self.blanks();
        if self.peek()? == close {
            self.at += 1;
            return Some(());
        }
        for index in 0.. {
            item(self, index)?;
            self.blanks();
            match self.peek()? {
                b',' => self.at += 1,
                byte if byte == close => break,
                _ => return None,
            }
        }
        self.at += 1;
        Some(())
    }

    /// Moves past a string and returns what it says.
    fn string(&mut self) -> Option<String> {
        let start = self.at;
        self.expect(b'"')?;
        loop {
            match self.peek()? {
                b'"' => break,
                b'\\' => self.at += 2,
                _ => self.at += 1,
            }
        }
        self.at += 1;
        serde_json::from_str(self.text.get(start..self.at)?).ok()
    }

    fn blanks(&mut self) {
        self.skip(|byte| b" \t\r\n".contains(&byte));
    }

    fn skip(&mut self, belongs: impl Fn(u8) -> bool) {
        while self.peek().is_some_and(&belongs) {
            self.at += 1;
        }
    }

    fn expect(&mut self, byte: u8) -> Option<()> {
        (self.peek()? == byte).then(|| self.at += 1)
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }
}
