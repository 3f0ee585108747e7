//! Solution of the linear systems of rest: by factors, which prove stability by their inertia, or by an iteration on box grids, which does not.
//!
//! An iteration leads to the state of rest; then its matrix is factorised, as far as its size allows, and all that follows is done with factors.

use crate::dynamics::equilibrium::static_matrix::Inertia;
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::grid_tangent::{GridTangent, Iterated};
use crate::dynamics::step_matrix::StepMatrix;
use crate::dynamics::step_solution::is_affordable;
use crate::dynamics::tangent::Tangent;
use crate::sparse::Singular;
use crate::sparse::multigrid::MultigridReport;
use crate::stop;

/// Most unknowns whose matrix is factorised for its inertia after an iteration has found the state.
const EXAMINED: usize = 100_000;
/// Residual of solutions of an iteration that are no updates of Newton's method, relative to that of zero.
const RESIDUAL: f64 = 1e-6;

impl Statics<'_> {
    /// Takes the tangent of the state evaluated last; factorises it where it is solved so.
    pub(super) fn factor(&mut self) -> Result<(), Singular> {
        self.factor_with(0.0)
    }

    /// The same with a stiffness σ in N mm for each rad, and each length of the system; an iteration has no inertia, for which it is added.
    pub(super) fn factor_with(&mut self, sigma: f64) -> Result<(), Singular> {
        self.sigma = sigma;
        let n = self.model.action.map.coordinates;
        let h = self.model.multiplier_time;
        for (value, scale) in self.values[self.added..].iter_mut().zip(&self.scales[..n]) {
            *value = -h * sigma / (scale * scale);
        }
        if let Some(part) = &mut self.inertia.symmetric_part {
            // Where it is singular, it gives no number of negative pivots.
            let _ = part.factor(&self.values);
        }
        let done = self.matrix.factor_unless(&self.values, &|| false);
        self.values[self.added..].fill(0.0);
        done.expect("it is never time to stop")
    }

    /// Solves with the tangent taken last, in place; what is prescribed does not move.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_by(rhs, |grids, rhs| {
            grids.solve(rhs, RESIDUAL, &|| stop::reason().is_some())
        });
    }

    /// Solves for an update of Newton's method, in place, as accurately as it deserves.
    pub(super) fn solve_for_update(&mut self, residual: &mut [f64]) {
        self.solve_by(residual, |grids, rhs| {
            grids.solve_for_update(rhs, &|| stop::reason().is_some())
        });
    }

    /// Solves by factors, or by an iteration; by factors too where that does not converge. What is stopped is no number.
    fn solve_by(
        &mut self,
        rhs: &mut [f64],
        iterate: impl FnOnce(&mut GridTangent, &mut [f64]) -> Iterated,
    ) {
        self.model.hold(rhs);
        let solved = match &mut self.matrix {
            StepMatrix::Direct(tangent) => return tangent.solve(rhs),
            StepMatrix::Grids(grids) => {
                let solved = iterate(grids, rhs);
                self.multigrid.add(grids.counted());
                solved
            }
        };
        match solved {
            Ok(Ok(())) => {}
            Ok(Err(_)) if self.fall_back() => {
                self.fallbacks += 1;
                self.evaluate_again();
                match self.factor() {
                    Ok(()) => self.solve(rhs),
                    Err(_) => rhs.fill(f64::NAN),
                }
            }
            _ => rhs.fill(f64::NAN),
        }
    }

    /// Factorises from now on, where there is room; returns true if it did not before.
    pub(super) fn fall_back(&mut self) -> bool {
        let unknowns = self.scales.len();
        if !(is_affordable(unknowns) && self.matrix.fall_back(self.model)) {
            return false;
        }
        self.inertia = Inertia::new(self.model);
        self.lay_down();
        true
    }

    /// Factorises from now on, where the size allows to examine stability.
    pub(super) fn examine(&mut self) {
        if self.residual.len() <= EXAMINED {
            self.fall_back();
        }
    }

    /// Returns true if an iteration solves, which does not prove stability.
    pub(super) fn is_iterated(&self) -> bool {
        self.matrix.direct().is_none()
    }

    /// Counts of an iteration, where one has solved, and of the systems for which factors took over.
    pub(super) fn iterations_on_grids(&self) -> Option<(MultigridReport, usize)> {
        (self.multigrid.levels > 0).then_some((self.multigrid, self.fallbacks))
    }

    /// Number of directions in which a disturbance of the state evaluated and factorised last grows, potentials following; `None`
    /// where the factorisation does not give them.
    pub(super) fn unstable(&mut self) -> Option<usize> {
        let falling = self.falling();
        match (falling, &self.inertia.symmetric_part) {
            (Some(0), _) | (_, None) => falling,
            (_, Some(_)) => self.growing(),
        }
    }

    /// Number of negative eigenvalues of the stiffness, of its symmetric part where it has no symmetry.
    ///
    /// The tangent is −h S with S the saddle of coordinates, multipliers and potentials: each multiplier has one negative
    /// eigenvalue of S, potentials have those of their own block, what remains belongs to the coordinates.
    pub(super) fn falling(&mut self) -> Option<usize> {
        let part = self.inertia.symmetric_part.as_ref();
        let tangent = part.or_else(|| self.matrix.direct())?;
        let positive = tangent.negative_pivots()?;
        let negative = self.residual.len() - positive;
        let electric = match &mut self.inertia.electric {
            Some(tangent) => {
                tangent.factor(&self.values).ok()?;
                let scalars = self.residual.len() - self.model.action.map.unknowns();
                scalars - tangent.negative_pivots()?
            }
            None => 0,
        };
        negative.checked_sub(self.model.action.map.multipliers + electric)
    }

    /// Brings potentials to Gauss's law at the state evaluated last; returns their update, or `None` where that fails.
    pub(super) fn potentials(&mut self) -> Option<Vec<f64>> {
        let m = self.model.action.map.unknowns();
        if let Some(grids) = self.matrix.grids_mut() {
            let is_over = || stop::reason().is_some();
            let found = grids.potentials_to_law(&self.residual, &is_over);
            self.multigrid.add(grids.counted());
            return Some(found.ok()??.split_off(m));
        }
        let tangent = self.inertia.electric.as_mut()?;
        tangent.factor(&self.values).ok()?;
        let mut update = self.residual[m..].to_vec();
        tangent.solve(&mut update);
        Some(update)
    }

    /// Entries of the tangent factorised last; none of one on grids.
    pub(super) fn entries(&self) -> impl Iterator<Item = ((usize, usize), f64)> + '_ {
        let tangent = self.matrix.direct().into_iter();
        tangent.flat_map(Tangent::entries)
    }
}
