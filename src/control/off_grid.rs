//! Notes about what is asked for where the grid has no instant or no step: the nearest instant, or nothing, stands for it.

use crate::control::bounded_quantity::BoundedQuantity;
use crate::control::limits::Limits;
use crate::control::problem::{Control, Duration, During, PathConstraint};
use crate::control::waypoint::instant_at;
use crate::math::shortest;

/// Parts of an interval by which a waypoint may miss an instant.
const OFF: f64 = 1e-6;

/// Verb of the notes about waypoints.
const REACHED: &str = "is reached";

/// Notes about waypoints and limits at a time that lie between two instants.
pub(super) fn off_grid(control: &Control) -> Vec<String> {
    let count = control.intervals;
    let note = |name: String, part: f64, verb: &str| {
        let k = instant_at(part, count);
        let at = match control.duration {
            Duration::Given(duration) => {
                let time = k as f64 / count as f64 * duration / 1e3;
                format!("{} s", shortest(time, 4))
            }
            Duration::Free { .. } => format!("instant {k} of {count}"),
        };
        ((part * count as f64 - k as f64).abs() > OFF)
            .then(|| format!("{name} lies between two instants: it {verb} at {at}"))
    };
    let exact = control.waypoints.iter();
    let exact = exact.filter_map(|waypoint| note(waypoint.name.clone(), waypoint.part, REACHED));
    let costs = control.objective.quantities.iter();
    let near = costs.filter_map(|cost| match cost.during {
        During::At(part) => note(
            format!("waypoint at {} of the duration", shortest(part, 6)),
            part,
            REACHED,
        ),
        During::Motion | During::End => None,
    });
    let limits = control.limits.iter().filter_map(|limit| match *limit {
        PathConstraint::Once { part, .. } => note(
            format!("limit at {} of the duration", shortest(part, 6)),
            part,
            "holds",
        ),
        _ => None,
    });
    let mut notes: Vec<String> = exact.chain(near).chain(limits).collect();
    notes.dedup();
    notes
}

/// Notes about limits of steps between intervals, of which one interval has none.
pub(super) fn without_steps(control: &Control, limits: &Limits) -> Vec<String> {
    let steps = limits.list.iter().filter(|_| control.intervals == 1);
    let steps = steps.filter(|bounded| bounded.quantity.before().is_some());
    let note = |bounded: &BoundedQuantity| {
        let name = &bounded.name;
        format!(
            "the {name} is limited from one interval to the next: one interval has no such step"
        )
    };
    let mut notes: Vec<String> = steps.map(note).collect();
    notes.dedup();
    notes
}
