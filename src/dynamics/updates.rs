//! Updates of a Newton iteration: the factors of its tangent, kept or made anew, and the parts that they leave out.
//!
//! Anderson's acceleration of an iteration with a fixed tangent.
//!
//! An iteration x ← x + f(x), f = −K⁻¹R with an old tangent K, converges linearly. From the last updates f and the steps that
//! were made, the combination of steps is found whose linearised update is least (D. G. Anderson, J. ACM 12, 1965).

use crate::dynamics::contraction::{Contraction, Verdict};
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::solving::Newton;
use crate::dynamics::tangent::Tangent;
use crate::dynamics::trajectory::TangentState;
use crate::math::{IsOver, Stopped};
use crate::sparse::Singular;
use crate::sparse::multigrid::NoSolution;
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Part of an update that the factors of a symmetric part may leave out; beyond it the whole tangent is factorised.
const LEFT_OUT: f64 = 0.3;

/// Solves for updates.
#[derive(Debug)]
pub(super) struct Updates {
    pub(super) matrix: NewtonMatrix,
    /// Occasions at which the tangent is factorised.
    pub(super) newton: Newton,
    anderson: Anderson,
    /// Size of each unknown; infinite where it says nothing about convergence.
    scales: Vec<f64>,
}

impl Updates {
    /// With a matrix and a scale for each unknown.
    pub(super) fn new(matrix: NewtonMatrix, scales: Vec<f64>, newton: Newton) -> Self {
        Self {
            matrix,
            newton,
            anderson: Anderson::default(),
            scales,
        }
    }

    /// Writes the tangent that is kept, and the step that it belongs to.
    pub(super) fn keep(&mut self, step: Option<f64>, to: &mut Option<TangentState>) {
        let to = to.get_or_insert_default();
        // Newton's method makes a new one in every iteration.
        to.step = step.filter(|_| self.newton == Newton::Modified);
        self.matrix.keep(to.step.is_some(), to);
    }

    /// Begins an attempt of a step.
    pub(super) fn begin(&mut self) {
        self.start();
        if let Some(grids) = self.matrix.grids_mut() {
            grids.start();
        }
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
        let done = self.matrix.factor_unless(values, is_over)?;
        match done.is_err() && self.make_exact() {
            true => self.matrix.factor_unless(values, is_over),
            false => Ok(done),
        }
    }

    /// Before the first update of an attempt.
    pub(super) fn contraction(&self) -> Contraction {
        match &self.matrix {
            NewtonMatrix::Direct(_) => Contraction::new(self.newton),
            NewtonMatrix::Grids(_) => Contraction::of_cheap_tangents(self.newton),
        }
    }

    /// Judges an update of this size by what its matrix leaves of it.
    pub(super) fn judge(&self, contraction: &mut Contraction, size: f64, reused: bool) -> Verdict {
        let is_approximate = |tangent: &Tangent| tangent.is_approximate();
        let tangent = self.matrix.direct();
        contraction.judge(size, reused, tangent.is_none_or(is_approximate))
    }

    /// Makes factors in double precision from now on; returns true if they were not before.
    pub(super) fn make_double(&mut self) -> bool {
        self.matrix.direct_mut().is_some_and(Tangent::make_double)
    }

    /// Factorises the whole tangent, in double precision, from now on; returns true if it did not before.
    pub(super) fn make_exact(&mut self) -> bool {
        self.matrix.direct_mut().is_some_and(Tangent::make_exact)
    }

    /// Turns a residual into an update; returns its size relative to the scales. An iteration that does not converge leaves the residual.
    pub(super) fn solve(
        &mut self,
        residual: &mut [f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<f64, NoSolution>, Stopped> {
        match (&mut self.matrix, self.newton) {
            (NewtonMatrix::Direct(tangent), Newton::Full) => tangent.solve(residual),
            (NewtonMatrix::Direct(tangent), Newton::Modified) => tangent.solve_roughly(residual),
            (NewtonMatrix::Grids(grids), _) => {
                if let Err(none) = grids.solve_for_update(residual, is_over)? {
                    return Ok(Err(none));
                }
            }
        }
        Ok(Ok(self.size(residual)))
    }

    /// Returns true if the factors leave out so much of an update of this size that the iteration would be slow.
    pub(super) fn leave_out_much(&mut self, update: &[f64], size: f64) -> bool {
        let tangent = self.matrix.direct_mut();
        let left_out = tangent.and_then(|tangent| tangent.left_out(update));
        left_out.is_some_and(|rest| self.size(&rest) > LEFT_OUT * size)
    }

    /// Combines an update with earlier ones, where the tangent is kept.
    pub(super) fn accelerate(&mut self, update: &mut [f64]) {
        if self.newton == Newton::Modified && self.matrix.direct().is_some() {
            self.anderson.improve(update);
        }
    }

    /// The largest part of an update relative to the scales.
    fn size(&self, update: &[f64]) -> f64 {
        let parts = update.iter().zip(&self.scales);
        parts.fold(0.0, |size, (part, scale)| size.max((part / scale).abs()))
    }
}

/// Number of earlier steps that are combined.
const DEPTH: usize = 4;

/// Steps and updates of the last iterations.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    /// Differences of the updates, and of the points, newest last.
    differences: VecDeque<[Vec<f64>; 2]>,
    last_update: Vec<f64>,
    last_step: Vec<f64>,
}

impl Anderson {
    /// Forgets earlier iterations.
    pub(super) fn start(&mut self) {
        self.differences.clear();
        self.last_update.clear();
    }

    /// Turns an update into a better step, in place.
    pub(super) fn improve(&mut self, update: &mut [f64]) {
        if self.last_update.len() == update.len() {
            let mut oldest = match self.differences.len() {
                DEPTH => self.differences.pop_front().unwrap_or_default(),
                _ => Default::default(),
            };
            let difference = update.iter().zip(&self.last_update).map(|(a, b)| a - b);
            oldest[0].clear();
            oldest[0].extend(difference);
            oldest[1].clear();
            oldest[1].extend_from_slice(&self.last_step);
            self.differences.push_back(oldest);
        }
        self.last_update.clear();
        self.last_update.extend_from_slice(update);
        let count = self.differences.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let products = DMatrix::from_fn(count, count, |i, j| {
            dot(&self.differences[i][0], &self.differences[j][0])
        });
        let rhs = DVector::from_fn(count, |i, _| {
            dot(&self.differences[i][0], &self.last_update)
        });
        // Nearly dependent updates say nothing new.
        let solved = (count > 0).then(|| products.svd(true, true).solve(&rhs, 1e-24));
        if let Some(Ok(factors)) = solved {
            for ([updates, steps], factor) in self.differences.iter().zip(&factors) {
                for ((value, u), s) in update.iter_mut().zip(updates).zip(steps) {
                    *value -= factor * (u + s);
                }
            }
        }
        self.last_step.clear();
        self.last_step.extend_from_slice(update);
    }
}
