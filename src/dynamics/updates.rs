//! Updates of a Newton iteration: the factors of its tangent, kept or made anew, and the parts that they leave out.

use crate::dynamics::anderson::Anderson;
use crate::dynamics::solving::Newton;
use crate::dynamics::step_state::TangentState;
use crate::dynamics::tangent::Tangent;
use crate::math::{IsOver, Stopped};
use crate::sparse::Singular;

/// Part of an update that the factors of a symmetric part may leave out; beyond it the whole tangent is factorised.
const LEFT_OUT: f64 = 0.3;

/// Solves for updates.
#[derive(Debug)]
pub(super) struct Updates {
    tangent: Tangent,
    newton: Newton,
    anderson: Anderson,
    /// Size of each unknown; infinite where it says nothing about convergence.
    scales: Vec<f64>,
}

impl Updates {
    /// With a tangent and a scale for each unknown.
    pub(super) fn new(tangent: Tangent, scales: Vec<f64>, newton: Newton) -> Self {
        Self {
            tangent,
            newton,
            anderson: Anderson::default(),
            scales,
        }
    }

    /// Returns the occasions at which the tangent is factorised.
    pub(super) fn newton(&self) -> Newton {
        self.newton
    }

    /// The method that factorises.
    pub(super) fn name(&self) -> String {
        self.tangent.name()
    }

    /// Writes the tangent that is kept, and the step that it belongs to.
    pub(super) fn keep(&self, step: Option<f64>, to: &mut Option<TangentState>) {
        let to = to.get_or_insert_default();
        // Newton's method makes a new one in every iteration.
        to.step = step.filter(|_| self.newton == Newton::Modified);
        self.tangent.keep(to.step.is_some(), to);
    }

    /// Restores a saved tangent. Returns false if it does not fit these equations.
    pub(super) fn take(&mut self, from: &TangentState) -> bool {
        self.tangent.take(from)
    }

    /// Forgets earlier updates.
    pub(super) fn start(&mut self) {
        self.anderson.start();
    }

    /// Factorises the tangent of these values, unless it is time to stop; the whole of it where its symmetric part is singular.
    pub(super) fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        let done = self.tangent.factor_unless(values, is_over)?;
        match done.is_err() && self.tangent.make_exact() {
            true => self.tangent.factor_unless(values, is_over),
            false => Ok(done),
        }
    }

    /// Returns true if the factors leave out a part of the tangent, or its last digits.
    pub(super) fn are_approximate(&self) -> bool {
        self.tangent.is_approximate()
    }

    /// Makes factors in double precision from now on; returns true if they were not before.
    pub(super) fn make_double(&mut self) -> bool {
        self.tangent.make_double()
    }

    /// Factorises the whole tangent, in double precision, from now on; returns true if it did not before.
    pub(super) fn make_exact(&mut self) -> bool {
        self.tangent.make_exact()
    }

    /// Turns a residual into an update; returns its size relative to the scales.
    pub(super) fn solve(&mut self, residual: &mut [f64]) -> f64 {
        match self.newton {
            Newton::Full => self.tangent.solve(residual),
            Newton::Modified => self.tangent.solve_roughly(residual),
        }
        self.size(residual)
    }

    /// Returns true if the factors leave out so much of an update of this size that the iteration would be slow.
    pub(super) fn leave_out_much(&mut self, update: &[f64], size: f64) -> bool {
        let left_out = self.tangent.left_out(update);
        left_out.is_some_and(|rest| self.size(&rest) > LEFT_OUT * size)
    }

    /// Combines an update with earlier ones, where the tangent is kept.
    pub(super) fn accelerate(&mut self, update: &mut [f64]) {
        if self.newton == Newton::Modified {
            self.anderson.improve(update);
        }
    }

    /// The largest part of an update relative to the scales.
    fn size(&self, update: &[f64]) -> f64 {
        let parts = update.iter().zip(&self.scales);
        parts.fold(0.0, |size, (part, scale)| size.max((part / scale).abs()))
    }
}
