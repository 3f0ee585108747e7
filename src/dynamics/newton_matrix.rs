//! The matrix of Newton's method, of a step or of rest: factorised, or by the nodes of boxes and meshes, where an iteration solves and
//! factors take over where it does not converge and there is room for them.

use crate::dynamics::grid_tangent::GridTangent;
use crate::dynamics::solving::{MultigridUse, Solving};
use crate::dynamics::step_state::TangentState;
use crate::dynamics::tangent::Tangent;
use crate::math::join::available;
use crate::math::{IsOver, Stopped};
use crate::model::Model;
use crate::sparse::{MethodState, Singular};

/// A matrix with its solver.
#[derive(Debug)]
pub(super) enum NewtonMatrix {
    /// Factorised.
    Direct(Box<Tangent>),
    /// On box grids.
    Grids(Box<GridTangent>),
}

/// Bytes of factors for each unknown of a block of `MEASURED` unknowns; they grow with the cube root of the number.
const OF_UNKNOWN: f64 = 3.4e4;
const MEASURED: f64 = 237_500.0;

/// Returns true if there is room for the factors of so many unknowns.
fn is_affordable(unknowns: usize) -> bool {
    let unknowns = unknowns as f64;
    let bytes = unknowns * OF_UNKNOWN * (unknowns / MEASURED).cbrt();
    available().is_none_or(|available| bytes < available)
}

impl NewtonMatrix {
    /// By the nodes where an iteration is wanted and nodes have all unknowns, otherwise factorised by `direct`. Factors that take over from an
    /// iteration are those of `later`.
    pub(super) fn new(
        model: &Model,
        solving: Solving,
        is_at_rest: bool,
        later: fn(&Model) -> Tangent,
        direct: impl FnOnce() -> Tangent,
    ) -> Self {
        let grids = solving.takes_grids(model).then(|| {
            let later = (solving.multigrid != MultigridUse::Alone).then_some(later);
            GridTangent::new(model, later, is_at_rest)
        });
        match grids.flatten() {
            Some(grids) => Self::Grids(Box::new(grids)),
            None => Self::Direct(Box::new(direct())),
        }
    }

    /// The factorised one.
    pub(super) fn direct(&self) -> Option<&Tangent> {
        match self {
            Self::Direct(tangent) => Some(tangent),
            Self::Grids(_) => None,
        }
    }

    /// The factorised one.
    pub(super) fn direct_mut(&mut self) -> Option<&mut Tangent> {
        match self {
            Self::Direct(tangent) => Some(tangent),
            Self::Grids(_) => None,
        }
    }

    /// The one on grids.
    pub(super) fn grids_mut(&mut self) -> Option<&mut GridTangent> {
        match self {
            Self::Grids(grids) => Some(grids),
            Self::Direct(_) => None,
        }
    }

    /// The method that solves.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Direct(tangent) => tangent.name(),
            Self::Grids(_) => "GMRES with multigrid".to_owned(),
        }
    }

    /// Takes the matrix of these values, unless it is time to stop.
    pub(super) fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        match self {
            Self::Direct(tangent) => tangent.factor_unless(values, is_over),
            Self::Grids(grids) => {
                // What follows from the matrix alone can be resumed with the same bits.
                grids.forget();
                grids.take();
                Ok(Ok(()))
            }
        }
    }

    /// Writes how it is solved, and the matrix where it is used again.
    pub(super) fn keep(&mut self, with_matrix: bool, to: &mut TangentState) {
        match self {
            Self::Direct(tangent) => tangent.keep(with_matrix, to),
            Self::Grids(grids) => {
                (to.is_approximate, to.method) = (false, MethodState::default());
                to.matrix.clear();
                if with_matrix {
                    grids.copy(&mut to.matrix);
                }
            }
        }
    }

    /// Returns true if the matrix serves for several steps.
    pub(super) fn is_kept(&self) -> bool {
        match self {
            Self::Direct(_) => true,
            Self::Grids(grids) => grids.is_kept(),
        }
    }

    /// Solves as it was done before; returns true if that is possible.
    pub(super) fn restore(&mut self, model: &Model, from: &TangentState) -> bool {
        if from.method.method.is_empty() {
            let Self::Grids(grids) = self else {
                return false;
            };
            return from.step.is_none() || grids.take_copy(&from.matrix);
        }
        self.fall_back(model);
        self.direct_mut().is_some_and(|tangent| tangent.take(from))
    }

    /// Factorises from now on where there is room; returns true if it did not before.
    pub(super) fn fall_back_with_room(&mut self, model: &Model) -> bool {
        is_affordable(model.variables.unknown_count()) && self.fall_back(model)
    }

    /// Factorises from now on; returns true if it did not before.
    fn fall_back(&mut self, model: &Model) -> bool {
        let Self::Grids(grids) = self else {
            return false;
        };
        let Some(direct) = grids.direct else {
            return false;
        };
        *self = Self::Direct(Box::new(direct(model)));
        true
    }
}
