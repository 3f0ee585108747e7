//! Costs of deviations from a motion, with their derivatives.

use crate::workflow::receding::program::Program;

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
                sum += self.layout.rates[c] * self.step(x, k, c).powi(2);
            }
        }
        self.deviate_at_end(x);
        sum += square(&self.deviation, &self.reference.at(self.begin + last).end);
        let slope = self.deviation.iter().zip(&self.lasting.slope);
        sum += 2.0 * slope.map(|(d, slope)| d * slope).sum::<f64>();
        for (k, inputs) in self.layout.driven.iter().enumerate() {
            let given = &self.reference.at(self.begin + k).inputs;
            for (i, (input, given)) in inputs.iter().zip(given).enumerate() {
                let [value, ..] = input.reading(x[input.column]);
                let off = value - given - self.lasting.inputs[i];
                sum += self.reference.inputs[i] * off.powi(2);
            }
        }
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
                let slope: f64 = (0..n).map(|b| places[(a, b)] * self.deviation[b]).sum();
                grad[column] += scale * slope;
                let slope = self.layout.rates[a] * self.step(x, k, a);
                grad[column] -= scale * slope;
                let (column, scale) = self.layout.coordinates[(k + 1) * n + a];
                grad[column] += scale * slope;
            }
        }
        self.deviate_at_end(x);
        let end = &self.reference.at(self.begin + last).end;
        for a in 0..self.deviation.len() {
            let (column, scale) = self.end_column(a);
            let all = self.deviation.iter().enumerate();
            let slope = all.map(|(b, d)| end[(a, b)] * d).sum::<f64>();
            grad[column] += scale * (slope + self.lasting.slope[a]);
        }
        for (k, inputs) in self.layout.driven.iter().enumerate() {
            let given = &self.reference.at(self.begin + k).inputs;
            for (i, (input, given)) in inputs.iter().zip(given).enumerate() {
                let [value, slope, _] = input.reading(x[input.column]);
                let off = value - given - self.lasting.inputs[i];
                grad[input.column] += self.reference.inputs[i] * off * slope;
            }
        }
    }

    /// Its second derivatives times a factor, in the order of the entries.
    pub(super) fn curvatures(&self, x: &[f64], sigma: f64, costs: &mut [f64]) {
        let (n, last) = (self.layout.width(), self.layout.intervals);
        let mut costs = costs.iter_mut();
        let mut put = |value: f64| *costs.next().expect("an entry") = sigma * value;
        let scale = |k: usize, c: usize| self.layout.coordinates[k * n + c].1;
        let rates = &self.layout.rates;
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
        for (k, inputs) in self.layout.driven.iter().enumerate() {
            let given = &self.reference.at(self.begin + k).inputs;
            for (i, (input, given)) in inputs.iter().zip(given).enumerate() {
                let [value, slope, curvature] = input.reading(x[input.column]);
                let off = value - given - self.lasting.inputs[i];
                put(self.reference.inputs[i] * (slope * slope + off * curvature));
            }
        }
    }
}

/// dᵀ M d.
fn square(d: &[f64], of: &nalgebra::DMatrix<f64>) -> f64 {
    let row = |(a, value): (usize, &f64)| {
        let row = d.iter().enumerate().map(|(b, other)| of[(a, b)] * other);
        value * row.sum::<f64>()
    };
    d.iter().enumerate().map(row).sum()
}
