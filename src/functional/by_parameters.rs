//! Derivatives of an element by free parameters, and by the arguments of the element from those by the arguments of its formula.

use crate::functional::law::{LawElement, MOST_PARAMETERS, Move};
use crate::math::{Derivatives, Matrix, Number, Vector};
use nalgebra::{SVector, Vector3};
use smallvec::SmallVec;

/// Values of the parameters of an element, as many as it has.
pub(super) type Values<T> = [T; MOST_PARAMETERS];

/// First and second derivatives by one parameter.
#[derive(Clone, Copy)]
pub(super) struct ByParameter<const NV: usize, const NS: usize> {
    pub(super) row: f64,
    pub(super) column: [Vector; NV],
    pub(super) mixed: [f64; NS],
    /// By this parameter and those up to it.
    pub(super) entries: Values<f64>,
}

/// First and second derivatives by the parameters of an element.
pub(super) type ByParameters<const NV: usize, const NS: usize> =
    SmallVec<[ByParameter<NV, NS>; MOST_PARAMETERS]>;

impl<const NV: usize, const NS: usize> ByParameter<NV, NS> {
    pub(super) const ZERO: Self = Self {
        row: 0.0,
        column: [Vector::new(0.0, 0.0, 0.0); NV],
        mixed: [0.0; NS],
        entries: [0.0; MOST_PARAMETERS],
    };
}

/// Derivatives by the arguments of an element from those by the arguments of its formula, or rates from rates.
pub(super) struct OfElement<'a, D, L, const NV: usize, const NS: usize> {
    pub(super) element: &'a LawElement<L, NV, NS>,
    pub(super) values: &'a Values<f64>,
    /// Number of vectors of the formula.
    pub(super) base: usize,
    /// Says which vectors of the formula have mixed second derivatives.
    pub(super) couples: fn(usize, usize) -> bool,
    pub(super) formula: D,
    pub(super) by: &'a [ByParameter<NV, NS>],
}

impl<D: Derivatives, L, const NV: usize, const NS: usize> OfElement<'_, D, L, NV, NS> {
    /// Argument of the formula that argument `i` of the element enters, the factor, and the parameter that is the factor.
    fn argument(&self, i: usize) -> (usize, f64, Option<usize>) {
        let vectors = self.base + self.element.moves.len();
        let (reading, a) = (i / vectors, i % vectors);
        match a.checked_sub(self.base) {
            None => (reading * self.base + a, 1.0, None),
            Some(moved) => {
                let Move {
                    of, parameter, at, ..
                } = self.element.moves[moved];
                let factor = self.values[parameter] - at;
                (reading * self.base + of, factor, Some(parameter))
            }
        }
    }
}

impl<D: Derivatives, L, const NV: usize, const NS: usize> Derivatives
    for OfElement<'_, D, L, NV, NS>
{
    fn force(&self, i: usize) -> Vector {
        let (argument, factor, _) = self.argument(i);
        self.formula.force(argument) * factor
    }

    fn row(&self, s: usize) -> f64 {
        match s.checked_sub(NS) {
            None => self.formula.row(s),
            Some(a) => self.by[a].row,
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let ((i, c, _), (j, d, _)) = (self.argument(i), self.argument(j));
        match (self.couples)(i, j) {
            true => self.formula.block(i, j) * (c * d),
            false => Matrix::zeros(),
        }
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let (argument, factor, own) = self.argument(i);
        match s.checked_sub(NS) {
            None => self.formula.column(argument, s) * factor,
            Some(a) if own == Some(a) => {
                self.by[a].column[argument] * factor + self.formula.force(argument)
            }
            Some(a) => self.by[a].column[argument] * factor,
        }
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        match (s.checked_sub(NS), t.checked_sub(NS)) {
            (None, None) => self.formula.entry(s, t),
            (Some(a), None) => self.by[a].mixed[t],
            (None, Some(b)) => self.by[b].mixed[s],
            (Some(a), Some(b)) => self.by[a.max(b)].entries[a.min(b)],
        }
    }
}

/// ∇E·w.
pub(super) fn contraction<
    T: Number,
    D: Derivatives<T>,
    const NV: usize,
    const NS: usize,
    const M: usize,
>(
    d: &D,
    w: &SVector<T, M>,
) -> T {
    let mut sum = T::zero();
    for i in 0..NV {
        let along: Vector3<T> = w.fixed_rows::<3>(3 * i).into();
        sum += d.force(i).dot(&along);
    }
    for s in 0..NS {
        sum += d.row(s) * w[3 * NV + s];
    }
    sum
}
