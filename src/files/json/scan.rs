//! The text of a JSON file, read value by value without keeping any of them.

use std::borrow::Cow;
use std::ops::Range;

/// A place in a JSON text that only moves forwards. Where the text is no JSON it stops: all that moves it says nothing then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scanner<'a> {
    pub(crate) text: &'a str,
    pub(crate) at: usize,
}

/// An entry of an object or of a list.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// Bytes of the key, quotes included; none in a list.
    pub(crate) key: Option<Range<usize>>,
    /// Bytes of the value.
    pub(crate) value: Range<usize>,
}

impl<'a> Scanner<'a> {
    /// At the first value of a text.
    pub(crate) fn of(text: &'a str) -> Self {
        Self::from(text, 0)
    }

    /// At the value that follows a byte.
    pub(crate) fn from(text: &'a str, at: usize) -> Self {
        let mut scanner = Self { text, at };
        scanner.blanks();
        scanner
    }

    /// The byte here.
    pub(crate) fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Moves past blanks.
    pub(crate) fn blanks(&mut self) {
        self.skip(|byte| b" \t\r\n".contains(&byte));
    }

    fn skip(&mut self, belongs: impl Fn(u8) -> bool) {
        while self.peek().is_some_and(&belongs) {
            self.at += 1;
        }
    }

    /// Moves past a byte and the blanks behind it.
    pub(crate) fn expect(&mut self, byte: u8) -> Option<()> {
        (self.peek()? == byte).then(|| self.at += 1)?;
        self.blanks();
        Some(())
    }

    /// Moves past a string, a number or a word.
    pub(crate) fn scalar(&mut self) -> Option<Range<usize>> {
        let start = self.at;
        match self.peek()? {
            b'"' => {
                self.at += 1;
                loop {
                    match self.peek()? {
                        b'"' => break,
                        b'\\' => self.at += 2,
                        _ => self.at += 1,
                    }
                }
                self.at += 1;
            }
            _ => self.skip(|byte| !b",]}: \t\r\n".contains(&byte)),
        }
        Some(start..self.at)
    }

    /// Moves past the value that begins here.
    pub(crate) fn value(&mut self) -> Option<Range<usize>> {
        let start = self.at;
        let mut open = 0_usize;
        loop {
            match self.peek()? {
                b'{' | b'[' => {
                    open += 1;
                    self.at += 1;
                }
                b'}' | b']' => {
                    open = open.checked_sub(1)?;
                    self.at += 1;
                }
                b',' | b':' => self.at += 1,
                _ => {
                    self.scalar()?;
                }
            }
            if open == 0 {
                return Some(start..self.at);
            }
            self.blanks();
        }
    }

    /// The entries of the object or list that begins here.
    pub(crate) fn entries(mut self) -> impl Iterator<Item = Entry> {
        let is_object = self.peek() == Some(b'{');
        let is_list = self.peek() == Some(b'[');
        self.at += 1;
        self.blanks();
        let mut is_first = true;
        std::iter::from_fn(move || {
            if !(is_object || is_list) || matches!(self.peek()?, b'}' | b']') {
                return None;
            }
            if !is_first {
                self.expect(b',')?;
            }
            is_first = false;
            let key = match is_object {
                true => Some(self.scalar()?),
                false => None,
            };
            if is_object {
                self.blanks();
                self.expect(b':')?;
            }
            let value = self.value()?;
            self.blanks();
            Some(Entry { key, value })
        })
    }

    /// The entry under a key of the object that begins here.
    pub(crate) fn entry(self, key: &str) -> Option<Entry> {
        let text = self.text;
        self.entries().find(|entry| {
            let found = entry.key.clone();
            found.and_then(|found| string(text, found)).as_deref() == Some(key)
        })
    }
}

/// Returns the text of a string; none where the bytes are no string.
pub(crate) fn string(text: &str, bytes: Range<usize>) -> Option<Cow<'_, str>> {
    let quoted = text.get(bytes)?;
    let inside = quoted.strip_prefix('"')?.strip_suffix('"')?;
    match inside.contains('\\') {
        false => Some(Cow::Borrowed(inside)),
        true => serde_json::from_str(quoted).ok().map(Cow::Owned),
    }
}

/// A JSON text without the blanks between its values.
pub(crate) fn compact(text: &str) -> String {
    let mut compact = String::with_capacity(text.len());
    let mut scanner = Scanner::of(text);
    while let Some(byte) = scanner.peek() {
        match byte {
            b'{' | b'}' | b'[' | b']' | b',' | b':' => {
                compact.push(char::from(byte));
                scanner.at += 1;
            }
            _ => match scanner.scalar() {
                Some(scalar) => compact.push_str(&text[scalar]),
                None => break,
            },
        }
        scanner.blanks();
    }
    compact
}
