//! Motion after a goal that no known voltages hold: under the last voltages, held on.

use serde::Serialize;

use crate::control::Solution;
use crate::control::problem::{BoundaryState, Control};
use crate::dynamics::Start;
use crate::dynamics::trajectory::Trajectory;
use crate::math::significant;
use crate::model::{Model, joint_unit};
use crate::workflow::distance::Distance;
use crate::workflow::held::{Held, held, is_small};
use crate::workflow::motion::trajectory;

/// Maximum number of parts of the goal listed.
const TOLD: usize = 3;

/// The motion after the goal, under the voltages of the last interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Afterwards {
    /// Time that was simulated in s.
    pub seconds: f64,
    /// Departure from each part of the goal, the farthest first.
    pub goal: Vec<Departure>,
    /// Greatest drift of the system from the last optimal instant.
    pub drift: Distance,
    /// Reason why the simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// True if the system stays at its goal.
    pub is_held: bool,
}

/// Departure from a part of a goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Departure {
    /// The marker or the joint.
    pub name: String,
    /// Greatest deviation from the goal.
    pub deviation: f64,
    /// Unit of the deviation: m or rad.
    pub unit: &'static str,
    /// Time at which it is greatest, in s after the end.
    pub time: f64,
}

/// Simulates on from the end of a motion, with the length of its path, to a goal that names places or joint coordinates and no voltages that hold it.
pub(crate) fn afterwards(
    model: &Model,
    control: &Control,
    optimal: &Solution,
    path_length: Distance,
) -> Option<Afterwards> {
    let is_named = control.names_no_hold() && !control.seeks_hold();
    let n = optimal.intervals();
    let end = Start {
        z: optimal.z.get(n)?.clone(),
        momentum: optimal.momentum.clone(),
        rates: None,
        time: *optimal.times.get(n)?,
    };
    let last = optimal.voltages.last()?;
    if !is_named || end.momentum.len() != model.coordinate_count() {
        return None;
    }
    let Held {
        motion,
        drift,
        failure,
    } = held(model, &end, optimal, last);
    Some(Afterwards {
        seconds: motion.times[motion.intervals()] / 1e3,
        goal: departures(model, &control.goal, &trajectory(model, &motion)),
        is_held: failure.is_none() && is_small(drift, path_length, model),
        drift,
        failure: failure.map(|error| error.to_string()),
    })
}

/// Returns the departures from the parts of a goal along a motion that begins there.
fn departures(model: &Model, goal: &BoundaryState, motion: &Trajectory) -> Vec<Departure> {
    let system = &model.system;
    let farthest = |name: &str, unit: &'static str, far: &dyn Fn(usize) -> f64| {
        let instants = 0..motion.times.len();
        let each = instants.map(|k| (far(k), motion.times[k] / 1e3));
        let (deviation, time) = each.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        Departure {
            name: name.to_owned(),
            deviation,
            unit,
            time,
        }
    };
    let mut list: Vec<Departure> = match goal {
        BoundaryState::Markers { places, .. } => {
            let all = places.iter();
            all.map(|(&m, place)| {
                let far = |k: usize| place.distance(&motion.marks[k][m]) / 1e3;
                farthest(&system.markers[m].name, "m", &far)
            })
            .collect()
        }
        BoundaryState::JointAngles { angles, .. } => {
            let all = angles.iter();
            all.map(|(&j, &value)| {
                let before = system.joints[..j].iter();
                let column = before.filter(|joint| joint.has_coordinate()).count();
                let (unit, scale) = match joint_unit(system, j) {
                    "mm" => ("m", 1e-3),
                    unit => (unit, 1.0),
                };
                let far = |k: usize| (motion.joints[k][column] - value).abs() * scale;
                farthest(&system.joints[j].name, unit, &far)
            })
            .collect()
        }
        _ => Vec::new(),
    };
    list.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
    list
}

impl Departure {
    /// In words, lengths in mm and angles in degrees.
    fn message(&self) -> String {
        let Self { name, time, .. } = self;
        let far = match self.unit {
            "m" => format!("{} mm", significant(1e3 * self.deviation, 3)),
            _ => format!("{}°", significant(self.deviation.to_degrees(), 3)),
        };
        format!(
            "{name} is up to {far} from its goal ({} s after the end)",
            significant(*time, 2)
        )
    }
}

impl Afterwards {
    /// That nothing holds the goal, where it is left; with the advice to seek inputs that hold it where these `can_be_sought`.
    pub(crate) fn warning(&self, can_be_sought: bool) -> Option<String> {
        if self.is_held {
            return None;
        }
        let mut far: Vec<String> = self
            .goal
            .iter()
            .take(TOLD)
            .map(Departure::message)
            .collect();
        far.push(format!("the system moves by {}", self.drift));
        far.extend(
            self.failure
                .iter()
                .map(|failure| format!("the motion ends early: {failure}")),
        );
        let advice = match can_be_sought {
            false => "\"rest_at_voltages\", or \"markers\" with \"hold\"",
            true => {
                "\"rest_at_voltages\", \"markers\" with \"hold\", or \"hold\": \"find\", which seeks the voltages of markers and joint angles"
            }
        };
        Some(format!(
            "nothing holds the goal: with the last inputs held on for {} s, {}; for an end that stays take {advice}",
            significant(self.seconds, 3),
            far.join(", ")
        ))
    }
}
