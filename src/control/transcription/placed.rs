//! What is known of the instants of a horizon.

/// What is known of the instants at the present point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Placed {
    /// Coordinates only.
    Nothing,
    /// Vectors.
    Vectors,
    /// Vectors and columns of P.
    Columns,
}
