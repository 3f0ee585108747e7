//! State of the kinematics of a horizon: the quantities known at its instants.

/// Quantities known at the instants for the present point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Placed {
    /// Coordinates only.
    Nothing,
    /// Vectors.
    Vectors,
    /// Vectors and columns of P.
    Columns,
}
