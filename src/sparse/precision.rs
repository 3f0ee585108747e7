//! Precision of the numbers of a factor.

/// Digits of the numbers of a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 24 bits: half the memory, and half the time of what only moves or multiplies numbers.
    Single,
    /// 53 bits.
    Double,
}

impl Precision {
    /// Largest error of a known solution that is accepted, with each unknown measured by its column: in single precision the part of an error
    /// that each iteration leaves.
    pub(crate) fn tolerated_loss(self) -> f64 {
        match self {
            Self::Single => 0.2,
            Self::Double => 1e-6,
        }
    }
}
