//! Costs of quantities and of energies of sources, their gradients, and their derivatives with the interval length.
//!
//! Second derivatives of energies by coordinates enter the sweep like those of a limit whose costate is the factor of the capacitance.
//!
//! Values and gradients of limits and goals, and of variables that are functions of time.

use crate::control::numbering::Column;
use crate::control::transcription::Transcription;
use crate::control::transcription::cost_rows::{EnergyRow, Jump, Summand};
use crate::control::transcription::limit_rows::{
    BEFORE, BEFORE_INSTANT, DURATION, LimitRow, SCALAR, Site, Step,
};
use crate::control::transcription::segment::Placed;
use crate::functional::{Horizon, Measure, Sample, SumDerivatives};
use crate::math::Vector;

impl Transcription<'_> {
    /// The costs of quantities.
    pub(super) fn costs(&mut self) -> f64 {
        if self.objective.quantities.is_empty() {
            return 0.0;
        }
        self.place(Placed::Vectors);
        let mut sum = 0.0;
        for cost in &self.objective.quantities {
            let measure = cost.site.measure(self.model, cost.measure);
            for k in cost.at.clone() {
                let value = measure.value(&self.sample(cost.site, k));
                sum += cost.summand(value, k, self.workspace.h).value;
            }
        }
        sum
    }

    /// Puts a factor times the gradient of each cost by coordinates and scalars into the rows, step by step; the factor is taken
    /// of its summand. Returns the sum of what `by_horizon` takes of it and of the derivative of the quantity by the interval length.
    pub(super) fn cost_gradients(
        &mut self,
        factor: impl Fn(&Summand) -> f64,
        by_horizon: impl Fn(&Summand, f64) -> f64,
    ) -> f64 {
        self.place(Placed::Columns);
        let map = &self.model.action.map;
        let (stride, coordinates) = (self.stride(), map.unknowns());
        self.workspace.rows.fill(0.0);
        let mut sum = 0.0;
        let mut part = std::mem::take(&mut self.workspace.measured);
        for cost in &self.objective.quantities {
            let measure = cost.site.measure(self.model, cost.measure);
            for k in cost.at.clone() {
                let sample = self.sample(cost.site, k);
                let summand = cost.summand(measure.value(&sample), k, self.workspace.h);
                measure.gradient(&sample, &mut part.forces, &mut part.rows);
                let factor = factor(&summand);
                let by_h = match cost.reads_rates && self.layout.horizon == Horizon::Free {
                    true => measure.by_duration(&sample),
                    false => 0.0,
                };
                sum += by_horizon(&summand, by_h);
                for side in (0..cost.site.sides()).filter(|&side| measure.reads(side)) {
                    let rows = &mut self.workspace.rows[(k + side) * stride..][..coordinates];
                    let columns = &self.workspace.instants[k + side].columns;
                    map.take_back(&cost.vectors, columns, &mut part.forces[side], factor, rows);
                }
                for &s in &cost.scalars {
                    self.workspace.rows[k * stride + coordinates + s] += part.rows[s] * factor;
                }
                part.rows.fill(0.0);
            }
        }
        self.workspace.measured = part;
        sum
    }

    /// Adds the gradients in the rows to those by the variables.
    pub(super) fn gather_cost_gradient(&mut self, grad: &mut [f64]) {
        let (stride, coordinates) = (self.stride(), self.model.action.map.unknowns());
        if let Some(of) = self.layout.span.twin() {
            let last = self.layout.span.all * stride;
            let (before, twin) = self.workspace.rows.split_at_mut(last);
            let sums = before[of * stride..][..coordinates].iter_mut();
            sums.zip(twin).for_each(|(sum, row)| *sum += *row);
        }
        let of_interval = |k: usize, s: usize| self.workspace.rows[k * stride + coordinates + s];
        for (column, number) in self.layout.unknowns.variables() {
            let row = match column {
                Column::Instant { k, i } => self.workspace.rows[k * stride + i],
                Column::Interval { k, s } => of_interval(k, s),
                Column::Parameter { s } => {
                    (0..self.layout.span.all).map(|k| of_interval(k, s)).sum()
                }
                Column::Horizon => continue,
            };
            grad[number] += row * self.variable_scales[number];
        }
    }

    /// Adds σ times the derivatives of the costs with the interval length to the values.
    pub(super) fn cost_border(&mut self, sigma: f64) {
        if self.objective.quantities.is_empty() {
            return;
        }
        let square = self.cost_gradients(
            |s| sigma * s.by_value_and_h,
            |s, by_h| sigma * (s.by_h_twice + 2.0 * s.by_value_and_h * by_h),
        );
        let pattern = self.model.action.layout();
        let (stride, coordinates) = (self.stride(), self.model.action.map.unknowns());
        for k in 0..=self.layout.span.all {
            let rows = &self.workspace.rows[k * stride..][..coordinates];
            let values = &mut self.workspace.values[pattern.horizon_at(k)..][..coordinates];
            values.iter_mut().zip(rows).for_each(|(v, row)| *v += row);
            if k == self.layout.span.all {
                break;
            }
            let rows = &self.workspace.rows[k * stride + coordinates..(k + 1) * stride];
            let values = &mut self.workspace.values[pattern.horizon_scalars_at(k)..][..rows.len()];
            values.iter_mut().zip(rows).for_each(|(v, row)| *v += row);
        }
        self.workspace.values[pattern.horizon_square_at(self.layout.span.all)] += square;
    }

    /// Places all instants at the present point as far as it is needed, the copy where stretches meet too.
    pub(super) fn place(&mut self, needed: Placed) {
        let map = &self.model.action.map;
        let workspace = &mut self.workspace;
        if let Some(middle) = self.layout.middle() {
            let here = &workspace.instants[middle];
            workspace.boundary_instant.z.copy_from_slice(&here.z);
        }
        let instants = workspace.instants.iter_mut();
        for instant in instants.chain([&mut workspace.boundary_instant]) {
            if workspace.placed < Placed::Vectors {
                map.vectors(instant);
            }
            if workspace.placed < needed && needed == Placed::Columns {
                map.tangent(instant);
            }
        }
        workspace.placed = workspace.placed.max(needed);
    }
}

impl Transcription<'_> {
    fn capacitance(&self, row: &EnergyRow, k: usize) -> f64 {
        let measure = Site::Instants.measure(self.model, row.measure);
        measure.value(&self.sample(Site::Instants, k))
    }

    /// The energies.
    pub(super) fn energies(&mut self) -> f64 {
        if self.objective.energies.is_empty() {
            return 0.0;
        }
        self.place(Placed::Vectors);
        let count = self.model.action.layout().interval_scalars;
        let mut sum = 0.0;
        for row in &self.objective.energies {
            for k in 0..=self.layout.span.all {
                let factor = row.factor(k, &self.workspace.scalars, count).value;
                sum += factor * self.capacitance(row, k);
            }
        }
        sum
    }

    /// Adds the gradient by coordinates and voltages to the rows, step by step.
    pub(super) fn energy_gradients(&mut self) {
        self.place(Placed::Columns);
        let pattern = self.model.action.layout();
        let (stride, coordinates) = (self.stride(), pattern.unknowns);
        let count = pattern.interval_scalars;
        let mut forces = std::mem::take(&mut self.workspace.measured.forces);
        for index in 0..self.objective.energies.len() {
            for k in 0..=self.layout.span.all {
                let row = &self.objective.energies[index];
                let factor = row.factor(k, &self.workspace.scalars, count);
                let capacitance = self.capacitance(row, k);
                for (side, slope) in factor.slopes.into_iter().enumerate() {
                    if let Some(interval) = interval(k, side, self.layout.span.all) {
                        let at = interval * stride + coordinates + row.scalar;
                        self.workspace.rows[at] += capacitance * slope;
                    }
                }
                self.add_slope(index, k, factor.value, k * stride, &mut forces);
            }
        }
        self.workspace.measured.forces = forces;
    }

    /// Adds a factor times the gradient of a capacitance by the coordinates of instant k to the rows from `first` on.
    fn add_slope(
        &mut self,
        index: usize,
        k: usize,
        factor: f64,
        first: usize,
        forces: &mut [Vec<Vector>; 2],
    ) {
        let map = &self.model.action.map;
        let row = &self.objective.energies[index];
        let measure = Site::Instants.measure(self.model, row.measure);
        let sample = self.sample(Site::Instants, k);
        measure.gradient(&sample, forces, &mut []);
        let rows = &mut self.workspace.rows[first..first + map.unknowns()];
        let columns = &self.workspace.instants[k].columns;
        map.take_back(&row.vectors, columns, &mut forces[0], factor, rows);
    }

    /// Adds σ times the second derivatives by the voltages, and by voltages and coordinates, to the values.
    pub(super) fn energy_curvature(&mut self, sigma: f64) {
        if self.objective.energies.is_empty() {
            return;
        }
        self.place(Placed::Columns);
        let pattern = self.model.action.layout();
        let count = pattern.interval_scalars;
        let mut forces = std::mem::take(&mut self.workspace.measured.forces);
        self.workspace.rows[..pattern.unknowns].fill(0.0);
        for index in 0..self.objective.energies.len() {
            for k in 0..=self.layout.span.all {
                // The gradient of the capacitance, in the storage of one instant's rows.
                self.add_slope(index, k, sigma, 0, &mut forces);
                let row = &self.objective.energies[index];
                let factor = row.factor(k, &self.workspace.scalars, count);
                let capacitance = sigma * self.capacitance(row, k);
                for side in 0..2 {
                    let Some(interval) = interval(k, side, self.layout.span.all) else {
                        continue;
                    };
                    self.workspace.values[pattern.scalars_at(interval) + row.square] +=
                        capacitance * factor.squares[side];
                    // Instant k ends the interval before it, and begins the one after it.
                    let mixed = pattern.mixed_at(interval, 1 - side);
                    for &(i, slot) in &row.mixed {
                        self.workspace.values[mixed + slot] +=
                            factor.slopes[side] * self.workspace.rows[i];
                    }
                }
                for &(i, _) in &row.mixed {
                    self.workspace.rows[i] = 0.0;
                }
            }
        }
        self.workspace.measured.forces = forces;
    }

    /// σ times the second derivative by the voltages of a jump, in their units.
    pub(super) fn energy_coupling(&self, jump: Jump, sigma: f64) -> f64 {
        let Some(index) = jump.energy else {
            return 0.0;
        };
        let row = &self.objective.energies[index];
        let count = self.model.action.layout().interval_scalars;
        let product = row.factor(jump.k, &self.workspace.scalars, count).product;
        let input = &self.objective.inputs[jump.input];
        let volts = input.size;
        sigma * product * self.capacitance(row, jump.k) * volts * volts
    }
}

/// The interval before (`side` 0) or after (1) instant k, where there is one.
fn interval(k: usize, side: usize, intervals: usize) -> Option<usize> {
    match side {
        0 => k.checked_sub(1),
        _ => (k < intervals).then_some(k),
    }
}

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
