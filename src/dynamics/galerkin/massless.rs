//! Vectors without mass, those of Maxwell branches and of charges, in a Galerkin step.
//!
//! They carry no momentum, so that the residual g of their equation need not vanish at the end of a step. With the rows of other vectors it
//! would return in the next step with the opposite sign, and grow. Their rows are `Σ_i b_i q_r(c_i) g(c_i)` with the polynomials q_r of degree
//! s − 1 through the points 0 … s − 1: a continuous Galerkin method, whose damping factor is the diagonal Padé approximation of the
//! exponential, of order 2s and below one for every relaxation time. As q_r is one at its point, zero at the others, and some share at the
//! end, the rows of a point are the usual ones and that share of those of the end.

use crate::dynamics::galerkin::rule::{Rule, Weights};
use crate::functional::{Blocks, SumDerivatives};
use crate::kinematics::{Carrier, MaterialVector};
use crate::math::Vector;
use crate::model::Model;

/// The vectors without mass and the pairs whose rows belong to them.
#[derive(Clone, Debug)]
pub(super) struct Massless {
    /// Coordinates.
    pub(super) coordinates: Vec<usize>,
    /// The vectors of them.
    vectors: Vec<usize>,
    /// Slots of couplings with full and with isotropic blocks.
    slots: [Vec<usize>; 2],
    /// Share of the end by point of the rows; none of a method that carries no residual.
    shares: Vec<f64>,
}

impl Massless {
    pub(super) fn new(model: &Model, rule: &Rule) -> Self {
        let coordinates: Vec<usize> = model.memory().collect();
        let is_massless = |vector: &MaterialVector| {
            let mut terms = vector.terms.iter();
            terms.any(|term| matches!(term.carrier, Carrier::Coordinate(i) if model.is_memory(i)))
        };
        let is_massless: Vec<bool> = model.vectors.iter().map(is_massless).collect();
        let vectors: Vec<usize> = (0..is_massless.len()).filter(|&v| is_massless[v]).collect();
        let couplings = model.action.intervals.couplings();
        let of_rows = |pairs: &[(usize, usize)]| {
            let slots = pairs.iter().enumerate();
            let own = slots.filter(|(_, (row, _))| is_massless[*row]);
            own.map(|(slot, _)| slot).collect()
        };
        Self {
            slots: [&couplings.full, &couplings.isotropic].map(|pairs| of_rows(pairs)),
            shares: match vectors.is_empty() {
                true => Vec::new(),
                false => rule.shares(),
            },
            coordinates,
            vectors,
        }
    }

    /// The vectors of the coordinates without mass.
    pub(super) fn vectors(&self) -> &[usize] {
        &self.vectors
    }

    /// Weight of the forces of a side of a sample on the end in the rows of a point; `None` where they have none.
    fn weight(&self, weights: &Weights, side: usize, row: usize) -> Option<f64> {
        let share = self.shares.get(row)?;
        let end = weights.give[side].last()?;
        Some(weights.quadrature * end * share).filter(|weight| *weight != 0.0)
    }

    /// Adds the share of the forces of a sample to those of the rows of a point.
    pub(super) fn add_forces(
        &self,
        (weights, row): (&Weights, usize),
        from: &SumDerivatives,
        forces: &mut [Vector],
    ) {
        for (side, all) in from.forces.iter().enumerate() {
            if let Some(weight) = self.weight(weights, side, row) {
                for &vector in &self.vectors {
                    forces[vector] += all[vector] * weight;
                }
            }
        }
    }

    /// Adds the share of the blocks of a sample by the vectors of a point to one block of the rows of another.
    pub(super) fn add_blocks(
        &self,
        (weights, row, point): (&Weights, usize, usize),
        from: &Blocks,
        (to, block): (&mut Blocks, usize),
    ) {
        for side in 0..4 {
            let take = weights.take[side % 2][point];
            let Some(weight) = self.weight(weights, side / 2, row) else {
                continue;
            };
            for &slot in &self.slots[0] {
                to.full[slot][block] += from.full[slot][side] * (weight * take);
            }
            for &slot in &self.slots[1] {
                to.isotropic[slot][block] += from.isotropic[slot][side] * (weight * take);
            }
        }
    }
}
