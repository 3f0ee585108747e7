//! The matrix of rest with its solvers: factors, which prove stability by their inertia, or an iteration on box grids, which does not.
//!
//! An iteration leads to the state of rest; then its matrix is factorised, as far as its size allows, and all that follows is done with factors.

use crate::dynamics::equilibrium::statics::{Statics, turned_pairs};
use crate::dynamics::grid_tangent::{Blocks, GridTangent, Iterated};
use crate::dynamics::solving::{MultigridUse, Solving};
use crate::dynamics::step_matrix::StepMatrix;
use crate::dynamics::step_solution::is_affordable;
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::functional::TermKind;
use crate::ipopt::interrupt;
use crate::model::Model;
use crate::sparse::multigrid::MultigridReport;
use crate::sparse::{Singular, Symmetry};

/// Most unknowns whose matrix is factorised for its inertia after an iteration has found the state.
const EXAMINED: usize = 250_000;
/// Residual of solutions of an iteration that are no updates of Newton's method, relative to that of zero.
const RESIDUAL: f64 = 1e-8;

/// Factors beside those of the matrix.
#[derive(Debug, Default)]
pub(super) struct Inertia {
    /// The symmetric part of the tangent where it has no symmetry.
    pub(super) symmetric_part: Option<Tangent>,
    /// The own block of the scalars with an equation.
    pub(super) electric: Option<Tangent>,
}

/// First places of the curvature of charts in the values, three a chart, and of the added stiffness.
pub(super) fn places(model: &Model) -> [usize; 2] {
    let curved = model.action.layout().values(1);
    [curved, curved + 3 * model.action.map.charted().len()]
}

/// Entries of the tangent, and its symmetry.
fn entries(model: &Model) -> (EntryList, Symmetry) {
    let (map, layout) = (&model.action.map, model.action.layout());
    let (n, m) = (map.coordinates, map.unknowns());
    let mut entries = EntryList::default();
    for (slot, entry) in layout.same.entries().enumerate() {
        entries.add(layout.same_at(0) + slot, entry);
        entries.add_to(layout.same_at(1) + slot, slot);
    }
    for (slot, (row, col)) in layout.cross.entries().enumerate() {
        let same = layout.same.find(row, col);
        let same = same.expect("what couples neighbouring instants couples within one");
        entries.add_to(layout.lower_at(0) + slot, same);
        entries.add_to(layout.upper_at(0) + slot, same);
    }
    entries.add_scalars(model, &[[0, 0], [1, 1]]);
    let [curved, added] = places(model);
    for (place, [i, j, _]) in map.charted().iter().flat_map(turned_pairs).enumerate() {
        for entry in [(i, j), (j, i)] {
            let same = layout.same.find(entry.0, entry.1);
            let same = same.expect("the turns of a joint are coupled");
            entries.add_to(curved + place, same);
        }
    }
    for (place, i) in (0..n).chain(m..model.variables.unknown_count()).enumerate() {
        entries.add(added + place, (i, i));
    }
    // The tangent is negative where a state is stable.
    entries.hold(&model.prescribed_coordinates(), -1.0);
    let mut terms = model.action.intervals.terms.iter();
    let symmetry = match terms.any(|term| term.kind() == TermKind::AppliedWork) {
        true => Symmetry::Unsymmetric,
        false => Symmetry::Symmetric,
    };
    (entries, symmetry)
}

/// The tangent, factorised.
fn direct(model: &Model) -> Tangent {
    let (entries, symmetry) = entries(model);
    entries.tangent(model.variables.unknown_count(), symmetry, None)
}

impl Inertia {
    fn new(model: &Model) -> Self {
        let (entries, symmetry) = entries(model);
        let size = model.variables.unknown_count();
        let symmetric_part =
            (symmetry == Symmetry::Unsymmetric).then(|| entries.symmetric_part(size));
        let algebraic = model.variables.algebraic();
        let electric = (!algebraic.is_empty()).then(|| {
            let mut entries = EntryList::default();
            entries.add_scalars(model, &[]);
            let first = model.action.map.unknowns();
            entries.tangent_from(first, algebraic.len(), Symmetry::Symmetric, None)
        });
        Self {
            symmetric_part,
            electric,
        }
    }
}

/// The matrix of a model, on box grids where these are wanted and hold all unknowns; what gives the inertia, where it is factorised.
pub(super) fn matrix(model: &Model, multigrid: Option<MultigridUse>) -> (StepMatrix, Inertia) {
    let layout = model.action.layout();
    let [same, lower, upper] = [layout.same_at(0), layout.lower_at(0), layout.upper_at(0)];
    let mixed = [layout.mixed_at(0, 0), layout.mixed_at(0, 1)];
    let [_, added] = places(model);
    let blocks = Blocks {
        same: &[same, layout.same_at(1)],
        cross: &[lower, upper],
        sides: [&mixed, &mixed],
        added: Some(added),
    };
    let grids = multigrid.and_then(|multigrid| {
        let solving = Solving {
            multigrid,
            ..Solving::default()
        };
        let is_wanted = solving.takes_grids(model.variables.unknown_count());
        is_wanted
            .then(|| GridTangent::new(model, &blocks, direct))
            .flatten()
    });
    match grids {
        Some(grids) => (StepMatrix::Grids(Box::new(grids)), Inertia::default()),
        None => (StepMatrix::Direct(direct(model)), Inertia::new(model)),
    }
}

impl Statics<'_> {
    /// Takes the tangent of the state evaluated last; factorises it where it is solved so.
    pub(super) fn factor(&mut self) -> Result<(), Singular> {
        if let Some(part) = &mut self.inertia.symmetric_part {
            // Where it is singular, it gives no number of negative pivots.
            let _ = part.factor(&self.values);
        }
        let done = self.matrix.factor_unless(&self.values, &|| false);
        done.expect("it is never time to stop")
    }

    /// The same with a stiffness σ in N mm for each rad, and each length of the system.
    pub(super) fn factor_with(&mut self, sigma: f64) -> Result<(), Singular> {
        let n = self.model.action.map.coordinates;
        let h = self.model.multiplier_time;
        for (value, scale) in self.values[self.added..].iter_mut().zip(&self.scales[..n]) {
            *value = -h * sigma / (scale * scale);
        }
        let outcome = self.factor();
        self.values[self.added..].fill(0.0);
        outcome
    }

    /// Solves with the tangent taken last, in place; what is prescribed does not move.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_by(rhs, |grids, rhs| {
            grids.solve(rhs, RESIDUAL, &|| interrupt::stop().is_some())
        });
    }

    /// Solves for an update of Newton's method, in place, as accurately as it deserves.
    pub(super) fn solve_for_update(&mut self, residual: &mut [f64]) {
        self.solve_by(residual, |grids, rhs| {
            grids.solve_for_update(rhs, &|| interrupt::stop().is_some())
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
        let unknowns = self.residual.len();
        if !(is_affordable(unknowns) && self.matrix.fall_back(self.model)) {
            return false;
        }
        self.inertia = Inertia::new(self.model);
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

    /// Number of directions in which the potential energy of the state evaluated and factorised last falls, potentials
    /// following; `None` where the factorisation does not give them.
    ///
    /// The tangent is −h S with S the saddle of coordinates, multipliers and potentials: each multiplier has one negative
    /// eigenvalue of S, potentials have those of their own block, what remains belongs to the coordinates.
    pub(super) fn unstable(&mut self) -> Option<usize> {
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
            let is_over = || interrupt::stop().is_some();
            let found = grids.potentials_to_law(&self.values, &self.residual, &is_over);
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
