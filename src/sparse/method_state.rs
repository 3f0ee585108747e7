//! State of a method of factorisation, from which factors are made again with the same bits.

use crate::sparse::Singular;
use crate::sparse::backend::Backend;
use crate::sparse::direct::Direct;

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
