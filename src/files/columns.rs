//! Columns of a CSV file or of a problem, with the units of their headers: `x [mm]`, `x (mm)`, `x / mm`, `x, mm`, `x in mm` or `x_mm`.

use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::units::quantity::{Kind, PhysicalQuantity, Quantity, describe};
use crate::files::units::unit::Unit;
use csv::{ReaderBuilder, StringRecord, Trim};
use std::collections::BTreeMap;
use std::fs::File;

/// Columns; of a CSV file those of one line of headers, in which lines that begin with `#` are comments.
pub(crate) struct Columns {
    /// File or key, for messages.
    place: String,
    headers: StringRecord,
    rows: Vec<StringRecord>,
}

/// A cell without the apostrophe that keeps a spreadsheet from taking a text for a formula.
fn plain(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(text) if text.starts_with(['=', '+', '-', '@']) => text,
        _ => cell,
    }
}

impl Columns {
    /// Reads a file that a problem names: relative to the problem, otherwise to the current folder.
    pub(crate) fn read(path: &str, scope: &Scope<'_>) -> Result<Self> {
        let path = scope.file_or_result(path, "the path of a CSV file")?;
        let mistake = |cause: &dyn std::fmt::Display| {
            let found = format!("{:?}, which cannot be read ({cause})", path.display());
            scope.wrong(
                found,
                "a CSV file in UTF-8: a line of headers, then lines of numbers",
            )
        };
        let file = File::open(&path).map_err(|cause| mistake(&cause))?;
        let mut reader = ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(Trim::All)
            .from_reader(file);
        let headers = reader.headers().map_err(|cause| mistake(&cause))?;
        refuse!(if headers.is_empty(), scope;
            found format!("{}, which is empty", path.display()),
            expected "a CSV file: a line of headers, then lines of numbers");
        let headers: StringRecord = headers.iter().map(plain).collect();
        refuse!(if headers.len() == 1 && headers[0].contains(';'), scope;
            found format!("{}, with semicolons between columns", path.display()),
            expected "a CSV file with commas between columns");
        let rows: Result<_, _> = reader.records().collect();
        Ok(Self {
            rows: rows.map_err(|cause| mistake(&cause))?,
            headers,
            place: path.display().to_string(),
        })
    }

    /// Columns that stand in the problem itself, by their headers; what is not finite is a gap.
    pub(crate) fn inside(
        columns: &BTreeMap<String, Vec<Option<f64>>>,
        scope: &Scope<'_>,
    ) -> Result<Self> {
        let count = columns.values().next().map_or(0, Vec::len);
        for (header, values) in columns {
            refuse!(if values.len() != count, scope.key(header);
                found format!("{} values beside {count}", values.len()),
                expected "columns that are as long as each other");
        }
        let cell = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
        let row = |k: usize| columns.values().map(|values| cell(values[k])).collect();
        Ok(Self {
            headers: columns.keys().collect(),
            rows: (0..count).map(row).collect(),
            place: "\"columns\"".to_owned(),
        })
    }

    /// All headers, and all rows, as they are written.
    pub(crate) fn written(&self) -> (&StringRecord, &[StringRecord]) {
        (&self.headers, &self.rows)
    }

    /// The column of a kind with a header, or with a header of this name and any unit; an empty cell is a mistake.
    pub(crate) fn column<M: PhysicalQuantity>(
        &self,
        name: &str,
        kind: &Kind,
        scope: &Scope<'_>,
    ) -> Result<Vec<Quantity<M>>> {
        let place = self.place(name, kind, scope)?;
        let read = |row: &StringRecord| self.cell(row, &place, scope);
        self.rows.iter().map(read).collect()
    }

    /// The same, where an empty cell is a gap.
    pub(crate) fn with_gaps<M: PhysicalQuantity>(
        &self,
        name: &str,
        kind: &Kind,
        scope: &Scope<'_>,
    ) -> Result<Vec<Option<Quantity<M>>>> {
        let place = self.place(name, kind, scope)?;
        let read = |row: &StringRecord| match row[place.index].is_empty() {
            true => Ok(None),
            false => self.cell(row, &place, scope).map(Some),
        };
        self.rows.iter().map(read).collect()
    }

    /// Place and unit of the column with a header. A note tells which unit is taken where the header has none.
    fn place(&self, name: &str, kind: &Kind, scope: &Scope<'_>) -> Result<Place> {
        let headers: Vec<Header<'_>> = (self.headers.iter())
            .map(|header| Header::new(header, kind))
            .collect();
        let at = |is_it: &dyn Fn(&Header<'_>) -> bool| {
            let headers = headers.iter().enumerate();
            let found = headers.filter(|(_, header)| is_it(header));
            found.map(|(at, _)| at).collect::<Vec<_>>()
        };
        let mut columns = at(&|header| header.whole == name);
        if columns.is_empty() {
            columns = at(&|header| header.name == name);
        }
        refuse!(if columns.len() > 1, scope;
            found format!("{} columns {name:?} in {}", columns.len(), self.place),
            expected "one column of this name");
        let Some(&at) = columns.first() else {
            let file = &self.place;
            let candidates = headers.iter().map(|header| header.name);
            let listed: Vec<&str> = self.headers.iter().take(20).collect();
            let expected = format!("a column of {file}, such as {}", listed.join(", "));
            return Err(scope
                .document
                .wrong_name(&scope.place, name, &expected, candidates));
        };
        let header = &headers[at];
        let unit = header.unit().map_err(|found| {
            let found = format!("the header {:?} of {}, {found}", header.whole, self.place);
            let expected = format!("{}, as \"{} [{}]\"", kind.name, header.name, kind.symbol());
            scope.wrong(found, expected)
        })?;
        let taken = kind.symbol();
        if unit.is_none() && !taken.is_empty() {
            let column = format!("{:?} of {}", header.whole, self.place);
            scope
                .document
                .note(format!("the header {column} has no unit: {taken} is taken"));
        }
        Ok(Place {
            index: at,
            unit: unit.map(str::to_owned),
        })
    }

    /// A cell in the unit of its column.
    fn cell<M: PhysicalQuantity>(
        &self,
        row: &StringRecord,
        place: &Place,
        scope: &Scope<'_>,
    ) -> Result<Quantity<M>> {
        let cell = &row[place.index];
        let quantity = match &place.unit {
            _ if cell.trim().is_empty() => Err("an empty cell".to_owned()),
            Some(unit) => Quantity::try_from_text(&format!("{cell} {unit}")),
            None => match cell.parse() {
                Ok(number) => Quantity::try_from_number(number),
                Err(_) => Err(format!("{cell:?}, which is no number")),
            },
        };
        quantity.map_err(|found| {
            let line = row.position().map(|at| format!("line {} of ", at.line()));
            let place = format!("{found}, in {}{}", line.unwrap_or_default(), self.place);
            scope.wrong(place, Quantity::<M>::expected())
        })
    }
}

/// Place of a column, and its unit where the header has one.
struct Place {
    index: usize,
    unit: Option<String>,
}

/// A header, read for a column of some kind.
#[derive(Debug)]
struct Header<'a> {
    /// As it is written.
    whole: &'a str,
    /// The part before the unit.
    name: &'a str,
    unit: WrittenUnit<'a>,
}

/// Text that stands for the unit of a header.
#[derive(Debug)]
enum WrittenUnit<'a> {
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
    fn new(whole: &'a str, kind: &Kind) -> Self {
        let all = splits(whole);
        let known = all
            .iter()
            .find_map(|&(name, tail)| Some((name, unit(tail, kind)?)));
        let is_marked = |c: char| c == '/' || BRACKETS.iter().any(|&(a, b)| c == a || c == b);
        let (name, unit) = match (known, whole.find(is_marked)) {
            (Some((name, unit)), _) => (name, WrittenUnit::Known(unit)),
            (None, None) => (whole, WrittenUnit::Nothing),
            (None, Some(mark)) => match all.iter().rfind(|(name, _)| name.len() <= mark) {
                Some(&(name, tail)) => (name, WrittenUnit::Other(tail)),
                None => (whole, WrittenUnit::Other(whole)),
            },
        };
        Self { whole, name, unit }
    }

    /// The unit, if there is one; the error names what is found in its place.
    fn unit(&self) -> Result<Option<&str>, String> {
        match &self.unit {
            WrittenUnit::Nothing => Ok(None),
            WrittenUnit::Known(unit) => Ok(Some(unit)),
            WrittenUnit::Other(tail) => Err(match Unit::parse(tail) {
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
