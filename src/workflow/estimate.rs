//! Errors of discretisation, estimated from the changes under refinement of the grid.
//!
//! With d the difference between a grid and the one with half its step, errors that fall like hᵖ leave `d/(2ᵖ − 1)` on the
//! finer grid and `d 2ᵖ/(2ᵖ − 1)` on the coarser one. Three grids show p, which is reported as it is. The midpoint rule has order
//! two, so that a p above two is chance: in an estimate a difference counts as no less than a quarter of the one before.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::model::Model;
use crate::model::system::JointKind;

/// Errors or orders by the name of the measure.
pub type Measures = BTreeMap<&'static str, f64>;

/// The measure that a grid has by itself: the motion against the one under the same voltages with half the step.
pub const RESPONSE: &str = "response";

/// Orders that estimates believe.
const ORDERS: [f64; 2] = [0.5, 2.0];
/// Differences below this are rounding.
const ROUNDING: f64 = 1e-13;

/// Values of a run that are compared with those on another grid, and with the motion at half the step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorSample {
    /// The objective; a simulation has none.
    pub objective: Option<f64>,
    /// The final time in ms, where it is free.
    pub duration: Option<f64>,
    /// Places by instant, in lengths of the system: of the markers, or where there are none of bodies and nodes.
    pub path: Vec<Vec<Vector3<f64>>>,
    /// The last instant: joint coordinates, directors of bodies, places of bodies and nodes (rad, or lengths of the system).
    pub end: Vec<f64>,
    /// Greatest deviation from the motion under the same voltages with half the step; infinite where there is no such motion.
    pub response: Option<f64>,
    /// Those of further motions of one program.
    pub further: Vec<Self>,
}

impl ErrorSample {
    /// A motion without objective.
    pub fn of_motion(model: &Model, discrete: &DiscreteTrajectory) -> Self {
        let motion = Trajectory::from_discrete(model, discrete);
        let length = model.length();
        let places = |k: usize| -> Vec<Vector3<f64>> {
            if !model.markers.is_empty() {
                return motion.marks[k].iter().map(|x| x / length).collect();
            }
            let mut places: Vec<_> = motion.poses[k].iter().map(|p| p.centre / length).collect();
            let bodies = places.len();
            let coordinates = discrete.z[k][model.action.map.nodes()].iter();
            for (value, &(node, axis)) in coordinates.zip(&model.action.map.of_nodes) {
                let least = bodies + node + 1;
                places.resize(least.max(places.len()), Vector3::zeros());
                places[least - 1][axis] = value / length;
            }
            places
        };
        let last = discrete.intervals();
        let kinds = model
            .system
            .joints
            .iter()
            .filter(|joint| joint.has_coordinate());
        let joints = motion.joints[last]
            .iter()
            .zip(kinds)
            .map(|(value, joint)| match joint.kind {
                JointKind::Prismatic { .. } => value / length,
                _ => *value,
            });
        let poses = &motion.poses[last];
        let directors = poses.iter().flat_map(|p| p.directors.iter().copied());
        let centres = poses.iter().flat_map(|p| p.centre.iter());
        let nodes = &discrete.z[last][model.action.map.nodes()];
        let lengths = centres.chain(nodes).map(|x| x / length);
        Self {
            path: (0..=last).map(places).collect(),
            end: joints.chain(directors).chain(lengths).collect(),
            ..Self::default()
        }
    }

    /// Greatest deviations along the path and at the end from a motion on a grid with this multiple of the intervals.
    fn apart(&self, fine: &Self) -> [f64; 2] {
        let times = (fine.path.len() - 1) / (self.path.len() - 1).max(1);
        let places = |k: usize| {
            let both = self.path[k].iter().zip(&fine.path[k * times]);
            both.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
        };
        let last = self.path.len() - 1;
        let end = self.end.iter().zip(&fine.end).map(|(a, b)| (a - b).abs());
        [
            (0..=last).map(places).fold(0.0, f64::max),
            end.fold(places(last), f64::max),
        ]
    }

    /// Greatest response of all motions.
    fn responses(&self) -> Option<f64> {
        let of_others = self.further.iter().filter_map(Self::responses);
        of_others.chain(self.response).reduce(f64::max)
    }

    /// Differences from a finer grid, of objective and duration relative to them; the greatest of all motions.
    pub fn differences(&self, fine: &Self) -> Measures {
        let mut out = Measures::new();
        let relative = |pair: (f64, f64)| match (pair.0 - pair.1).abs() {
            0.0 => 0.0,
            apart => apart / pair.0.abs().max(pair.1.abs()),
        };
        let objective = self.objective.zip(fine.objective).map(relative);
        let duration = self.duration.zip(fine.duration).map(relative);
        let [path, end] = self.apart(fine);
        out.extend(objective.map(|value| ("objective", value)));
        out.extend(duration.map(|value| ("duration", value)));
        out.extend([("path", path), ("end", end)]);
        for (own, fine) in self.further.iter().zip(&fine.further) {
            for (name, value) in own.differences(fine) {
                let most = out.entry(name).or_insert(value);
                *most = most.max(value);
            }
        }
        out
    }

    /// Errors of this grid: differences from a finer grid whose own errors are known; of the response its own.
    pub fn errors_from(&self, fine: &Self, left: &Measures) -> Measures {
        let mut errors = self.differences(fine);
        for (name, error) in &mut errors {
            *error += left.get(name).copied().unwrap_or_default();
        }
        // Half the step leaves a quarter of an error of second order.
        errors.extend(self.responses().map(|value| (RESPONSE, 4.0 / 3.0 * value)));
        errors
    }

    /// Greatest deviation from a motion on a finer grid, along the path and at the end.
    pub fn deviation(&self, fine: &Self) -> f64 {
        let [path, end] = self.apart(fine);
        path.max(end)
    }
}

/// Differences from grid to grid, and the error that they show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Convergence {
    /// By grid from the second on, those with the grid before; for [`RESPONSE`] from the first on, its own.
    differences: BTreeMap<&'static str, Vec<Difference>>,
}

/// A difference between two grids.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Difference {
    /// As it is; infinite where it is not finite.
    seen: f64,
    /// No less than a quarter of the one before.
    believed: f64,
}

impl Convergence {
    /// Takes in the next finer grid.
    pub fn add(&mut self, coarse: Option<&ErrorSample>, fine: &ErrorSample) {
        let mut new = coarse
            .map(|coarse| coarse.differences(fine))
            .unwrap_or_default();
        new.extend(fine.responses().map(|value| (RESPONSE, value)));
        for (name, value) in new {
            let list = self.differences.entry(name).or_default();
            let least = list.last().map_or(0.0, |before| before.believed / 4.0);
            let seen = if value.is_nan() { f64::INFINITY } else { value };
            let believed = seen.max(least);
            list.push(Difference { seen, believed });
        }
    }

    /// Orders that the last three grids show, as they are: zero or less where differences do not fall. Nothing of a measure
    /// that is rounding, or has too few grids.
    pub fn orders(&self) -> Measures {
        let mut orders = self.shown(|difference| difference.seen);
        orders.retain(|_, order| order.is_finite());
        orders
    }

    /// Returns true if all measures have two differences of which the second is smaller by at least the least order that estimates believe, or is
    /// rounding.
    pub fn is_confirmed(&self) -> bool {
        let falls = |list: &Vec<Difference>| match list.as_slice() {
            [.., last] if last.seen <= ROUNDING => true,
            [.., before, last] => before.seen >= ORDERS[0].exp2() * last.seen,
            _ => false,
        };
        self.differences.values().all(falls)
    }

    /// The orders shown by differences of either kind.
    fn shown(&self, kind: impl Fn(&Difference) -> f64) -> Measures {
        let order = |list: &Vec<Difference>| {
            let [.., before, last] = list.as_slice() else {
                return None;
            };
            let [before, last] = [before, last].map(&kind);
            let is_real = before.is_finite() && last.is_finite() && last > ROUNDING;
            is_real.then(|| (before / last).log2())
        };
        let known = self.differences.iter();
        known
            .filter_map(|(&name, list)| Some((name, order(list)?)))
            .collect()
    }

    /// Errors left on the finest grid, with `assumed` for an order that is not known.
    pub fn errors(&self, assumed: f64) -> Measures {
        self.left(assumed, |name, factor| match name {
            RESPONSE => factor / (factor - 1.0),
            _ => 1.0 / (factor - 1.0),
        })
    }

    /// The last differences times `part` of the factor by which errors fall from grid to grid.
    fn left(&self, assumed: f64, part: impl Fn(&'static str, f64) -> f64) -> Measures {
        let orders = self.shown(|difference| difference.believed);
        let error = |(&name, list): (&&'static str, &Vec<Difference>)| {
            let order = orders.get(name).copied().unwrap_or(assumed);
            let factor = order.clamp(ORDERS[0], ORDERS[1]).exp2();
            Some((name, list.last()?.believed * part(name, factor)))
        };
        self.differences.iter().filter_map(error).collect()
    }
}

/// The measure with the greatest error.
pub fn greatest(errors: &Measures) -> Option<(&'static str, f64)> {
    let all = errors.iter().map(|(&name, &value)| (name, value));
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}
