//! Input of an evaluation on one interval: scalars, length, and the blocks asked for.

use crate::coordinates::configuration::Configuration;
use crate::functional::{BlockMask, Horizon, Outer, Sample};

/// Input of an evaluation on one interval, in addition to its two instants.
#[derive(Clone, Copy, Debug)]
pub struct Interval<'a> {
    /// Scalars, such as voltages and potentials.
    pub scalars: &'a [f64],
    /// Their rates along the direction; read at order `Third` only.
    pub along: &'a [f64],
    /// Length in ms.
    pub h: f64,
    /// Interval length as a given number or an argument.
    pub horizon: Horizon,
    /// Blocks that are asked for.
    pub sides: BlockMask,
    /// Functions of the measures of the site.
    pub outer: &'a [Outer],
}

impl<'a> Interval<'a> {
    /// A given interval, all blocks.
    pub fn given(scalars: &'a [f64], h: f64) -> Self {
        Self {
            scalars,
            along: &[],
            h,
            horizon: Horizon::Given,
            sides: BlockMask::ALL,
            outer: &[],
        }
    }

    /// Returns the input of terms on this interval.
    pub fn sample(&self, [a, b]: [&'a Configuration; 2]) -> Sample<'a> {
        Sample {
            vectors: [&a.x, &b.x],
            along: [&a.w, &b.w],
            scalars: self.scalars,
            scalars_along: self.along,
            h: self.h,
            horizon: self.horizon,
            sides: self.sides,
            outer: self.outer,
        }
    }
}
