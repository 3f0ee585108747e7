//! The graph of a symmetric matrix: the pairs of unknowns that share an entry.

use crate::math::{IsOver, Stopped};

/// Places of the entries of a symmetric matrix, of either triangle or both.
#[derive(Clone, Copy, Debug)]
pub struct Pattern<'a> {
    /// Row of each entry.
    pub rows: &'a [u32],
    /// Column of each entry.
    pub cols: &'a [u32],
}

impl<'a> Pattern<'a> {
    pub(super) const fn new(rows: &'a [u32], cols: &'a [u32]) -> Self {
        Self { rows, cols }
    }

    /// Number of entries.
    pub(super) const fn len(self) -> usize {
        self.rows.len()
    }

    /// Row and column of each entry.
    pub(super) fn places(self) -> impl Iterator<Item = (u32, u32)> + use<'a> {
        self.rows.iter().copied().zip(self.cols.iter().copied())
    }
}

/// Neighbours of each unknown in ascending order, itself left out.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph of a matrix of `order` unknowns with these entries.
    pub(super) fn new(
        order: usize,
        pattern: Pattern<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<Self, Stopped> {
        progress.add(pattern.len())?;
        let mut starts = vec![0; order + 1];
        let pairs = || pattern.places().filter(|(row, col)| row != col);
        for (row, col) in pairs() {
            starts[row as usize + 1] += 1;
            starts[col as usize + 1] += 1;
        }
        for i in 0..order {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut mixed = vec![0; starts[order] as usize];
        progress.add(mixed.len())?;
        let mut put = |list: &mut [u32], from: u32, to: u32| {
            let place = &mut next[from as usize];
            list[*place as usize] = to;
            *place += 1;
        };
        for (row, col) in pairs() {
            put(&mut mixed, row, col);
            put(&mut mixed, col, row);
        }
        progress.add(mixed.len())?;
        // A symmetric list, transposed, is in order.
        let mut next = starts.clone();
        let mut sorted = vec![0; mixed.len()];
        for i in 0..order {
            for &j in &mixed[starts[i] as usize..starts[i + 1] as usize] {
                let place = &mut next[j as usize];
                sorted[*place as usize] = i as u32;
                *place += 1;
            }
        }
        progress.add(sorted.len())?;
        Ok(Self::without_duplicates(starts, sorted))
    }

    fn without_duplicates(mut starts: Vec<u32>, mut sorted: Vec<u32>) -> Self {
        let (mut kept, mut begin) = (0, 0);
        for i in 0..starts.len() - 1 {
            let end = starts[i + 1] as usize;
            let first = kept;
            for place in begin..end {
                let j = sorted[place];
                if kept == first || sorted[kept - 1] != j {
                    sorted[kept] = j;
                    kept += 1;
                }
            }
            begin = end;
            starts[i + 1] = kept as u32;
        }
        sorted.truncate(kept);
        Self {
            starts,
            neighbours: sorted,
        }
    }

    /// Number of unknowns.
    pub(super) const fn order(&self) -> usize {
        self.starts.len() - 1
    }

    /// Neighbours of unknown `i`.
    pub(super) fn neighbours(&self, i: usize) -> &[u32] {
        &self.neighbours[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// Returns the offsets of the neighbours of each unknown, with the end of the last, and all neighbours.
    pub(super) fn lists(&self) -> (&[u32], &[u32]) {
        (&self.starts, &self.neighbours)
    }
}

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
