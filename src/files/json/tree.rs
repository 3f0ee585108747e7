//! The tree of a JSON text: each value with its bytes in the text. What is put into the tree stands behind the text.

use serde_json::Value;
use std::borrow::Cow;
use std::fmt::{self, Write};
use std::mem;
use std::ops::Range;

use crate::files::json::path::{JsonPath, Step};

/// Nesting that is followed: files and values have 128 levels at most, and a place that is put into a tree 64.
const DEEPEST: usize = 512;

/// A JSON text and its values.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    text: String,
    root: Node,
}

/// A value: a scalar by its bytes, or an object or list by its entries.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Bytes of its key in an object, quotes included; empty elsewhere.
    key: Span,
    bytes: Span,
    parts: Box<[Self]>,
}

/// Bytes of a text, which has fewer than 2³².
#[derive(Clone, Copy, Debug)]
struct Span {
    start: u32,
    end: u32,
}

impl Span {
    fn new(bytes: Range<usize>) -> Self {
        let [start, end] = [bytes.start, bytes.end].map(|at| at as u32);
        Self { start, end }
    }

    fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// A value in its text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Json<'a> {
    text: &'a str,
    node: &'a Node,
}

impl Tree {
    /// Of a text that is JSON. Of any other text the values up to the first mistake, or none, may be wrong.
    pub(crate) fn of(text: String) -> Self {
        let root = Node::of(&text, 0);
        Self { text, root }
    }

    /// The whole.
    pub(crate) fn json(&self) -> Json<'_> {
        Json {
            text: &self.text,
            node: &self.root,
        }
    }

    /// The text, with what was put into the tree behind it.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Puts a value, given as JSON, in a place, of which objects that are missing are made; a new entry is the first of its object.
    /// Returns the bytes where it stands.
    pub(crate) fn put(&mut self, place: &[Step], value: &str) -> Range<usize> {
        let (mut node, mut rest) = (&mut self.root, place);
        while let Some((step, after)) = rest.split_first() {
            let json = Json {
                text: &self.text,
                node: &*node,
            };
            let Some(index) = json.position(step) else {
                break;
            };
            (node, rest) = (&mut node.parts[index], after);
        }
        let start = self.text.len();
        let is_object = self.text[node.bytes.range()].starts_with('{');
        let keys: Vec<Value> = rest.iter().filter_map(Step::key).map(Value::from).collect();
        for key in &keys {
            write!(self.text, "{{{key}:").expect("a text takes all");
        }
        self.text.push_str(value);
        self.text.extend(keys.iter().map(|_| '}'));
        let mut new = Node::of(&self.text, start);
        if is_object && !keys.is_empty() {
            let old = mem::take(&mut node.parts);
            node.parts = mem::take(&mut new.parts).into_iter().chain(old).collect();
        } else {
            new.key = node.key;
            *node = new;
        }
        start..self.text.len()
    }

    /// Puts values of this tree in the place of the entries under a key.
    pub(crate) fn set_entries(&mut self, key: &str, entries: Vec<Node>) {
        if let Some(index) = self.json().index_of(key) {
            self.root.parts[index].parts = entries.into();
        }
    }
}

impl Node {
    /// The value that follows a byte.
    fn of(text: &str, at: usize) -> Self {
        let bytes = text.as_bytes();
        Scanner { bytes, at }.value(0..0, 0)
    }
}

impl<'a> Json<'a> {
    /// The text of a string, number or word; of any other value as it was read.
    pub(crate) fn written(self) -> &'a str {
        &self.text[self.node.bytes.range()]
    }

    /// The first character, which tells objects, lists, strings, numbers and words apart.
    pub(crate) fn first(self) -> Option<char> {
        self.written().chars().next()
    }

    /// The text of its key with quotes; empty in a list.
    pub(crate) fn written_key(self) -> &'a str {
        &self.text[self.node.key.range()]
    }

    /// Its place in the text.
    pub(crate) fn span(self) -> Range<usize> {
        self.node.bytes.range()
    }

    /// The place of its key in the text.
    pub(crate) fn key_span(self) -> Range<usize> {
        self.node.key.range()
    }

    /// A copy of the value.
    pub(crate) fn node(self) -> Node {
        self.node.clone()
    }

    /// The entries of an object or list.
    pub(crate) fn parts(self) -> impl DoubleEndedIterator<Item = Self> + ExactSizeIterator + Clone {
        let text = self.text;
        self.node.parts.iter().map(move |node| Self { text, node })
    }

    /// The entry at an index.
    pub(crate) fn part(self, index: usize) -> Option<Self> {
        let node = self.node.parts.get(index)?;
        Some(Self { node, ..self })
    }

    /// The text that a string says.
    pub(crate) fn string(self) -> Option<Cow<'a, str>> {
        unquoted(self.written())
    }

    /// The key under which it stands.
    pub(crate) fn key(self) -> Option<Cow<'a, str>> {
        unquoted(self.written_key())
    }

    /// The value under a key.
    pub(crate) fn entry(self, key: &str) -> Option<Self> {
        self.part(self.index_of(key)?)
    }

    /// The value one step further.
    pub(crate) fn step(self, step: &Step) -> Option<Self> {
        self.part(self.position(step)?)
    }

    /// Index of the entry under a key, the last one where the key is repeated.
    fn index_of(self, key: &str) -> Option<usize> {
        let mut parts = self.parts();
        parts.rposition(|part| part.key().as_deref() == Some(key))
    }

    fn position(self, step: &Step) -> Option<usize> {
        match step {
            Step::Key(key) => self.index_of(key),
            Step::Index(index) => {
                let is_there = self.first() == Some('[') && *index < self.node.parts.len();
                is_there.then_some(*index)
            }
        }
    }

    /// The first answer about a value, in the order of the text, and its place.
    pub(crate) fn find_map<T>(self, answer: &impl Fn(Self) -> Option<T>) -> Option<(JsonPath, T)> {
        if let Some(found) = answer(self) {
            return Some((JsonPath::default(), found));
        }
        self.parts().enumerate().find_map(|(index, part)| {
            let (mut place, found) = part.find_map(answer)?;
            let key = part.key().map(|key| Step::Key(key.into_owned()));
            place.0.insert(0, key.unwrap_or(Step::Index(index)));
            Some((place, found))
        })
    }
}

/// In one line: `{}` without blanks, `{:#}` with blanks between values.
impl fmt::Display for Json<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (open, close) = match self.first() {
            Some('{') => ('{', '}'),
            Some('[') => ('[', ']'),
            _ => return f.write_str(self.written()),
        };
        let blank = if f.alternate() { " " } else { "" };
        let margin = match open == '{' && self.parts().len() > 0 {
            true => blank,
            false => "",
        };
        write!(f, "{open}{margin}")?;
        for (index, part) in self.parts().enumerate() {
            if index > 0 {
                write!(f, ",{blank}")?;
            }
            if open == '{' {
                write!(f, "{}:{blank}", part.written_key())?;
            }
            part.fmt(f)?;
        }
        write!(f, "{margin}{close}")
    }
}

/// The text of a string between quotes; none where it is no string.
fn unquoted(quoted: &str) -> Option<Cow<'_, str>> {
    let inside = quoted.strip_prefix('"')?.strip_suffix('"')?;
    match inside.contains('\\') {
        false => Some(Cow::Borrowed(inside)),
        true => serde_json::from_str(quoted).ok().map(Cow::Owned),
    }
}

/// A place in a text that only moves forwards.
struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Scanner<'_> {
    /// The byte behind the blanks that follow.
    fn peek(&mut self) -> Option<u8> {
        let rest = self.bytes[self.at..].iter();
        self.at += rest.take_while(|byte| b" \t\r\n".contains(byte)).count();
        self.bytes.get(self.at).copied()
    }

    /// Moves past a byte, if it follows.
    fn takes(&mut self, byte: u8) -> bool {
        let is_next = self.peek() == Some(byte);
        self.at += usize::from(is_next);
        is_next
    }

    /// Moves past the string, number or word that follows.
    fn scalar(&mut self) -> Range<usize> {
        let is_string = self.peek() == Some(b'"');
        let start = self.at;
        if is_string {
            self.at += 1;
            while let Some(&byte) = self.bytes.get(self.at) {
                self.at += if byte == b'\\' { 2 } else { 1 };
                if byte == b'"' {
                    break;
                }
            }
            self.at = self.at.min(self.bytes.len());
        } else {
            let rest = self.bytes[start..].iter();
            self.at += rest
                .take_while(|byte| !b",]}: \t\r\n".contains(byte))
                .count();
        }
        start..self.at
    }

    /// The value that follows.
    fn value(&mut self, key: Range<usize>, depth: usize) -> Node {
        let open = self.peek();
        let start = self.at;
        let mut parts = Vec::new();
        match open {
            Some(b'{' | b'[') if depth < DEEPEST => {
                self.at += 1;
                let (is_object, close) = match open {
                    Some(b'{') => (true, b'}'),
                    _ => (false, b']'),
                };
                while !self.takes(close) {
                    let mut key = 0..0;
                    if is_object {
                        key = self.scalar();
                        self.takes(b':');
                    }
                    parts.push(self.value(key, depth + 1));
                    if !self.takes(b',') {
                        self.takes(close);
                        break;
                    }
                }
            }
            _ => drop(self.scalar()),
        }
        Node {
            key: Span::new(key),
            bytes: Span::new(start..self.at),
            parts: parts.into(),
        }
    }
}
