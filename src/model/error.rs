//! Errors of the construction of a model.

use crate::math::Fault;
use thiserror::Error;

/// A system does not permit the analysis.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelError {
    /// Reduced coordinates need a tree.
    #[error(
        "reduced coordinates need joints that form a tree, but joint \"{joint}\" closes a loop; choose \"coordinates\": \"redundant\""
    )]
    NoTree {
        /// The joint that closes a loop.
        joint: String,
    },
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

/// A part of a system that makes no sense.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{list}.{}: found {}, expected {}", self.place(), fault.finding(), fault.expected)]
pub struct SystemError {
    /// List of the system that has the part, such as `springs`.
    pub list: &'static str,
    /// Its index there.
    pub index: usize,
    /// Its name.
    pub name: String,
    /// The rule that does not hold.
    pub fault: Box<Fault>,
}

impl SystemError {
    /// The place of the fault in the list: `spring1.stiffness`.
    fn place(&self) -> String {
        self.fault.clone().under(&self.name).at
    }
}
