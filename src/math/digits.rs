//! Numbers as people read them.

/// A number with so many digits that count; trailing zeros stay.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let before = value.abs().log10().floor() as i64 + 1;
    let decimals = usize::try_from(digits as i64 - before).unwrap_or(0);
    format!("{value:.decimals$}")
}
