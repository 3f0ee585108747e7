//! A square diagonal block (equations × states): its sparsity and its couplings to other unknowns.

use std::ops::Range;

use super::envelope::Envelope;

/// An entry of one of the blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// Its number among the values; before these are known, among the entries.
    pub(super) value: u32,
    pub(super) row: u32,
    pub(super) column: u32,
    /// Offset of the response of the column among the columns of the block.
    pub(super) place: u32,
}

/// One group. States and equations are counted through all groups, reduced unknowns by themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) states: Range<usize>,
    pub(super) equations: Range<usize>,
    /// Reduced unknowns to which its states respond: by way of earlier groups, directly, and the states that are left over.
    pub(super) reach: Vec<u32>,
    /// Number of those that come by way of earlier groups.
    pub(super) inherited: usize,
    /// Reduced unknowns of the columns of H S + Kᵀ.
    pub(super) weighted: Vec<u32>,
    /// Entries of A: of its own states, with what their factors fill, and of earlier ones.
    pub(super) own: Vec<Item>,
    pub(super) envelope: Envelope,
    pub(super) below: Vec<Item>,
    /// Entries of Gᵀ, column one of the rest.
    pub(super) inputs: Vec<Item>,
    /// Entries of H, each once: row a state of the group, column one of its own or of an earlier one.
    pub(super) curvature: Vec<Item>,
    /// Entries of Kᵀ, column one of the rest.
    pub(super) coupling: Vec<Item>,
    /// Entries on the diagonal of its equations, where the states of the group bear that.
    pub(super) diagonal: Vec<Item>,
}

impl Block {
    /// States that are left over.
    pub(super) fn free(&self) -> usize {
        self.states.len() - self.equations.len()
    }

    /// Finds what its factors fill.
    pub(super) fn fill(&mut self) {
        let (equation, state) = (self.equations.start, self.states.start);
        let entries = self.own.iter();
        let entries =
            entries.map(|item| (item.row as usize - equation, item.column as usize - state));
        self.envelope = Envelope::new(self.equations.len(), self.states.len(), entries);
    }

    /// Number of its entries.
    pub(super) fn items(&self) -> usize {
        let lists = [
            &self.own,
            &self.below,
            &self.inputs,
            &self.curvature,
            &self.coupling,
            &self.diagonal,
        ];
        lists.iter().map(|list| list.len()).sum()
    }

    pub(super) fn multiplications(&self) -> f64 {
        let (n, items) = (
            self.states.len(),
            2 * self.curvature.len() + self.below.len(),
        );
        let (reach, weighted) = (self.reach.len() as f64, self.weighted.len() as f64);
        let (of_factors, of_one) = (self.envelope.of_factors(), self.envelope.of_solution());
        of_factors as f64 + reach * ((of_one + items) as f64 + n as f64 * weighted)
    }
}
