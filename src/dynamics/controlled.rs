//! Steps whose length the local error controls.

/// A step of controlled length.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Controlled {
    /// Its length in ms.
    pub(super) taken: f64,
    /// Length in ms that the next one may have.
    pub(super) next: f64,
    /// Multipliers at its start.
    pub(super) multipliers: Vec<f64>,
}

/// Factor of a step whose local error, of third order, is `used` of what is allowed per time, with some room.
pub(super) fn factor(used: f64) -> f64 {
    (0.9 / used.sqrt()).max(0.1)
}
