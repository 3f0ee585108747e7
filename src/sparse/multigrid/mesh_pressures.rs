//! Pressures on one level of a mesh without a grid: those of elements on the finest level, of aggregates of elements on coarser ones.
//!
//! They are corrected behind each sweep as those of a grid are (`pressures.rs`), with S = C + B D⁻¹ Bᵀ. Elements with a node in
//! common are neighbours; an aggregate has one pressure, and the sums of volumes and compliances.

use crate::sparse::multigrid::aggregates::Points;
use crate::sparse::multigrid::aggregation::Aggregation;
use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::node_grid::{Block, COMPONENTS, add};
use crate::sparse::multigrid::pressure_correction::{Lists, Schur, correct};
use crate::sparse::multigrid::triangles::NodeMesh;

/// Values of the components of a node.
type AtNode = [f32; COMPONENTS];

/// The pressures of a level.
#[derive(Debug)]
pub(super) struct MeshPressures {
    /// B, by pressure and node.
    pattern: BlockRows,
    slopes: Vec<AtNode>,
    /// C.
    pub(super) compliance: Vec<f32>,
    /// Pressures of each node, with places in B.
    of_nodes: Vec<Vec<[u32; 2]>>,
    /// S.
    neighbours: BlockRows,
    schur: Vec<f32>,
    inverse: Vec<f32>,
    /// Places of the aggregates or elements.
    points: Points,
    /// Pressure of the next coarser level that each is a part of; none of the coarsest level.
    parents: Vec<u32>,
    /// g.
    pub(super) rhs: Vec<f32>,
    pub(super) p: Vec<f32>,
    residual: Vec<f32>,
    correction: Vec<f32>,
    swept: Vec<f32>,
    direction: Vec<f32>,
    product: Vec<f32>,
}

impl MeshPressures {
    /// Of the elements of a mesh.
    pub(super) fn of_elements(mesh: &NodeMesh) -> Self {
        let rows = mesh.elements.iter().map(|nodes| nodes.to_vec());
        let centre = |nodes: &[u32; 8]| {
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
        let neighbours = BlockRows::new((0..pattern.count()).map(|pressure| {
            let around = pattern.columns(pressure).iter();
            let mut found = vec![pressure as u32];
            for &node in around {
                found.extend(of_nodes[node as usize].iter().map(|[other, _]| *other));
            }
            found
        }));
        let zero = || vec![0.0; pattern.count()];
        Self {
            slopes: vec![AtNode::default(); pattern.blocks()],
            compliance: zero(),
            schur: vec![0.0; neighbours.blocks()],
            inverse: zero(),
            parents: Vec::new(),
            rhs: zero(),
            p: zero(),
            residual: zero(),
            correction: zero(),
            swept: zero(),
            direction: zero(),
            product: zero(),
            pattern,
            of_nodes,
            neighbours,
            points,
        }
    }

    /// Pressures of aggregates, on the next coarser level with so many nodes.
    pub(super) fn coarse(&mut self, transfer: &Aggregation, nodes: usize) -> Self {
        let (parents, points) = self.points.alone(&self.neighbours);
        let mut columns = vec![Vec::new(); points.count()];
        for (pressure, &parent) in parents.iter().enumerate() {
            for &node in self.pattern.columns(pressure) {
                let of_node = transfer.pattern.columns(node as usize);
                columns[parent as usize].extend_from_slice(of_node);
            }
        }
        self.parents = parents;
        Self::new(BlockRows::new(columns.into_iter()), nodes, points)
    }

    /// Bytes of its lists.
    pub(super) fn bytes(&self) -> usize {
        let of_slopes = size_of::<AtNode>() + size_of::<[u32; 3]>();
        let of_schur = size_of::<[u32; 2]>() * self.schur.len();
        of_slopes * self.slopes.len() + of_schur + 40 * self.p.len()
    }

    /// The pattern of the matrix with the nodes of each pressure coupled.
    pub(super) fn couple(&self, rows: &BlockRows) -> BlockRows {
        BlockRows::new((0..rows.count()).map(|node| {
            let mut columns = rows.columns(node).to_vec();
            for [pressure, _] in &self.of_nodes[node] {
                columns.extend_from_slice(self.pattern.columns(*pressure as usize));
            }
            columns
        }))
    }

    /// Takes the volume of an element with these nodes.
    pub(super) fn take(
        &mut self,
        element: usize,
        nodes: &[usize; 8],
        slopes: &[AtNode; 8],
        compliance: f32,
    ) {
        self.compliance[element] = compliance;
        for (node, slopes) in nodes.iter().zip(slopes) {
            let place = self.pattern.find(element, *node);
            self.slopes[place.expect("a node of the element")] = *slopes;
        }
    }

    /// Writes the slopes and compliances of the next coarser level; `free` has a bit for each component of its nodes that moves.
    pub(super) fn coarsen(&self, transfer: &Aggregation, free: &[u8], coarse: &mut Self) {
        coarse.slopes.fill(AtNode::default());
        coarse.compliance.fill(0.0);
        for (pressure, &parent) in self.parents.iter().enumerate() {
            if self.compliance[pressure] == 0.0 {
                continue;
            }
            let parent = parent as usize;
            coarse.compliance[parent] += self.compliance[pressure];
            for place in self.pattern.range(pressure) {
                let slopes = &self.slopes[place];
                for weights in transfer.pattern.range(self.pattern.column(place)) {
                    let node = transfer.pattern.column(weights);
                    let to = coarse.pattern.find(parent, node);
                    let to = &mut coarse.slopes[to.expect("a node of the aggregate")];
                    let block = &transfer.values[weights];
                    for (component, sum) in to.iter_mut().enumerate() {
                        let column = &block[COMPONENTS * component..][..COMPONENTS];
                        let moved = column.iter().zip(slopes).map(|(a, b)| a * b);
                        if free[node] & 1 << component != 0 {
                            *sum += moved.sum::<f32>();
                        }
                    }
                }
            }
        }
    }

    /// Makes S, with the inverse of the diagonal blocks.
    pub(super) fn prepare(&mut self, blocks: &[Block]) {
        self.schur.fill(0.0);
        for pressure in 0..self.p.len() {
            if self.compliance[pressure] == 0.0 {
                self.inverse[pressure] = 0.0;
                continue;
            }
            let own = self.neighbours.diagonal(pressure);
            self.schur[own] = self.compliance[pressure];
            for place in self.pattern.range(pressure) {
                let node = self.pattern.column(place);
                let (mut moved, mut turned) = (AtNode::default(), AtNode::default());
                add(&mut moved, &blocks[node], &self.slopes[place]);
                super::node_grid::add_transposed(&mut turned, &blocks[node], &self.slopes[place]);
                for [other, there] in &self.of_nodes[node] {
                    let slopes = &self.slopes[*there as usize];
                    let both = moved.iter().zip(&turned).map(|(a, b)| 0.5 * (a + b));
                    let product: f32 = both.zip(slopes).map(|(a, b)| a * b).sum();
                    let slot = self.neighbours.find(pressure, *other as usize);
                    self.schur[slot.expect("both have the node")] += product;
                }
            }
            self.inverse[pressure] = self.schur[own].recip();
        }
    }

    /// Makes its residual the right-hand side of the next coarser level.
    pub(super) fn restrict(&self, coarse: &mut Self) {
        coarse.rhs.fill(0.0);
        for (residual, &parent) in self.residual.iter().zip(&self.parents) {
            coarse.rhs[parent as usize] += residual;
        }
    }

    /// Adds the pressures of the next coarser level.
    pub(super) fn add_coarse(&mut self, coarse: &Self) {
        let lists = self.p.iter_mut().zip(&self.parents);
        for ((p, &parent), compliance) in lists.zip(&self.compliance) {
            if *compliance != 0.0 {
                *p += coarse.p[parent as usize];
            }
        }
    }

    /// B x of one pressure.
    #[inline(always)]
    fn along(&self, pressure: usize, x: &[AtNode]) -> f32 {
        let mut sums = AtNode::default();
        for place in self.pattern.range(pressure) {
            let there = &x[self.pattern.column(place)];
            for (sum, (slope, x)) in sums.iter_mut().zip(self.slopes[place].iter().zip(there)) {
                *sum += slope * x;
            }
        }
        sums.iter().sum()
    }

    /// Adds a multiple of Bᵀ p to forces.
    pub(super) fn add_forces(&self, p: &[f32], factor: f32, forces: &mut [AtNode]) {
        for (pressure, p) in p.iter().enumerate() {
            for place in self.pattern.range(pressure) {
                let there = &mut forces[self.pattern.column(place)];
                for (sum, slope) in there.iter_mut().zip(&self.slopes[place]) {
                    *sum += factor * slope * p;
                }
            }
        }
    }

    /// Writes g − B x + C p.
    pub(super) fn leave(&mut self, x: &[AtNode]) {
        for pressure in 0..self.p.len() {
            let along = self.along(pressure, x);
            let compliance = self.compliance[pressure] * self.p[pressure];
            self.residual[pressure] = self.rhs[pressure] - along + compliance;
        }
    }

    /// Adds Bᵀ C⁻¹ g to forces, which makes them those of displacements alone.
    pub(super) fn condense(&mut self, forces: &mut [AtNode]) {
        for (pressure, compliance) in self.compliance.iter().enumerate() {
            self.correction[pressure] = match *compliance == 0.0 {
                true => 0.0,
                false => self.rhs[pressure] / compliance,
            };
        }
        self.add_forces(&self.correction, 1.0, forces);
    }

    /// Makes pressures those that belong to displacements.
    pub(super) fn follow(&mut self, x: &[AtNode]) {
        for pressure in 0..self.p.len() {
            let change = self.along(pressure, x) - self.rhs[pressure];
            self.p[pressure] = match self.compliance[pressure] == 0.0 {
                true => 0.0,
                false => change / self.compliance[pressure],
            };
        }
    }

    /// Adds Bᵀ C⁻¹ B to a matrix.
    pub(super) fn add_to(&self, rows: &BlockRows, matrix: &mut [[f64; COMPONENTS * COMPONENTS]]) {
        for pressure in 0..self.p.len() {
            if self.compliance[pressure] == 0.0 {
                continue;
            }
            let factor = f64::from(self.compliance[pressure]).recip();
            for row in self.pattern.range(pressure) {
                for column in self.pattern.range(pressure) {
                    let nodes = [row, column].map(|place| self.pattern.column(place));
                    let block = rows.find(nodes[0], nodes[1]);
                    let block = &mut matrix[block.expect("nodes of a pressure are coupled")];
                    for (entry, sum) in block.iter_mut().enumerate() {
                        let own = self.slopes[row][entry % COMPONENTS];
                        let there = self.slopes[column][entry / COMPONENTS];
                        *sum += factor * f64::from(own) * f64::from(there);
                    }
                }
            }
        }
    }

    /// Corrects pressures, and displacements; `forces` is overwritten, `blocks` are the inverse of the diagonal ones.
    pub(super) fn correct(&mut self, x: &mut [AtNode], blocks: &[Block], forces: &mut [AtNode]) {
        self.leave(x);
        correct(self);
        for (p, q) in self.p.iter_mut().zip(&self.correction) {
            *p += q;
        }
        forces.fill(AtNode::default());
        self.add_forces(&self.correction, -1.0, forces);
        for ((x, force), block) in x.iter_mut().zip(forces).zip(blocks) {
            add(x, block, force);
        }
    }

    /// Product of one row of S.
    #[inline(always)]
    fn sum(&self, pressure: usize, x: &[f32]) -> f32 {
        let range = self.neighbours.range(pressure);
        let entries = self.schur[range].iter();
        let columns = self.neighbours.columns(pressure);
        let products = entries.zip(columns);
        products
            .map(|(entry, column)| entry * x[*column as usize])
            .sum()
    }
}

impl Schur for MeshPressures {
    fn lists(&mut self) -> Lists<'_> {
        Lists {
            residual: &mut self.residual,
            correction: &mut self.correction,
            swept: &mut self.swept,
            direction: &mut self.direction,
            product: &mut self.product,
        }
    }

    fn multiply(&mut self) {
        for pressure in 0..self.p.len() {
            self.product[pressure] = self.sum(pressure, &self.direction);
        }
    }

    fn sweep(&mut self) {
        self.swept.fill(0.0);
        let count = self.p.len();
        for pressure in (0..count).chain((0..count).rev()) {
            let left = self.residual[pressure] - self.sum(pressure, &self.swept);
            self.swept[pressure] += self.inverse[pressure] * left;
        }
    }
}
