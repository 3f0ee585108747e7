//! Elimination of the leading columns of a dense front: `A = L D Lᵀ` with pivots of one or two columns.
//!
//! A panel of columns is eliminated one pivot after the other, then the columns behind it are updated at once. A column that is no
//! pivot waits behind the others; what is no pivot at the end is left to the parent (a delay).

use pulp::{Simd, WithSimd};

use super::dense::Dense;
use super::graph::Progress;
use super::pivot::{Pivot, Rules};
use super::update::{Packed, Panel, update};
use crate::math::Stopped;

/// Columns of a panel: wide, so that good pairs are found in it.
const PANEL: usize = 32;

/// Memory of eliminations.
#[derive(Clone, Debug, Default)]
pub(super) struct Workspace {
    packed: Packed,
    /// L D of a panel.
    unscaled: Vec<f64>,
}

/// Counts of an elimination.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    /// Columns eliminated.
    pub(super) eliminated: usize,
    /// Negative eigenvalues of D.
    pub(super) negative: usize,
    /// Columns that hold nothing.
    pub(super) zero: usize,
}

/// Eliminates as many columns as possible; at a root, all.
pub(super) struct Eliminate<'a, 'b, 'c> {
    pub(super) front: Dense<'a>,
    pub(super) rules: Rules,
    pub(super) is_root: bool,
    pub(super) workspace: &'b mut Workspace,
    pub(super) progress: &'b mut Progress<'c>,
}

impl WithSimd for Eliminate<'_, '_, '_> {
    type Output = Result<Count, Stopped>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, unit: S) -> Self::Output {
        let all = self.front.candidates;
        let mut count = Count::default();
        let mut tail = all;
        while count.eliminated < tail {
            let begin = count.eliminated;
            // No narrow panel at the end.
            let end = if tail - begin < 2 * PANEL {
                tail
            } else {
                begin + PANEL
            };
            self.panel(unit, end, &mut count)?;
            let left = end - count.eliminated;
            for i in 0..left.min(tail - end) {
                self.front.swap(count.eliminated + i, tail - 1 - i);
            }
            tail -= left;
        }
        if count.eliminated < all {
            self.panel(unit, all, &mut count)?;
        }
        if self.is_root && count.eliminated < all {
            self.rules.threshold = 0.0;
            self.panel(unit, all, &mut count)?;
            for q in count.eliminated..all {
                self.front.clear(q);
            }
            count.zero += all - count.eliminated;
            count.eliminated = all;
        }
        Ok(count)
    }
}

impl Eliminate<'_, '_, '_> {
    /// Eliminates columns up to `end` as long as there are pivots, and updates those behind.
    #[inline(always)]
    fn panel<S: Simd>(&mut self, unit: S, end: usize, count: &mut Count) -> Result<(), Stopped> {
        let begin = count.eliminated;
        let stride = self.front.stride;
        let needed = (end - begin) * stride;
        self.progress.add(needed * (self.front.order - begin) / 2)?;
        if self.workspace.unscaled.len() < needed {
            self.workspace.unscaled.resize(needed, 0.0);
        }
        while let Some(pivot) = self.front.choose(unit, self.rules, count.eliminated..end) {
            let q = count.eliminated;
            let unscaled = &mut self.workspace.unscaled[(q - begin) * stride..];
            match pivot {
                Pivot::Zero(c) => {
                    self.front.swap(q, c);
                    self.front.clear(q);
                    unscaled[..stride].fill(0.0);
                    count.zero += 1;
                    count.eliminated += 1;
                }
                Pivot::One(c) => {
                    self.front.swap(q, c);
                    count.negative += self.front.eliminate_one(unit, q, end, unscaled);
                    count.eliminated += 1;
                }
                Pivot::Two(a, b) => {
                    self.front.swap(q, a);
                    self.front.swap(q + 1, b);
                    count.negative += self.front.eliminate_two(unit, q, end, unscaled);
                    count.eliminated += 2;
                }
            }
        }
        let pivots = count.eliminated - begin;
        if pivots > 0 && end < self.front.order {
            let (left, right) = self.front.values.split_at_mut(end * stride);
            let panel = Panel {
                left: &left[begin * stride..],
                right: &self.workspace.unscaled,
                stride,
                pivots,
            };
            let packed = &mut self.workspace.packed;
            update(unit, packed, panel, right, end..self.front.order);
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "../../tests/units/kkt/eliminate.rs"]
mod tests;
