//! Constraints that follow from others: closed loops with more joints than they need, joints written twice.

use crate::coordinates::Configuration;
use crate::functional::Order;
use crate::model::layout::variables::Role;
use crate::model::model::Model;
use nalgebra::{DMatrix, DVector};

/// A gradient whose part independent of the others is smaller than this follows from them.
const DEPENDENT: f64 = 1e-9;
/// Number of multipliers above which redundancy is not checked.
const MANY: usize = 2000;

impl Model {
    /// The closing constraint that was left out and is violated most at coordinates, by more than a gap that is allowed: its name and gap, in
    /// rad or relative to the length of the system.
    pub fn open_loop(&self, z: &[f64], allowed: f64) -> Option<(String, f64)> {
        if self.loops.is_empty() {
            return None;
        }
        let poses = self.condensed_poses(&self.action.map.placed(z));
        let (gap, name) = self.loops.gap(&poses)?;
        (gap > allowed || gap.is_nan()).then(|| (name.to_owned(), gap))
    }

    /// max |g| over the closing constraints that were left out at an instant, without units or in mm.
    pub fn loop_violation(&self, instant: &Configuration) -> f64 {
        match self.loops.is_empty() {
            true => 0.0,
            false => self.loops.violation(&self.condensed_poses(instant)),
        }
    }

    /// Names of constraints whose gradients follow from those before them where z is, in redundant coordinates; the others
    /// are independent.
    pub fn redundant_constraints(&self, z: &[f64]) -> Vec<String> {
        let (action, n) = (&self.action, self.coordinate_count());
        let multipliers = self.variables.with(Role::Multiplier);
        let m = multipliers.len();
        if m == 0 || m > MANY {
            return Vec::new();
        }
        let layout = action.layout();
        let mut scratch = action.scratch(Order::Hessian);
        let mut values = vec![0.0; layout.values(1)];
        let mut instant = action.map.placed(z);
        action.evaluate_instant(Order::Hessian, &mut instant, &[], &mut scratch);
        action.pull_back_instant(Order::Hessian, &mut instant, 0, &mut scratch, &mut values);
        let mut gradients = DMatrix::<f64>::zeros(n, m);
        for (slot, (row, col)) in layout.same.entries().enumerate() {
            if row < n && col >= n {
                let unit = if self.is_length(row) {
                    self.length()
                } else {
                    1.0
                };
                gradients[(row, col - n)] += values[layout.same_at(0) + slot] * unit;
            }
        }
        let names = multipliers.iter().zip(gradients.column_iter());
        let mut independent: Vec<DVector<f64>> = Vec::new();
        let mut redundant = Vec::new();
        for (multiplier, gradient) in names {
            let mut rest = gradient.into_owned();
            rest.try_normalize_mut(0.0);
            // Once more, for what rounding left of the first time.
            for _ in 0..2 {
                for direction in &independent {
                    let along = direction.dot(&rest);
                    rest.axpy(-along, direction, 1.0);
                }
            }
            match rest.try_normalize(DEPENDENT) {
                Some(direction) => independent.push(direction),
                None => redundant.push(multiplier.name.clone()),
            }
        }
        redundant
    }
}
