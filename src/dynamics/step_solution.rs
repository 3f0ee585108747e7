//! Solution of the linear systems of a step: by factors, or by an iteration, for which factors take over where it does not converge.

use crate::dynamics::error::StepError;
use crate::dynamics::step_matrix::StepMatrix;
use crate::dynamics::stepper::{Equations, Steps};
use crate::functional::Order;
use crate::math::join::available;
use crate::model::Model;
use crate::stop;
use std::time::Instant;

/// Bytes of factors for each unknown of a block of `MEASURED` unknowns; they grow with the cube root of the number.
const OF_UNKNOWN: f64 = 3.4e4;
const MEASURED: f64 = 237_500.0;

/// Returns true if there is room for the factors of so many unknowns.
pub(super) fn is_affordable(unknowns: usize) -> bool {
    let unknowns = unknowns as f64;
    let bytes = unknowns * OF_UNKNOWN * (unknowns / MEASURED).cbrt();
    available().is_none_or(|available| bytes < available)
}

impl StepMatrix {
    /// Factorises from now on where there is room; returns true if it did not before.
    pub(super) fn fall_back_with_room(&mut self, model: &Model) -> bool {
        let unknowns = model.variables.unknown_count();
        is_affordable(unknowns) && self.fall_back(model)
    }
}

impl<E: Equations> Steps<E> {
    /// Takes the tangent evaluated last, and factorises it where it is solved so.
    pub(super) fn factor(&mut self, h: f64) -> Result<(), StepError> {
        let began = Instant::now();
        let values = self.equations.values();
        let done = stop::heed(|is_over| self.updates.factor_unless(values, is_over));
        self.report.factorisation += began.elapsed().as_secs_f64();
        let is_kept = self.updates.matrix.is_kept() && done == Ok(Ok(()));
        self.factored = is_kept.then_some(h);
        let done = done.map_err(|stopped| self.stopped(h, stopped))?;
        if self.updates.matrix.direct().is_some() {
            self.report.factorisations += 1;
        }
        done.map_err(|singular| {
            self.equations.restore();
            let [start, _] = self.equations.ends();
            StepError::Singular {
                time: self.equations.time(),
                step: h,
                name: self.equations.unknown_name(singular.column),
                redundant: self.equations.model().redundant_constraints(&start.z),
            }
        })
    }

    /// Solves for an update, with the whole tangent where a new factor leaves out too much; returns its size relative to the
    /// scales, which is no number where there is no update.
    pub(super) fn solve(&mut self, h: f64, is_fresh: bool) -> Result<f64, StepError> {
        let size = match self.solve_once(h)? {
            Some(size) => size,
            None if self
                .updates
                .matrix
                .fall_back_with_room(self.equations.model()) =>
            {
                self.report.fallbacks += 1;
                self.evaluate(Order::Hessian, h);
                self.factor(h)?;
                self.solve_once(h)?.unwrap_or(f64::NAN)
            }
            None => {
                self.residual.fill(f64::NAN);
                return Ok(f64::NAN);
            }
        };
        if !(is_fresh && self.updates.leave_out_much(&self.residual, size)) {
            return Ok(size);
        }
        self.evaluate(Order::Hessian, h);
        self.updates.make_exact();
        self.factor(h)?;
        Ok(self.solve_once(h)?.unwrap_or(f64::NAN))
    }

    /// Solves for an update; `None` where the iteration does not converge.
    fn solve_once(&mut self, h: f64) -> Result<Option<f64>, StepError> {
        let began = Instant::now();
        let solved = stop::heed(|is_over| self.updates.solve(&mut self.residual, is_over));
        self.report.solution += began.elapsed().as_secs_f64();
        self.count();
        let solved = solved.map_err(|stopped| self.stopped(h, stopped))?;
        Ok(solved.ok())
    }

    /// Takes in the counts of the iterations.
    fn count(&mut self) {
        if let Some(grids) = self.updates.matrix.grids_mut() {
            self.report.multigrid.add(grids.counted());
        }
    }

    /// Brings potentials that are far from Gauss's law to it before anything moves; returns true if it did so.
    pub(super) fn place_potentials(&mut self, h: f64) -> Result<bool, StepError> {
        let Some(grids) = self.updates.matrix.grids_mut() else {
            return Ok(false);
        };
        let update = stop::heed(|is_over| grids.potentials_first(&self.residual, is_over));
        self.count();
        let update = update.map_err(|stopped| self.stopped(h, stopped))?;
        if let Some(update) = &update {
            self.equations.update(update);
        }
        Ok(update.is_some())
    }
}
