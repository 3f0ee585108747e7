//! State of rest: the unknowns of a step with the charts behind which its turns are counted, its modes, and the loads and instabilities by which
//! it is lost.

use std::ops::{Deref, DerefMut};

/// The unknowns of a step (see [`Variables`](crate::model::Variables)); as a slice they stand without the charts, behind which turns are
/// zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestState {
    pub(super) unknowns: Vec<f64>,
    pub(super) charts: Vec<f64>,
}

impl Deref for RestState {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.unknowns
    }
}

impl DerefMut for RestState {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.unknowns
    }
}

/// Cause of a soft mode: the smallest of the three parts of its stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Softening {
    /// The forces of voltages, as in pull-in.
    Voltages,
    /// Weights and loads, as in collapse.
    Loads,
    /// Elastic forces, as in buckling.
    Elastic,
}

/// The softest mode of a state of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Change of each coordinate; the largest is 1 (rad, or lengths of the system).
    pub direction: Vec<f64>,
    /// Parts that move most, in words: joints, or bodies, or a node of a block, then the muscle whose stretch changes most.
    pub moves: String,
    /// Cause of its softness; `None` where nothing takes from the elastic stiffness along it.
    pub softening: Option<Softening>,
}

/// The lowest mode of blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct LowestMode {
    /// Its eigenvalue in N/mm, of vectors of all displacements of nodes.
    pub stiffness: f64,
    /// Distance in N/mm within which there is an eigenvalue.
    pub bound: f64,
    /// Number of directions found in which the potential energy falls, of at most four that are sought; `None` where bounds decide nothing.
    pub unstable: Option<usize>,
    /// Iterations.
    pub iterations: usize,
    /// Change of each coordinate.
    pub(super) direction: Vec<f64>,
}

/// A lowest mode with the values that it belongs to.
#[derive(Debug, Default)]
pub(super) struct Examined {
    pub(super) at: Vec<f64>,
    pub(super) found: Option<LowestMode>,
}

/// Load that grows along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// The weights and the loads, without voltages.
    Forces,
    /// The voltages, under all weights and loads.
    Voltages,
}

/// Instability by which an equilibrium under a growing load is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instability {
    /// The path turns back: beyond this voltage there is no equilibrium nearby (pull-in).
    PullIn,
    /// The path turns back under growing weights or loads: the robot collapses.
    Collapse,
    /// The path goes on, but another one branches off and is preferred (buckling).
    Buckling,
}

impl Instability {
    /// The word in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::PullIn => "pull_in",
            Self::Collapse => "collapse",
            Self::Buckling => "buckling",
        }
    }

    /// The word in sentences.
    pub fn words(self) -> &'static str {
        match self {
            Self::PullIn => "pull-in",
            Self::Collapse => "collapse under load",
            Self::Buckling => "buckling",
        }
    }

    /// Returns the instability at a limit point of a load.
    pub(super) fn of_turn(load: Load) -> Self {
        match load {
            Load::Forces => Self::Collapse,
            Load::Voltages => Self::PullIn,
        }
    }
}
