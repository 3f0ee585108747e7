//! Units of the objective.

/// V in a kV, the unit of voltages in objectives.
pub(super) const KILOVOLT: f64 = 1000.0;
/// s in a ms.
pub(super) const MILLISECOND: f64 = 1e-3;
