//! Destination of blocks: the values of an interval, or of an instant.

use crate::coordinates::map::CoordinateMap;
use crate::coordinates::pattern::StepPattern;

/// Offsets of the blocks of one interval in the values: of the four blocks, of both mixed blocks and of scalars;
/// mixed blocks and scalars without an offset (`usize::MAX`) go nowhere.
#[derive(Clone, Copy, Debug)]
pub struct Destination {
    /// (k, k), (k, k+1), (k+1, k), (k+1, k+1).
    pub blocks: [usize; 4],
    /// (z_k, s), (z_{k+1}, s).
    pub mixed: [usize; 2],
    /// (s, s).
    pub scalars: usize,
}

/// Place of a sum in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::coordinates) enum Site {
    /// Scalars are those of the interval.
    Intervals,
    /// Scalars are multipliers, unknowns of the instant itself.
    Instants,
}

impl Site {
    /// Places of the coupling of coordinate `row` and scalar `s`: a block of its own for an interval, both triangles of
    /// (z, z) for an instant.
    pub(super) fn mixed(
        self,
        layout: &mut StepPattern,
        map: &CoordinateMap,
        row: usize,
        s: usize,
    ) -> Vec<usize> {
        match self {
            Self::Intervals => vec![layout.mixed.slot(row, s)],
            Self::Instants => {
                let multiplier = map.coordinates + s;
                vec![
                    layout.same.slot(row, multiplier),
                    layout.same.slot(multiplier, row),
                ]
            }
        }
    }
}
