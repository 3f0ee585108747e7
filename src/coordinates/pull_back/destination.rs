//! Destination of blocks: the values of an interval, or of an instant.

use crate::coordinates::map::{CoordinateMap, LinearPart};
use crate::coordinates::pattern::StepPattern;
use crate::functional::BlockMask;
use crate::math::Matrix;

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

/// One scalar entry c · block[i, j] of a pair of linear vectors; compact, since a mesh has millions.
#[derive(Clone, Copy, Debug)]
struct LinearEntry {
    factor: f64,
    slot: u32,
    same: u32,
    cross: u32,
    entry: (u8, u8),
}

/// Entries of all pairs of linear vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Linear {
    full: Vec<LinearEntry>,
    isotropic: Vec<LinearEntry>,
}

impl Linear {
    /// Adds a pair with a full block.
    pub(super) fn add_full(
        &mut self,
        slot: usize,
        parts: [&[LinearPart]; 2],
        layout: &mut StepPattern,
        site: Site,
    ) {
        add(&mut self.full, slot, parts, layout, site, |_, _| true);
    }

    /// Adds a pair with an isotropic block.
    pub(super) fn add_isotropic(
        &mut self,
        slot: usize,
        parts: [&[LinearPart]; 2],
        layout: &mut StepPattern,
        site: Site,
    ) {
        add(&mut self.isotropic, slot, parts, layout, site, |i, j| {
            i == j
        });
    }

    /// Gives back memory that further pairs would have taken.
    pub(super) fn shrink_to_fit(&mut self) {
        self.full.shrink_to_fit();
        self.isotropic.shrink_to_fit();
    }

    /// Adds the blocks to the values.
    pub(super) fn add(
        &self,
        full: &[[Matrix; 4]],
        isotropic: &[[f64; 4]],
        sides: BlockMask,
        target: &Destination,
        values: &mut [f64],
    ) {
        for side in (0..4).filter(|&s| sides.blocks[s]) {
            let base = target.blocks[side];
            let crosses = side == 1 || side == 2;
            let place = |e: &LinearEntry| base + if crosses { e.cross } else { e.same } as usize;
            for e in &self.full {
                let (i, j) = (e.entry.0 as usize, e.entry.1 as usize);
                values[place(e)] += e.factor * full[e.slot as usize][side][(i, j)];
            }
            for e in &self.isotropic {
                values[place(e)] += e.factor * isotropic[e.slot as usize][side];
            }
        }
    }
}

fn add(
    list: &mut Vec<LinearEntry>,
    slot: usize,
    [s, t]: [&[LinearPart]; 2],
    layout: &mut StepPattern,
    site: Site,
    couples: impl Fn(usize, usize) -> bool,
) {
    for p in s {
        for q in t.iter().filter(|q| couples(p.axis, q.axis)) {
            let (row, col) = (p.coordinate, q.coordinate);
            let cross = match site {
                Site::Intervals => layout.cross.slot(row, col) as u32,
                Site::Instants => u32::MAX,
            };
            list.push(LinearEntry {
                factor: p.factor * q.factor,
                slot: slot as u32,
                same: layout.same.slot(row, col) as u32,
                cross,
                entry: (p.axis as u8, q.axis as u8),
            });
        }
    }
}
