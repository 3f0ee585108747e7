//! The part of the objective that is a polynomial in voltages and interval length: a weighted sum of effort, rate and duration.
//!
//! Inputs v (voltages in kV, loads in N or N m), interval length τ in s:
//!
//! ```text
//! f = a τ Σ_k |v_k|² + b/τ Σ_{k=0..N} |v_k − v_{k−1}|² + c N τ,     v_{−1}, v_N: rest voltages of start and goal.
//! ```

use crate::control::costs::Objective;
use crate::control::numbering::Span;

/// The objective with the voltages at rest before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// Weights of effort, rate and duration.
    effort: f64,
    rate: f64,
    duration: f64,
    scalars: usize,
    span: Span,
    /// Rest voltages before the first and after the last interval in kV.
    ends: [Option<Vec<f64>>; 2],
}

impl Cost {
    /// An objective over the intervals of a horizon; `ends` are the rest voltages in kV where they are known.
    pub fn new(
        objective: &Objective,
        scalars: usize,
        span: Span,
        ends: [Option<Vec<f64>>; 2],
    ) -> Self {
        Self {
            effort: objective.effort,
            rate: objective.rate,
            duration: objective.duration,
            scalars,
            span,
            ends,
        }
    }

    /// Takes the weights of another objective.
    pub(super) fn weigh(&mut self, objective: &Objective) {
        self.effort = objective.effort;
        self.rate = objective.rate;
        self.duration = objective.duration;
    }

    /// Returns true if neighbouring intervals couple.
    pub fn couples_intervals(&self) -> bool {
        self.rate != 0.0 && self.span.all > 1
    }

    /// Returns true if voltages enter by their squares alone.
    pub fn is_of_squares(&self) -> bool {
        self.rate == 0.0
    }

    /// Voltage s of interval k, where k = 0 is the rest before the first.
    fn jump(&self, v: &[f64], k: usize, s: usize) -> Option<f64> {
        let at = |k: usize| v[k * self.scalars + s];
        let before = match self.span.before(k) {
            None => self.ends[0].as_ref().map(|e| e[s]),
            Some(before) => Some(at(before)),
        };
        let after = if k == self.span.all {
            self.ends[1].as_ref().map(|e| e[s])
        } else {
            Some(at(k))
        };
        Some(after? - before?)
    }

    fn squares(&self, v: &[f64]) -> (f64, f64) {
        let effort = v.iter().map(|x| x * x).sum();
        let jumps = (0..=self.span.all).flat_map(|k| (0..self.scalars).map(move |s| (k, s)));
        let rate = jumps
            .filter_map(|(k, s)| self.jump(v, k, s))
            .map(|j| j * j)
            .sum();
        (effort, rate)
    }

    /// f at voltages v (kV, interval by interval) and interval length τ (s).
    pub fn value(&self, v: &[f64], tau: f64) -> f64 {
        let (effort, rate) = self.squares(v);
        let mut sum = self.effort * tau * effort + self.duration * self.span.end as f64 * tau;
        if self.rate != 0.0 {
            sum += self.rate * rate / tau;
        }
        sum
    }

    /// ∂f/∂v into `out`; returns ∂f/∂τ.
    pub fn gradient(&self, v: &[f64], tau: f64, out: &mut [f64]) -> f64 {
        for (g, x) in out.iter_mut().zip(v) {
            *g = 2.0 * self.effort * tau * x;
        }
        self.add_rate_gradient(v, tau, out);
        let (effort, rate) = self.squares(v);
        self.effort * effort - self.rate * rate / (tau * tau) + self.duration * self.span.end as f64
    }

    /// Adds ∂/∂v of the rate term.
    fn add_rate_gradient(&self, v: &[f64], tau: f64, out: &mut [f64]) {
        if self.rate == 0.0 {
            return;
        }
        for k in 0..=self.span.all {
            for s in 0..self.scalars {
                let Some(jump) = self.jump(v, k, s) else {
                    continue;
                };
                let slope = 2.0 * self.rate / tau * jump;
                if let Some(before) = self.span.before(k) {
                    out[before * self.scalars + s] -= slope;
                }
                if k < self.span.all {
                    out[k * self.scalars + s] += slope;
                }
            }
        }
    }

    /// ∂²f/∂v² of one voltage of interval k with itself.
    pub fn curvature(&self, k: usize, tau: f64) -> f64 {
        let before = self.span.before(k).is_some() || self.ends[0].is_some();
        let after = k + 1 < self.span.all || self.span.is_closed || self.ends[1].is_some();
        let jumps = f64::from(u8::from(before) + u8::from(after));
        2.0 * self.effort * tau + 2.0 * self.rate / tau * jumps
    }

    /// ∂²f of one voltage with the same voltage of the interval before.
    pub fn coupling(&self, tau: f64) -> f64 {
        -2.0 * self.rate / tau
    }

    /// ∂²f/∂v∂τ into `out`; returns ∂²f/∂τ².
    pub fn horizon(&self, v: &[f64], tau: f64, out: &mut [f64]) -> f64 {
        out.fill(0.0);
        self.add_rate_gradient(v, tau, out);
        for (g, x) in out.iter_mut().zip(v) {
            *g = 2.0 * self.effort * x - *g / tau;
        }
        let (_, rate) = self.squares(v);
        2.0 * self.rate * rate / (tau * tau * tau)
    }
}
