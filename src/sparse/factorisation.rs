//! Interface of the methods of factorisation, and the error of a singular matrix.

use crate::math::{IsOver, Stopped};
use crate::sparse::Precision;
use crate::sparse::backend::Backend;
use crate::sparse::direct::Direct;
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

/// State of a solver that determines how it factorises the next matrix: what it has learnt from those before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MethodState {
    /// The method, as a table names it.
    pub method: String,
    /// Matrices in a row that needed double precision in place of single.
    pub doubled: usize,
}

impl Direct {
    /// Returns the state that determines how the next matrix is factorised.
    pub fn state(&self) -> MethodState {
        MethodState {
            method: self.method().to_owned(),
            doubled: self.doubled,
        }
    }

    /// Factorises the next matrix as another solver of this pattern would; returns true if it can.
    pub fn take(&mut self, state: &MethodState) -> bool {
        while self.method() != state.method {
            match self.factorisation.more_robust() {
                Some(other) => self.factorisation = other,
                None => return false,
            }
        }
        self.doubled = state.doubled;
        self.factored = false;
        true
    }

    /// Factorises a matrix that was factorised before, by the method that did so at last.
    ///
    /// # Errors
    /// It was another matrix or method.
    pub fn factor_again(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.pattern.gather(values, &mut self.values);
        self.measure();
        self.equilibrate();
        self.rehearse();
        let outcome = match self.backend {
            Backend::Dense => self.factorisation.factor(&self.values),
            _ => self.attempt(&|| false).expect("it is never time to stop"),
        };
        self.factored = outcome.is_ok();
        outcome
    }
}
