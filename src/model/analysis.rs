//! The analysis of a system, as far as it decides which terms the model needs.

use crate::model::constants::constant::{Constant, Parameter};
use crate::model::presolve::graph::Graph;
use crate::model::quantities::quantity::Quantity;
use crate::model::system::maxwell::Response;
use std::collections::BTreeSet;
use thiserror::Error;

/// Coordinates in which a problem is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coordinates {
    /// Joint coordinates of a spanning tree, with multipliers of the joints that close loops; what no joint connects to the ground floats.
    Reduced,
    /// Directors with multipliers; any graph of bodies and joints.
    Redundant,
}

impl Coordinates {
    /// The word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reduced => "reduced",
            Self::Redundant => "redundant",
        }
    }

    /// Returns true if no constraint joins the coordinates of the joints of a graph.
    pub(crate) fn are_independent(self, graph: &Graph) -> bool {
        self == Self::Reduced && graph.loops().is_empty()
    }

    /// Returns the coordinates that a word in files names.
    pub fn named(word: &str) -> Option<Self> {
        [Self::Reduced, Self::Redundant]
            .into_iter()
            .find(|coordinates| coordinates.name() == word)
    }
}

/// Request to a model: motion or equilibrium, coordinates, quantities.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// Coordinates; reduced ones without a choice.
    pub coordinates: Option<Coordinates>,
    /// Length of the intervals in ms, about; it scales multipliers.
    pub interval: f64,
    /// Quantities that can be measured.
    pub quantities: Vec<Quantity>,
    /// Those of them, by index, of which a curved function is minimised.
    pub curved: BTreeSet<usize>,
    /// Constants that are free.
    pub parameters: Vec<Parameter>,
    /// True for a motion; a state of rest has neither inertia nor viscosity.
    pub of_motion: bool,
    /// Response of Maxwell branches at rest; in a motion they relax.
    pub response: Response,
    /// Sources whose voltage or load is zero all the time.
    pub zero_inputs: BTreeSet<usize>,
    /// Bodies and blocks that may start to move; `None`: anything may be set in motion by hand.
    pub initially_moving: Option<InitiallyMoving>,
}

/// Bodies and blocks that a start, a goal or a limit names; all others start at rest in the reference configuration, and
/// nothing but forces moves them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InitiallyMoving {
    /// Bodies.
    pub bodies: BTreeSet<usize>,
    /// Blocks of the scene.
    pub solids: BTreeSet<usize>,
}

impl Analysis {
    /// Returns true if a constant of some kind is free.
    pub(super) fn is_sought(&self, is_meant: impl Fn(Constant) -> bool) -> bool {
        let mut constants = self.parameters.iter().flat_map(|p| &p.constants);
        constants.any(|follower| is_meant(follower.constant))
    }

    /// The motion in intervals of about `interval` ms, of which nothing is known: any voltage may act, anything may move.
    pub fn of_motion(interval: f64) -> Self {
        Self {
            coordinates: None,
            interval,
            quantities: Vec::new(),
            curved: BTreeSet::new(),
            parameters: Vec::new(),
            of_motion: true,
            response: Response::Relaxed,
            zero_inputs: BTreeSet::new(),
            initially_moving: None,
        }
    }

    /// The state of rest under any voltages.
    pub fn of_rest() -> Self {
        Self {
            of_motion: false,
            ..Self::of_motion(1.0)
        }
    }
}

/// A system does not permit the analysis.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelError {
    /// A loop is closed in the reference configuration only.
    #[error(
        "the joints that close loops ({joints}) contradict each other along the motion: places and axes leave a gap of {gap:.1e} (rad, or of the length of the system), expected none; write them with more digits, as all axes of a plane linkage along one direction, or use spherical joints"
    )]
    OpenLoop {
        /// The joints.
        joints: String,
        /// The gap that stays.
        gap: f64,
    },
    /// An element has no volume, or is inverted.
    #[error("element {element} of block \"{solid}\" is inverted or degenerate")]
    Inverted {
        /// The block.
        solid: String,
        /// The element.
        element: usize,
    },
}
