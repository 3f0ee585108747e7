//! A quantity as it is written: a number, or a string of a number with a unit.

use crate::files::units::unit::{Dimension, Unit, scale};

/// Written value: a number in SI units, or a string with a unit. It takes 16 bytes, and lists of many thousands are read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Written {
    Number(f64),
    Text(Box<str>),
}

impl Written {
    /// Number and unit; none of a plain number.
    pub(super) fn parts(&self) -> (f64, Option<Unit>) {
        match self {
            Self::Number(number) => (*number, None),
            Self::Text(text) => match parts(text) {
                Ok((number, unit)) => (number, Some(unit)),
                Err(_) => (f64::NAN, None),
            },
        }
    }
}

/// Number and unit of a text; the error names the value found instead.
pub(super) fn parts(text: &str) -> Result<(f64, Unit), String> {
    let (number, tail) = split_number(text.trim_start());
    let number: f64 = number
        .parse()
        .map_err(|_| format!("{text:?}, which does not begin with a number"))?;
    if tail.trim().is_empty() {
        return Err(format!("{text:?}, which has no unit"));
    }
    let unit = Unit::parse(tail)
        .ok_or_else(|| format!("{text:?}, where {:?} is no known unit", tail.trim()))?;
    Ok((number, unit))
}

/// The decimal number at the start of a text, and the rest.
fn split_number(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let sign = |at: usize| at + usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = digits(sign(0));
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = sign(end + 1);
        let exponent = digits(start);
        if exponent > start {
            end = exponent;
        }
    }
    text.split_at(end)
}

/// Symbols of units of the International System, by which quantities are written in tables.
const SYMBOLS: [&str; 25] = [
    "m",
    "kg",
    "s",
    "V",
    "rad",
    "Pa",
    "kg/m^3",
    "Pa s",
    "F/m",
    "V/m",
    "m/s^2",
    "m/s",
    "rad/s",
    "1/s",
    "kg m^2",
    "N m s/rad",
    "N s/m",
    "N/m",
    "N",
    "m^2",
    "N m",
    "N/m^3",
    "C",
    "C/m^2",
    "A",
];

/// Symbol of the unit of a dimension in the International System.
pub(super) fn symbol(dimension: Dimension) -> String {
    let named = |symbol: &&&str| Unit::parse(symbol).is_some_and(|one| one.dimension == dimension);
    let symbol = SYMBOLS.iter().find(named);
    symbol.map_or_else(|| dimension.to_string(), |symbol| (*symbol).to_owned())
}

/// Value and unit in the International System of a text such as `80 kPa`; none where it is no number with a unit.
pub(crate) fn si(text: &str) -> Option<(f64, String)> {
    let (number, unit) = parts(text).ok()?;
    let value = scale(number * unit.factor, unit.exponent);
    Some((value, symbol(unit.dimension)))
}
