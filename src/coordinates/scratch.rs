//! Storage of an evaluation, and what an interval of a sweep carries on to the next.

use crate::functional::{Blocks, Order, Output};
use crate::math::Matrix;

/// Storage that one evaluation needs, allocated once for each thread.
///
/// In a sweep over a horizon the blocks of an instant are summed over both neighbouring intervals before they are pulled
/// back: [`Scratch::carry`] after each interval, and [`Reduced::pull_back_last`](crate::coordinates::Reduced::pull_back_last) at the end.
#[derive(Clone, Debug)]
pub struct Scratch {
    /// Derivatives of the last interval.
    pub interval: Output,
    /// Derivatives of the last instant.
    pub instant: Output,
    pub(super) carried: [Carried; 2],
    pub(super) local: Vec<f64>,
}

/// Blocks (k+1, k+1) of the interval before.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    full: Vec<Matrix>,
    isotropic: Vec<f64>,
}

impl Carried {
    pub(super) fn new(blocks: &Blocks) -> Self {
        Self {
            full: vec![Matrix::zeros(); blocks.full.len()],
            isotropic: vec![0.0; blocks.isotropic.len()],
        }
    }

    /// Adds the carried blocks to those of the first instant, and takes those of the second.
    fn exchange(&mut self, blocks: &mut Blocks) {
        for (carried, block) in self.full.iter_mut().zip(&mut blocks.full) {
            block[0] += std::mem::replace(carried, block[3]);
        }
        for (carried, block) in self.isotropic.iter_mut().zip(&mut blocks.isotropic) {
            block[0] += std::mem::replace(carried, block[3]);
        }
    }
}

impl Scratch {
    /// Forgets carried blocks, before a sweep.
    pub fn start(&mut self) {
        for carried in &mut self.carried {
            carried.full.fill(Matrix::zeros());
            carried.isotropic.fill(0.0);
        }
    }

    /// Moves the blocks of the second instant of the interval evaluated last to the next interval.
    pub fn carry(&mut self, order: Order) {
        if order >= Order::Hessian {
            self.carried[0].exchange(&mut self.interval.plain.blocks);
        }
        if order == Order::Third {
            self.carried[1].exchange(&mut self.interval.contracted.blocks);
        }
    }
}
