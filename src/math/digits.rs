//! Numbers formatted for readers.

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

#[cfg(test)]
mod tests {
    use crate::math::digits::no_smaller;

    #[test]
    fn a_number_rounded_up_is_no_smaller() {
        for (value, expected) in [
            (0.1841, "0.185"),
            (0.2, "0.200"),
            (24.44, "24.5"),
            (9.996, "10.00"),
            (0.001_234, "0.00124"),
        ] {
            let found: f64 = no_smaller(value, 3).parse().unwrap();
            assert!(found >= value, "{found} for {value}");
            assert_eq!(found, expected.parse::<f64>().unwrap());
        }
    }
}
