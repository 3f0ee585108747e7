//! Messages about the deviations of a motion from its reference.

use crate::math::significant;
use crate::workflow::tracking::Tracked;

/// Most joints that notes name one by one.
const NAMED: usize = 3;

/// Deviations in words.
pub(crate) fn words(of: &Tracked) -> String {
    let shown = |value: f64| match of.unit {
        "m" => format!("{} mm", significant(1e3 * value, 3)),
        unit => format!("{} {unit}", significant(value, 3)),
    };
    let [rms, most] = [of.error.rms, of.error.maximum].map(shown);
    format!("{rms} rms and at most {most}")
}

/// Lines about the tracking errors of a motion; of many joints the worst.
pub(crate) fn notes(tracked: &[Tracked]) -> Vec<String> {
    let joints = tracked.iter().filter(|one| one.kind == "joint");
    let count = joints.clone().count();
    let worst = joints.max_by(|a, b| a.error.maximum.total_cmp(&b.error.maximum));
    let line = |one: &Tracked| {
        let Tracked {
            kind, name, error, ..
        } = one;
        let time = significant(error.time_of_maximum, 3);
        let words = words(one);
        format!("{kind} {name} deviates from its path by {words} (at {time} s)")
    };
    let is_told = |one: &&Tracked| one.kind == "marker" || count <= NAMED;
    let mut lines: Vec<String> = tracked.iter().filter(is_told).map(line).collect();
    if let Some(worst) = worst.filter(|_| count > NAMED) {
        lines.push(format!("of {count} joints that follow, {}", line(worst)));
    }
    lines
}
