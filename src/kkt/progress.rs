//! Progress of analyses and factorisations that may be stopped before their end.

use crate::math::{IsOver, Stopped};

/// Multiplications between two questions, or numbers read: some milliseconds at most, and more than a small system takes.
const BETWEEN: usize = 1 << 22;

/// Asks for a stop: at the beginning, then after so much work that a question costs nothing against it.
pub(super) struct Progress<'a> {
    is_over: IsOver<'a>,
    /// Multiplications since the last question.
    since: usize,
}

impl<'a> Progress<'a> {
    pub(super) fn new(is_over: IsOver<'a>) -> Self {
        Self {
            is_over,
            since: BETWEEN,
        }
    }

    /// Announces the number of multiplications that come next, or of numbers to be read.
    pub(super) fn add(&mut self, multiplications: usize) -> Result<(), Stopped> {
        if self.since >= BETWEEN {
            self.since = 0;
            if (self.is_over)() {
                return Err(Stopped);
            }
        }
        self.since += multiplications;
        Ok(())
    }

    /// Progress of each half of the next work, which are done in parallel.
    pub(super) fn halves(&self) -> [Self; 2] {
        let Self { is_over, since } = *self;
        [0, 1].map(|_| Self { is_over, since })
    }
}
