//! Vectors against scalars.

use crate::coordinates::map::{CoordinateMap, Dependence};
use crate::coordinates::pattern::StepPattern;
use crate::coordinates::pull_back::destination::{Destination, Site};
use crate::functional::Part;
use crate::math::Vector;

/// One entry of a vector against a scalar.
#[derive(Clone, Copy, Debug)]
enum Entry {
    Articulated {
        slot: usize,
        column: usize,
        stride: usize,
        place: usize,
    },
    Linear {
        slot: usize,
        factor: f64,
        component: usize,
        place: usize,
    },
}

/// Entries of all couplings of a vector and a scalar.
#[derive(Clone, Debug, Default)]
pub(super) struct Mixed {
    list: Vec<Entry>,
}

impl Mixed {
    /// Adds the coupling of a vector and scalar s.
    pub(super) fn add(
        &mut self,
        slot: usize,
        vector: usize,
        s: usize,
        motion: &CoordinateMap,
        layout: &mut StepPattern,
        site: Site,
    ) {
        match &motion.vectors[vector] {
            Dependence::Articulated(packed) => {
                for (i, &row) in packed.support.iter().enumerate() {
                    for place in site.mixed(layout, motion, row, s) {
                        let (column, stride) = (packed.first + i, packed.stride);
                        self.list.push(Entry::Articulated {
                            slot,
                            column,
                            stride,
                            place,
                        });
                    }
                }
            }
            Dependence::Linear { parts, .. } => {
                for part in parts {
                    for place in site.mixed(layout, motion, part.coordinate, s) {
                        self.list.push(Entry::Linear {
                            slot,
                            factor: part.factor,
                            component: part.axis,
                            place,
                        });
                    }
                }
            }
        }
    }

    /// Adds Pᵀ m of both instants.
    pub(super) fn plain(
        &self,
        columns: [&[f64]; 2],
        part: &Part,
        target: &Destination,
        values: &mut [f64],
    ) {
        self.each(target, values, |entry, side| match *entry {
            Entry::Articulated {
                slot,
                column,
                stride,
                ..
            } => dot(
                columns[side],
                column,
                stride,
                &part.blocks.mixed[slot][side],
            ),
            Entry::Linear {
                slot,
                factor,
                component,
                ..
            } => factor * part.blocks.mixed[slot][side][component],
        });
    }

    /// Adds Pᵀ m_w + P′_lᵀ m of both instants.
    pub(super) fn along(
        &self,
        columns: [&[f64]; 2],
        columns_l: [&[f64]; 2],
        [plain, contracted]: [&Part; 2],
        target: &Destination,
        values: &mut [f64],
    ) {
        self.each(target, values, |entry, side| match *entry {
            Entry::Articulated {
                slot,
                column,
                stride,
                ..
            } => {
                dot(
                    columns[side],
                    column,
                    stride,
                    &contracted.blocks.mixed[slot][side],
                ) + dot(
                    columns_l[side],
                    column,
                    stride,
                    &plain.blocks.mixed[slot][side],
                )
            }
            Entry::Linear {
                slot,
                factor,
                component,
                ..
            } => factor * contracted.blocks.mixed[slot][side][component],
        });
    }

    fn each(&self, target: &Destination, values: &mut [f64], value: impl Fn(&Entry, usize) -> f64) {
        for side in (0..2).filter(|&side| target.mixed[side] != usize::MAX) {
            for entry in &self.list {
                let (Entry::Articulated { place, .. } | Entry::Linear { place, .. }) = *entry;
                values[target.mixed[side] + place] += value(entry, side);
            }
        }
    }
}

/// One column of a vector times a vector.
#[inline]
fn dot(columns: &[f64], column: usize, stride: usize, v: &Vector) -> f64 {
    columns[column] * v.x + columns[column + stride] * v.y + columns[column + 2 * stride] * v.z
}
