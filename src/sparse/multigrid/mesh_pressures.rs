//! Elements of a mesh without a grid with their pressures: those of the mesh on the finest level, aggregates of them on coarser ones.
//!
//! Elements with a node in common are neighbours; an aggregate has one pressure, and the sums of volumes and compliances.

use crate::sparse::multigrid::aggregation::{Aggregation, Points};
use crate::sparse::multigrid::pressures::{Elements, Field};
use crate::sparse::multigrid::triangles::{BlockRows, NodeMesh};
use std::ops::Range;

/// The elements of a level.
#[derive(Debug)]
pub(super) struct MeshElements {
    /// Nodes of each.
    pattern: BlockRows,
    /// Elements of each node, with places in B.
    of_nodes: Vec<Vec<[u32; 2]>>,
    /// Pattern of S.
    neighbours: BlockRows,
    /// Places of the aggregates or elements.
    points: Points,
    /// Element of the next coarser level that each is a part of; none of the coarsest level.
    parents: Vec<u32>,
}

impl MeshElements {
    /// Those of a mesh.
    pub(super) fn of_mesh(mesh: &NodeMesh) -> Self {
        let rows = mesh.elements.iter().cloned();
        let centre = |nodes: &Vec<u32>| {
            let mut sum = [0.0; 3];
            for &node in nodes {
                for (sum, x) in sum.iter_mut().zip(mesh.places[node as usize]) {
                    *sum += x / 8.0;
                }
            }
            sum
        };
        let places: Vec<[f64; 3]> = mesh.elements.iter().map(centre).collect();
        Self::new(BlockRows::new(rows), mesh.places.len(), Points::at(&places))
    }

    fn new(pattern: BlockRows, nodes: usize, points: Points) -> Self {
        let of_nodes = pattern.by_column(nodes);
        let neighbours = BlockRows::new((0..pattern.count()).map(|element| {
            let around = pattern.columns(element).iter();
            let mut found = vec![element as u32];
            for &node in around {
                found.extend(of_nodes[node as usize].iter().map(|[other, _]| *other));
            }
            found
        }));
        Self {
            parents: Vec::new(),
            pattern,
            of_nodes,
            neighbours,
            points,
        }
    }

    /// Aggregates of elements, on the next coarser level with so many nodes.
    pub(super) fn coarse(&mut self, transfer: &Aggregation, nodes: usize) -> Self {
        let (parents, points) = self.points.alone(&self.neighbours);
        let mut columns = vec![Vec::new(); points.count()];
        for (element, &parent) in parents.iter().enumerate() {
            for &node in self.pattern.columns(element) {
                let of_node = transfer.pattern.columns(node as usize);
                columns[parent as usize].extend_from_slice(of_node);
            }
        }
        self.parents = parents;
        Self::new(BlockRows::new(columns.into_iter()), nodes, points)
    }

    /// The pattern of the matrix with the nodes of each element coupled.
    pub(super) fn with_nodes_coupled(&self, rows: &BlockRows) -> BlockRows {
        BlockRows::new((0..rows.count()).map(|node| {
            let mut columns = rows.columns(node).to_vec();
            for [element, _] in &self.of_nodes[node] {
                columns.extend_from_slice(self.pattern.columns(*element as usize));
            }
            columns
        }))
    }
}

impl Elements for MeshElements {
    fn field(&self) -> Field {
        Field::new(self.pattern.count(), 0)
    }

    fn slopes(&self) -> usize {
        self.pattern.blocks()
    }

    #[inline(always)]
    fn range(&self, element: usize) -> Range<usize> {
        self.pattern.range(element)
    }

    #[inline(always)]
    fn nodes(&self, element: usize) -> impl Iterator<Item = usize> {
        let nodes = self.pattern.columns(element).iter();
        nodes.map(|node| *node as usize)
    }

    fn of_node(&self, node: usize) -> impl Iterator<Item = [usize; 2]> {
        let elements = self.of_nodes[node].iter();
        elements.map(|element| element.map(|number| number as usize))
    }

    fn parent(&self, element: usize) -> usize {
        self.parents[element] as usize
    }

    fn entries(&self) -> usize {
        self.neighbours.blocks()
    }

    fn entry(&self, row: [usize; 2], column: [usize; 2]) -> usize {
        let entry = self.neighbours.find(row[0], column[0]);
        entry.expect("both have the node")
    }

    #[inline(always)]
    fn product(&self, element: usize, schur: &[f32], x: &Field) -> f32 {
        let entries = schur[self.neighbours.range(element)].iter();
        let products = entries.zip(self.neighbours.columns(element));
        products
            .map(|(entry, column)| entry * x.values[*column as usize])
            .sum()
    }
}
