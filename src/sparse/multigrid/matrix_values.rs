//! Values of the matrix of a solver: the volumes of elements, and copies of all.

use crate::sparse::multigrid::boxes::{Parts, products};
use crate::sparse::multigrid::element_volume::{CORNERS, ElementVolume, corners};
use crate::sparse::multigrid::node_grid::{COMPONENTS, GridNode};
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

    /// Takes the volume of an element, whose part is in the matrix that was written, with one of its nodes and the corner that it is.
    pub fn take_volume(&mut self, node: GridNode, corner: usize, volume: &ElementVolume) {
        if let Some((_, element)) = self.element(node, corner) {
            self.parts.volumes.list[element] = *volume;
        }
    }

    /// Product of the derivatives of a volume and the solution found last, by its pressure; zero where there is none.
    pub fn volume_change(&self, node: GridNode, corner: usize) -> f64 {
        let Some((part, element)) = self.element(node, corner) else {
            return 0.0;
        };
        let pressure = self.x[self.x.len() - self.parts.volumes.list.len() + element];
        self.parts.volumes.change(part, element, pressure)
    }

    /// Box and number of an element; `None` where it has no pressure.
    fn element(&self, node: GridNode, corner: usize) -> Option<(usize, usize)> {
        let Parts { boxes, starts, .. } = &self.parts;
        let node = node.number();
        let part = starts.partition_point(|&start| start <= node) - 1;
        let finest = &boxes.get(part)?.levels[0];
        (finest.pressures.is_some()).then(|| (part, node - corners(finest.counts)[corner]))
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
            let nodes = parts.nodes(part);
            for volume in parts.volumes.without_scale(part, nodes, factors) {
                to.extend(volume.slopes.as_flattened());
                to.push(volume.factor);
            }
        }
    }

    /// Takes values that were copied in place of those that were written; returns true if they fit.
    pub fn restore_values(&mut self, from: &[f64]) -> bool {
        let Parts {
            matrix,
            starts,
            first_blocks,
            volumes,
            ..
        } = &mut self.parts;
        if from.len() != matrix.as_flattened().len() + OF_VOLUME * volumes.list.len() {
            return false;
        }
        let mut rest = from;
        for (part, of) in starts.windows(2).zip(first_blocks.windows(2)) {
            let blocks = matrix[of[0]..of[1]].as_flattened_mut();
            let (own, behind) = rest.split_at(blocks.len());
            blocks.copy_from_slice(own);
            rest = behind;
            for volume in volumes.list.get_mut(part[0]..part[1]).unwrap_or_default() {
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
