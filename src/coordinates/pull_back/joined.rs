//! Pairs of a vector on the tree and a linear one, for elastic blocks that are glued to bodies.

use crate::coordinates::map::LinearPart;
use crate::coordinates::pull_back::destination::{Plan, Pulled};
use crate::coordinates::pull_back::images::BlockKind;
use crate::coordinates::tree::TangentColumns;
use crate::functional::Blocks;
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
        packed: &TangentColumns,
        parts: &[LinearPart],
        row_is_articulated: bool,
        plan: &mut Plan<'_>,
    ) {
        for (i, &moving) in packed.support.iter().enumerate() {
            for part in parts {
                let [same, cross] = match row_is_articulated {
                    true => plan.places(moving, part.coordinate),
                    false => plan.places(part.coordinate, moving),
                };
                let entry = JoinedEntry {
                    slot,
                    transposed,
                    row_is_articulated,
                    column: packed.first + i,
                    stride: packed.stride,
                    axis: part.axis,
                    factor: part.factor,
                    same,
                    cross,
                };
                match kind {
                    BlockKind::Full => self.full.push(entry),
                    BlockKind::Isotropic => self.isotropic.push(entry),
                }
            }
        }
    }

    /// Adds Pᵀ H P, and P′_lᵀ H P + Pᵀ Hᵀ P′_l of plain blocks H, where there are any; only the articulated vector has a P′_l.
    pub(super) fn pull(&self, h: &Blocks, plain: Option<&Blocks>, to: &mut Pulled<'_>) {
        let (columns, columns_l) = (to.columns, to.columns_l);
        each(&self.full, to, |e, side, instant| {
            let value = dot(columns[instant], e, &line(e, &h.full[e.slot][side]));
            let Some(plain) = plain else { return value };
            // The articulated vector stands in front of H in both: the block of a virtual work is unsymmetric, and Hᵀ is
            // the block of the pair in the other order, seen from the other side.
            let plain = match e.row_is_articulated {
                true => &plain.full[e.slot][side],
                false => &plain.full[e.transposed][2 * (side % 2) + side / 2],
            };
            value + dot(columns_l[instant], e, &plain.column(e.axis).into())
        });
        each(&self.isotropic, to, |e, side, instant| {
            let place = e.column + e.axis * e.stride;
            let value = columns[instant][place] * h.isotropic[e.slot][side];
            plain.map_or(value, |plain| {
                value + columns_l[instant][place] * plain.isotropic[e.slot][side]
            })
        });
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
    to: &mut Pulled<'_>,
    value: impl Fn(&JoinedEntry, usize, usize) -> f64,
) {
    for side in (0..4).filter(|&s| to.sides.blocks[s]) {
        let (row, col) = (side / 2, side % 2);
        for e in list {
            let instant = if e.row_is_articulated { row } else { col };
            let place = if row == col { e.same } else { e.cross };
            to.values[to.target.blocks[side] + place] += e.factor * value(e, side, instant);
        }
    }
}
