//! Pattern of the entries of a step-periodic block-tridiagonal matrix.
//!
//! With z_k the coordinates and multipliers of instant k and s_k the scalars of interval k, second derivatives of a sum
//! over a horizon exist only at (z_k, z_k), (z_{k+1}, z_k), (z_k, z_{k+1}), (z_k, s_k), (z_{k+1}, s_k), (s_k, s_k), and
//! at the interval length against all of these. One table of slots serves every interval.

use crate::math::compact_index;

/// Places of the entries of one kind of block, in the order in which they were asked for.
#[derive(Clone, Debug, Default)]
pub struct BlockPattern {
    entries: Vec<(u32, u32)>,
    /// (column, slot) of the entries of each row, by column.
    rows: Vec<Vec<(u32, u32)>>,
}

impl BlockPattern {
    /// Slot of an entry, which joins the pattern if it is new.
    pub fn slot(&mut self, row: usize, col: usize) -> usize {
        if self.rows.len() <= row {
            self.rows.resize_with(row + 1, Vec::new);
        }
        let of_row = &mut self.rows[row];
        let at = of_row.partition_point(|&(other, _)| (other as usize) < col);
        match of_row.get(at) {
            Some(&(other, slot)) if other as usize == col => slot as usize,
            _ => {
                let slot = self.entries.len();
                of_row.insert(at, (compact_index(col), compact_index(slot)));
                self.entries.push((compact_index(row), compact_index(col)));
                slot
            }
        }
    }

    /// Slot of an entry of the pattern.
    pub fn find(&self, row: usize, col: usize) -> Option<usize> {
        let of_row = self.rows.get(row)?;
        let at = of_row.binary_search_by_key(&col, |&(other, _)| other as usize);
        Some(of_row[at.ok()?].1 as usize)
    }

    /// Gives back memory that further entries would have taken.
    fn shrink_to_fit(&mut self) {
        self.entries.shrink_to_fit();
        self.rows.iter_mut().for_each(Vec::shrink_to_fit);
    }

    /// Row and column of all entries, by slot.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (usize, usize)> + Clone + '_ {
        let entry = |&(row, col): &(u32, u32)| (row as usize, col as usize);
        self.entries.iter().map(entry)
    }
}

/// The blocks of one step and their places in its segment of the values.
#[derive(Clone, Debug, Default)]
pub struct StepPattern {
    /// (z_k, z_k).
    pub same: BlockPattern,
    /// (z_{k+1}, z_k), and likewise (z_k, z_{k+1}).
    pub cross: BlockPattern,
    /// (z_k, s_k), and likewise (z_{k+1}, s_k).
    pub mixed: BlockPattern,
    /// (s_k, s_k), lower triangle.
    pub scalars: BlockPattern,
    /// Number of entries of z.
    pub unknowns: usize,
    /// Number of scalars of an interval.
    pub interval_scalars: usize,
}

impl StepPattern {
    /// Gives back memory that further entries would have taken.
    pub(super) fn shrink_to_fit(&mut self) {
        for pattern in [
            &mut self.same,
            &mut self.cross,
            &mut self.mixed,
            &mut self.scalars,
        ] {
            pattern.shrink_to_fit();
        }
    }

    /// Places of (z_k, z_k).
    pub fn same_at(&self, k: usize) -> usize {
        k * self.stride()
    }

    /// Places of (z_{k+1}, z_k).
    pub fn lower_at(&self, k: usize) -> usize {
        self.same_at(k) + self.same.entries.len()
    }

    /// Places of (z_k, z_{k+1}).
    pub fn upper_at(&self, k: usize) -> usize {
        self.lower_at(k) + self.cross.entries.len()
    }

    /// Places of (z_{k+side}, s_k).
    pub fn mixed_at(&self, k: usize, side: usize) -> usize {
        self.upper_at(k) + self.cross.entries.len() + side * self.mixed.entries.len()
    }

    /// Places of (s_k, s_k).
    pub fn scalars_at(&self, k: usize) -> usize {
        self.mixed_at(k, 2)
    }

    /// Places of (z_k, h).
    pub fn horizon_at(&self, k: usize) -> usize {
        self.scalars_at(k) + self.scalars.entries.len()
    }

    /// Places of (s_k, h).
    pub fn horizon_scalars_at(&self, k: usize) -> usize {
        self.horizon_at(k) + self.unknowns
    }

    /// Length of the segment of one step.
    pub fn stride(&self) -> usize {
        self.same.entries.len()
            + 2 * self.cross.entries.len()
            + 2 * self.mixed.entries.len()
            + self.scalars.entries.len()
            + self.unknowns
            + self.interval_scalars
    }

    /// Place of (h, h) for a horizon of `intervals`.
    pub fn horizon_square_at(&self, intervals: usize) -> usize {
        (intervals + 1) * self.stride()
    }

    /// Length of the values of a horizon.
    pub fn values(&self, intervals: usize) -> usize {
        self.horizon_square_at(intervals) + 1
    }
}
