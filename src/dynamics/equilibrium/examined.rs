//! The lowest mode of a state of rest, which tells its stability without factors.

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
