//! Faults of parts: the place in the part, the value found there, and the expectation.
//!
//! Numbers formatted for readers.

use std::collections::HashSet;
use std::fmt::Display;

/// A rule of a part that does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Place in the part by the keys of files, such as `to.at`; empty for the part as a whole.
    pub at: String,
    /// Value at that place, where it is the mistake; a file has it as it is written.
    pub value: Option<String>,
    /// Description of the value; behind a value what may be said of it, such as `, along the span`.
    pub found: String,
    /// Expectation in place of it.
    pub expected: String,
}

/// Expectation of a value, to which a file adds the kind of quantity.
const POSITIVE: &str = "a positive value";
const NOT_NEGATIVE: &str = "zero or a positive value";

/// Expectation of a direction.
pub const DIRECTION: &str = "a direction, such as [0, 0, 1]";

impl Fault {
    /// A fault at a place by its description.
    pub fn new(at: impl Display, found: impl Display, expected: impl Display) -> Self {
        Self {
            at: at.to_string(),
            value: None,
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    /// The value at a place is not what is expected; `why` may say more of it.
    pub fn of(at: impl Display, value: impl Display, why: &str, expected: impl Display) -> Self {
        Self {
            value: Some(value.to_string()),
            ..Self::new(at, why, expected)
        }
    }

    /// The same of what has the part under a key.
    pub fn under(mut self, key: &str) -> Self {
        let dot = if self.at.is_empty() || self.at.starts_with('[') {
            ""
        } else {
            "."
        };
        self.at = format!("{key}{dot}{}", self.at);
        self
    }

    /// The description with the value as it is.
    pub fn finding(&self) -> String {
        format!("{}{}", self.value.as_deref().unwrap_or(""), self.found)
    }

    /// Returns true if a kind of quantity belongs behind what is expected.
    pub fn expects_quantity(&self) -> bool {
        [POSITIVE, NOT_NEGATIVE].contains(&self.expected.as_str())
    }
}

/// A place in a part by the keys of files, for a rule that does not hold there.
#[derive(Clone, Copy, Debug)]
pub struct Key<D>(pub D);

/// The part as a whole.
pub const WHOLE: Key<&str> = Key("");

impl<D: Display> Key<D> {
    /// The fault of what is found here.
    pub fn wrong(self, found: String, expected: impl Display) -> Fault {
        Fault::new(self.0, found, expected)
    }

    /// The fault of the value here, which a file has as it is written.
    pub fn wrong_value(self, value: impl Display, expected: impl Display) -> Fault {
        Fault::of(self.0, value, "", expected)
    }
}

/// Refuses what is found at a place, or the value there, if something holds or is there, or unless it holds.
macro_rules! refuse {
    (if let $there:pat = $of:expr, $at:expr; found $found:expr, expected $expected:expr) => {
        if let $there = $of {
            return Err($at.wrong($found.to_string(), $expected));
        }
    };
    (if $holds:expr, $at:expr; found $found:expr, expected $expected:expr) => {
        if $holds {
            return Err($at.wrong($found.to_string(), $expected));
        }
    };
    (unless $holds:expr, $at:expr; found $found:expr, expected $expected:expr) => {
        match $holds {
            true => {}
            false => return Err($at.wrong($found.to_string(), $expected)),
        }
    };
    (unless $holds:expr, $at:expr; value $value:expr, expected $expected:expr) => {
        match $holds {
            true => {}
            false => return Err($at.wrong_value($value, $expected)),
        }
    };
}
pub(crate) use refuse;

/// A value that has to be positive and finite.
///
/// # Errors
/// It is not.
pub fn positive(at: impl Display, number: f64) -> Result<(), Fault> {
    refuse!(unless number > 0.0 && number.is_finite(), Key(at); value number, expected POSITIVE);
    Ok(())
}

/// A value that has to be zero or positive, and finite.
///
/// # Errors
/// It is not.
pub fn not_negative(at: impl Display, number: f64) -> Result<(), Fault> {
    refuse!(unless number >= 0.0 && number.is_finite(), Key(at); value number, expected NOT_NEGATIVE);
    Ok(())
}

/// Refuses a name that is empty, reserved, or that of an entry before it.
///
/// # Errors
/// The index of the first such name.
pub fn unique(names: &[impl AsRef<str>], reserved: &[&str]) -> Result<(), (usize, Fault)> {
    let mut seen = HashSet::new();
    for (index, name) in names.iter().map(AsRef::as_ref).enumerate() {
        let [wrong, expected] = match name {
            "" => ["", "a name"],
            name if reserved.contains(&name) => ["", "a name that is not reserved"],
            name if !seen.insert(name) => [" a second time", "a name that is not taken"],
            _ => continue,
        };
        return Err((
            index,
            Fault::new("name", format!("{name:?}{wrong}"), expected),
        ));
    }
    Ok(())
}

/// Below this a number is written with an exponent.
const SMALL: f64 = 1e-4;
/// And from this on.
const LARGE: f64 = 1e15;

/// Formats a number with this number of significant digits; trailing zeros stay. Very small and very large ones have an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if value.abs() < SMALL || value.abs() >= LARGE {
        let decimals = digits.saturating_sub(1);
        return format!("{value:.decimals$e}");
    }
    let before = value.abs().log10().floor() as i64 + 1;
    let decimals = usize::try_from(digits as i64 - before).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// The same without zeros at its end: `6.25` of 6.250000.
pub fn shortest(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    match text.parse::<f64>() {
        Ok(rounded) if (SMALL..LARGE).contains(&value.abs()) || value == 0.0 => rounded.to_string(),
        _ => text,
    }
}

/// The same for a positive number, rounded up.
pub fn no_smaller(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    match text.parse::<f64>() {
        Ok(rounded) if rounded < value => {
            let last = 10_f64.powf(value.log10().floor() + 1.0 - digits as f64);
            significant(value + last, digits)
        }
        _ => text,
    }
}

/// Prefixes of thousands, from 10⁻¹² to 10⁹.
const PREFIXES: [&str; 8] = ["p", "n", "µ", "m", "", "k", "M", "G"];

/// A unit of the International System, such as `Pa s`, with the prefix that suits an amount of it, and the factor to it: `kPa s` and 1e-3. A
/// power, an angle and a reciprocal have none.
pub fn prefixed(amount: f64, unit: &str) -> (String, f64) {
    // Prefixes stand before the gram.
    let (unit, factor) = match unit.strip_prefix("kg") {
        Some(rest) => (format!("g{rest}"), 1e3),
        None => (unit.to_owned(), 1.0),
    };
    let first = unit
        .find(|c: char| !c.is_alphabetic())
        .unwrap_or(unit.len());
    let is_plain = first > 0 && !unit[first..].starts_with('^') && &unit[..first] != "rad";
    let thousands = match is_plain && amount != 0.0 {
        true => ((factor * amount.abs()).log10() / 3.0)
            .floor()
            .clamp(-4.0, 3.0) as i32,
        false => 0,
    };
    let prefix = PREFIXES[(thousands + 4) as usize];
    (format!("{prefix}{unit}"), factor / 1e3_f64.powi(thousands))
}

#[cfg(test)]
#[path = "../../tests/units/math/digits.rs"]
mod tests;
