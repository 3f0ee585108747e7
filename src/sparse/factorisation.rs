//! Interface of the methods of factorisation, and the error of a singular matrix.

use crate::math::{IsOver, Stopped};
use std::fmt::Debug;
use thiserror::Error;

/// The matrix is singular to working precision.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the matrix is singular: nothing determines unknown {column}")]
pub struct Singular {
    /// The column without a pivot.
    pub column: usize,
}

/// A factorisation of square matrices with one pattern.
pub trait Factorisation: Debug + Send {
    /// The method, as a table names it.
    fn name(&self) -> &'static str;

    /// The precision of its factors.
    fn precision(&self) -> Precision {
        Precision::Double
    }

    /// Factorises the matrix with these values, one for each slot of its pattern.
    ///
    /// # Errors
    /// The method breaks down; that it does not, says nothing about the accuracy of its factors.
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular>;

    /// The same, left undone where it turns out in its midst that it is time to stop; methods that are a single call of a library ask
    /// once, at the beginning.
    ///
    /// # Errors
    /// It was time to stop.
    fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        match is_over() {
            true => Err(Stopped),
            false => Ok(self.factor(values)),
        }
    }

    /// Solves with the last factorisation, in place.
    fn solve(&mut self, rhs: &mut [f64]);

    /// The number of negative eigenvalues, where the method gives it.
    fn negative_pivots(&self) -> Option<usize>;

    /// The same factorisation in single precision, if there is one.
    fn in_single_precision(&self) -> Option<Box<dyn Factorisation>> {
        None
    }

    /// A factorisation of the same pattern that may succeed where this one does not, if there is one.
    fn more_robust(&self) -> Option<Box<dyn Factorisation>> {
        None
    }
}

/// Digits of the numbers of a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 24 bits: half the memory, and half the time of what only moves or multiplies numbers.
    Single,
    /// 53 bits.
    Double,
}

impl Precision {
    /// Largest error of a known solution that is accepted, with each unknown measured by its column: in single precision the part of an error
    /// that each iteration leaves.
    pub(crate) fn tolerated_loss(self) -> f64 {
        match self {
            Self::Single => 0.2,
            Self::Double => 1e-6,
        }
    }
}
