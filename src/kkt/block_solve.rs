//! Solutions with the factors of a block, of several right-hand sides at once and of one.

use std::ops::Range;

use faer::linalg::triangular_solve as triangular;
use faer::{MatMut, MatRef, Par};
use pulp::Simd;

use super::bandwidth_order::Panel;
use super::block_lu::{BlockLu, subtract_product};
use super::dense::{dot, subtract};

/// Factors of a panel, and the rows of right-hand sides that they meet.
struct PanelRows<'a> {
    /// Triangle of its own equations.
    own: MatRef<'a, f64>,
    /// The other rows: above it of the upper factor, below it of the lower one.
    rest: MatRef<'a, f64>,
    of_own: MatMut<'a, f64>,
    of_rest: MatMut<'a, f64>,
}

impl PanelRows<'_> {
    fn subtract_rest_from_own(&mut self) {
        let (rest, known) = (self.rest.transpose(), self.of_rest.as_ref());
        subtract_product(self.of_own.as_mut(), rest, known);
    }

    fn subtract_own_from_rest(&mut self) {
        subtract_product(self.of_rest.as_mut(), self.rest, self.of_own.as_ref());
    }
}

impl BlockLu {
    /// Replaces right-hand sides, each at the beginning of a column of as many numbers as there are unknowns, by the unknowns that they
    /// determine where free ones are zero.
    pub(super) fn solve(&self, right: &mut [f64]) {
        for panel in &self.envelope.panels {
            let mut part = self.upper(panel, right);
            part.subtract_rest_from_own();
            let factor = part.own.transpose();
            triangular::solve_lower_triangular_in_place(factor, part.of_own, Par::Seq);
        }
        for column in right.chunks_exact_mut(self.envelope.unknowns) {
            column[self.envelope.equations..].fill(0.0);
        }
        self.distribute(right);
    }

    /// Writes one column for each free unknown: the unknowns that the equations determine where it is one and right-hand sides are zero.
    pub(super) fn free(&self, to: &mut [f64]) {
        to.fill(0.0);
        for (i, column) in to.chunks_exact_mut(self.envelope.unknowns).enumerate() {
            column[self.envelope.equations + i] = 1.0;
        }
        self.distribute(to);
    }

    /// `L⁻ᵀ`, and the unknowns where they were before the exchanges.
    fn distribute(&self, right: &mut [f64]) {
        for panel in self.envelope.panels.iter().rev() {
            let mut part = self.lower(panel, right);
            part.subtract_rest_from_own();
            let factor = part.own.transpose();
            triangular::solve_unit_upper_triangular_in_place(factor, part.of_own, Par::Seq);
            for column in right.chunks_exact_mut(self.envelope.unknowns) {
                self.exchange_back(panel, column);
            }
        }
    }

    /// Replaces columns of as many numbers as there are unknowns by the multipliers of the equations that balance those that are determined;
    /// they stand at the beginning.
    pub(super) fn solve_transposed(&self, right: &mut [f64]) {
        for panel in &self.envelope.panels {
            for column in right.chunks_exact_mut(self.envelope.unknowns) {
                self.exchange(panel, column);
            }
            let mut part = self.lower(panel, right);
            let values = part.of_own.as_mut();
            triangular::solve_unit_lower_triangular_in_place(part.own, values, Par::Seq);
            part.subtract_own_from_rest();
        }
        for panel in self.envelope.panels.iter().rev() {
            let mut part = self.upper(panel, right);
            let values = part.of_own.as_mut();
            triangular::solve_upper_triangular_in_place(part.own, values, Par::Seq);
            part.subtract_own_from_rest();
        }
    }

    /// The part of a panel in the upper factor.
    fn upper<'a>(&'a self, panel: &Panel, right: &'a mut [f64]) -> PanelRows<'a> {
        let rows = panel.rows.start..panel.equations.end;
        let before = panel.equations.start - rows.start;
        let (rest, own) = self.rectangle(rows.clone(), panel).split_at_row(before);
        let (of_rest, of_own) = self.rows(right, rows).split_at_row_mut(before);
        PanelRows {
            own,
            rest,
            of_own,
            of_rest,
        }
    }

    /// The part of a panel in the lower factor.
    fn lower<'a>(&'a self, panel: &Panel, right: &'a mut [f64]) -> PanelRows<'a> {
        let (rows, width) = (panel.equations.start..panel.rows.end, panel.equations.len());
        let (own, rest) = self.rectangle(rows.clone(), panel).split_at_row(width);
        let (of_own, of_rest) = self.rows(right, rows).split_at_row_mut(width);
        PanelRows {
            own,
            rest,
            of_own,
            of_rest,
        }
    }

    /// [`Self::solve`] of one column.
    #[inline(always)]
    pub(super) fn solve_one<S: Simd>(&self, unit: S, right: &mut [f64]) {
        for panel in &self.envelope.panels {
            for j in panel.equations.clone() {
                let column = self.column(panel.rows.start..j + 1, j);
                let (above, pivot) = column.split_at(j - panel.rows.start);
                let known = dot(unit, above, &right[panel.rows.start..j]);
                right[j] = (right[j] - known) / pivot[0];
            }
        }
        right[self.envelope.equations..].fill(0.0);
        for panel in self.envelope.panels.iter().rev() {
            for j in panel.equations.clone().rev() {
                let below = self.column(j + 1..panel.rows.end, j);
                right[j] -= dot(unit, below, &right[j + 1..panel.rows.end]);
            }
            self.exchange_back(panel, right);
        }
    }

    /// [`Self::solve_transposed`] of one column.
    #[inline(always)]
    pub(super) fn solve_one_transposed<S: Simd>(&self, unit: S, right: &mut [f64]) {
        for panel in &self.envelope.panels {
            self.exchange(panel, right);
            for j in panel.equations.clone() {
                let below = self.column(j + 1..panel.rows.end, j);
                let value = right[j];
                subtract(unit, &mut right[j + 1..panel.rows.end], below, value);
            }
        }
        for panel in self.envelope.panels.iter().rev() {
            for j in panel.equations.clone().rev() {
                let column = self.column(panel.rows.start..j + 1, j);
                let (above, pivot) = column.split_at(j - panel.rows.start);
                let value = right[j] / pivot[0];
                right[j] = value;
                subtract(unit, &mut right[panel.rows.start..j], above, value);
            }
        }
    }

    fn exchange(&self, panel: &Panel, column: &mut [f64]) {
        for j in panel.equations.clone() {
            column.swap(j, self.exchanges[j] as usize);
        }
    }

    fn exchange_back(&self, panel: &Panel, column: &mut [f64]) {
        for j in panel.equations.clone().rev() {
            column.swap(j, self.exchanges[j] as usize);
        }
    }

    /// Rows of columns of as many numbers as there are unknowns.
    fn rows<'a>(&self, numbers: &'a mut [f64], rows: Range<usize>) -> MatMut<'a, f64> {
        let columns = numbers.len() / self.envelope.unknowns;
        let all = MatMut::from_column_major_slice_mut(numbers, self.envelope.unknowns, columns);
        all.subrows_mut(rows.start, rows.len())
    }
}

#[cfg(test)]
#[path = "../../tests/units/kkt/block_solve.rs"]
mod tests;
