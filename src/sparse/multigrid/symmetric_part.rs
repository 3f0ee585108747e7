//! The symmetric part of a matrix by the nodes of boxes and meshes.

use crate::sparse::multigrid::boxes::Parts;
use crate::sparse::multigrid::node_grid::{
    COMPONENTS, ENTRIES, NEIGHBOURS, NodeBlock, OWN, offsets,
};

impl Parts {
    /// Replaces the matrix by its symmetric part.
    pub(super) fn symmetrise(&mut self) {
        for (part, one) in self.boxes.iter().enumerate() {
            let offsets = offsets(one.levels[0].counts);
            let nodes = self.nodes(part);
            let blocks = &mut self.matrix[NEIGHBOURS * nodes.start..NEIGHBOURS * nodes.end];
            for node in 0..nodes.len() {
                for (neighbour, offset) in offsets.iter().enumerate().skip(OWN) {
                    let other = node + *offset as usize;
                    if other >= nodes.len() {
                        continue;
                    }
                    let here = NEIGHBOURS * node + neighbour;
                    let there = NEIGHBOURS * other + (NEIGHBOURS - 1 - neighbour);
                    symmetrise_pair(blocks, here, there);
                }
            }
        }
        for (mesh, one) in self.meshes.iter().enumerate() {
            let blocks = self.blocks(self.boxes.len() + mesh);
            let (blocks, rows) = (&mut self.matrix[blocks], &one.levels[0].matrix.rows);
            for (here, (node, other)) in rows.entries().enumerate() {
                if node <= other {
                    let there = rows.find(other, node);
                    symmetrise_pair(blocks, here, there.expect("neighbours are so both ways"));
                }
            }
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
