//! Response to an input that oscillates, `q = Re x exp(iωt)` for `u = u₀ + Re exp(iωt)`, about a state of rest:
//!
//! ```text
//! (K + iω C − ω² M) x = F,
//! ```
//!
//! with multipliers and potentials, as real and imaginary part of one system. A voltage acts by its change about that of rest.

use crate::dynamics::equilibrium::vibrations::Vibrations;
use crate::functional::{Measure, Sample};
use crate::math::Vector;
use crate::sparse::Direct;
use crate::stop;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Derivatives of a quantity by what responds.
struct Output {
    /// By coordinates, and by their rates.
    by: [Vec<f64>; 2],
    /// By the scalars of an interval.
    scalars: Vec<f64>,
}

impl Vibrations<'_> {
    /// Responses of quantities of the model, by their numbers, to the input of a source of amplitude 1 at frequencies in kHz; a row for each frequency.
    /// Nothing where the source acts on nothing, a quantity is not measured, a frequency is an eigenvalue, or it was stopped.
    pub fn responses(
        &self,
        source: usize,
        quantities: &[usize],
        frequencies: &[f64],
    ) -> Option<Vec<Vec<Complex<f64>>>> {
        let model = self.statics.model;
        let (size, h) = (self.statics.residual.len(), model.multiplier_time);
        let scalar = model.variables.input(source)?;
        let outputs: Option<Vec<Output>> = quantities.iter().map(|&one| self.output(one)).collect();
        let outputs = outputs?;
        let mut change = vec![0.0; model.variables.inputs().len()];
        change[scalar] = 1.0;
        let mut force = vec![0.0; size];
        self.statics.add_load(&change, &mut force);
        model.hold(&mut force);
        let tangent: Vec<_> = self.statics.entries().collect();
        let twice = |(i, j): (usize, usize)| [(i, j), (size + i, size + j)];
        let mixed = |(i, j): (usize, usize)| [(i, size + j), (size + i, j)];
        let entries = tangent
            .iter()
            .chain(&self.mass)
            .flat_map(|(entry, _)| twice(*entry));
        let entries = entries.chain(self.damping.iter().flat_map(|(entry, _)| mixed(*entry)));
        let mut solver = Direct::new(2 * size, &entries.collect::<Vec<_>>());
        let at = |frequency: f64| {
            if stop::reason().is_some() {
                return None;
            }
            let omega = TAU * frequency;
            // The tangent is −h K.
            let still = tangent.iter().flat_map(|(_, value)| [*value; 2]);
            let inert = self
                .mass
                .iter()
                .flat_map(|(_, value)| [h * omega * omega * value; 2]);
            let damped = self.damping.iter().map(|(_, value)| h * omega * value);
            let damped = damped.flat_map(|value| [value, -value]);
            solver
                .factor(&still.chain(inert).chain(damped).collect::<Vec<_>>())
                .ok()?;
            let mut x: Vec<f64> = force.iter().map(|f| -f).collect();
            x.resize(2 * size, 0.0);
            solver.solve(&mut x);
            let x = |i: usize| Complex::new(x[i], x[size + i]);
            let of = |output: &Output| {
                let mut sum = Complex::new(output.scalars[scalar], 0.0);
                for (i, (by, by_rate)) in output.by[0].iter().zip(&output.by[1]).enumerate() {
                    sum += x(i) * Complex::new(*by, omega * by_rate);
                }
                for (s, by) in output.scalars.iter().enumerate() {
                    if let Some(place) = model.variables.place(s) {
                        sum += x(place) * *by;
                    }
                }
                sum
            };
            let row: Vec<Complex<f64>> = outputs.iter().map(of).collect();
            row.iter()
                .all(|value| value.norm().is_finite())
                .then_some(row)
        };
        frequencies.iter().copied().map(at).collect()
    }

    /// Derivatives of a quantity of the model.
    fn output(&self, quantity: usize) -> Option<Output> {
        let model = self.statics.model;
        let action = &model.action;
        let is_of_intervals = model.analysis.quantities[quantity].is_of_intervals();
        let sums = if is_of_intervals {
            &action.intervals
        } else {
            &action.instants
        };
        let measure: &dyn Measure = sums.measures[model.measured[quantity]?].as_ref();
        let h = model.multiplier_time;
        let instant = action.map.placed(&self.place());
        let sample = Sample {
            h: if is_of_intervals { h } else { 1.0 },
            ..Sample::of_instant(&instant.x, &self.statics.scalars)
        };
        let zeros = || vec![Vector::zeros(); instant.x.len()];
        let mut forces = [zeros(), zeros()];
        let mut scalars = vec![0.0; self.statics.scalars.len()];
        measure.gradient(&sample, &mut forces, &mut scalars);
        // An interval stands for its middle.
        let by_rate = if is_of_intervals { 0.5 * h } else { 0.0 };
        let [here, next] = forces.map(|forces| {
            let mut rows = vec![0.0; action.map.coordinates];
            action.map.pull_back(&instant.columns, &forces, &mut rows);
            rows
        });
        let pairs = || here.iter().zip(&next);
        Some(Output {
            by: [
                pairs().map(|(a, b)| a + b).collect(),
                pairs().map(|(a, b)| by_rate * (b - a)).collect(),
            ],
            scalars,
        })
    }
}
