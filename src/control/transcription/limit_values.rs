//! Values and gradients of limits and goals, and of variables that are functions of time.

use crate::control::transcription::Transcription;
use crate::control::transcription::limit_rows::{
    BEFORE, BEFORE_INSTANT, DURATION, LimitRow, SCALAR, Site, Step,
};
use crate::functional::{Horizon, Measure, Sample, SumDerivatives};
use crate::math::Vector;

/// A part of a step in an interval: a measure times a factor.
struct Part<'a> {
    measure: &'a dyn Measure,
    interval: usize,
    factor: f64,
    /// Marks of the entries by coordinates of both instants, and by scalars.
    sides: [usize; 2],
    scalars: usize,
}

impl<'m> Transcription<'m> {
    fn measure(&self, limit: &LimitRow) -> &'m dyn Measure {
        limit.site.measure(self.model, limit.measure)
    }

    /// The frame in which a measure of intervals is read at rest at instant k.
    fn sample_at_rest<'a>(&'a self, k: usize, scalars: &'a [f64]) -> Sample<'a> {
        Sample::of_instant(&self.workspace.instants[k].x, scalars)
    }

    pub(super) fn limit_value(&self, limit: &LimitRow, k: usize) -> f64 {
        let value = match &limit.step {
            Some(step) => self.step_value(limit, step, k),
            None => self.measure(limit).value(&self.sample(limit.site, k)),
        };
        match limit.bounded.rate {
            Some(rate) => value - rate * limit.part(k) * self.workspace.h,
            None => value,
        }
    }

    fn step_value(&self, limit: &LimitRow, step: &Step, k: usize) -> f64 {
        let site = limit.site;
        let before = site.measure(self.model, step.before);
        let before = match step.interval_before(k) {
            Some(k) => before.value(&self.sample(site, k)),
            None => before.value(&self.sample_at_rest(k, step.at_rest(0))),
        };
        let after = match step.interval(k) {
            Some(k) => self.measure(limit).value(&self.sample(site, k)),
            None => self
                .measure(limit)
                .value(&self.sample_at_rest(k, step.at_rest(1))),
        };
        step.factor * (after - before)
    }

    /// Gradients of the limits, behind the periodic values.
    pub(super) fn limit_gradients(&mut self) {
        let mut place = self.model.action.layout().values(self.layout.intervals);
        let count = self.model.action.map.unknowns();
        self.workspace.rows[..count].fill(0.0);
        let mut part = std::mem::take(&mut self.workspace.measured);
        for row in 0..self.layout.limit_rows.len() {
            let (limit, k) = self.layout.limit_rows[row];
            let is_step = self.layout.limits[limit].step.is_some();
            match is_step {
                true => self.step_gradient(limit, k, place, &mut part),
                false => self.limit_gradient(limit, k, place, &mut part),
            }
            place += self.layout.limits[limit].entries.len();
        }
        self.workspace.measured = part;
    }

    /// Gradient of a limit at instant or interval k from a place among the values on.
    fn limit_gradient(
        &mut self,
        limit: usize,
        k: usize,
        mut place: usize,
        part: &mut SumDerivatives,
    ) {
        let map = &self.model.action.map;
        let limit = &self.layout.limits[limit];
        let measure = self.measure(limit);
        let site = limit.site;
        measure.gradient(&self.sample(site, k), &mut part.forces, &mut part.rows);
        // Rows of the coordinates of one side at a time, in the storage of one instant's rows.
        let mut at = 0;
        for side in (0..site.sides()).filter(|&side| measure.reads(side)) {
            for &vector in &limit.vectors {
                map.pull_back_one(
                    vector,
                    &self.workspace.instants[k + side].columns,
                    &part.forces[side][vector],
                    &mut self.workspace.rows,
                );
            }
            while let Some(&(_, i)) = limit.entries.get(at).filter(|(s, _)| *s == side) {
                self.workspace.values[place] = std::mem::take(&mut self.workspace.rows[i]);
                (at, place) = (at + 1, place + 1);
            }
        }
        for &(mark, s) in &limit.entries[at..] {
            self.workspace.values[place] = match mark {
                DURATION => {
                    let rate = limit.bounded.rate.unwrap_or(0.0);
                    measure.by_duration(&self.sample(site, k)) - rate
                }
                _ => part.rows[s],
            };
            place += 1;
        }
        clear(part, &limit.vectors);
    }

    /// Gradient of a limit of a step before interval k from a place among the values on: the sum of those of its parts.
    fn step_gradient(
        &mut self,
        limit: usize,
        k: usize,
        place: usize,
        derivatives: &mut SumDerivatives,
    ) {
        let map = &self.model.action.map;
        let limit = &self.layout.limits[limit];
        let Some(step) = &limit.step else {
            return;
        };
        let entries = || limit.entries.iter().enumerate();
        self.workspace.values[place..place + limit.entries.len()].fill(0.0);
        let after = step.interval(k).map(|interval| Part {
            measure: self.measure(limit),
            interval,
            factor: step.factor,
            sides: [0, 1],
            scalars: SCALAR,
        });
        let before = step.interval_before(k).map(|interval| Part {
            measure: limit.site.measure(self.model, step.before),
            interval,
            factor: -step.factor,
            sides: [BEFORE_INSTANT, 0],
            scalars: BEFORE,
        });
        let mut by_duration = 0.0;
        for part in [after, before].into_iter().flatten() {
            let sample = self.sample(Site::Intervals, part.interval);
            if part.measure.reads_rates() && self.layout.horizon == Horizon::Free {
                by_duration += part.factor * part.measure.by_duration(&sample);
            }
            part.measure
                .gradient(&sample, &mut derivatives.forces, &mut derivatives.rows);
            for side in (0..2).filter(|&side| part.measure.reads(side)) {
                for &vector in &limit.vectors {
                    let force = derivatives.forces[side][vector] * part.factor;
                    let columns = &self.workspace.instants[part.interval + side].columns;
                    map.pull_back_one(vector, columns, &force, &mut self.workspace.rows);
                }
                for (at, &(_, i)) in entries().filter(|(_, (mark, _))| *mark == part.sides[side]) {
                    let row = std::mem::take(&mut self.workspace.rows[i]);
                    self.workspace.values[place + at] += row;
                }
            }
            for (at, &(_, s)) in entries().filter(|(_, (mark, _))| *mark == part.scalars) {
                self.workspace.values[place + at] += part.factor * derivatives.rows[s];
            }
            clear(derivatives, &limit.vectors);
        }
        let rate = limit.bounded.rate.unwrap_or(0.0) * limit.part(k);
        for (at, _) in entries().filter(|(_, (mark, _))| *mark == DURATION) {
            self.workspace.values[place + at] = by_duration - rate;
        }
    }
}

/// Sets what a gradient has been added to back to zero.
fn clear(part: &mut SumDerivatives, vectors: &[usize]) {
    for &vector in vectors {
        for side in &mut part.forces {
            side[vector] = Vector::zeros();
        }
    }
    part.rows.fill(0.0);
}

impl Transcription<'_> {
    /// v − S(c h) at a point.
    pub(super) fn time_value(&self, place: usize, x: &[f64]) -> f64 {
        let column = self.layout.times.column(place);
        let [value, ..] = self.layout.times.derivatives(place, self.workspace.h);
        self.variable_scales[column] * x[column] - value
    }

    /// Gradients by v and h, behind those of the limits.
    pub(super) fn time_gradients(&mut self) {
        let times = &self.layout.times;
        let first = self.workspace.values.len() - 2 * times.len();
        let pairs = self.workspace.values[first..].chunks_exact_mut(2);
        for (place, pair) in pairs.enumerate() {
            let [_, slope, _] = times.derivatives(place, self.workspace.h);
            pair.copy_from_slice(&[1.0, -slope]);
        }
    }

    /// Adds the second derivatives along the costates of all rows to that by the interval length twice.
    pub(super) fn time_curvature(&mut self, costates: &[f64]) {
        let (times, first) = (&self.layout.times, self.layout.first_time_row());
        if times.len() == 0 {
            return;
        }
        let along = |place: usize| {
            let row = first + place;
            let [_, _, curvature] = times.derivatives(place, self.workspace.h);
            -costates[row] * self.row_scales[row] * curvature
        };
        let sum: f64 = (0..times.len()).map(along).sum();
        let square = self
            .model
            .action
            .layout()
            .horizon_square_at(self.layout.intervals);
        self.workspace.values[square] += sum;
    }
}
