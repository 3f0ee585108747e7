//! Unknowns of a fit: the constants, then the unknowns of the start of each recording that is fitted.

use crate::control::problem::{Identification, Recording};
use std::ops::Range;

/// Values of all unknowns: constants in the units of their components, and changes of coordinates and momenta at starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknowns {
    /// Values.
    pub values: Vec<f64>,
    /// Number of constants.
    pub constants: usize,
    /// Unknowns of the start of each recording; none of those that are held out.
    pub starts: Vec<Range<usize>>,
}

impl Unknowns {
    /// Constants at their guesses, starts as they are given; `count` tells the number of unknowns of a start.
    pub(super) fn new(task: &Identification, mut count: impl FnMut(&Recording) -> usize) -> Self {
        let mut values: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
        let constants = values.len();
        let starts = task.recordings.iter().map(|recording| {
            let first = values.len();
            if !recording.is_held_out {
                values.resize(first + count(recording), 0.0);
            }
            first..values.len()
        });
        Self {
            starts: starts.collect(),
            constants,
            values,
        }
    }

    /// Values of the constants, and of the unknowns of the start of each recording.
    pub fn of_values(constants: &[f64], starts: &[&[f64]]) -> Self {
        let mut values = constants.to_vec();
        let range = |start: &&[f64]| {
            let first = values.len();
            values.extend_from_slice(start);
            first..values.len()
        };
        Self {
            starts: starts.iter().map(range).collect(),
            constants: constants.len(),
            values,
        }
    }

    /// The constants.
    pub fn of_constants(&self) -> &[f64] {
        &self.values[..self.constants]
    }

    /// Unknowns of the start of a recording.
    pub fn of_start(&self, recording: usize) -> &[f64] {
        &self.values[self.starts[recording].clone()]
    }
}
