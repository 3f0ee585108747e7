//! A scene, what remains of it, and the layout of its unknowns: all from which terms, constraints and measures of a model are made.

use crate::kinematics::{Pose, Vectors};
use crate::model::analysis::{Analysis, Coordinates};
use crate::model::constants::free_parameters::Sought;
use crate::model::layout::internal::Internals;
use crate::model::layout::solids::Solids;
use crate::model::layout::variables::Variables;
use crate::model::presolve::graph::Graph;
use crate::model::presolve::loops::Loops;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::System;
use crate::model::terms::Terms;

/// A scene with what remains of it, from which the parts of a model are constructed.
#[derive(Debug)]
pub(crate) struct Construction<'a> {
    pub(crate) system: &'a System,
    pub(crate) presolved: &'a Presolved,
    pub(crate) analysis: &'a Analysis,
    pub(crate) coordinates: Coordinates,
    /// Poses of the bodies that remain.
    pub(crate) reference: &'a [Pose],
    pub(crate) blocks: &'a Solids,
    pub(crate) internals: &'a Internals,
    pub(crate) loops: &'a Loops,
    pub(crate) graph: &'a Graph,
    /// Variables of the intervals.
    pub(crate) variables: &'a Variables,
    /// Vector of the span of each muscle.
    pub(crate) spans: &'a [usize],
    /// The free parameters.
    pub(crate) sought: Sought,
}

impl Construction<'_> {
    /// No terms, to which those of parts are added.
    pub(crate) fn no_terms<'v>(&'v self, vectors: &'v mut Vectors) -> Terms<'v> {
        Terms::new(
            self.presolved.carriers(self.reference),
            self.presolved.system.gravity,
            self.analysis.of_motion,
            self.analysis.response,
            self.sought.clone(),
            self.variables,
            vectors,
        )
    }
}
