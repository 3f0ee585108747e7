//! Values and gradients of limits and goals, and of variables that are functions of time.

use crate::control::transcription::Transcription;
use crate::control::transcription::limit_rows::{
    BEFORE, BEFORE_INSTANT, DURATION, LimitRow, SCALAR, Step,
};
use crate::functional::{Horizon, Measure, Sample, SumDerivatives};

/// A part of a limit at an instant or in an interval: a measure times a factor.
struct Part<'m> {
    measure: &'m dyn Measure,
    at: usize,
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

    /// The measures whose gradients times their factors are that of a limit at instant or interval k.
    fn parts(&self, limit: &LimitRow, k: usize) -> [Option<Part<'m>>; 2] {
        let (factor, after, before) = match &limit.step {
            None => (1.0, Some(k), None),
            Some(step) => {
                let before = step.interval_before(k).map(|at| (at, step.before));
                (step.factor, step.interval(k), before)
            }
        };
        let after = after.map(|at| Part {
            measure: self.measure(limit),
            at,
            factor,
            sides: [0, 1],
            scalars: SCALAR,
        });
        let before = before.map(|(at, measure)| Part {
            measure: limit.site.measure(self.model, measure),
            at,
            factor: -factor,
            sides: [BEFORE_INSTANT, 0],
            scalars: BEFORE,
        });
        [after, before]
    }

    /// Gradients of the limits, behind the periodic values.
    pub(super) fn limit_gradients(&mut self) {
        let mut place = self.model.action.layout().values(self.layout.span.all);
        let count = self.model.action.map.unknowns();
        self.workspace.rows[..count].fill(0.0);
        let mut derivatives = std::mem::take(&mut self.workspace.measured);
        for row in 0..self.layout.limit_rows.len() {
            let (limit, k) = self.layout.limit_rows[row];
            self.limit_gradient(limit, k, place, &mut derivatives);
            place += self.layout.limits[limit].entries.len();
        }
        self.workspace.measured = derivatives;
    }

    /// Gradient of a limit at instant or interval k from a place among the values on: the sum of those of its parts.
    fn limit_gradient(
        &mut self,
        limit: usize,
        k: usize,
        place: usize,
        derivatives: &mut SumDerivatives,
    ) {
        let map = &self.model.action.map;
        let limit = &self.layout.limits[limit];
        let entries = || limit.entries.iter().enumerate();
        self.workspace.values[place..place + limit.entries.len()].fill(0.0);
        let mut by_duration = 0.0;
        for part in self.parts(limit, k).into_iter().flatten() {
            let (measure, factor) = (part.measure, part.factor);
            let sample = self.sample(limit.site, part.at);
            if measure.reads_rates() && self.layout.horizon == Horizon::Free {
                by_duration += factor * measure.by_duration(&sample);
            }
            let SumDerivatives { forces, rows, .. } = &mut *derivatives;
            measure.gradient(&sample, forces, rows);
            // Rows of the coordinates of one side at a time, in the storage of one instant's rows.
            for side in (0..limit.site.sides()).filter(|&side| measure.reads(side)) {
                let columns = &self.workspace.instants[part.at + side].columns;
                let (forces, sums) = (&mut forces[side], &mut self.workspace.rows);
                map.take_back(&limit.vectors, columns, forces, factor, sums);
                for (at, &(_, i)) in entries().filter(|(_, (mark, _))| *mark == part.sides[side]) {
                    self.workspace.values[place + at] += std::mem::take(&mut sums[i]);
                }
            }
            for (at, &(_, s)) in entries().filter(|(_, (mark, _))| *mark == part.scalars) {
                self.workspace.values[place + at] += factor * rows[s];
            }
            rows.fill(0.0);
        }
        let rate = limit.bounded.rate.unwrap_or(0.0) * limit.part(k);
        for (at, _) in entries().filter(|(_, (mark, _))| *mark == DURATION) {
            self.workspace.values[place + at] = by_duration - rate;
        }
    }
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
            .horizon_square_at(self.layout.span.all);
        self.workspace.values[square] += sum;
    }
}
