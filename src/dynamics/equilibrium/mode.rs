//! The softest mode of a state of rest, and the cause of its softness.

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
