//! The choice of pivots in a dense front: single ones and pairs, none that lets the factor grow.
//!
//! A pivot is taken if no entry of its columns of L becomes greater than 1/u (threshold partial pivoting of Duff and Reid, 1983). Single
//! pivots that are large are preferred; else the partner with the largest entry of the column is tried (Bunch and Kaufman, 1977).
//!
//! Signs of the eigenvalues of a symmetric matrix.

use super::dense::{Dense, largest};
use pulp::Simd;
use std::ops::Range;

/// A single pivot at least this part of the largest other entry of its column is taken without looking for a pair.
const GOOD: f64 = 0.1;
/// The same with regard to entries of columns that may be pivots: α = (1 + √17) / 8 of Bunch and Kaufman.
const BALANCE: f64 = 0.64;
/// Least determinant of a pair against the product of its diagonal: below, all digits are lost.
const CANCELLED: f64 = 1e-13;

/// Rules by which a pivot is accepted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// u: the part of the largest other entry of its column that a pivot must reach.
    pub(super) threshold: f64,
    /// Columns without an entry greater than this count as zero.
    pub(super) zero: f64,
}

/// Pivot that is eliminated next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pivot {
    /// One column.
    One(usize),
    /// Two columns together.
    Two(usize, usize),
    /// A column that holds nothing.
    Zero(usize),
}

/// Largest entries of a column, without the diagonal, among those not eliminated.
#[derive(Clone, Copy, Debug, Default)]
struct Beside {
    /// Largest entry in rows of the panel, and where.
    most: f64,
    at: usize,
    /// Largest of all others.
    rest: f64,
}

impl Dense<'_> {
    /// A pivot of the columns of a panel that keeps the rules, if any.
    #[inline(always)]
    pub(super) fn choose<S: Simd>(
        &self,
        unit: S,
        rules: Rules,
        panel: Range<usize>,
    ) -> Option<Pivot> {
        // A loop, since closures are not compiled for the vector unit.
        for c in panel.clone() {
            if let Some(pivot) = self.of_column(unit, rules, c, &panel) {
                return Some(pivot);
            }
        }
        None
    }

    /// Column `c` as a pivot, alone or with a partner.
    #[inline(always)]
    fn of_column<S: Simd>(
        &self,
        unit: S,
        rules: Rules,
        c: usize,
        panel: &Range<usize>,
    ) -> Option<Pivot> {
        let beside = self.beside(unit, c, usize::MAX, panel);
        let diagonal = self.at(c, c).abs();
        let most = beside.most.max(beside.rest);
        if most.max(diagonal) <= rules.zero {
            return Some(Pivot::Zero(c));
        }
        let is_pivot = diagonal > rules.zero && diagonal >= rules.threshold * most;
        if is_pivot && (diagonal >= GOOD * most || diagonal >= BALANCE * beside.most) {
            return Some(Pivot::One(c));
        }
        if beside.most > 0.0 && self.is_pair(unit, rules, c, beside, panel) {
            return Some(Pivot::Two(c.min(beside.at), c.max(beside.at)));
        }
        is_pivot.then_some(Pivot::One(c))
    }

    /// Returns true if a column and its largest entry make a pair: the inverse of the pair times the largest entries in its columns.
    #[inline(always)]
    fn is_pair<S: Simd>(
        &self,
        unit: S,
        rules: Rules,
        c: usize,
        beside: Beside,
        panel: &Range<usize>,
    ) -> bool {
        let t = beside.at;
        let (a, b) = (self.at(c, c).abs(), self.at(t, t).abs());
        let product = self.at(c, c) * self.at(t, t);
        let determinant = (product - beside.most * beside.most).abs();
        if determinant <= rules.zero * rules.zero || determinant < CANCELLED * product.abs() {
            return false;
        }
        let of_partner = self.beside(unit, t, c, panel);
        let (g, h) = (beside.rest, of_partner.most.max(of_partner.rest));
        let growth = (b * g + beside.most * h).max(a * h + beside.most * g);
        rules.threshold * growth <= determinant
    }

    /// Largest entries of column `c` without row `skipped`.
    #[inline(always)]
    fn beside<S: Simd>(&self, unit: S, c: usize, skipped: usize, panel: &Range<usize>) -> Beside {
        let column = &self.values[c * self.stride..][..self.order];
        let mut beside = Beside {
            rest: largest(unit, &column[panel.end..]),
            ..Beside::default()
        };
        let mut look = |i: usize, value: f64| {
            let value = value.abs();
            if i != skipped && value > beside.most {
                beside.rest = beside.rest.max(beside.most);
                (beside.most, beside.at) = (value, i);
            } else if i != skipped && value > beside.rest {
                beside.rest = value;
            }
        };
        for j in panel.start..c {
            look(j, self.values[c + j * self.stride]);
        }
        for (i, &value) in column.iter().enumerate().take(panel.end).skip(c + 1) {
            look(i, value);
        }
        beside
    }
}

/// Numbers of negative eigenvalues, and of those that are zero to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inertia {
    /// Negative eigenvalues.
    pub negative: usize,
    /// Eigenvalues that are zero to rounding: pivots without an entry in their column.
    pub zero: usize,
}
