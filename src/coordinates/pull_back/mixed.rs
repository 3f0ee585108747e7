//! Vectors against scalars.

use crate::coordinates::map::{CoordinateMap, Dependence};
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::destination::{Destination, Site};
use crate::functional::SumDerivatives;
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
    pub(super) fn add(
        &mut self,
        slot: usize,
        vector: usize,
        s: usize,
        map: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) {
        match &map.vectors[vector] {
            Dependence::Articulated(packed) => {
                for (i, &row) in packed.support.iter().enumerate() {
                    for place in site.mixed(layout, map, row, s) {
                        self.list.push(MixedEntry::Articulated {
                            slot: compact_index(slot),
                            column: compact_index(packed.first + i),
                            stride: compact_index(packed.stride),
                            place: compact_index(place),
                        });
                    }
                }
            }
            Dependence::Linear { parts, .. } => {
                for part in parts {
                    for place in site.mixed(layout, map, part.coordinate, s) {
                        self.list.push(MixedEntry::Linear {
                            slot: compact_index(slot),
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

    /// Adds Pᵀ m of both instants.
    pub(super) fn plain(
        &self,
        columns: [&[f64]; 2],
        part: &SumDerivatives,
        target: &Destination,
        values: &mut [f64],
    ) {
        self.each(target, values, |entry, side| match *entry {
            MixedEntry::Articulated {
                slot,
                column,
                stride,
                ..
            } => dot(
                columns[side],
                column,
                stride,
                &part.blocks.mixed[slot as usize][side],
            ),
            MixedEntry::Linear {
                slot,
                factor,
                component,
                ..
            } => factor * part.blocks.mixed[slot as usize][side][component as usize],
        });
    }

    /// Adds Pᵀ m_w + P′_lᵀ m of both instants.
    pub(super) fn along(
        &self,
        columns: [&[f64]; 2],
        columns_l: [&[f64]; 2],
        [plain, contracted]: [&SumDerivatives; 2],
        target: &Destination,
        values: &mut [f64],
    ) {
        self.each(target, values, |entry, side| match *entry {
            MixedEntry::Articulated {
                slot,
                column,
                stride,
                ..
            } => {
                dot(
                    columns[side],
                    column,
                    stride,
                    &contracted.blocks.mixed[slot as usize][side],
                ) + dot(
                    columns_l[side],
                    column,
                    stride,
                    &plain.blocks.mixed[slot as usize][side],
                )
            }
            MixedEntry::Linear {
                slot,
                factor,
                component,
                ..
            } => factor * contracted.blocks.mixed[slot as usize][side][component as usize],
        });
    }

    fn each(
        &self,
        target: &Destination,
        values: &mut [f64],
        value: impl Fn(&MixedEntry, usize) -> f64,
    ) {
        for side in (0..2).filter(|&side| target.mixed[side] != usize::MAX) {
            for entry in &self.list {
                let (MixedEntry::Articulated { place, .. } | MixedEntry::Linear { place, .. }) =
                    *entry;
                values[target.mixed[side] + place as usize] += value(entry, side);
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
