//! Anderson's acceleration of an iteration with a fixed tangent.
//!
//! An iteration x ← x + f(x), f = −K⁻¹R with an old tangent K, converges linearly. From the last updates f and the steps that
//! were made, the combination of steps is found whose linearised update is least (D. G. Anderson, J. ACM 12, 1965).

use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Number of earlier steps that are combined.
const DEPTH: usize = 4;

/// Steps and updates of the last iterations.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    /// Differences of the updates, and of the points, newest last.
    differences: VecDeque<[Vec<f64>; 2]>,
    last_update: Vec<f64>,
    last_step: Vec<f64>,
}

impl Anderson {
    /// Forgets earlier iterations.
    pub(super) fn start(&mut self) {
        self.differences.clear();
        self.last_update.clear();
    }

    /// Turns an update into a better step, in place.
    pub(super) fn improve(&mut self, update: &mut [f64]) {
        if self.last_update.len() == update.len() {
            let mut oldest = match self.differences.len() {
                DEPTH => self.differences.pop_front().unwrap_or_default(),
                _ => Default::default(),
            };
            let difference = update.iter().zip(&self.last_update).map(|(a, b)| a - b);
            oldest[0].clear();
            oldest[0].extend(difference);
            oldest[1].clear();
            oldest[1].extend_from_slice(&self.last_step);
            self.differences.push_back(oldest);
        }
        self.last_update.clear();
        self.last_update.extend_from_slice(update);
        let count = self.differences.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let products = DMatrix::from_fn(count, count, |i, j| {
            dot(&self.differences[i][0], &self.differences[j][0])
        });
        let rhs = DVector::from_fn(count, |i, _| {
            dot(&self.differences[i][0], &self.last_update)
        });
        // Nearly dependent updates say nothing new.
        let solved = (count > 0).then(|| products.svd(true, true).solve(&rhs, 1e-24));
        if let Some(Ok(factors)) = solved {
            for ([updates, steps], factor) in self.differences.iter().zip(&factors) {
                for ((value, u), s) in update.iter_mut().zip(updates).zip(steps) {
                    *value -= factor * (u + s);
                }
            }
        }
        self.last_step.clear();
        self.last_step.extend_from_slice(update);
    }
}
