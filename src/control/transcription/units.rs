//! Units of the objective.

/// s in a ms.
pub(super) const MILLISECOND: f64 = 1e-3;
