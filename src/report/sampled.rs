//! Selection of the instants of a long motion that tables, figures and page show.
//!
//! Every n-th instant is shown, and more of them where the motion is fast: the path of a joint or marker
//! between two of them differs from the straight line by less than 1/500 of the height of a figure.

use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::workflow::{Tracked, TrackedPath};

/// Fewest intervals that are shown where some are left out.
const FEWEST: usize = 2000;
/// Part of the range of a curve that cannot be seen.
const SEEN: f64 = 2e-3;

/// Instants that are shown, of a motion of which not all are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sampled {
    /// Their indices: the first, the last, and some between.
    pub instants: Vec<usize>,
}

impl Sampled {
    /// Of a motion with these observations those nearest to multiples of `every` ms, or as many as are needed to see it; `None` where
    /// all are shown.
    pub fn from_observations(observations: &Observations, every: Option<f64>) -> Option<Self> {
        let times = &observations.columns.first()?.values;
        let last = times.len().checked_sub(1)?;
        let mut instants: Vec<usize> = match every {
            Some(every) => multiples(times, every),
            None => seen(times, observations),
        };
        instants.push(last);
        instants.dedup();
        (instants.len() <= last).then_some(Self { instants })
    }

    /// The motion at these instants, with the mean voltages between them.
    pub fn trajectory(&self, full: &Trajectory) -> Trajectory {
        let mean = |ends: &[usize]| {
            let within = &full.voltages[ends[0]..ends[1]];
            let length = |k: usize| full.times[k + 1] - full.times[k];
            let of_source = |s: usize| {
                let first = within[0][s];
                if within.iter().all(|row| row[s] == first) {
                    return first;
                }
                let sum = |of: &dyn Fn(usize) -> f64| (ends[0]..ends[1]).map(of).sum::<f64>();
                sum(&|k| length(k) * full.voltages[k][s]) / sum(&length)
            };
            (0..within[0].len()).map(of_source).collect()
        };
        Trajectory {
            times: self.pick(&full.times),
            joints: self.pick(&full.joints),
            poses: self.pick(&full.poses),
            marks: self.pick(&full.marks),
            voltages: self.instants.windows(2).map(mean).collect(),
            ends: Vec::new(),
            charges: full
                .charges
                .iter()
                .map(|(&muscle, charges)| (muscle, self.pick(charges)))
                .collect(),
        }
    }

    /// The columns at these instants.
    pub fn observations(&self, full: &Observations) -> Observations {
        let column = |column: &Column| Column {
            name: column.name.clone(),
            unit: column.unit,
            values: self.pick(&column.values),
        };
        Observations {
            columns: full.columns.iter().map(column).collect(),
        }
    }

    /// Coordinates at these instants, and the voltages and potentials before them.
    pub fn discrete_trajectory(&self, full: &DiscreteTrajectory) -> DiscreteTrajectory {
        let before = |&k: &usize| full.scalars[k - 1].clone();
        DiscreteTrajectory {
            times: self.pick(&full.times),
            z: self.pick(&full.z),
            scalars: self.instants[1..].iter().map(before).collect(),
            ..DiscreteTrajectory::default()
        }
    }

    /// Returns the references at these instants.
    pub fn tracked(&self, full: &[Tracked]) -> Vec<Tracked> {
        let path = |path: &TrackedPath| path.at(&self.instants);
        let tracked = |tracked: &Tracked| Tracked {
            paths: tracked.paths.iter().map(path).collect(),
            deviation: self.pick(&tracked.deviation),
            ..tracked.clone()
        };
        full.iter().map(tracked).collect()
    }

    fn pick<T: Clone>(&self, list: &[T]) -> Vec<T> {
        self.instants.iter().map(|&k| list[k].clone()).collect()
    }
}

/// Another motion, which is drawn next to one: not more of it than of that.
pub fn thinned(full: &Trajectory) -> Trajectory {
    let last = full.times.len() - 1;
    let mut instants: Vec<usize> = (0..=last).step_by((last / FEWEST).max(1)).collect();
    instants.push(last);
    instants.dedup();
    Sampled { instants }.trajectory(full)
}

/// The instants nearest to multiples of a time from the first one, each once.
fn multiples(times: &[f64], every: f64) -> Vec<usize> {
    let last = times.len() - 1;
    let since = |k: usize| (times[k] - times[0]) / every;
    let middle = |k: usize| 0.5 * (since(k) + since(k + 1));
    // A multiple between the middles of the intervals around an instant is nearest to it.
    let is_nearest = |&k: &usize| middle(k - 1).ceil() < middle(k);
    [0].into_iter()
        .chain((1..last).filter(is_nearest))
        .collect()
}

/// Returns each n-th instant, and those between that are needed to see the motion.
fn seen(times: &[f64], observations: &Observations) -> Vec<usize> {
    let last = times.len() - 1;
    let stride = (last / FEWEST).max(1);
    let columns = &observations.columns[1..];
    let moves = |column: &&Column| matches!(column.unit, "mm" | "rad");
    let mut curves: Vec<Curve<'_>> = columns
        .iter()
        .filter(moves)
        .map(Curve::from_column)
        .collect();
    if curves.is_empty() {
        let kinetic = columns
            .iter()
            .find(|column| column.name == "kinetic_energy");
        curves.extend(kinetic.map(Curve::from_column));
    }
    let mut instants = Vec::new();
    let mut spans = Vec::new();
    for start in (0..last).step_by(stride) {
        spans.push([start, (start + stride).min(last)]);
        while let Some([from, to]) = spans.pop() {
            if to > from + 1 && curves.iter().any(|curve| curve.bends(times, from, to)) {
                let middle = from.midpoint(to);
                spans.extend([[middle, to], [from, middle]]);
            } else {
                instants.push(from);
            }
        }
    }
    instants
}

/// A column, and the part of its range that cannot be seen.
struct Curve<'a> {
    values: &'a [f64],
    unseen: f64,
}

impl<'a> Curve<'a> {
    fn from_column(column: &'a Column) -> Self {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let wider = |(low, high): (f64, f64), value: &f64| (low.min(*value), high.max(*value));
        let (low, high) = column.values.iter().fold(ends, wider);
        Self {
            values: &column.values,
            unseen: SEEN * (high - low),
        }
    }

    /// Returns true if it differs visibly from the straight line between two instants.
    fn bends(&self, times: &[f64], from: usize, to: usize) -> bool {
        let Self { values, unseen } = self;
        let slope = (values[to] - values[from]) / (times[to] - times[from]);
        let line = |k: usize| values[from] + slope * (times[k] - times[from]);
        (from + 1..to).any(|k| (values[k] - line(k)).abs() > *unseen)
    }
}
