//! Units as text: prefix × unit × power, joined by products and quotients.
//!
//! A quantity is written as a number, or as a text of a number with a unit.

use serde_json::Value;
use std::f64::consts::PI;
use std::fmt;

/// Symbols of the units whose powers make a dimension.
const BASE: [&str; 6] = ["m", "kg", "s", "A", "K", "rad"];

/// Exponents of length, mass, time, current, temperature and the radian.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Dimension([i32; BASE.len()]);

impl Dimension {
    /// Decimal exponent from SI to g, mm, ms, A (so that V, N, MPa and mJ come out coherent).
    pub(crate) fn internal_exponent(self) -> i32 {
        3 * (self.0[0] + self.0[1] + self.0[2])
    }

    fn has_radian(self) -> bool {
        self.0[5] != 0
    }

    fn times(mut self, other: Self, power: i32) -> Option<Self> {
        for (own, term) in self.0.iter_mut().zip(other.0) {
            *own = own.checked_add(term.checked_mul(power)?)?;
        }
        Some(self)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms: Vec<String> = BASE
            .into_iter()
            .zip(self.0)
            .filter(|&(_, exponent)| exponent != 0)
            .map(|(symbol, exponent)| match exponent {
                1 => symbol.to_owned(),
                _ => format!("{symbol}^{exponent}"),
            })
            .collect();
        f.write_str(&terms.join(" "))
    }
}

/// A unit as a multiple of the coherent SI unit: factor × 10^exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    /// Factor in addition to the power of ten, 1 for decimal units.
    pub(crate) factor: f64,
    /// Power of ten.
    pub(crate) exponent: i32,
    /// Dimension.
    pub(crate) dimension: Dimension,
}

/// Largest power and combined decimal exponent that a unit may have.
const LARGEST: i32 = 99;

impl Unit {
    /// The unit 1.
    pub(crate) const ONE: Self = Self {
        factor: 1.0,
        exponent: 0,
        dimension: Dimension([0; BASE.len()]),
    };

    fn times(self, other: Self, power: i32) -> Option<Self> {
        let exponent = self
            .exponent
            .checked_add(other.exponent.checked_mul(power)?)?;
        let factor = self.factor * other.factor.powi(power);
        (exponent.abs() <= LARGEST && factor.is_finite()).then_some(())?;
        Some(Self {
            factor,
            exponent,
            dimension: self.dimension.times(other.dimension, power)?,
        })
    }

    /// Reads a product of units such as `kg/m^3`, `Pa s`, `N m s/rad`, `m·s⁻²`, `1/s`.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut unit = Self::ONE;
        let mut rest = text.trim();
        let mut divide = false;
        let mut first = true;
        while !rest.is_empty() {
            let (term, tail) = split_symbol(rest);
            let (power, tail) = split_power(tail)?;
            let term = match term {
                "" if first && rest.starts_with('1') => Self::ONE,
                _ => Self::symbol(term)?,
            };
            unit = unit.times(term, if divide { -power } else { power })?;
            (divide, rest) = split_operator(tail)?;
            first = false;
        }
        (!first && !divide).then_some(unit)
    }

    /// Reads one symbol, with or without a prefix.
    fn symbol(symbol: &str) -> Option<Self> {
        if let Some(unit) = named(symbol) {
            return Some(unit);
        }
        PREFIXES.iter().find_map(|&(prefix, exponent)| {
            let unit = named(symbol.strip_prefix(prefix)?)?;
            let prefixable = unit.factor == 1.0 && !unit.dimension.has_radian();
            prefixable.then_some(Self {
                exponent: unit.exponent + exponent,
                ..unit
            })
        })
    }
}

/// value × 10^exponent with one rounding while the power of ten is exact.
pub(crate) fn scale(value: f64, exponent: i32) -> f64 {
    if exponent < 0 {
        value / 10_f64.powi(-exponent)
    } else {
        value * 10_f64.powi(exponent)
    }
}

/// SI prefixes and their decimal exponents.
const PREFIXES: [(&str, i32); 14] = [
    ("da", 1),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
];

/// Units that have a name of their own: exponents of their dimension, factor and power of ten.
const NAMED: [(&str, [i32; BASE.len()], f64, i32); 21] = [
    ("m", [1, 0, 0, 0, 0, 0], 1.0, 0),
    ("Hz", [0, 0, -1, 0, 0, 0], 1.0, 0),
    ("g", [0, 1, 0, 0, 0, 0], 1.0, -3),
    ("t", [0, 1, 0, 0, 0, 0], 1.0, 3),
    ("s", [0, 0, 1, 0, 0, 0], 1.0, 0),
    ("min", [0, 0, 1, 0, 0, 0], 60.0, 0),
    ("A", [0, 0, 0, 1, 0, 0], 1.0, 0),
    ("K", [0, 0, 0, 0, 1, 0], 1.0, 0),
    ("N", [1, 1, -2, 0, 0, 0], 1.0, 0),
    ("Pa", [-1, 1, -2, 0, 0, 0], 1.0, 0),
    ("bar", [-1, 1, -2, 0, 0, 0], 1.0, 5),
    ("J", [2, 1, -2, 0, 0, 0], 1.0, 0),
    ("W", [2, 1, -3, 0, 0, 0], 1.0, 0),
    ("C", [0, 0, 1, 1, 0, 0], 1.0, 0),
    ("V", [2, 1, -3, -1, 0, 0], 1.0, 0),
    ("Ohm", [2, 1, -3, -2, 0, 0], 1.0, 0),
    ("Ω", [2, 1, -3, -2, 0, 0], 1.0, 0),
    ("F", [-2, -1, 4, 2, 0, 0], 1.0, 0),
    ("rad", [0, 0, 0, 0, 0, 1], 1.0, 0),
    ("deg", [0, 0, 0, 0, 0, 1], PI / 180.0, 0),
    ("°", [0, 0, 0, 0, 0, 1], PI / 180.0, 0),
];

fn named(symbol: &str) -> Option<Unit> {
    let (_, dimension, factor, exponent) = NAMED.into_iter().find(|one| one.0 == symbol)?;
    Some(Unit {
        factor,
        exponent,
        dimension: Dimension(dimension),
    })
}

/// The letters at the start of a text, and the rest (a leading `1` stands for no symbol).
fn split_symbol(text: &str) -> (&str, &str) {
    let end = text
        .find(|c: char| !(c.is_alphabetic() || c == '°'))
        .unwrap_or(text.len());
    match text.strip_prefix('1') {
        Some(rest) if end == 0 => ("", rest),
        _ => text.split_at(end),
    }
}

/// The power at the start of a text (`^-2`, `2`, `⁻²`, or nothing for 1), and the rest.
fn split_power(text: &str) -> Option<(i32, &str)> {
    let plain = |c: char| match c {
        '⁻' => Some('-'),
        '⁰' => Some('0'),
        '¹' => Some('1'),
        '²' => Some('2'),
        '³' => Some('3'),
        '⁴'..='⁹' => char::from_digit(c as u32 - '⁰' as u32, 10),
        '-' | '0'..='9' => Some(c),
        _ => None,
    };
    let (marked, body) = match text.strip_prefix('^') {
        Some(body) => (true, body),
        None => (false, text),
    };
    let end = body.find(|c| plain(c).is_none()).unwrap_or(body.len());
    if end == 0 {
        return (!marked).then_some((1, body));
    }
    let digits: String = body[..end].chars().filter_map(plain).collect();
    let power: i32 = digits.parse().ok()?;
    (power.abs() <= LARGEST).then_some((power, &body[end..]))
}

/// The operator at the start of a text (true for a division), and the rest.
fn split_operator(text: &str) -> Option<(bool, &str)> {
    let rest = text.trim_start();
    if let Some(rest) = rest.strip_prefix('/') {
        return Some((true, rest.trim_start()));
    }
    if let Some(rest) = rest.strip_prefix(['*', '·', '⋅']) {
        let rest = rest.trim_start();
        return (!rest.is_empty()).then_some((false, rest));
    }
    (rest.is_empty() || rest.len() < text.len()).then_some((false, rest))
}

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

/// Number and unit of a value, a number or a text such as `50 mm`, as they are written; no unit of a number.
pub(crate) fn number_and_unit(value: &Value) -> Option<(f64, Option<&str>)> {
    let Value::String(text) = value else {
        return Some((value.as_f64()?, None));
    };
    let (number, unit) = split_number(text.trim_start());
    let number: f64 = number.parse().ok()?;
    number.is_finite().then(|| (number, Some(unit.trim())))
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
