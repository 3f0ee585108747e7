//! The matrix of a step: factorised, or on box grids, where an iteration solves.

use crate::dynamics::grid_tangent::GridTangent;
use crate::dynamics::step_state::TangentState;
use crate::dynamics::tangent::Tangent;
use crate::math::{IsOver, Stopped};
use crate::model::Model;
use crate::sparse::{MethodState, Singular};

/// A matrix of a step with its solver.
#[derive(Debug)]
pub(super) enum StepMatrix {
    /// Factorised.
    Direct(Box<Tangent>),
    /// On box grids.
    Grids(Box<GridTangent>),
}

impl StepMatrix {
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

    /// Factorises from now on; returns true if it did not before.
    pub(super) fn fall_back(&mut self, model: &Model) -> bool {
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
