//! Header of a column: its name and its unit, as `x [mm]`, `x (mm)`, `x / mm`, `x, mm`, `x in mm` or `x_mm`.

use crate::files::units::quantity::{Kind, describe};
use crate::files::units::unit::Unit;

/// A header, read for a column of some kind.
#[derive(Debug)]
pub(super) struct Header<'a> {
    /// As it is written.
    pub(super) whole: &'a str,
    /// The part before the unit.
    pub(super) name: &'a str,
    unit: Written<'a>,
}

/// Text that stands for the unit of a header.
#[derive(Debug)]
enum Written<'a> {
    /// Nothing.
    Nothing,
    /// A unit of the kind.
    Known(String),
    /// Something in brackets or behind a slash that is no unit of the kind.
    Other(&'a str),
}

/// Characters between a name and a unit.
const SEPARATORS: [char; 10] = [' ', '\u{a0}', '_', ',', ';', ':', '.', '|', '-', '/'];
/// Brackets around a unit.
const BRACKETS: [(char, char); 4] = [('[', ']'), ('(', ')'), ('{', '}'), ('<', '>')];

impl<'a> Header<'a> {
    /// Reads a header; what may be a name as well is a unit only if it is one of the kind.
    pub(super) fn new(whole: &'a str, kind: &Kind) -> Self {
        let all = splits(whole);
        let known = all
            .iter()
            .find_map(|&(name, tail)| Some((name, unit(tail, kind)?)));
        let is_marked = |c: char| c == '/' || BRACKETS.iter().any(|&(a, b)| c == a || c == b);
        let (name, unit) = match (known, whole.find(is_marked)) {
            (Some((name, unit)), _) => (name, Written::Known(unit)),
            (None, None) => (whole, Written::Nothing),
            (None, Some(mark)) => match all.iter().rfind(|(name, _)| name.len() <= mark) {
                Some(&(name, tail)) => (name, Written::Other(tail)),
                None => (whole, Written::Other(whole)),
            },
        };
        Self { whole, name, unit }
    }

    /// The unit, if there is one; the error names what is found in its place.
    pub(super) fn unit(&self) -> Result<Option<&str>, String> {
        match &self.unit {
            Written::Nothing => Ok(None),
            Written::Known(unit) => Ok(Some(unit)),
            Written::Other(tail) => Err(match Unit::parse(tail) {
                Some(unit) => format!("which is {}", describe(unit.dimension)),
                None => format!("where {tail:?} is no known unit"),
            }),
        }
    }
}

/// Names with what may be the unit behind them, the shortest name first.
fn splits(whole: &str) -> Vec<(&str, &str)> {
    let name = |before: &'_ str| -> usize {
        let name = before.trim_end_matches(SEPARATORS);
        name.strip_suffix(" in").unwrap_or(name).trim_end().len()
    };
    if let Some((before, inside)) = bracketed(whole) {
        return vec![(&whole[..name(before)], inside.trim())];
    }
    let split = |(at, _)| {
        let tail = whole[at..].trim_start_matches(SEPARATORS);
        (&whole[..name(&whole[..at])], tail)
    };
    let all = whole.match_indices(SEPARATORS).map(split);
    all.filter(|(name, tail)| !name.is_empty() && tail.contains(char::is_alphabetic))
        .collect()
}

/// Text before the brackets at its end, and within them.
fn bracketed(text: &str) -> Option<(&str, &str)> {
    let last = text.chars().next_back()?;
    let (open, close) = BRACKETS.into_iter().find(|&(_, close)| close == last)?;
    let mut depth = 0;
    let start = text.char_indices().rfind(|&(_, c)| {
        depth += i32::from(c == close) - i32::from(c == open);
        c == open && depth == 0
    })?;
    let inside = &text[start.0 + open.len_utf8()..text.len() - close.len_utf8()];
    Some((&text[..start.0], inside))
}

/// The text as a unit of a kind, also as `mm_s` or `mm_per_s`, and `-` for a plain number.
fn unit(text: &str, kind: &Kind) -> Option<String> {
    let forms = [
        if text == "-" { "1" } else { text }.to_owned(),
        text.replace("_per_", "/"),
        text.replacen('_', "/", 1),
        text.replace('_', " "),
    ];
    let is_of_kind =
        |form: &&String| Unit::parse(form).is_some_and(|unit| kind.is_in(unit.dimension));
    forms.iter().find(is_of_kind).cloned()
}
