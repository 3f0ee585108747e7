//! Refinement of the grid to an accuracy: each grid starts from the solution on the one before, until the estimated error is small enough.
//!
//! Errors of discretisation, estimated from the changes under refinement of the grid.
//!
//! With d the difference between a grid and the one with half its step, errors that fall like hᵖ leave `d/(2ᵖ − 1)` on the
//! finer grid and `d 2ᵖ/(2ᵖ − 1)` on the coarser one. Three grids show p, which is reported as it is. The midpoint rule has order
//! two, so that a p above two is chance: in an estimate a difference counts as no less than a quarter of the one before.

use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::model::Model;
use crate::model::system::JointKind;
use crate::workflow::error::WorkflowError;
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Largest ratio of the intervals of a grid to those of the first.
const FINEST: usize = 1 << 10;
/// The finest grid for an estimate, in times the intervals of the first.
const ESTIMATED: usize = 8;
/// No grid has more variables than this.
pub(super) const VARIABLES: usize = 2_000_000;
/// Order of optimal voltages until three grids show it: switches and the cost of the first and last jump may make it one.
pub(super) const OF_CONTROL: f64 = 1.0;

/// Target of the error of discretisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AccuracyTarget {
    /// Grids are refined until every error is estimated below this.
    Below(f64),
    /// The error on the grid of the problem is estimated, by two refinements or more.
    Estimate,
}

/// A run on one grid.
#[derive(Clone, Debug)]
pub struct Attempt<R> {
    /// The run.
    pub run: R,
    /// Values that are compared.
    pub sample: ErrorSample,
    /// Number of intervals or steps.
    pub intervals: usize,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Unknowns of all instants.
    pub variables: usize,
    /// Status at its end, in a word.
    pub status: &'static str,
    /// True if it came to its end.
    pub is_complete: bool,
}

/// Error of discretisation, as written to `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// The error that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub requested: Option<f64>,
    /// True if the estimate is below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_met: Option<bool>,
    /// Estimated errors of the solution that is kept; none where there is no second grid.
    pub estimate: Measures,
    /// True if differences that fall over three grids confirm the estimate.
    pub is_confirmed: bool,
    /// Orders in the step that the last three grids show, as observed; zero or less where differences do not fall.
    pub order: Measures,
    /// Order where none is shown.
    pub assumed_order: f64,
    /// The grids, coarsest first.
    pub levels: Vec<GridLevel>,
    /// Reason why there is no finer grid, where the accuracy is not met or no estimate could be made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
}

/// A grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridLevel {
    /// Number of intervals or steps.
    pub intervals: usize,
    /// Status at its end.
    pub status: &'static str,
    /// Seconds, set-up and comparison included.
    pub seconds: f64,
    /// Iterations of the solver, or of Newton's method.
    pub iterations: usize,
    /// The objective; a simulation has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objective: Option<f64>,
    /// Estimated errors, from the grids so far.
    #[serde(skip_serializing_if = "Measures::is_empty")]
    pub estimate: Measures,
}

/// The run that is kept and the way to it.
#[derive(Clone, Debug)]
pub struct Refined<R> {
    /// The run on the finest grid that was solved; the one on the first grid where only its error was asked for.
    pub run: R,
    /// Factor by which its intervals exceed those of the first grid.
    pub times: usize,
    /// Iterations on the grids up to its own.
    pub iterations: usize,
    /// Error of discretisation, as reported.
    pub accuracy: Accuracy,
}

/// Runs on finer and finer grids.
///
/// `attempt` runs on a number of times the intervals of the first grid, from the run before; `stop` says in a word why no
/// other grid may follow. The order of convergence is `assumed` until three grids show it.
///
/// # Errors
/// The first run has no answer. A later one that has none ends the refinement.
pub fn refine<R>(
    wanted: AccuracyTarget,
    assumed: f64,
    stop: impl Fn() -> Option<&'static str>,
    mut attempt: impl FnMut(usize, Option<&R>) -> Result<Attempt<R>, WorkflowError>,
) -> Result<Refined<R>, WorkflowError> {
    let mut timed = |times: usize, before: Option<&R>| {
        let began = Instant::now();
        attempt(times, before).map(|attempt| {
            let level = GridLevel::new(&attempt, began.elapsed().as_secs_f64());
            (attempt, level)
        })
    };
    let (first, level) = timed(1, None)?;
    let mut grids = Grids::new(first, level, assumed);
    while grids.stopped.is_none() {
        let finer = 2 * grids.times;
        grids.stopped = stop().map(str::to_owned).or_else(|| grids.limit(finer));
        if grids.stopped.is_some() {
            break;
        }
        match timed(finer, Some(&grids.kept.run)) {
            Err(error) => grids.stopped = Some(error.to_string()),
            Ok((fine, level)) if !fine.is_complete => {
                grids.stopped = Some(fine.status.to_owned());
                grids.levels.push(level);
            }
            Ok((fine, level)) => {
                let is_last = match wanted {
                    AccuracyTarget::Below(requested) => grids.replace(fine, level, requested),
                    AccuracyTarget::Estimate => grids.compare(fine, level),
                };
                if is_last {
                    break;
                }
            }
        }
    }
    Ok(grids.finish(wanted))
}

/// The grids of a refinement so far.
struct Grids<R> {
    /// The run on the finest grid, and the factor by which its intervals exceed those of the first.
    kept: Attempt<R>,
    times: usize,
    /// The run on the first grid, where its error alone was asked for.
    own: Option<Attempt<R>>,
    /// Iterations on the grids up to the one that is kept.
    iterations: usize,
    levels: Vec<GridLevel>,
    convergence: Convergence,
    assumed: f64,
    estimate: Measures,
    is_confirmed: bool,
    /// Reason why there is no finer grid.
    stopped: Option<String>,
}

impl<R> Grids<R> {
    /// The first grid.
    fn new(first: Attempt<R>, level: GridLevel, assumed: f64) -> Self {
        let mut convergence = Convergence::default();
        convergence.add(None, &first.sample);
        Self {
            times: 1,
            own: None,
            iterations: first.iterations,
            levels: vec![level],
            convergence,
            assumed,
            estimate: Measures::new(),
            is_confirmed: false,
            stopped: (!first.is_complete).then(|| first.status.to_owned()),
            kept: first,
        }
    }

    /// The word for a next grid that would be too fine.
    fn limit(&self, finer: usize) -> Option<String> {
        let is_too_large = finer > FINEST || 2 * self.kept.variables > VARIABLES;
        is_too_large.then(|| "too_large".to_owned())
    }

    /// Estimates the errors of a finer grid.
    fn estimate(&mut self, fine: &Attempt<R>) {
        self.convergence.add(Some(&self.kept.sample), &fine.sample);
        self.is_confirmed = self.convergence.is_confirmed();
        self.estimate = self.convergence.errors(self.assumed);
    }

    /// Estimates the error of the first grid by a finer one. Returns true if that was the last grid.
    fn compare(&mut self, fine: Attempt<R>, level: GridLevel) -> bool {
        self.estimate(&fine);
        // The first grid is as far from the finest one, and that from the limit.
        let first = self.own.as_ref().unwrap_or(&self.kept);
        self.estimate = first.sample.errors_from(&fine.sample, &self.estimate);
        self.levels[0].estimate.clone_from(&self.estimate);
        self.levels.push(level);
        self.times *= 2;
        let coarse = std::mem::replace(&mut self.kept, fine);
        self.own.get_or_insert(coarse);
        self.is_confirmed || self.times >= ESTIMATED
    }

    /// Keeps a finer grid in place of the one before. Returns true if its error is below the one requested.
    fn replace(&mut self, fine: Attempt<R>, mut level: GridLevel, requested: f64) -> bool {
        self.estimate(&fine);
        level.estimate.clone_from(&self.estimate);
        self.levels.push(level);
        self.iterations += fine.iterations;
        self.times *= 2;
        self.kept = fine;
        is_below(&self.estimate, requested) && self.is_confirmed
    }

    /// The run that is kept, with the error of its grid.
    fn finish(self, wanted: AccuracyTarget) -> Refined<R> {
        let (kept, times) = match self.own {
            Some(own) => (own, 1),
            None => (self.kept, self.times),
        };
        let requested = match wanted {
            AccuracyTarget::Below(value) => Some(value),
            AccuracyTarget::Estimate => None,
        };
        let is_below = |value| self.is_confirmed && is_below(&self.estimate, value);
        Refined {
            run: kept.run,
            times,
            iterations: self.iterations,
            accuracy: Accuracy {
                requested,
                is_met: requested.map(is_below),
                is_confirmed: self.is_confirmed,
                order: self.convergence.orders(),
                assumed_order: self.assumed,
                estimate: self.estimate,
                levels: self.levels,
                stopped: self.stopped,
            },
        }
    }
}

/// Returns true if there is an estimate, all of it below a value.
fn is_below(estimate: &Measures, value: f64) -> bool {
    greatest(estimate).is_some_and(|(_, error)| error <= value)
}

impl GridLevel {
    fn new<R>(attempt: &Attempt<R>, seconds: f64) -> Self {
        Self {
            intervals: attempt.intervals,
            status: attempt.status,
            seconds,
            iterations: attempt.iterations,
            objective: attempt.sample.objective,
            estimate: Measures::new(),
        }
    }
}

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
        let joints = model.system.joints.iter();
        let joints = joints.filter(|joint| joint.has_coordinate());
        let joints = motion.joints[last].iter().zip(joints);
        let joints = joints.map(|(value, joint)| match joint.kind {
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
        let new = coarse.map(|coarse| coarse.differences(fine));
        let mut new = new.unwrap_or_default();
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
        let known = known.filter_map(|(&name, list)| Some((name, order(list)?)));
        known.collect()
    }

    /// Errors left on the finest grid, with `assumed` for an order that is not known.
    pub fn errors(&self, assumed: f64) -> Measures {
        let orders = self.shown(|difference| difference.believed);
        let errors = self.differences.iter().filter_map(|(&name, list)| {
            let order = orders.get(name).copied().unwrap_or(assumed);
            // By this errors fall from grid to grid.
            let factor = order.clamp(ORDERS[0], ORDERS[1]).exp2();
            let part = match name {
                RESPONSE => factor / (factor - 1.0),
                _ => 1.0 / (factor - 1.0),
            };
            Some((name, list.last()?.believed * part))
        });
        errors.collect()
    }
}

/// The measure with the greatest error.
pub fn greatest(errors: &Measures) -> Option<(&'static str, f64)> {
    let all = errors.iter().map(|(&name, &value)| (name, value));
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}
