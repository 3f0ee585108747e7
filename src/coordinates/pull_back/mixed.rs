//! Vectors against scalars.

use crate::coordinates::map::Dependence;
use crate::coordinates::pull_back::destination::{Plan, Pulled};
use crate::math::{Vector, compact_index};

/// One entry of a vector against a scalar; compact, since a mesh with potentials has millions.
#[derive(Clone, Copy, Debug)]
enum MixedEntry {
    Articulated {
        slot: u32,
        column: u32,
        stride: u32,
        place: u32,
    },
    Linear {
        slot: u32,
        factor: f64,
        component: u8,
        place: u32,
    },
}

/// Entries of all couplings of a vector and a scalar.
#[derive(Clone, Debug, Default)]
pub(super) struct Mixed {
    list: Vec<MixedEntry>,
}

impl Mixed {
    /// Adds the coupling of a vector and scalar s.
    pub(super) fn add(&mut self, slot: usize, vector: usize, s: usize, plan: &mut Plan<'_>) {
        let slot = compact_index(slot);
        match &plan.map.vectors[vector] {
            Dependence::Articulated(packed) => {
                for (i, &row) in packed.support.iter().enumerate() {
                    for place in plan.mixed(row, s) {
                        self.list.push(MixedEntry::Articulated {
                            slot,
                            column: compact_index(packed.first + i),
                            stride: compact_index(packed.stride),
                            place: compact_index(place),
                        });
                    }
                }
            }
            Dependence::Linear { parts, .. } => {
                for part in parts {
                    for place in plan.mixed(part.coordinate, s) {
                        self.list.push(MixedEntry::Linear {
                            slot,
                            factor: part.factor,
                            component: part.axis as u8,
                            place: compact_index(place),
                        });
                    }
                }
            }
        }
    }

    /// Gives back memory that further couplings would have taken.
    pub(super) fn shrink_to_fit(&mut self) {
        self.list.shrink_to_fit();
    }

    /// Adds Pᵀ m of both instants, and P′_lᵀ m of plain blocks m, where there are any.
    pub(super) fn pull(
        &self,
        m: &[[Vector; 2]],
        plain: Option<&[[Vector; 2]]>,
        to: &mut Pulled<'_>,
    ) {
        for side in (0..2).filter(|&side| to.target.mixed[side] != usize::MAX) {
            let (columns, columns_l) = (to.columns[side], to.columns_l[side]);
            let values = &mut to.values[to.target.mixed[side]..];
            for entry in &self.list {
                let (place, value) = match *entry {
                    MixedEntry::Articulated {
                        slot,
                        column,
                        stride,
                        place,
                    } => {
                        let value = dot(columns, column, stride, &m[slot as usize][side]);
                        let more = plain.map(|plain| {
                            dot(columns_l, column, stride, &plain[slot as usize][side])
                        });
                        (place, more.map_or(value, |more| value + more))
                    }
                    MixedEntry::Linear {
                        slot,
                        factor,
                        component,
                        place,
                    } => (place, factor * m[slot as usize][side][component as usize]),
                };
                values[place as usize] += value;
            }
        }
    }
}

/// One column of a vector times a vector.
#[inline]
fn dot(columns: &[f64], column: u32, stride: u32, v: &Vector) -> f64 {
    let (column, stride) = (column as usize, stride as usize);
    columns[column] * v.x + columns[column + stride] * v.y + columns[column + 2 * stride] * v.z
}
