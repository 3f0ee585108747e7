//! A solution carried to another number of intervals: coordinates and costates along smooth curves, voltages by their means.
//!
//! Data of an instant or interval are carried by value: coordinates, voltages, potentials, costates of
//! momentum balances and of Gauss's laws. Sums over a step go with its length: impulses of constraints, costates
//! of path limits, of bounds and of functions of time. A finer grid has more and smaller ones.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::identification::{Costates, Solution};
use crate::control::numbering::{Column, Row};
use crate::control::problem::Control;
use crate::control::transcription::Site;
use crate::control::transcription::layout::Layout;
use crate::coordinates::CoordinateMap;
use crate::model::{Model, Role};

/// Instants of the old grid that a curve is led through.
const THROUGH: usize = 4;

/// Two grids over one duration, or over one that is stretched.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grids {
    from: usize,
    to: usize,
    /// New duration in old ones.
    stretch: f64,
}

/// Instants of the old grid with their weights.
type Weights = Vec<(usize, f64)>;

impl Grids {
    /// Makes the map from a number of intervals to another, with the duration multiplied by `stretch`.
    pub(super) fn new(from: usize, to: usize, stretch: f64) -> Self {
        Self { from, to, stretch }
    }

    /// New interval length in old ones.
    fn ratio(self) -> f64 {
        self.from as f64 / self.to as f64 * self.stretch
    }

    /// Means over new interval k of what the old intervals have. Within an old one the value runs along the flatter of the lines
    /// to its neighbours, or is constant next to a peak and at the ends: smooth voltages stay smooth, jumps stay jumps, and
    /// a jump within a new interval keeps its impulse.
    pub(super) fn mean(self, rows: &[Vec<f64>], k: usize) -> Vec<f64> {
        let place = |k: usize| (k * self.from) as f64 / self.to as f64;
        let (begin, end) = (place(k), place(k + 1));
        let first = k * self.from / self.to;
        let last = ((k + 1) * self.from).div_ceil(self.to);
        let part = |i: usize, s: usize| {
            let (a, b) = (begin.max(i as f64), end.min((i + 1) as f64));
            let middle = 0.5 * (a + b) - i as f64 - 0.5;
            (b - a) / (end - begin) * (rows[i][s] + middle * slope(rows, i, s))
        };
        let mean = |s: usize| (first..last).map(|i| part(i, s)).sum();
        (0..rows[0].len()).map(mean).collect()
    }

    /// Old interval that the middle of new interval k is in.
    fn interval(self, k: usize) -> usize {
        ((2 * k + 1) * self.from / (2 * self.to)).min(self.from - 1)
    }

    /// Old instants around new instant k and the weights of their polynomial there; the instant itself where it is one.
    fn weights(self, k: usize) -> Weights {
        let exact = k * self.from;
        if exact.is_multiple_of(self.to) {
            return vec![(exact / self.to, 1.0)];
        }
        let place = exact as f64 / self.to as f64;
        let count = THROUGH.min(self.from + 1);
        let before = (exact / self.to + 1).saturating_sub(count / 2);
        let first = before.min(self.from + 1 - count);
        let nodes = first..first + count;
        let weight = |j: usize| {
            let factor = |l: usize| (place - l as f64) / (j as f64 - l as f64);
            nodes.clone().filter(|&l| l != j).map(factor).product()
        };
        nodes.clone().map(|j| (j, weight(j))).collect()
    }

    /// Old instant next to new instant k.
    fn nearest(self, k: usize) -> usize {
        (2 * k * self.from + self.to) / (2 * self.to)
    }
}

/// Change of entry s within interval i: the smaller one of those from the interval before and to the next; none where they differ
/// in sign and at the ends.
fn slope(rows: &[Vec<f64>], i: usize, s: usize) -> f64 {
    if i == 0 || i + 1 == rows.len() {
        return 0.0;
    }
    let [before, after] = [(i - 1, i), (i, i + 1)].map(|(a, b)| rows[b][s] - rows[a][s]);
    match before * after > 0.0 {
        true if before.abs() < after.abs() => before,
        true => after,
        false => 0.0,
    }
}

/// Coordinates and impulses of constraints at the new instants, the impulses in units of `unit` ms times a force.
pub(super) fn coordinates(
    solved: &Solution,
    grids: Grids,
    map: &CoordinateMap,
    unit: f64,
) -> Vec<Vec<f64>> {
    let impulse = grids.ratio() * solved.multiplier_time / unit;
    let at = |k: usize| {
        let mut z = vec![0.0; solved.z[0].len()];
        for (j, weight) in grids.weights(k) {
            for (value, old) in z.iter_mut().zip(&solved.z[j]) {
                *value += weight * old;
            }
        }
        for multiplier in &mut z[map.coordinates..map.unknowns()] {
            *multiplier *= impulse;
        }
        let weights = grids.weights(k);
        let parts = weights.iter().map(|&(j, weight)| (weight, &*solved.z[j]));
        map.mean_of_charts(&parts.collect::<Vec<_>>(), &mut z);
        z
    };
    (0..=grids.to).map(at).collect()
}

/// Costates on the new grid; `None` where the solution has none of this program.
pub(super) fn costates(
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    solved: &Solution,
    grids: Grids,
) -> Option<Costates> {
    let old = solved.costates.as_ref()?;
    let from = Layout::new(model, boundary, control, grids.from);
    let to = Layout::new(model, boundary, control, grids.to);
    let fits = old.rows.len() == from.unknowns.rows.len()
        && old.lower.len() == from.unknowns.columns.len()
        && old.upper.len() == from.unknowns.columns.len();
    if !fits {
        return None;
    }
    let ratio = grids.ratio();
    let constraint = ratio * solved.multiplier_time / model.multiplier_time;
    let interval = |k: usize| match k < to.span.end {
        true => grids.interval(k),
        false => from.span.end,
    };
    let row = |row: &Row| match *row {
        // What holds the goal: the impulse of the static forces shrinks with the interval, in the balances at both of its ends.
        Row::Instant { k, i } if k > to.span.end => {
            let of = |k: usize| from.unknowns.row(k, i).map_or(0.0, |r| old.rows[r]);
            let last = of(from.span.end);
            (last + of(from.span.end + 1)) / ratio - last
        }
        Row::Instant { k, i } => {
            let weights = grids.weights(k);
            let factor = match model.variables.unknown(i).role {
                Role::Multiplier => constraint,
                _ => 1.0,
            };
            let value =
                |&(j, weight): &(usize, f64)| Some(weight * old.rows[from.unknowns.row(j, i)?]);
            let smooth: Option<f64> = weights.iter().map(value).sum();
            let nearest = || from.unknowns.row(grids.nearest(k), i).map(|r| old.rows[r]);
            factor * smooth.or_else(nearest).unwrap_or(0.0)
        }
        Row::Interval { k, s } => {
            let place = from.unknowns.row_of_scalar(interval(k), s);
            place.map_or(0.0, |r| old.rows[r])
        }
        Row::Time { of, .. } => from.carried_of_time(of, grids, to.span.end, &old.rows),
        Row::Limit { limit, k } => from.carried(limit, k, grids, &old.rows),
    };
    let bound = |list: &[f64], column: &Column| match *column {
        Column::Instant { k, i } => {
            let place = from.unknowns.unknown(grids.nearest(k), i);
            ratio * place.map_or(0.0, |v| list[v])
        }
        Column::Interval { k, s } => {
            let place = from.unknowns.scalar(interval(k), s);
            let factor = if k < to.span.end { ratio } else { 1.0 };
            factor * place.map_or(0.0, |v| list[v])
        }
        Column::Parameter { s } => from.unknowns.scalar(0, s).map_or(0.0, |v| list[v]),
        // The duration is a multiple of the interval length.
        Column::Horizon => {
            let intervals = grids.to as f64 / grids.from as f64;
            from.unknowns.horizon().map_or(0.0, |v| list[v]) * intervals
        }
    };
    let of = |list: &[f64]| {
        to.unknowns
            .columns
            .iter()
            .map(|column| bound(list, column))
            .collect()
    };
    Some(Costates {
        rows: to.unknowns.rows.iter().map(row).collect(),
        lower: of(&old.lower),
        upper: of(&old.upper),
    })
}

impl Layout {
    /// Costate of the row of a variable that is a function of time, on a grid whose motion ends at instant `end`. That of a prescribed motion at its
    /// end is a momentum, no sum over a step.
    fn carried_of_time(&self, of: Column, grids: Grids, end: usize, old: &[f64]) -> f64 {
        let (column, is_end) = match of {
            Column::Instant { k, i } if k == end => (self.unknowns.unknown(self.span.end, i), true),
            Column::Instant { k, i } => {
                let within = grids.nearest(k).min(self.span.end.max(1) - 1);
                (self.unknowns.unknown(within, i), false)
            }
            Column::Interval { k, s } if k >= end => (self.unknowns.scalar(self.span.end, s), true),
            Column::Interval { k, s } => (self.unknowns.scalar(grids.interval(k), s), false),
            Column::Parameter { .. } | Column::Horizon => (None, false),
        };
        let factor = if is_end { 1.0 } else { grids.ratio() };
        factor * self.row_of_time(column).map_or(0.0, |r| old[r])
    }

    /// Costate of a limit or goal at new instant or interval k.
    fn carried(&self, limit: usize, k: usize, grids: Grids, old: &[f64]) -> f64 {
        let of = &self.limits[limit];
        let first = self.unknowns.rows.len() - self.limit_rows.len() + of.first;
        let is_single = of.bounded.when.is_single();
        let site = match of.site {
            Site::Intervals if k >= grids.to && !is_single => self.span.end,
            Site::Intervals => grids.interval(k),
            Site::Instants => grids.nearest(k),
        };
        let factor = match (is_single, of.site) {
            // A marker rests at the goal when its last step is nothing; the shorter that step, the dearer its length.
            (true, Site::Intervals) => 1.0 / grids.ratio(),
            (true, Site::Instants) => 1.0,
            (false, _) => grids.ratio(),
        };
        let place = site.clamp(of.at.start, of.at.end.max(1) - 1);
        let value = old.get(first + place - of.at.start);
        factor * value.copied().unwrap_or(0.0)
    }
}
