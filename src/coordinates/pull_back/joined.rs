//! Pairs of a vector on the tree and a linear one, for elastic blocks that are glued to bodies.

use crate::coordinates::map::LinearPart;
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::articulated::Ends;
use crate::coordinates::pull_back::destination::{Destination, Site};
use crate::coordinates::pull_back::images::BlockKind;
use crate::coordinates::tree::TangentColumns;
use crate::functional::BlockMask;
use crate::math::{Matrix, Vector};

/// One entry: a column of the articulated vector against one coordinate of the linear vector.
#[derive(Clone, Copy, Debug)]
struct JoinedEntry {
    slot: usize,
    /// Slot of the pair in the other order.
    transposed: usize,
    /// True if the articulated vector gives the row.
    row_is_articulated: bool,
    column: usize,
    stride: usize,
    axis: usize,
    factor: f64,
    same: usize,
    cross: usize,
}

/// Entries of all such pairs.
#[derive(Clone, Debug, Default)]
pub(super) struct Joined {
    full: Vec<JoinedEntry>,
    isotropic: Vec<JoinedEntry>,
}

impl Joined {
    /// Adds a pair in the order of its block; `row_is_articulated` says which of both vectors is first.
    pub(super) fn add(
        &mut self,
        kind: BlockKind,
        [slot, transposed]: [usize; 2],
        (packed, parts): (&TangentColumns, &[LinearPart]),
        row_is_articulated: bool,
        layout: &mut StepPattern,
        site: Site,
    ) {
        for (i, &moving) in packed.support.iter().enumerate() {
            for part in parts {
                let (row, col) = if row_is_articulated {
                    (moving, part.coordinate)
                } else {
                    (part.coordinate, moving)
                };
                let cross = match site {
                    Site::Intervals => layout.cross.slot(row, col),
                    Site::Instants => usize::MAX,
                };
                let entry = JoinedEntry {
                    slot,
                    transposed,
                    row_is_articulated,
                    column: packed.first + i,
                    stride: packed.stride,
                    axis: part.axis,
                    factor: part.factor,
                    same: layout.same.slot(row, col),
                    cross,
                };
                match kind {
                    BlockKind::Full => self.full.push(entry),
                    BlockKind::Isotropic => self.isotropic.push(entry),
                }
            }
        }
    }

    /// Adds Pᵀ H P.
    pub(super) fn plain(
        &self,
        ends: Ends<'_>,
        full: &[[Matrix; 4]],
        isotropic: &[[f64; 4]],
        sides: BlockMask,
        target: &Destination,
        values: &mut [f64],
    ) {
        each(&self.full, sides, target, values, |e, side, instant| {
            dot(ends.columns[instant], e, &line(e, &full[e.slot][side]))
        });
        each(
            &self.isotropic,
            sides,
            target,
            values,
            |e, side, instant| {
                ends.columns[instant][e.column + e.axis * e.stride] * isotropic[e.slot][side]
            },
        );
    }

    /// Adds Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l; only the articulated vector has a P′_l.
    pub(super) fn along(
        &self,
        ends: Ends<'_>,
        full: [&[[Matrix; 4]]; 2],
        isotropic: [&[[f64; 4]]; 2],
        sides: BlockMask,
        target: &Destination,
        values: &mut [f64],
    ) {
        each(&self.full, sides, target, values, |e, side, instant| {
            // The articulated vector stands in front of H in both: the block of a virtual work is unsymmetric, and Hᵀ is
            // the block of the pair in the other order, seen from the other side.
            let h = if e.row_is_articulated {
                &full[0][e.slot][side]
            } else {
                &full[0][e.transposed][2 * (side % 2) + side / 2]
            };
            dot(ends.columns[instant], e, &line(e, &full[1][e.slot][side]))
                + dot(ends.columns_l[instant], e, &h.column(e.axis).into())
        });
        each(
            &self.isotropic,
            sides,
            target,
            values,
            |e, side, instant| {
                let place = e.column + e.axis * e.stride;
                ends.columns[instant][place] * isotropic[1][e.slot][side]
                    + ends.columns_l[instant][place] * isotropic[0][e.slot][side]
            },
        );
    }
}

/// Returns the vector that the articulated columns meet in a block: its column or row at the axis of the linear coordinate.
fn line(entry: &JoinedEntry, block: &Matrix) -> Vector {
    if entry.row_is_articulated {
        block.column(entry.axis).into()
    } else {
        block.row(entry.axis).transpose()
    }
}

fn dot(columns: &[f64], e: &JoinedEntry, v: &Vector) -> f64 {
    let (c, s) = (e.column, e.stride);
    columns[c] * v.x + columns[c + s] * v.y + columns[c + 2 * s] * v.z
}

/// Adds `value(entry, side, instant of the articulated vector)` for all sides that are asked for.
fn each(
    list: &[JoinedEntry],
    sides: BlockMask,
    target: &Destination,
    values: &mut [f64],
    value: impl Fn(&JoinedEntry, usize, usize) -> f64,
) {
    for side in (0..4).filter(|&s| sides.blocks[s]) {
        let (row, col) = (side / 2, side % 2);
        for e in list {
            let instant = if e.row_is_articulated { row } else { col };
            let place = if row == col { e.same } else { e.cross };
            values[target.blocks[side] + place] += e.factor * value(e, side, instant);
        }
    }
}
