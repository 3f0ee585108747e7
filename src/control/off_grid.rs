//! Notes about what is asked for between two instants of the grid, and is reached at the nearest one.

use crate::control::problem::{Control, During, PathConstraint};
use crate::math::shortest;

/// Parts of an interval by which a waypoint may miss an instant.
const OFF: f64 = 1e-6;

/// Notes about waypoints and limits at a time that lie between two instants.
pub(super) fn off_grid(control: &Control) -> Vec<String> {
    let note = |name: String, part: f64| {
        let wanted = part * control.intervals as f64;
        let k = wanted.round();
        let time = k / control.intervals as f64 * control.duration.first() / 1e3;
        let time = shortest(time, 4);
        ((wanted - k).abs() > OFF)
            .then(|| format!("{name} lies between two instants: it is reached at {time} s"))
    };
    let exact = control.waypoints.iter();
    let exact = exact.filter_map(|waypoint| note(waypoint.name.clone(), waypoint.part));
    let costs = control.objective.quantities.iter();
    let near = costs.filter_map(|cost| match cost.during {
        During::At(part) => note(
            format!("waypoint at {} of the duration", shortest(part, 6)),
            part,
        ),
        During::Motion | During::End => None,
    });
    let limits = control.limits.iter().filter_map(|limit| match *limit {
        PathConstraint::Once { part, .. } => note(
            format!("limit at {} of the duration", shortest(part, 6)),
            part,
        ),
        _ => None,
    });
    let mut notes: Vec<String> = exact.chain(near).chain(limits).collect();
    notes.dedup();
    notes
}
