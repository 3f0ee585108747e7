//! The program of a receding horizon: the discrete equations of the next intervals, with the costs of deviations from a motion.
//!
//! ```text
//! minimise  ½ Σ_{k=1..N−1} δq_kᵀ Q_k δq_k + ½ r Σ_{k=0..N−1} |δq_{k+1} − δq_k|²/h² + ½ Σ_{k=0..N−1} δu_kᵀ R δu_k + ½ (δq_N, δp_N)ᵀ S_N (δq_N, δp_N)
//! ```
//!
//! with the costs of the regulator (`workflow::regulator`): S_N counts all that follows. The equations are those of the transcription with the
//! state q_0, p_0 at their start. Their last row, which says that the motion comes to rest, has the momentum p_N as an unknown here. The motion is that
//! of the regulator in short steps, a number of them in each interval, under the same inputs: these are one column.
//!
//! Costs of deviations from a motion, with their derivatives.

use crate::control::{Column, Row, Transcription};
use crate::feedback::product;
use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Nlp, Stage};
use crate::workflow::receding::layout::{
    Between, Layout, Reference, Steered, between, held_over_parts,
};

/// The program.
#[derive(Debug)]
pub(super) struct Program<'m> {
    motion: InSquares<Transcription<'m>>,
    pub(super) reference: &'m Reference,
    pub(super) layout: Layout<'m>,
    bounds: Bounds,
    row_bounds: Bounds,
    jacobian: Entries,
    hessian: Entries,
    /// Numbers of entries of the motion alone.
    counts: [usize; 2],
    /// Column here of each one of the transcription, and their values there.
    own: Vec<usize>,
    point: Vec<f64>,
    /// Columns of the motion.
    of_columns: Vec<Column>,
    /// Columns of coordinates within an interval, with those at both of its ends, and the part of it that has passed there.
    pub(super) between: Vec<Between>,
    /// Number of columns of the motion.
    pub(super) columns: usize,
    /// Instant of the reference at which the horizon begins.
    pub(super) begin: usize,
    /// Momenta at the start, in the order of the state.
    pub(super) momentum: Vec<f64>,
    /// Deviations of the state at the end, and of coordinates, for one evaluation.
    pub(super) deviation: Vec<f64>,
    /// Constant disturbances with their effects.
    pub(super) lasting: Lasting,
}

/// Constant disturbances, with what they change of the motion that is followed.
#[derive(Clone, Debug)]
pub(super) struct Lasting {
    /// The forces, then the changes of the inputs against them.
    values: Vec<f64>,
    forces: usize,
    /// Changes of the state at rest, coordinates then momenta, and of the inputs; slope of the cost at the end.
    pub(super) state: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    pub(super) slope: Vec<f64>,
}

impl<'m> Program<'m> {
    /// The program of a transcription with an open start without momenta, and an end at rest with no coordinate given.
    pub(super) fn new(
        motion: Transcription<'m>,
        reference: &'m Reference,
        steered: &'m Steered,
    ) -> Self {
        let inert = steered.inert.len();
        let (state, inputs) = (steered.coordinates.len() + inert, steered.inputs.len());
        let (forces, parts) = (steered.forced.len(), steered.parts);
        let unknowns = motion.unknowns();
        let scalars: Vec<usize> = steered.inputs.iter().map(|&(s, _)| s).collect();
        let (own, of_columns) = held_over_parts(&unknowns.columns, &scalars, parts);
        let columns = of_columns.len();
        let squares = motion.squares();
        let of_squares = Squares::of(&motion, squares.clone());
        let layout = Layout::new(&motion, &own, steered);
        let [jacobian, hessian] = [motion.jacobian_structure(), motion.hessian_structure()];
        let mut given = motion.variables().clone();
        of_squares.square(&mut given.lower);
        of_squares.square(&mut given.upper);
        let size = columns + inert;
        let mut bounds = Bounds::none(size);
        for (column, &own) in own.iter().enumerate() {
            bounds.lower[own] = given.lower[column];
            bounds.upper[own] = given.upper[column];
        }
        let mut out = Self {
            row_bounds: motion.constraints().clone(),
            counts: [jacobian.count(), hessian.count()],
            motion: InSquares::new(motion, of_squares, &jacobian, &hessian),
            point: vec![0.0; own.len()],
            reference,
            deviation: vec![0.0; state],
            momentum: vec![0.0; inert],
            lasting: Lasting {
                values: vec![0.0; forces + inputs],
                forces,
                state: vec![0.0; state],
                inputs: vec![0.0; inputs],
                slope: vec![0.0; state],
            },
            layout,
            bounds,
            jacobian,
            hessian,
            own,
            between: between(&of_columns, parts),
            of_columns,
            columns,
            begin: 0,
        };
        out.take_structure();
        out
    }

    /// Columns of the entries become those of this program.
    fn take_structure(&mut self) {
        for column in &mut self.jacobian.cols {
            *column = self.own[*column as usize] as u32;
        }
        let Entries { rows, cols } = &mut self.hessian;
        for (row, col) in rows.iter_mut().zip(cols) {
            let [a, b] = [*row, *col].map(|column| self.own[column as usize] as u32);
            (*row, *col) = (a.max(b), a.min(b));
        }
        self.add_structure();
    }

    /// Adds the entries of the momenta at the end, and of the costs.
    fn add_structure(&mut self) {
        for (place, &(row, _)) in self.layout.momenta[1].iter().enumerate() {
            self.jacobian.push(row, self.columns + place);
        }
        let (n, last) = (self.layout.width(), self.layout.intervals);
        let column = |k: usize, c: usize| self.layout.coordinates[k * n + c].0;
        let mut add = |a: usize, b: usize| self.hessian.push(a.max(b), a.min(b));
        for k in 0..last {
            for a in 0..n {
                (0..=a).for_each(|b| add(column(k, a), column(k, b)));
            }
            for c in 0..n {
                add(column(k + 1, c), column(k, c));
            }
        }
        let size = n + self.layout.steered.inert.len();
        let of_end = |c: usize| match c < n {
            true => column(last, c),
            false => self.columns + c - n,
        };
        for a in 0..size {
            (0..=a).for_each(|b| add(of_end(a), of_end(b)));
        }
        for input in self.layout.driven.iter().flatten() {
            add(input.column, input.column);
        }
    }

    /// Inputs of the first interval: V, N, N mm.
    pub(super) fn first_inputs(&self, x: &[f64], out: &mut [f64]) {
        let inputs = self.layout.driven[0]
            .iter()
            .zip(&self.layout.steered.inputs);
        for (value, (input, (_, is_squared))) in out.iter_mut().zip(inputs) {
            let [acting, ..] = input.reading(x[input.column]);
            *value = match is_squared {
                true => acting.max(0.0).sqrt(),
                false => acting,
            };
        }
    }

    /// The state of the reference at an instant of the horizon, and its inputs, as values of the columns.
    pub(super) fn refer(&self, k: usize, x: &mut [f64]) {
        let n = self.layout.width();
        let point = self.reference.at(self.begin + k);
        for c in 0..n {
            let (column, scale) = self.layout.coordinates[k * n + c];
            x[column] = point.state[c] / scale;
        }
        if k == self.layout.intervals {
            for (place, &(_, scale)) in self.layout.momenta[1].iter().enumerate() {
                x[self.columns + place] = point.momentum[place] * scale;
            }
            return;
        }
        for (input, value) in self.layout.driven[k].iter().zip(&point.inputs) {
            let value = if input.is_root { value.sqrt() } else { *value };
            x[input.column] = value / input.scale;
        }
    }

    /// The motion that is followed as values of the columns, on straight lines between its instants.
    pub(super) fn refer_all(&self, x: &mut [f64]) {
        (0..=self.layout.intervals).for_each(|k| self.refer(k, x));
        for &(i, [from, to], part) in &self.between {
            x[i] = x[from] + part * (x[to] - x[from]);
        }
    }

    /// Columns and rows of the motion.
    pub(super) fn numbers(&self) -> (&[Column], &[Row]) {
        (&self.of_columns, &self.motion.program.unknowns().rows)
    }

    /// Values of the columns of the transcription.
    fn spread(&mut self, x: &[f64]) {
        for (value, &own) in self.point.iter_mut().zip(&self.own) {
            *value = x[own];
        }
    }

    /// Takes constant disturbances, and the changes of inputs against them, for the horizon that begins now.
    pub(super) fn load(&mut self, forces: &[f64], against: &[f64]) {
        let end = self.reference.at(self.begin + self.layout.intervals);
        let (Some(rest), Some(slope)) = (&self.reference.rest, &end.slope) else {
            return;
        };
        let Lasting {
            values,
            forces: count,
            state,
            inputs,
            slope: of_end,
        } = &mut self.lasting;
        values[..*count].copy_from_slice(forces);
        values[*count..].copy_from_slice(against);
        inputs.copy_from_slice(against);
        for (matrix, to) in [(rest, state), (slope, of_end)] {
            let rows = to.iter_mut().enumerate();
            rows.for_each(|(row, to)| *to = product(matrix, row, values));
        }
    }

    /// Holds the state at the start: values of its columns, and its momenta.
    pub(super) fn hold_start(&mut self, values: &[f64], momenta: &[f64]) {
        for (&(column, _), value) in self.layout.coordinates.iter().zip(values) {
            self.bounds.lower[column] = *value;
            self.bounds.upper[column] = *value;
        }
        self.momentum.copy_from_slice(momenta);
    }
}

impl Nlp for Program<'_> {
    fn variables(&self) -> &Bounds {
        &self.bounds
    }

    fn constraints(&self) -> &Bounds {
        &self.row_bounds
    }

    fn jacobian_structure(&self) -> Entries {
        self.jacobian.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.hessian.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.costs(x)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.slopes(x, grad);
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.spread(x);
        self.motion.constraint(&self.point, g);
        for (&(row, scale), momentum) in self.layout.momenta[0].iter().zip(&self.momentum) {
            g[row] += scale * momentum;
        }
        for (&(row, _), momentum) in self.layout.momenta[1].iter().zip(&x[self.columns..]) {
            g[row] -= momentum;
        }
        for &(row, time, force) in &self.layout.forced {
            g[row] += time * self.lasting.values[force];
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        let (motion, momenta) = values.split_at_mut(self.counts[0]);
        self.spread(x);
        self.motion.jacobian(&self.point, motion);
        momenta.fill(-1.0);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        let (motion, costs) = values.split_at_mut(self.counts[1]);
        self.spread(x);
        self.motion.hessian(&self.point, sigma, costates, motion);
        self.curvatures(x, sigma, costs);
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        let given = self.motion.stages()?;
        let last = Stage::Of(2 * (self.layout.intervals * self.layout.steered.parts) as u32);
        let mut stages = vec![last; self.columns + self.layout.steered.inert.len()];
        for (stage, &own) in given.into_iter().zip(&self.own).rev() {
            stages[own] = stage;
        }
        Some(stages)
    }
}

impl Program<'_> {
    /// Deviations of the coordinates of an instant.
    fn deviate(&mut self, x: &[f64], k: usize) {
        let n = self.layout.width();
        let point = self.reference.at(self.begin + k);
        for c in 0..n {
            let (column, scale) = self.layout.coordinates[k * n + c];
            self.deviation[c] = scale * x[column] - point.state[c] - self.lasting.state[c];
        }
    }

    /// Deviations of coordinates and momenta at the end.
    fn deviate_at_end(&mut self, x: &[f64]) {
        let (n, last) = (self.layout.width(), self.layout.intervals);
        self.deviate(x, last);
        let point = self.reference.at(self.begin + last);
        for (place, &(_, scale)) in self.layout.momenta[1].iter().enumerate() {
            let momentum = x[self.columns + place] / scale;
            let rest = self.lasting.state[n + place];
            self.deviation[n + place] = momentum - point.momentum[place] - rest;
        }
    }

    /// Difference of the deviations of a coordinate over an interval.
    fn step(&self, x: &[f64], k: usize, c: usize) -> f64 {
        let n = self.layout.width();
        let at = |k: usize| {
            let (column, scale) = self.layout.coordinates[k * n + c];
            scale * x[column] - self.reference.at(self.begin + k).state[c]
        };
        at(k + 1) - at(k)
    }

    /// Hands over column, reading, deviation and weight of each input.
    fn each_input(&self, x: &[f64], mut to: impl FnMut(usize, [f64; 3], f64, f64)) {
        for (k, inputs) in self.layout.driven.iter().enumerate() {
            let given = &self.reference.at(self.begin + k).inputs;
            for (i, (input, given)) in inputs.iter().zip(given).enumerate() {
                let reading = input.reading(x[input.column]);
                let off = reading[0] - given - self.lasting.inputs[i];
                to(input.column, reading, off, self.reference.inputs[i]);
            }
        }
    }

    /// Columns of the values of the state at the end with their scales.
    fn end_column(&self, c: usize) -> (usize, f64) {
        let n = self.layout.width();
        match c < n {
            true => self.layout.coordinates[self.layout.intervals * n + c],
            false => (self.columns + c - n, 1.0 / self.layout.momenta[1][c - n].1),
        }
    }

    /// The sum of all costs.
    pub(super) fn costs(&mut self, x: &[f64]) -> f64 {
        let (n, last) = (self.layout.width(), self.layout.intervals);
        let mut sum = 0.0;
        for k in 0..last {
            self.deviate(x, k);
            let places = &self.reference.at(self.begin + k).places;
            sum += square(&self.deviation[..n], places);
            for c in 0..n {
                sum += self.layout.steered.rates[c] * self.step(x, k, c).powi(2);
            }
        }
        self.deviate_at_end(x);
        sum += square(&self.deviation, &self.reference.at(self.begin + last).end);
        let slope = self.deviation.iter().zip(&self.lasting.slope);
        sum += 2.0 * slope.map(|(d, slope)| d * slope).sum::<f64>();
        self.each_input(x, |_, _, off, weight| sum += weight * off.powi(2));
        0.5 * sum
    }

    /// Its gradient.
    pub(super) fn slopes(&mut self, x: &[f64], grad: &mut [f64]) {
        grad.fill(0.0);
        let (n, last) = (self.layout.width(), self.layout.intervals);
        for k in 0..last {
            self.deviate(x, k);
            let places = &self.reference.at(self.begin + k).places;
            for a in 0..n {
                let (column, scale) = self.layout.coordinates[k * n + a];
                grad[column] += scale * product(places, a, &self.deviation[..n]);
                let slope = self.layout.steered.rates[a] * self.step(x, k, a);
                grad[column] -= scale * slope;
                let (column, scale) = self.layout.coordinates[(k + 1) * n + a];
                grad[column] += scale * slope;
            }
        }
        self.deviate_at_end(x);
        let end = &self.reference.at(self.begin + last).end;
        for a in 0..self.deviation.len() {
            let (column, scale) = self.end_column(a);
            let slope = product(end, a, &self.deviation);
            grad[column] += scale * (slope + self.lasting.slope[a]);
        }
        self.each_input(x, |column, [_, slope, _], off, weight| {
            grad[column] += weight * off * slope;
        });
    }

    /// Its second derivatives times a factor, in the order of the entries.
    pub(super) fn curvatures(&self, x: &[f64], sigma: f64, costs: &mut [f64]) {
        let (n, last) = (self.layout.width(), self.layout.intervals);
        let mut costs = costs.iter_mut();
        let mut put = |value: f64| *costs.next().expect("an entry") = sigma * value;
        let scale = |k: usize, c: usize| self.layout.coordinates[k * n + c].1;
        let rates = &self.layout.steered.rates;
        for k in 0..last {
            let places = &self.reference.at(self.begin + k).places;
            // The step before and that behind.
            let steps = if k == 0 { 1.0 } else { 2.0 };
            for a in 0..n {
                for b in 0..=a {
                    let of_rates = if a == b { steps * rates[a] } else { 0.0 };
                    put(scale(k, a) * scale(k, b) * (places[(a, b)] + of_rates));
                }
            }
            for (c, rate) in rates.iter().enumerate() {
                put(-scale(k, c) * scale(k + 1, c) * rate);
            }
        }
        let end = &self.reference.at(self.begin + last).end;
        for a in 0..self.deviation.len() {
            for b in 0..=a {
                let of_rates = if a == b && a < n { rates[a] } else { 0.0 };
                let scales = self.end_column(a).1 * self.end_column(b).1;
                put(scales * (end[(a, b)] + of_rates));
            }
        }
        self.each_input(x, |_, [_, slope, curvature], off, weight| {
            put(weight * (slope * slope + off * curvature));
        });
    }
}

/// dᵀ M d.
fn square(d: &[f64], of: &nalgebra::DMatrix<f64>) -> f64 {
    let rows = d.iter().enumerate();
    rows.map(|(a, value)| value * product(of, a, d)).sum()
}
