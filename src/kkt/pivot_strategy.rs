//! Strategy of pivoting of a factorisation, from weak to strict.

use super::pivot::Rules;

/// Threshold of pivots for each [`PivotStrategy`].
const THRESHOLDS: [f64; 5] = [0.1, 1e-8, 1e-4, 1e-2, 0.1];
/// Largest entry of a column that counts as zero: of a matrix as it is, and of an equilibrated one.
const ZEROS: [f64; 2] = [1e-20, 1e-14];

/// Strategy of a factorisation: condensed, of the matrix as it is, or equilibrated and under stricter and stricter rules for pivots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PivotStrategy {
    Condensed,
    #[default]
    Plain,
    Scaled,
    Careful,
    Strict,
}

impl PivotStrategy {
    /// Returns the next stricter strategy.
    pub(super) const fn stricter(self) -> Self {
        match self {
            Self::Condensed | Self::Plain => Self::Scaled,
            Self::Scaled => Self::Careful,
            Self::Careful | Self::Strict => Self::Strict,
        }
    }

    /// Returns the rules by which pivots are accepted.
    pub(super) fn rules(self) -> Rules {
        Rules {
            threshold: THRESHOLDS[self as usize],
            zero: ZEROS[usize::from(self != Self::Plain)],
        }
    }
}
