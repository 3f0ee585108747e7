//! The nodes of a mesh without a grid, with the unknowns at each node, and the places of blocks among those of all nodes.

use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::node_grid::{COMPONENTS, GridNode, NEIGHBOURS, OWN};
use std::sync::Arc;

/// A mesh of hexahedra whose nodes are on no grid.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeMesh {
    /// Places of the nodes in mm.
    pub places: Vec<[f64; 3]>,
    /// Nodes of each element: around its lower face, then around its upper one.
    pub elements: Vec<[u32; 8]>,
    /// Unknowns of each node by component; `None` where the value is given.
    pub unknowns: Vec<[Option<u32>; COMPONENTS]>,
    /// Length of the shortest edge in mm.
    pub shortest_edge: f64,
    /// True if elements have pressures, as they resist changes of their volumes by far more than anything else.
    pub has_pressures: bool,
}

/// Distance of two places.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Places of the blocks of a matrix by node: those of boxes come first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockPlaces {
    /// Number of nodes of boxes.
    pub(super) of_boxes: usize,
    /// First node and first block of each mesh, and its pattern.
    pub(super) meshes: Vec<(usize, usize, Arc<BlockRows>)>,
}

impl BlockPlaces {
    /// Number of the block of the rows of a node and the columns of another one; `None` where they are no neighbours.
    #[inline(always)]
    pub fn block(&self, row: GridNode, column: GridNode) -> Option<usize> {
        let [row_number, column_number] = [row.number(), column.number()];
        if row_number < self.of_boxes {
            return match column_number < self.of_boxes {
                true => row.neighbour_block(column),
                false => None,
            };
        }
        let part = self.meshes.iter().rfind(|mesh| mesh.0 <= row_number)?;
        let (first, block, rows) = (part.0, part.1, &part.2);
        let column = column_number.checked_sub(first)?;
        Some(block + rows.find(row_number - first, column)?)
    }

    /// The block on the diagonal of a node.
    pub(super) fn diagonal(&self, node: usize) -> usize {
        match self.meshes.iter().rfind(|mesh| mesh.0 <= node) {
            Some((first, block, rows)) => block + rows.diagonal(node - first),
            None => NEIGHBOURS * node + OWN,
        }
    }
}
