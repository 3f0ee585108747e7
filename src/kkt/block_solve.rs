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
mod tests {
    use pulp::{Arch, Simd, WithSimd};

    use super::super::bandwidth_order::Envelope;
    use super::super::block_lu::{BlockLu, Room};
    use crate::math::Random;

    const EQUATIONS: usize = 150;
    const UNKNOWNS: usize = 153;

    /// One column, and the block.
    struct One<'a>(&'a BlockLu, &'a mut [f64], bool);

    impl WithSimd for One<'_> {
        type Output = ();

        fn with_simd<S: Simd>(self, unit: S) {
            match self.2 {
                true => self.0.solve_one_transposed(unit, self.1),
                false => self.0.solve_one(unit, self.1),
            }
        }
    }

    /// Equations that hold a few unknowns near them each, small ones where pivots would stand without exchanges.
    fn entries() -> Vec<(usize, usize, f64)> {
        let of = |i: usize| i.saturating_sub(6)..UNKNOWNS.min(i + 9);
        let places = (0..EQUATIONS).flat_map(|i| of(i).map(move |j| (i, j)));
        let mut random = Random::new(7);
        let size = |i, j| if i == j { 1e-9 } else { 1.0 };
        places
            .map(|(i, j)| (i, j, size(i, j) * random.between(-1.0, 1.0)))
            .collect()
    }

    fn factored(entries: &[(usize, usize, f64)]) -> (BlockLu, bool) {
        let places = entries.iter().map(|&(i, j, _)| (i, j));
        let mut block = BlockLu::new(Envelope::new(EQUATIONS, UNKNOWNS, places));
        assert!(block.envelope.panels.len() > 3, "there is one panel alone");
        assert!(
            block.envelope.len() < EQUATIONS * UNKNOWNS / 2,
            "{} numbers",
            block.envelope.len()
        );
        for &(i, j, value) in entries {
            block.add(i, j, value);
        }
        let mut room = Room::for_blocks(std::slice::from_ref(&block));
        let is_regular = block.factor(&mut room);
        (block, is_regular)
    }

    fn times(entries: &[(usize, usize, f64)], unknowns: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; EQUATIONS];
        entries
            .iter()
            .for_each(|&(i, j, a)| out[i] += a * unknowns[j]);
        out
    }

    fn assert_near(found: &[f64], expected: &[f64], size: f64) {
        for (i, (x, y)) in found.iter().zip(expected).enumerate() {
            assert!((x - y).abs() <= 1e-11 * size, "{i}: {x}, not {y}");
        }
    }

    fn largest(numbers: &[f64]) -> f64 {
        numbers.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    #[test]
    fn unknowns_and_multipliers_fulfil_what_is_naively_multiplied() {
        let entries = entries();
        let (block, is_regular) = factored(&entries);
        assert!(is_regular);
        let exchanged = (0..EQUATIONS).filter(|&j| block.exchanges[j] as usize != j);
        assert!(exchanged.count() > EQUATIONS / 2, "hardly any exchange");

        let mut free = vec![0.0; 3 * UNKNOWNS];
        block.free(&mut free);
        for column in free.chunks_exact(UNKNOWNS) {
            assert!(largest(column) >= 1.0);
            assert_near(&times(&entries, column), &[0.0; EQUATIONS], largest(column));
        }

        let mut random = Random::new(11);
        let right: Vec<f64> = (0..3 * UNKNOWNS)
            .map(|_| random.between(-1.0, 1.0))
            .collect();
        let mut several = right.clone();
        block.solve(&mut several);
        let is_free = |i: usize| several[i] == 0.0;
        assert_eq!(
            (0..UNKNOWNS).filter(|&i| is_free(i)).count(),
            UNKNOWNS - EQUATIONS
        );
        for (k, column) in several.chunks_exact(UNKNOWNS).enumerate() {
            let right = &right[k * UNKNOWNS..][..UNKNOWNS];
            assert_near(&times(&entries, column), right, largest(column));
            let mut one = right.to_vec();
            Arch::new().dispatch(One(&block, &mut one, false));
            assert_near(&one, column, largest(column));
        }

        let mut multipliers = right.clone();
        block.solve_transposed(&mut multipliers);
        for (k, column) in multipliers.chunks_exact(UNKNOWNS).enumerate() {
            let right = &right[k * UNKNOWNS..][..UNKNOWNS];
            let mut balance = vec![0.0; UNKNOWNS];
            entries
                .iter()
                .for_each(|&(i, j, a)| balance[j] += a * column[i]);
            for i in (0..UNKNOWNS).filter(|&i| !is_free(i)) {
                assert_near(&balance[i..=i], &right[i..=i], largest(column));
            }
            let mut one = right.to_vec();
            Arch::new().dispatch(One(&block, &mut one, true));
            assert_near(&one[..EQUATIONS], &column[..EQUATIONS], largest(column));
        }
    }

    #[test]
    fn equations_that_depend_on_each_other_are_told() {
        let mut entries = entries();
        // Equation 71 becomes twice equation 70.
        let row: Vec<_> = entries.iter().filter(|e| e.0 == 70).copied().collect();
        entries.retain(|e| e.0 != 71);
        entries.extend(row.iter().map(|&(_, j, value)| (71, j, 2.0 * value)));
        assert!(!factored(&entries).1);
    }
}
