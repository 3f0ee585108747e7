//! Values of the matrix of a solver: the volumes of elements, and copies of all.

use crate::sparse::multigrid::node_grid::{
    COMPONENTS, CORNERS, ENTRIES, ElementVolume, GridNode, NodeBlock,
};
use crate::sparse::multigrid::parts::{Parts, products};
use crate::sparse::multigrid::solver::Multigrid;

/// Numbers of a volume.
const OF_VOLUME: usize = COMPONENTS * CORNERS + 1;

impl Multigrid {
    /// Returns true if volumes of elements belong to the matrix.
    pub fn has_pressures(&self) -> bool {
        !self.parts.volumes.is_empty()
    }

    /// Forgets the volumes of elements, before others are taken.
    pub fn clear_volumes(&mut self) {
        self.parts.volumes.list.fill(ElementVolume::default());
    }

    /// Takes the volume of an element, whose part is in the matrix that was written, with its nodes that move, by corner; returns its place.
    pub fn take_volume(
        &mut self,
        corners: &[Option<GridNode>; CORNERS],
        volume: &ElementVolume,
    ) -> Option<usize> {
        let Parts {
            starts, volumes, ..
        } = &mut self.parts;
        let known = corners.iter().flatten().next()?.number();
        let part = starts.partition_point(|&start| start <= known) - 1;
        let local = |node: GridNode| (node.number() - starts[part]) as u32;
        let place = volumes.find(part, &corners.map(|node| node.map(local)))?;
        volumes.list[place] = *volume;
        Some(place)
    }

    /// Product of the derivatives of the volume at a place and the solution found last, by its pressure.
    pub fn volume_change(&self, place: usize) -> f64 {
        let volumes = &self.parts.volumes;
        volumes.change(place, self.x[self.x.len() - volumes.list.len() + place])
    }

    /// Copies the values as they were written.
    pub fn copy_values(&self, to: &mut Vec<f64>) {
        let parts = &self.parts;
        to.clear();
        for (part, factors) in parts.scales.iter().enumerate() {
            let products = products(factors).map(f64::recip);
            for block in &parts.matrix[parts.blocks(part)] {
                to.extend(block.iter().zip(&products).map(|(entry, by)| entry * by));
            }
            for volume in parts.volumes.without_scale(part, factors) {
                to.extend(volume.slopes.as_flattened());
                to.push(volume.factor);
            }
        }
    }

    /// Takes values that were copied in place of those that were written; returns true if they fit.
    pub fn restore_values(&mut self, from: &[f64]) -> bool {
        let Parts {
            matrix,
            first_blocks,
            volumes,
            ..
        } = &mut self.parts;
        if from.len() != matrix.as_flattened().len() + OF_VOLUME * volumes.list.len() {
            return false;
        }
        let mut rest = from;
        for (part, of) in first_blocks.windows(2).enumerate() {
            let blocks = matrix[of[0]..of[1]].as_flattened_mut();
            let (own, behind) = rest.split_at(blocks.len());
            blocks.copy_from_slice(own);
            rest = behind;
            let range = volumes.range(part);
            for volume in &mut volumes.list[range] {
                let (own, behind) = rest.split_at(OF_VOLUME);
                volume
                    .slopes
                    .as_flattened_mut()
                    .copy_from_slice(&own[..OF_VOLUME - 1]);
                volume.factor = own[OF_VOLUME - 1];
                rest = behind;
            }
        }
        true
    }
}

impl Parts {
    /// Replaces the matrix by its symmetric part.
    pub(super) fn symmetrise(&mut self) {
        for (part, one) in self.list.iter().enumerate() {
            let blocks = &mut self.matrix[self.first_blocks[part]..self.first_blocks[part + 1]];
            let pattern = one.pattern();
            pattern.each(|here, [node, other]| {
                if node <= other {
                    let there = pattern.transposed(here, [node, other]);
                    symmetrise_pair(blocks, here, there);
                }
            });
        }
    }
}

/// Replaces a block, and the one across the diagonal, by their symmetric part.
fn symmetrise_pair(blocks: &mut [NodeBlock], here: usize, there: usize) {
    let [a, b] = [blocks[here], blocks[there]];
    for entry in 0..ENTRIES {
        let (row, col) = (entry % COMPONENTS, entry / COMPONENTS);
        let transposed = COMPONENTS * row + col;
        let mean = 0.5 * (a[entry] + b[transposed]);
        (blocks[here][entry], blocks[there][transposed]) = (mean, mean);
    }
}
