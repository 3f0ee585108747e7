//! Units as text: prefix × unit × power, joined by products and quotients, over the dimensions of uom.
//!
//! A quantity is written as a number, or as a text of a number with a unit.

use std::fmt;
use uom::typenum::Integer;
use uom::{Conversion, si};

/// Exponents of length, mass, time, current, temperature, amount and luminous intensity, then of the radian.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Dimension {
    si: [i32; 7],
    radian: i32,
}

impl Dimension {
    /// The dimension of a quantity of uom.
    pub(crate) fn of<D: si::Dimension + ?Sized>() -> Self {
        let si = [
            D::L::to_i32(),
            D::M::to_i32(),
            D::T::to_i32(),
            D::I::to_i32(),
            D::Th::to_i32(),
            D::N::to_i32(),
            D::J::to_i32(),
        ];
        Self { si, radian: 0 }
    }

    /// The same with a power of the radian.
    pub(crate) fn radians(self, radian: i32) -> Self {
        Self { radian, ..self }
    }

    /// Decimal exponent from SI to g, mm, ms, A (so that V, N, MPa and mJ come out coherent).
    pub(crate) fn internal_exponent(self) -> i32 {
        3 * (self.si[0] + self.si[1] + self.si[2])
    }

    fn times(mut self, other: Self, power: i32) -> Option<Self> {
        for (own, term) in self.si.iter_mut().zip(other.si) {
            *own = own.checked_add(term.checked_mul(power)?)?;
        }
        self.radian = self.radian.checked_add(other.radian.checked_mul(power)?)?;
        Some(self)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let symbols = ["m", "kg", "s", "A", "K", "mol", "cd", "rad"];
        let exponents = self.si.into_iter().chain([self.radian]);
        let terms: Vec<String> = symbols
            .into_iter()
            .zip(exponents)
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
        dimension: Dimension {
            si: [0; 7],
            radian: 0,
        },
    };

    /// A unit of uom.
    fn of<D: si::Dimension + ?Sized, U: Conversion<f64, T = f64>>() -> Self {
        let coefficient = U::coefficient();
        let exponent = coefficient.log10().round() as i32;
        let decimal = scale(1.0, exponent) == coefficient;
        Self {
            factor: if decimal { 1.0 } else { coefficient },
            exponent: if decimal { exponent } else { 0 },
            dimension: Dimension::of::<D>(),
        }
    }

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
            let prefixable = unit.factor == 1.0 && unit.dimension.radian == 0;
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

/// Units that have a name of their own.
fn named(symbol: &str) -> Option<Unit> {
    let radian = |unit: Unit| Unit {
        dimension: unit.dimension.radians(1),
        ..unit
    };
    Some(match symbol {
        "m" => Unit::of::<si::length::Dimension, si::length::meter>(),
        "g" => Unit::of::<si::mass::Dimension, si::mass::gram>(),
        "t" => Unit::of::<si::mass::Dimension, si::mass::ton>(),
        "s" => Unit::of::<si::time::Dimension, si::time::second>(),
        "min" => Unit::of::<si::time::Dimension, si::time::minute>(),
        "A" => Unit::of::<si::electric_current::Dimension, si::electric_current::ampere>(),
        "K" => Unit::of::<
            si::thermodynamic_temperature::Dimension,
            si::thermodynamic_temperature::kelvin,
        >(),
        "N" => Unit::of::<si::force::Dimension, si::force::newton>(),
        "Pa" => Unit::of::<si::pressure::Dimension, si::pressure::pascal>(),
        "bar" => Unit::of::<si::pressure::Dimension, si::pressure::bar>(),
        "J" => Unit::of::<si::energy::Dimension, si::energy::joule>(),
        "W" => Unit::of::<si::power::Dimension, si::power::watt>(),
        "C" => Unit::of::<si::electric_charge::Dimension, si::electric_charge::coulomb>(),
        "V" => Unit::of::<si::electric_potential::Dimension, si::electric_potential::volt>(),
        "Ohm" | "Ω" => {
            Unit::of::<si::electrical_resistance::Dimension, si::electrical_resistance::ohm>()
        }
        "F" => Unit::of::<si::capacitance::Dimension, si::capacitance::farad>(),
        "rad" => radian(Unit::of::<si::angle::Dimension, si::angle::radian>()),
        "deg" | "°" => radian(Unit::of::<si::angle::Dimension, si::angle::degree>()),
        _ => return None,
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
