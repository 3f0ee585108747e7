//! What a motion begins and ends with.

use crate::control::limits::Limits;
use crate::dynamics::{Equilibrium, Start};

/// A control problem's model with its start and goal.
#[derive(Debug)]
pub struct BoundaryConditions {
    /// Where the motion starts.
    pub start: Start,
    /// Where it ends.
    pub goal: TerminalState,
    /// Voltages at rest before the start and after the goal (V, one per muscle), where known.
    pub rest: [Option<Vec<f64>>; 2],
    /// Limits and goal equations.
    pub limits: Limits,
}

/// The final state: at rest, with these coordinates given.
#[derive(Clone, Debug, PartialEq)]
pub struct TerminalState {
    /// Given coordinates; `None` where the optimisation decides.
    pub coordinates: Vec<Option<f64>>,
    /// Charts of the final configuration, where its coordinates are given; none otherwise, and where there are none.
    pub charts: Vec<f64>,
    /// Whether the nodes of elastic blocks rest too.
    pub nodes_rest: bool,
    /// The equilibrium that it is, where it is one under voltages that are named.
    pub rest: Option<Equilibrium>,
}
