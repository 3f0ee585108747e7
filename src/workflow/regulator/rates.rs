//! Costs of rates: of the differences of coordinates over an interval, which a receding horizon counts too.
//!
//! With x₊ = A x + B u a step costs `xᵀQx + uᵀRu + (x₊ − x)ᵀW(x₊ − x)`, which is `xᵀQ̂x + 2 xᵀN u + uᵀR̂u` with
//!
//! ```text
//! Q̂ = Q + (A − 1)ᵀW(A − 1),     N = (A − 1)ᵀWB,     R̂ = R + BᵀWB
//! ```
//!
//! Of the inputs `v = u + L x`, L = R̂⁻¹Nᵀ, the step has no such products: A′ = A − B L, Q′ = Q̂ − N L, K = K′ + L. Q′ is computed as
//! `Q + (A − 1)ᵀ (W⁻¹ + BR⁻¹Bᵀ)⁻¹ (A − 1)`, a sum of squares.

use crate::feedback::{Costs, HeldGain, NotHeld, RiccatiStep, held_gain, riccati_step, symmetric};
use crate::workflow::regulator::regulated::RegulatedStep;
use nalgebra::{DMatrix, DVector};

/// All costs of a step as factors of products.
#[derive(Clone, Debug)]
pub struct WholeCosts {
    /// Q̂ and R̂.
    pub costs: Costs,
    /// Nᵀ, by input over the state.
    pub cross: DMatrix<f64>,
}

/// A step without products of state and inputs.
struct Plain {
    /// A′.
    by_state: DMatrix<f64>,
    /// Q′ and R̂.
    costs: Costs,
    /// L.
    shift: DMatrix<f64>,
}

impl RegulatedStep {
    /// True if rates cost.
    pub(crate) fn has_rates(&self) -> bool {
        self.rates.iter().any(|weight| *weight > 0.0)
    }

    /// A − 1.
    fn change(&self) -> DMatrix<f64> {
        let n = self.by_state.nrows();
        &self.by_state - DMatrix::identity(n, n)
    }

    /// W times a matrix.
    pub(super) fn weighted(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(of.nrows(), of.ncols(), |i, j| self.rates[i] * of[(i, j)])
    }

    /// Its costs with those of rates.
    pub fn whole_costs(&self) -> WholeCosts {
        let change = self.change();
        let weighted = self.weighted(&self.by_inputs);
        WholeCosts {
            costs: Costs {
                state: &self.costs.state + change.transpose() * self.weighted(&change),
                inputs: &self.costs.inputs + self.by_inputs.transpose() * &weighted,
            },
            cross: weighted.transpose() * change,
        }
    }

    /// `None` where R̂ is not positive definite.
    fn plain(&self) -> Option<Plain> {
        let WholeCosts { costs, cross } = self.whole_costs();
        let shift = costs.inputs.clone().cholesky()?.solve(&cross);
        let costly: Vec<usize> = (0..self.rates.len())
            .filter(|&i| self.rates[i] > 0.0)
            .collect();
        let moved = self.by_inputs.select_rows(&costly);
        let resistance = self.costs.inputs.clone().cholesky()?;
        let weights = costly.iter().map(|&i| 1.0 / self.rates[i]);
        let weights = DVector::from_iterator(costly.len(), weights);
        let inner = &moved * resistance.solve(&moved.transpose());
        let inner = symmetric(inner + DMatrix::from_diagonal(&weights));
        let change = self.change().select_rows(&costly);
        let of_rates = change.transpose() * inner.cholesky()?.solve(&change);
        let state = &self.costs.state + symmetric(of_rates);
        Some(Plain {
            by_state: &self.by_state - &self.by_inputs * &shift,
            costs: Costs { state, ..costs },
            shift,
        })
    }

    /// The gain before a cost, and the cost with that of the step.
    pub(crate) fn riccati(&self, after: &DMatrix<f64>) -> Option<RiccatiStep> {
        if !self.has_rates() {
            return riccati_step([&self.by_state, &self.by_inputs], &self.costs, after);
        }
        let plain = self.plain()?;
        let found = riccati_step([&plain.by_state, &self.by_inputs], &plain.costs, after)?;
        Some(RiccatiStep {
            gain: found.gain + plain.shift,
            cost: found.cost,
        })
    }

    /// The gain of the step for ever.
    pub(super) fn for_ever(&self) -> Result<HeldGain, NotHeld> {
        if !self.has_rates() {
            return held_gain([&self.by_state, &self.by_inputs], &self.costs);
        }
        let plain = self.plain().ok_or(NotHeld::Unsolved)?;
        let found = held_gain([&plain.by_state, &self.by_inputs], &plain.costs)?;
        Ok(HeldGain {
            gain: found.gain + plain.shift,
            ..found
        })
    }
}
