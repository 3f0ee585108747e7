//! Warning of muscles beyond the stretches for which the constants of their materials hold.

use crate::dynamics::OutOfRange;

/// Most muscles that are written out.
const LISTED: usize = 4;

/// One warning; with times where there is a motion.
pub(crate) fn warning(list: &[OutOfRange], moves: bool) -> Option<String> {
    if list.is_empty() {
        return None;
    }
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
    let named: Vec<String> = list.iter().take(LISTED).map(one).collect();
    let more = match list.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    Some(format!(
        "outside the range of stretch for which the constants of the material hold: {}{more}",
        named.join("; ")
    ))
}
