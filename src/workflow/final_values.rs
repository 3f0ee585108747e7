//! Final values of a motion, and those at its waypoints: the quantities that costs of single instants name.

use serde::Serialize;

use crate::control::problem::{Control, During, QuantityCost, instant_at};
use crate::dynamics::trajectory::Trajectory;
use crate::model::System;
use crate::workflow::tracking::path;

/// A coordinate of a marker or a joint at the end or at a waypoint, and what a cost asks for there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalValue {
    /// `tip_x`, `joint1`.
    pub name: String,
    /// Value that the cost asks for, in the unit.
    pub asked: f64,
    /// Value there.
    pub reached: f64,
    /// The distance of both, of angles without full turns.
    pub deviation: f64,
    /// m or rad.
    pub unit: &'static str,
    /// Time of the waypoint in s; absent at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

/// All that the costs of a problem ask for at single instants, with its motion: at waypoints in the order of the costs, then at its end.
pub(crate) fn final_values(
    system: &System,
    control: &Control,
    motion: &Trajectory,
) -> [Vec<FinalValue>; 2] {
    let costs = control.objective.quantities.iter();
    let (mut on_the_way, mut at_end) = (Vec::new(), Vec::new());
    for cost in costs {
        match cost.during {
            During::Motion => {}
            During::At(part) => {
                let k = instant_at(part, motion.intervals());
                on_the_way.extend(value(system, cost, motion, Some(k)));
            }
            During::End => at_end.extend(value(system, cost, motion, None)),
        }
    }
    [on_the_way, at_end]
}

/// The value of a cost at the instant of a waypoint, or at the end.
fn value(
    system: &System,
    cost: &QuantityCost,
    motion: &Trajectory,
    waypoint: Option<usize>,
) -> Option<FinalValue> {
    let path = path(system, cost, motion)?;
    let k = waypoint.unwrap_or(motion.intervals());
    let (scale, unit) = match cost.quantity.unit(system) {
        "mm" => (1e-3, "m"),
        unit => (1.0, unit),
    };
    Some(FinalValue {
        asked: scale * path.reference.get(k)?,
        reached: scale * path.value.get(k)?,
        deviation: scale * path.difference.get(k)?.abs(),
        name: path.name,
        unit,
        time: waypoint.map(|k| motion.times[k] / 1e3),
    })
}
