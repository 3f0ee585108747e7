//! Destination of blocks: the values of an interval, or of an instant.

use crate::coordinates::configuration::Configuration;
use crate::coordinates::map::{CoordinateMap, LinearPart};
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::images::BlockKind;
use crate::functional::{BlockMask, Blocks};

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

/// The places of the entries of a site, which join the layout.
pub(super) struct Plan<'l> {
    pub(super) map: &'l CoordinateMap,
    pub(super) layout: &'l mut StepPattern,
    pub(super) site: Site,
}

impl Plan<'_> {
    /// Places of an entry in the blocks of one instant and between neighbours; there is none of the latter (`usize::MAX`) at an instant.
    pub(super) fn places(&mut self, row: usize, col: usize) -> [usize; 2] {
        let cross = match self.site {
            Site::Intervals => self.layout.cross.slot(row, col),
            Site::Instants => usize::MAX,
        };
        [self.layout.same.slot(row, col), cross]
    }

    /// Places of the coupling of coordinate `row` and scalar `s`: a block of its own for an interval, both triangles of
    /// (z, z) for an instant.
    pub(super) fn mixed(&mut self, row: usize, s: usize) -> Vec<usize> {
        match self.site {
            Site::Intervals => vec![self.layout.mixed.slot(row, s)],
            Site::Instants => {
                let (multiplier, same) = (self.map.coordinates + s, &mut self.layout.same);
                vec![same.slot(row, multiplier), same.slot(multiplier, row)]
            }
        }
    }
}

/// Values to which the blocks between two instants are pulled back.
#[derive(Debug)]
pub(in crate::coordinates) struct Pulled<'a> {
    /// Packed columns of both instants, and their derivatives along the direction.
    pub(super) columns: [&'a [f64]; 2],
    pub(super) columns_l: [&'a [f64]; 2],
    /// Blocks that are asked for.
    pub(super) sides: BlockMask,
    pub(super) target: &'a Destination,
    /// Images and local matrix of one group.
    pub(super) local: &'a mut [f64],
    pub(super) values: &'a mut [f64],
}

impl<'a> Pulled<'a> {
    /// Of two placed instants.
    pub(in crate::coordinates) fn new(
        ends: [&'a Configuration; 2],
        sides: BlockMask,
        target: &'a Destination,
        local: &'a mut [f64],
        values: &'a mut [f64],
    ) -> Self {
        Self {
            columns: ends.map(|end| end.columns.as_slice()),
            columns_l: ends.map(|end| end.columns_l.as_slice()),
            sides,
            target,
            local,
            values,
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
    /// Adds a pair.
    pub(super) fn add(
        &mut self,
        kind: BlockKind,
        slot: usize,
        parts: [&[LinearPart]; 2],
        plan: &mut Plan<'_>,
    ) {
        let (list, is_full) = match kind {
            BlockKind::Full => (&mut self.full, true),
            BlockKind::Isotropic => (&mut self.isotropic, false),
        };
        for p in parts[0] {
            for q in parts[1].iter().filter(|q| is_full || p.axis == q.axis) {
                let [same, cross] = plan.places(p.coordinate, q.coordinate);
                list.push(LinearEntry {
                    factor: p.factor * q.factor,
                    slot: slot as u32,
                    same: same as u32,
                    cross: cross as u32,
                    entry: (p.axis as u8, q.axis as u8),
                });
            }
        }
    }

    /// Gives back memory that further pairs would have taken.
    pub(super) fn shrink_to_fit(&mut self) {
        self.full.shrink_to_fit();
        self.isotropic.shrink_to_fit();
    }

    /// Adds the blocks to the values.
    pub(super) fn pull(&self, blocks: &Blocks, to: &mut Pulled<'_>) {
        for side in (0..4).filter(|&s| to.sides.blocks[s]) {
            let base = to.target.blocks[side];
            let crosses = side == 1 || side == 2;
            let place = |e: &LinearEntry| base + if crosses { e.cross } else { e.same } as usize;
            for e in &self.full {
                let (i, j) = (e.entry.0 as usize, e.entry.1 as usize);
                to.values[place(e)] += e.factor * blocks.full[e.slot as usize][side][(i, j)];
            }
            for e in &self.isotropic {
                to.values[place(e)] += e.factor * blocks.isotropic[e.slot as usize][side];
            }
        }
    }
}
