//! Final values of a motion: the quantities that the final costs of its objective name.

use serde::Serialize;

use crate::control::problem::{Control, During};
use crate::dynamics::trajectory::Trajectory;
use crate::model::System;
use crate::workflow::tracking::path;

/// A coordinate of a marker or a joint at the end, and what a final cost asks for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalValue {
    /// `tip_x`, `joint1`.
    pub name: String,
    /// Value that the cost asks for, in the unit.
    pub asked: f64,
    /// Value at the end of the motion.
    pub reached: f64,
    /// The distance of both, of angles without full turns.
    pub deviation: f64,
    /// m or rad.
    pub unit: &'static str,
}

/// All that the final costs of a problem ask for, with its motion.
pub(crate) fn final_values(
    system: &System,
    control: &Control,
    motion: &Trajectory,
) -> Vec<FinalValue> {
    let costs = control.objective.quantities.iter();
    let at_end = costs.filter(|cost| cost.during == During::End);
    at_end
        .filter_map(|cost| {
            let path = path(system, cost, motion)?;
            let (scale, unit) = match cost.quantity.unit(system) {
                "mm" => (1e-3, "m"),
                unit => (1.0, unit),
            };
            Some(FinalValue {
                asked: scale * path.reference.last()?,
                reached: scale * path.value.last()?,
                deviation: scale * path.difference.last()?.abs(),
                name: path.name,
                unit,
            })
        })
        .collect()
}
