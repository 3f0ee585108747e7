//! Pairs of linear vectors: constant coefficients, entry by entry.

use crate::functional::Sides;
use crate::math::Matrix;
use crate::reduction::pattern::Layout;
use crate::reduction::pull_back::{Site, Target};

/// One scalar entry c · block[i, j] of a pair of linear vectors.
#[derive(Clone, Copy, Debug)]
struct Entry {
    slot: usize,
    factor: f64,
    entry: (usize, usize),
    same: usize,
    cross: usize,
}

/// Entries of all pairs of linear vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Linear {
    full: Vec<Entry>,
    isotropic: Vec<Entry>,
}

impl Linear {
    /// Adds a pair with a full block; parts are (first coordinate, coefficient).
    pub(super) fn add_full(
        &mut self,
        slot: usize,
        parts: [&[(usize, f64)]; 2],
        layout: &mut Layout,
        site: Site,
    ) {
        for entry in (0..9).map(|e| (e / 3, e % 3)) {
            self.full.extend(entries(slot, parts, entry, layout, site));
        }
    }

    /// Adds a pair with an isotropic block.
    pub(super) fn add_isotropic(
        &mut self,
        slot: usize,
        parts: [&[(usize, f64)]; 2],
        layout: &mut Layout,
        site: Site,
    ) {
        for i in 0..3 {
            self.isotropic
                .extend(entries(slot, parts, (i, i), layout, site));
        }
    }

    /// Adds the blocks to the values.
    pub(super) fn add(
        &self,
        full: &[[Matrix; 4]],
        isotropic: &[[f64; 4]],
        sides: Sides,
        target: &Target,
        values: &mut [f64],
    ) {
        for side in (0..4).filter(|&s| sides.blocks[s]) {
            let base = target.blocks[side];
            let place = |e: &Entry| {
                base + if side == 1 || side == 2 {
                    e.cross
                } else {
                    e.same
                }
            };
            for e in &self.full {
                values[place(e)] += e.factor * full[e.slot][side][e.entry];
            }
            for e in &self.isotropic {
                values[place(e)] += e.factor * isotropic[e.slot][side];
            }
        }
    }
}

fn entries(
    slot: usize,
    [s, t]: [&[(usize, f64)]; 2],
    entry: (usize, usize),
    layout: &mut Layout,
    site: Site,
) -> Vec<Entry> {
    let mut list = Vec::new();
    for &(f, c) in s {
        for &(g, d) in t {
            let (row, col) = (f + entry.0, g + entry.1);
            let same = layout.same.slot(row, col);
            let cross = match site {
                Site::Intervals => layout.cross.slot(row, col),
                Site::Instants => usize::MAX,
            };
            list.push(Entry {
                slot,
                factor: c * d,
                entry,
                same,
                cross,
            });
        }
    }
    list
}
