//! Muscles outside the domain of the first-order dielectric, in one note and in `summary.json`.

use crate::dynamics::{OutOfDomain, OutOfRange};
use serde::Serialize;

/// Most muscles and blocks that are written out.
const LISTED: usize = 4;

/// A muscle or block outside the domain of its first-order dielectric.
#[derive(Clone, Debug, Serialize)]
pub struct Outside {
    /// The muscle or block.
    name: String,
    /// Largest stretch.
    stretch: f64,
    /// Stretch beyond which charge and stiffness are negative.
    limit: f64,
    /// First time at which it is outside, in s.
    first: f64,
    /// Time at which the stretch is largest, in s.
    time: f64,
}

/// As `summary.json` has it.
pub(crate) fn records(list: &[OutOfDomain]) -> Vec<Outside> {
    let outside = |one: &OutOfDomain| Outside {
        name: one.name.clone(),
        stretch: one.stretch,
        limit: one.limit,
        first: one.first / 1e3,
        time: one.time / 1e3,
    };
    list.iter().map(outside).collect()
}

/// One note; with times where there is a motion.
pub(crate) fn note(list: &[Outside], moves: bool) -> Option<String> {
    let one = |out: &Outside| {
        let when = match moves {
            true => format!(" at {:.4} s, outside from {:.4} s on", out.time, out.first),
            false => String::new(),
        };
        format!(
            "{} is stretched to {:.4}{when} (the domain ends at {:.4})",
            out.name, out.stretch, out.limit
        )
    };
    let what = "outside the domain of the first-order dielectric, where charge and stiffness turn negative";
    listed(what, list, one)
}

/// Words on some of a list, and the number of the others; none of an empty one.
fn listed<T>(what: &str, list: &[T], one: impl Fn(&T) -> String) -> Option<String> {
    let named: Vec<String> = list.iter().take(LISTED).map(one).collect();
    let more = match list.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    (!named.is_empty()).then(|| format!("{what}: {}{more}", named.join("; ")))
}

/// One warning; with times where there is a motion.
pub(crate) fn stretch_range_warning(list: &[OutOfRange], moves: bool) -> Option<String> {
    let one = |out: &OutOfRange| {
        let when = match moves {
            true => format!(" at {:.4} s", out.time / 1e3),
            false => String::new(),
        };
        let [low, high] = out.range;
        format!(
            "{} has a stretch of {:.4}{when} (they hold from {low} to {high})",
            out.name, out.stretch
        )
    };
    let what = "outside the range of stretch for which the constants of the material hold";
    listed(what, list, one)
}
