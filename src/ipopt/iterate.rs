//! An iterate as an observer sees it, and the data of the one before.

use crate::ipopt::record::Record;
use crate::ipopt::solution::{Iteration, Multipliers};
use crate::ipopt::squares::Squares;
use crate::nlp::Bounds;

/// An accepted iterate.
#[derive(Debug)]
pub struct Reached<'a> {
    /// Its variables.
    pub x: &'a [f64],
    /// The iterate before, where its multipliers are known: Ipopt gives those of an iterate on the way to the next one, and none in the
    /// restoration phase.
    pub before: Option<Before<'a>>,
}

/// The iterate before, with its multipliers.
#[derive(Debug)]
pub struct Before<'a> {
    /// Report of Ipopt on it.
    pub report: &'a Iteration,
    /// Its variables.
    pub x: &'a [f64],
    record: &'a Record,
    bounds: &'a Bounds,
    squares: &'a Squares,
    /// Factor of f in all that Ipopt sees.
    scale: f64,
}

impl<'a> Before<'a> {
    /// The latest iterate of a record, where its multipliers are known.
    pub(super) fn from_record(
        record: &'a Record,
        x: &'a [f64],
        (bounds, squares): (&'a Bounds, &'a Squares),
        scale: f64,
    ) -> Option<Self> {
        let report = record.iterations.last()?;
        (!record.costates.is_empty()).then_some(Self {
            report,
            x,
            record,
            bounds,
            squares,
            scale,
        })
    }

    /// Its multipliers; those of bounds are the barrier parameter over the distance, to which Ipopt keeps them near.
    pub fn multipliers(&self) -> Multipliers {
        let mut multipliers = Multipliers::default();
        multipliers.reset(self.x.len(), self.record.costates.len());
        self.record.write_multipliers(self.bounds, &mut multipliers);
        self.squares.of_roots(self.x, &mut multipliers);
        multipliers.scale(self.scale.recip());
        multipliers
    }
}
