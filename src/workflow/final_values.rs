//! Final values of a motion, and those at its waypoints: the quantities that costs of single instants name.

use serde::Serialize;

use crate::control::measured_value;
use crate::control::problem::{Control, CostFunction, During, QuantityCost, instant_at};
use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::workflow::optimum::Optimum;
use crate::workflow::tracking::path;

/// A coordinate of a marker or a joint or a measured quantity at the end or at a waypoint, and what a cost asks for there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalValue {
    /// `tip_x`, `joint1`, `muscle1_tension`.
    pub name: String,
    /// Value that the cost asks for, in the unit.
    pub asked: f64,
    /// Value there.
    pub reached: f64,
    /// The distance of both, of angles without full turns.
    pub deviation: f64,
    /// m, rad, N, V/um, mA, W, rad/s or m/s.
    pub unit: &'static str,
    /// Time of the waypoint in s; absent at the end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
}

/// All that the costs of a problem ask for at single instants, with its motion: at waypoints in the order of the costs, then at its end.
pub(crate) fn final_values(
    optimum: &Optimum,
    control: &Control,
    motion: (&Trajectory, &DiscreteTrajectory),
) -> [Vec<FinalValue>; 2] {
    let (mut on_the_way, mut at_end) = (Vec::new(), Vec::new());
    for (index, cost) in control.objective.quantities.iter().enumerate() {
        match cost.during {
            During::Motion => {}
            During::At(part) => {
                let k = instant_at(part, motion.0.intervals());
                on_the_way.extend(value(optimum, (index, cost), motion, Some(k)));
            }
            During::End => at_end.extend(value(optimum, (index, cost), motion, None)),
        }
    }
    [on_the_way, at_end]
}

/// The value of a cost at the instant of a waypoint, or at the end.
fn value(
    optimum: &Optimum,
    (index, cost): (usize, &QuantityCost),
    (motion, discrete): (&Trajectory, &DiscreteTrajectory),
    waypoint: Option<usize>,
) -> Option<FinalValue> {
    let system = &optimum.model.system;
    let k = waypoint.unwrap_or(motion.intervals());
    let time = waypoint.map(|k| motion.times[k] / 1e3);
    if let Some(name) = cost.quantity.column(system) {
        let of = (&optimum.model, &optimum.boundary);
        let (reached, unit) = measured_value(of, (index, &cost.quantity), discrete, k)?;
        let asked = match &cost.function {
            CostFunction::Square { reference } => reference.at(motion.times[k]),
            CostFunction::Itself => 0.0,
        };
        return Some(FinalValue {
            name,
            asked,
            reached,
            deviation: (reached - asked).abs(),
            unit,
            time,
        });
    }
    let path = path(system, cost, motion)?;
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
        time,
    })
}
