//! Tracking errors: deviations of markers and joints from the references of the objective, read off the motion itself.

use crate::control::measured_value;
use crate::control::problem::{Control, CostFunction, During, QuantityCost, instant_at};
use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::math::Signal;
use crate::model::system::{Joint, System};
use crate::model::{What, joint_unit};
use crate::workflow::optimum::Optimum;
use serde::Serialize;

/// A marker or a joint, its reference, and its deviations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tracked {
    /// `marker` or `joint`.
    pub kind: &'static str,
    /// Its name.
    pub name: String,
    /// Unit of the deviations: m or rad.
    pub unit: &'static str,
    /// Deviations of the motion.
    #[serde(flatten)]
    pub error: TrackingError,
    /// Deviations of a simulation under the same voltages with half the step; absent where there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulated: Option<TrackingError>,
    /// Paths that it tracked, one for each direction of a marker.
    #[serde(skip)]
    pub paths: Vec<TrackedPath>,
    /// Deviation at each instant, in mm or rad.
    #[serde(skip)]
    pub deviation: Vec<f64>,
}

/// Deviations over time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrackingError {
    /// Root of the mean square over time.
    pub rms: f64,
    /// The greatest at an instant.
    pub maximum: f64,
    /// The time in s of the greatest.
    pub time_of_maximum: f64,
}

/// A coordinate and its reference, at each instant, in mm or rad.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackedPath {
    /// `tip_x`, `joint1`.
    pub name: String,
    /// Direction of a marker.
    pub axis: Option<usize>,
    /// Value.
    pub value: Vec<f64>,
    /// Reference.
    pub reference: Vec<f64>,
    /// Their difference, of angles without full turns.
    pub(crate) difference: Vec<f64>,
}

impl TrackedPath {
    /// A value and its reference.
    fn new(name: String, axis: Option<usize>, [value, reference]: [Vec<f64>; 2]) -> Self {
        let pairs = value.iter().zip(&reference);
        Self {
            name,
            axis,
            difference: pairs.map(|(value, reference)| value - reference).collect(),
            value,
            reference,
        }
    }

    /// The same at some of the instants, by their indices.
    pub fn at(&self, instants: &[usize]) -> Self {
        let pick = |list: &[f64]| instants.iter().map(|&k| list[k]).collect();
        Self {
            name: self.name.clone(),
            axis: self.axis,
            value: pick(&self.value),
            reference: pick(&self.reference),
            difference: pick(&self.difference),
        }
    }
}

/// All that an optimum follows, with its motion as a trajectory.
pub fn followed(optimum: &Optimum, control: &Control, motion: &Trajectory) -> Vec<Tracked> {
    let model = &optimum.model;
    let tested = optimum.resimulation.as_ref();
    let half = tested.and_then(|tested| tested.half.as_ref());
    let half = half.map(|discrete| Trajectory::from_discrete(model, discrete));
    tracked(&model.system, control, motion, half.as_ref())
}

/// All that a motion of a control problem follows; `simulated` is the motion under its voltages with half the step.
pub fn tracked(
    system: &System,
    control: &Control,
    motion: &Trajectory,
    simulated: Option<&Trajectory>,
) -> Vec<Tracked> {
    let mut groups: Vec<Vec<&QuantityCost>> = Vec::new();
    let costs = control.objective.quantities.iter();
    for cost in costs.filter(|cost| cost.during == During::Motion) {
        let same = groups
            .iter_mut()
            .find(|group| of_marker(group[0]).is_some() && of_marker(group[0]) == of_marker(cost));
        match same {
            Some(group) => group.push(cost),
            None => groups.push(vec![cost]),
        }
    }
    let of = |group: Vec<&QuantityCost>| {
        let along = |motion: &Trajectory| -> Vec<TrackedPath> {
            let paths = group.iter().filter_map(|cost| path(system, cost, motion));
            paths.collect()
        };
        let (kind, name, unit) = match (of_marker(group[0]), &group[0].quantity.what) {
            (Some(m), _) => ("marker", &system.markers[m].name, "m"),
            (None, &What::Joint { joint, .. }) if !group[0].quantity.is_step() => {
                let is_length = joint_unit(system, joint) == "mm";
                ("joint", &system.joints[joint].name, unit(is_length))
            }
            _ => return None,
        };
        let own = Tracked::new(kind, name, unit, &motion.times, along(motion));
        let again = simulated
            .map(|motion| Tracked::new(kind, name, unit, &motion.times, along(motion)).error);
        Some(Tracked {
            simulated: again,
            ..own
        })
    };
    groups.into_iter().filter_map(of).collect()
}

/// Unit of deviations of a length, or of an angle.
fn unit(is_length: bool) -> &'static str {
    if is_length { "m" } else { "rad" }
}

impl Tracked {
    /// A marker or a joint by its paths at times in ms.
    fn new(
        kind: &'static str,
        name: &str,
        unit: &'static str,
        times: &[f64],
        paths: Vec<TrackedPath>,
    ) -> Self {
        let deviation = deviations(&paths);
        let scale = if unit == "m" { 1e-3 } else { 1.0 };
        Self {
            kind,
            name: name.to_owned(),
            unit,
            error: TrackingError::from_deviations(times, &deviation, scale),
            simulated: None,
            paths,
            deviation,
        }
    }

    /// A marker of a motion and its places in mm in another one, at each instant.
    pub(crate) fn marker(
        name: &str,
        marker: usize,
        motion: &Trajectory,
        reference: &[[f64; 3]],
    ) -> Self {
        let of_axis = |axis: usize| {
            let value = motion.marks.iter().map(|places| places[marker][axis]);
            let reference = reference.iter().map(|place| place[axis]);
            let name = format!("{name}_{}", ["x", "y", "z"][axis]);
            TrackedPath::new(name, Some(axis), [value.collect(), reference.collect()])
        };
        let paths = (0..3).map(of_axis).collect();
        Self::new("marker", name, "m", &motion.times, paths)
    }

    /// A coordinate of a motion, a length in mm or not, and its values in another motion, at each instant.
    pub(crate) fn coordinate(
        name: &str,
        is_length: bool,
        times: &[f64],
        values: [Vec<f64>; 2],
    ) -> Self {
        let path = TrackedPath::new(name.to_owned(), None, values);
        Self::new("joint", name, unit(is_length), times, vec![path])
    }
}

fn of_marker(cost: &QuantityCost) -> Option<usize> {
    match cost.quantity.what {
        What::Place { marker, .. } => Some(marker),
        _ => None,
    }
}

/// A coordinate of a motion and its reference.
pub(crate) fn path(
    system: &System,
    cost: &QuantityCost,
    motion: &Trajectory,
) -> Option<TrackedPath> {
    let CostFunction::Square { reference } = &cost.function else {
        return None;
    };
    let (name, axis, value) = match cost.quantity.what {
        What::Place { marker, axis } => {
            let name = format!("{}_{}", system.markers[marker].name, ["x", "y", "z"][axis]);
            let marks = motion.marks.iter().map(|places| places[marker][axis]);
            (name, Some(axis), marks.collect::<Vec<f64>>())
        }
        What::Joint { joint, .. } if !cost.quantity.is_step() => {
            let before = system.joints[..joint].iter();
            let column = before.filter(|j| Joint::has_coordinate(j)).count();
            let values = motion.joints.iter().map(|row| row[column]);
            (system.joints[joint].name.clone(), None, values.collect())
        }
        _ => return None,
    };
    let at = |t: &f64| Signal::at(reference, *t);
    let reference: Vec<f64> = motion.times.iter().map(at).collect();
    let mut path = TrackedPath::new(name, axis, [value, reference]);
    if let Some(period) = cost.quantity.period(system) {
        let turns = path.difference.iter_mut();
        turns.for_each(|far| *far -= period * (*far / period).round());
    }
    Some(path)
}

/// The distance over all directions at each instant.
fn deviations(paths: &[TrackedPath]) -> Vec<f64> {
    let count = paths.first().map_or(0, |path| path.value.len());
    let at = |k: usize| {
        let squares = paths.iter().map(|path| path.difference[k].powi(2));
        squares.sum::<f64>().sqrt()
    };
    (0..count).map(at).collect()
}

impl TrackingError {
    /// Of deviations at times in ms, by the trapezoidal rule.
    fn from_deviations(times: &[f64], deviations: &[f64], scale: f64) -> Self {
        let mut integral = 0.0;
        for (t, e) in times.windows(2).zip(deviations.windows(2)) {
            integral += 0.5 * (t[1] - t[0]) * (e[0] * e[0] + e[1] * e[1]);
        }
        let duration = times[times.len() - 1] - times[0];
        let worst = (0..deviations.len()).max_by(|&a, &b| deviations[a].total_cmp(&deviations[b]));
        let worst = worst.unwrap_or(0);
        Self {
            rms: scale * (integral / duration).sqrt(),
            maximum: scale * deviations[worst],
            time_of_maximum: times[worst] / 1e3,
        }
    }
}

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
    motion: &Trajectory,
    discrete: &DiscreteTrajectory,
) -> [Vec<FinalValue>; 2] {
    let mut found = [Vec::new(), Vec::new()];
    for (index, cost) in control.objective.quantities.iter().enumerate() {
        let waypoint = match cost.during {
            During::Motion => continue,
            During::At(part) => Some(instant_at(part, motion.intervals())),
            During::End => None,
        };
        let value = value(optimum, index, cost, motion, discrete, waypoint);
        found[usize::from(waypoint.is_none())].extend(value);
    }
    found
}

/// The value of a cost at the instant of a waypoint, or at the end.
fn value(
    optimum: &Optimum,
    index: usize,
    cost: &QuantityCost,
    motion: &Trajectory,
    discrete: &DiscreteTrajectory,
    waypoint: Option<usize>,
) -> Option<FinalValue> {
    let system = &optimum.model.system;
    let k = waypoint.unwrap_or(motion.intervals());
    let time = waypoint.map(|k| motion.times[k] / 1e3);
    if let Some(name) = cost.quantity.column(system) {
        let (model, boundary) = (&optimum.model, &optimum.boundary);
        let (reached, unit) = measured_value(model, boundary, index, &cost.quantity, discrete, k)?;
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
