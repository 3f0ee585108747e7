//! Box grids and meshes side by side: their matrix in double precision, by blocks, with its product and its preconditioner.

use crate::math::join;
use crate::sparse::Singular;
use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::hierarchy::Hierarchy;
use crate::sparse::multigrid::krylov::Operator;
use crate::sparse::multigrid::level::Level;
use crate::sparse::multigrid::mesh_level::MeshLevel;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, ENTRIES, Field, NEIGHBOURS, NodeBlock, NodeGrid, VolumePlaces, corners,
    offsets,
};
use crate::sparse::multigrid::triangles::{BlockPlaces, NodeMesh};
use crate::sparse::multigrid::volumes::{Volumes, scale_of_mean};
use std::ops::Range;
use std::sync::Arc;

/// The boxes, the meshes behind them, and their matrix.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) boxes: Vec<Hierarchy<Level>>,
    pub(super) meshes: Vec<Hierarchy<MeshLevel>>,
    /// First node of each part, and the number of all.
    pub(super) starts: Vec<usize>,
    /// First block of each part, and the number of all.
    pub(super) first_blocks: Vec<usize>,
    pub(super) places: Arc<BlockPlaces>,
    /// Blocks by node and neighbour, each by column.
    pub(super) matrix: Vec<NodeBlock>,
    /// Factors of rows and columns of a part by component.
    pub(super) scales: Vec<[f64; COMPONENTS]>,
    /// Volumes of elements; none where no part has pressures.
    pub(super) volumes: Volumes,
}

impl Parts {
    /// The parts without a matrix.
    pub(super) fn new(grids: &[NodeGrid], node_meshes: &[NodeMesh]) -> Self {
        let boxes: Vec<_> = grids.iter().map(Hierarchy::of).collect();
        let meshes: Vec<_> = node_meshes.iter().map(Hierarchy::of_mesh).collect();
        let (mut starts, mut first_blocks) = (vec![0], vec![0]);
        for grid in grids {
            starts.push(starts[starts.len() - 1] + grid.unknowns.len());
            first_blocks.push(NEIGHBOURS * starts[starts.len() - 1]);
        }
        let mut volumes = Volumes::default();
        for grid in grids {
            let count = if grid.has_pressures {
                grid.unknowns.len()
            } else {
                0
            };
            volumes.add(count, VolumePlaces::Box(corners(grid.counts())));
        }
        for (mesh, one) in node_meshes.iter().zip(&meshes) {
            let elements = if mesh.has_pressures {
                &mesh.elements[..]
            } else {
                &[]
            };
            let places = VolumePlaces::of_mesh(elements, &one.levels[0].free);
            volumes.add(elements.len(), places);
        }
        let mut places = BlockPlaces {
            of_boxes: starts[grids.len()],
            meshes: Vec::new(),
        };
        for one in &meshes {
            let finest = &one.levels[0];
            let (node, block) = (starts[starts.len() - 1], first_blocks[starts.len() - 1]);
            places
                .meshes
                .push((node, block, finest.matrix.rows.clone()));
            starts.push(node + finest.free.len());
            first_blocks.push(block + finest.matrix.rows.blocks());
        }
        let parts = boxes.len() + meshes.len();
        Self {
            matrix: vec![[0.0; ENTRIES]; first_blocks[parts]],
            scales: vec![[1.0; COMPONENTS]; parts],
            volumes,
            places: Arc::new(places),
            boxes,
            meshes,
            starts,
            first_blocks,
        }
    }

    /// Number of nodes of all parts.
    pub(super) fn node_count(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Number of levels of the part that has most.
    pub(super) fn levels(&self) -> usize {
        let of_boxes = self.boxes.iter().map(|one| one.levels.len());
        let of_meshes = self.meshes.iter().map(|one| one.levels.len());
        of_boxes.chain(of_meshes).max().unwrap_or(0)
    }

    /// Bytes of all levels.
    pub(super) fn bytes(&self) -> usize {
        let of_boxes = self.boxes.iter().map(Hierarchy::bytes);
        of_boxes
            .chain(self.meshes.iter().map(Hierarchy::bytes))
            .sum()
    }

    /// Nodes of a part.
    pub(super) fn nodes(&self, part: usize) -> Range<usize> {
        self.starts[part]..self.starts[part + 1]
    }

    /// Blocks of a part.
    pub(super) fn blocks(&self, part: usize) -> Range<usize> {
        self.first_blocks[part]..self.first_blocks[part + 1]
    }

    /// Factor of the row and column at a place.
    pub(super) fn scale_of(&self, place: usize) -> f64 {
        let part = match self.scales.len() {
            1 => 0,
            _ => {
                self.starts
                    .partition_point(|&start| start <= place / COMPONENTS)
                    - 1
            }
        };
        self.scales[part][place % COMPONENTS]
    }

    /// Finds scales that make the mean of the diagonal one: of all displacements of a part, and of its potentials.
    pub(super) fn find_scales(&mut self) {
        for part in 0..self.scales.len() {
            let mut sums = [[0.0; 2]; COMPONENTS];
            for node in self.nodes(part) {
                let own = &self.matrix[self.places.diagonal(node)];
                for (component, [sum, count]) in sums.iter_mut().enumerate() {
                    let diagonal = own[(COMPONENTS + 1) * component].abs();
                    *sum += diagonal;
                    *count += f64::from(u8::from(diagonal > 0.0));
                }
            }
            sums[0][0] -= self.volumes.resistance(part);
            let scale = |parts: Range<usize>| {
                let (sum, count) = sums[parts]
                    .iter()
                    .fold((0.0, 0.0), |(s, c), [sum, count]| (s + sum, c + count));
                scale_of_mean(sum / count)
            };
            let displacement = scale(0..3);
            self.volumes.find_scale(part, displacement);
            self.scales[part] = [displacement, displacement, displacement, scale(3..4)];
        }
    }

    /// Multiplies rows and columns by their factors.
    pub(super) fn scale(&mut self) {
        for part in 0..self.scales.len() {
            let products = products(&self.scales[part]);
            let blocks = self.blocks(part);
            for block in &mut self.matrix[blocks] {
                for (entry, product) in block.iter_mut().zip(&products) {
                    *entry *= product;
                }
            }
            self.volumes.scale(part, &self.scales[part]);
        }
    }

    /// Product of the matrix with a vector by node on either side.
    pub(super) fn along(&self, x: &[[f64; COMPONENTS]]) -> f64 {
        let mut sum = 0.0;
        for (part, rows) in self.of_meshes() {
            let (x, blocks) = (&x[self.nodes(part)], &self.matrix[self.blocks(part)]);
            for (block, (node, other)) in blocks.iter().zip(rows.entries()) {
                for (column, value) in block.chunks_exact(COMPONENTS).zip(&x[other]) {
                    let along: f64 = column.iter().zip(&x[node]).map(|(a, x)| a * x).sum();
                    sum += along * value;
                }
            }
        }
        for (part, one) in self.boxes.iter().enumerate() {
            let offsets = offsets(one.levels[0].counts);
            let x = &x[self.nodes(part)];
            for node in 0..x.len() {
                let blocks = &self.matrix[NEIGHBOURS * (self.starts[part] + node)..];
                for (block, offset) in blocks.iter().zip(&offsets) {
                    let other = usize::try_from(node as isize + offset).ok();
                    let Some(there) = other.and_then(|other| x.get(other)) else {
                        continue;
                    };
                    for (column, value) in block.chunks_exact(COMPONENTS).zip(there) {
                        let along: f64 = column.iter().zip(&x[node]).map(|(a, x)| a * x).sum();
                        sum += along * value;
                    }
                }
            }
        }
        sum
    }

    /// Numbers of the meshes among the parts, and their patterns.
    pub(super) fn of_meshes(&self) -> impl Iterator<Item = (usize, &BlockRows)> {
        let meshes = self.meshes.iter().enumerate();
        let boxes = self.boxes.len();
        meshes.map(move |(mesh, one)| (boxes + mesh, &*one.levels[0].matrix.rows))
    }

    /// Makes the grids of the present matrix.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        for (mesh, one) in self.meshes.iter_mut().enumerate() {
            let part = self.boxes.len() + mesh;
            let blocks = self.first_blocks[part]..self.first_blocks[part + 1];
            let blocks = &self.matrix[blocks];
            let level = &mut one.levels[0];
            level
                .matrix
                .write(|block| blocks[block].map(|entry| entry as f32));
            self.volumes.take_out_of_mesh(part, blocks, level);
            one.prepare()?;
        }
        for part in 0..self.boxes.len() {
            let nodes = self.nodes(part);
            let blocks = &self.matrix[NEIGHBOURS * nodes.start..NEIGHBOURS * nodes.end];
            let level = &mut self.boxes[part].levels[0];
            level.matrix.rows_mut().write(|node, row| {
                for (to, from) in row.iter_mut().zip(&blocks[NEIGHBOURS * node..]) {
                    *to = from.map(|entry| entry as f32);
                }
            });
            self.volumes.take_out(part, blocks, level);
            self.boxes[part].prepare()?;
        }
        Ok(())
    }
}

impl Operator for Parts {
    fn apply(&mut self, x: &[f32], product: &mut [f64]) {
        for part in 0..self.boxes.len() {
            let nodes = self.nodes(part);
            let counts = self.boxes[part].levels[0].counts;
            let field = &mut self.boxes[part].levels[0].x;
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            field
                .nodes_mut()
                .as_flattened_mut()
                .copy_from_slice(&x[own.clone()]);
            let blocks = &self.matrix[NEIGHBOURS * nodes.start..NEIGHBOURS * nodes.end];
            let field = &self.boxes[part].levels[0].x;
            let half = nodes.len() / 2;
            let (lower, upper) = product[own].split_at_mut(COMPONENTS * half);
            join(
                || multiply(blocks, field, offsets(counts), 0, lower),
                || multiply(blocks, field, offsets(counts), half, upper),
            );
            self.volumes.apply(part, nodes.start, x, product);
        }
        for (part, rows) in self.of_meshes() {
            let nodes = self.nodes(part);
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let (blocks, half) = (&self.matrix[self.blocks(part)], nodes.len() / 2);
            let of_part = &x[own.clone()];
            let (lower, upper) = product[own].split_at_mut(COMPONENTS * half);
            join(
                || multiply_rows(rows, blocks, of_part, 0, lower),
                || multiply_rows(rows, blocks, of_part, half, upper),
            );
            self.volumes.apply(part, nodes.start, x, product);
        }
    }

    fn precondition(&mut self, r: &[f64], x: &mut [f32]) {
        let behind = COMPONENTS * self.node_count();
        for part in 0..self.boxes.len() {
            let nodes = self.nodes(part);
            let finest = &mut self.boxes[part].levels[0];
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let field = finest.rhs.nodes_mut().as_flattened_mut();
            for (value, r) in field.iter_mut().zip(&r[own.clone()]) {
                *value = *r as f32;
            }
            let of_pressures = self.volumes.range(part);
            let of_pressures = behind + of_pressures.start..behind + of_pressures.end;
            if let Some(pressures) = &mut finest.pressures {
                let rhs = pressures.rhs.nodes_mut().iter_mut();
                for (value, r) in rhs.zip(&r[of_pressures.clone()]) {
                    *value = *r as f32;
                }
            }
            self.boxes[part].cycle();
            let finest = &self.boxes[part].levels[0];
            x[own].copy_from_slice(finest.x.nodes().as_flattened());
            if let Some(pressures) = &finest.pressures {
                x[of_pressures].copy_from_slice(pressures.p.nodes());
            }
        }
        for mesh in 0..self.meshes.len() {
            let part = self.boxes.len() + mesh;
            let nodes = self.nodes(part);
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let rhs = self.meshes[mesh].levels[0].rhs.as_flattened_mut();
            for (value, r) in rhs.iter_mut().zip(&r[own.clone()]) {
                *value = *r as f32;
            }
            let of_pressures = self.volumes.range(part);
            let of_pressures = behind + of_pressures.start..behind + of_pressures.end;
            if let Some(pressures) = &mut self.meshes[mesh].levels[0].pressures {
                for (value, r) in pressures.rhs.iter_mut().zip(&r[of_pressures.clone()]) {
                    *value = *r as f32;
                }
            }
            self.meshes[mesh].cycle();
            let finest = &self.meshes[mesh].levels[0];
            x[own].copy_from_slice(finest.x.as_flattened());
            if let Some(pressures) = &finest.pressures {
                x[of_pressures].copy_from_slice(&pressures.p);
            }
        }
    }

    fn is_reduced(&self) -> bool {
        !self.volumes.is_empty()
    }

    fn reduce(&self, residual: &mut [f64]) {
        for part in 0..self.scales.len() {
            self.volumes.condense(part, self.starts[part], residual);
        }
    }
}

/// Factors of the entries of a block.
pub(super) fn products(factors: &[f64; COMPONENTS]) -> [f64; ENTRIES] {
    std::array::from_fn(|entry| factors[entry % COMPONENTS] * factors[entry / COMPONENTS])
}

/// Writes the products of the rows of nodes from one on.
fn multiply(
    blocks: &[[f64; ENTRIES]],
    field: &Field,
    offsets: [isize; NEIGHBOURS],
    first: usize,
    product: &mut [f64],
) {
    for (row, product) in product.chunks_exact_mut(COMPONENTS).enumerate() {
        let node = first + row;
        let at = (node + field.margin) as isize;
        let mut sum = [0.0; COMPONENTS];
        for (block, offset) in blocks[NEIGHBOURS * node..][..NEIGHBOURS]
            .iter()
            .zip(&offsets)
        {
            let there = &field.values[(at + offset) as usize];
            for (column, value) in block.chunks_exact(COMPONENTS).zip(there) {
                let value = f64::from(*value);
                for (sum, entry) in sum.iter_mut().zip(column) {
                    *sum += entry * value;
                }
            }
        }
        product.copy_from_slice(&sum);
    }
}

/// Writes the products of the rows of a mesh from one on.
fn multiply_rows(
    rows: &BlockRows,
    blocks: &[NodeBlock],
    x: &[f32],
    first: usize,
    product: &mut [f64],
) {
    for (row, product) in product.chunks_exact_mut(COMPONENTS).enumerate() {
        let mut sum = [0.0; COMPONENTS];
        for block in rows.range(first + row) {
            let there = &x[COMPONENTS * rows.column(block)..][..COMPONENTS];
            for (column, value) in blocks[block].chunks_exact(COMPONENTS).zip(there) {
                let value = f64::from(*value);
                for (sum, entry) in sum.iter_mut().zip(column) {
                    *sum += entry * value;
                }
            }
        }
        product.copy_from_slice(&sum);
    }
}

// The finest grids are in the form in which products read them.
const _: () = assert!(size_of::<Block>() == 64);
