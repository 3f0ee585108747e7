//! Box grids and meshes side by side: their matrix in double precision, by blocks, with its product and its preconditioner.

use crate::sparse::Singular;
use crate::sparse::multigrid::aggregation::Aggregation;
use crate::sparse::multigrid::grid::Trilinear;
use crate::sparse::multigrid::krylov::Operator;
use crate::sparse::multigrid::level::Hierarchy;
use crate::sparse::multigrid::node_grid::{
    AtNode, Block, COMPONENTS, ENTRIES, NodeBlock, NodeGrid, VolumePlaces, add_double, corners,
};
use crate::sparse::multigrid::triangles::{BlockPlaces, BlockRows, NodeMesh};
use crate::sparse::multigrid::volumes::{Volumes, scale_of_mean};
use std::ops::Range;
use std::sync::Arc;

/// The levels of a box or a mesh.
#[derive(Debug)]
pub(super) enum Part {
    Box(Hierarchy<Trilinear>),
    Mesh(Hierarchy<Aggregation>),
}

/// Evaluates an expression of the levels of a part, whatever they are.
macro_rules! of_levels {
    ($part:expr, $one:ident => $value:expr) => {
        match $part {
            Part::Box($one) => $value,
            Part::Mesh($one) => $value,
        }
    };
}

impl Part {
    /// Number of planes along each axis; `None` of a mesh.
    pub(super) fn counts(&self) -> Option<[usize; 3]> {
        match self {
            Self::Box(one) => Some(one.nodes.each_ref().map(Vec::len)),
            Self::Mesh(_) => None,
        }
    }

    /// Pattern of the matrix.
    pub(super) fn rows(&self) -> &Arc<BlockRows> {
        of_levels!(self, one => &one.levels[0].matrix.rows)
    }

    /// The levels without matrices of scalars at the same nodes, a component each; `free` has a bit for each one without a given value.
    pub(super) fn of_scalars(&self, free: Vec<u8>) -> Self {
        match self {
            Self::Box(one) => {
                let rows = self.rows().clone();
                Self::Box(Hierarchy::between(&one.nodes, rows, free, false))
            }
            Self::Mesh(one) => Self::Mesh(one.of_scalars(free)),
        }
    }

    /// Writes the blocks of the finest matrix, which count row by row.
    pub(super) fn write(&mut self, of: impl Fn(usize) -> Block) {
        of_levels!(self, one => one.levels[0].matrix.write(of));
    }

    /// For each node, a bit for each component without a given value.
    pub(super) fn free(&self) -> &[u8] {
        of_levels!(self, one => &one.levels[0].free)
    }

    /// Makes the matrices of all levels from that of the finest one.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        of_levels!(self, one => one.prepare())
    }

    /// One V-cycle.
    pub(super) fn cycle(&mut self) {
        of_levels!(self, one => one.cycle());
    }

    /// Its right-hand side.
    pub(super) fn rhs_mut(&mut self) -> &mut [AtNode] {
        of_levels!(self, one => &mut one.levels[0].rhs)
    }

    /// Its solution.
    pub(super) fn x(&self) -> &[AtNode] {
        of_levels!(self, one => &one.levels[0].x)
    }

    /// The right-hand side of pressures; nothing where there are none.
    fn rhs_of_pressures_mut(&mut self) -> &mut [f32] {
        of_levels!(self, one => match &mut one.levels[0].pressures {
            Some(pressures) => pressures.rhs.inner_mut(),
            None => &mut [],
        })
    }

    /// The pressures; nothing where there are none.
    fn pressures(&self) -> &[f32] {
        of_levels!(self, one => match &one.levels[0].pressures {
            Some(pressures) => pressures.p.inner(),
            None => &[],
        })
    }
}

/// The boxes, the meshes behind them, and their matrix.
#[derive(Debug)]
pub(super) struct Parts {
    pub(super) list: Vec<Part>,
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
    pub(super) fn new(grids: &[NodeGrid], meshes: &[NodeMesh]) -> Self {
        let mut volumes = Volumes::default();
        let mut list = Vec::new();
        for grid in grids {
            let count = match grid.has_pressures {
                true => grid.unknowns.len(),
                false => 0,
            };
            volumes.add(count, VolumePlaces::Box(corners(grid.counts())));
            list.push(Part::Box(Hierarchy::of(grid)));
        }
        for mesh in meshes {
            let part = Part::Mesh(Hierarchy::of_mesh(mesh));
            let elements = match mesh.has_pressures {
                true => &mesh.elements[..],
                false => &[],
            };
            let places = VolumePlaces::of_mesh(elements, part.free());
            volumes.add(elements.len(), places);
            list.push(part);
        }
        let (mut starts, mut first_blocks) = (vec![0], vec![0]);
        let mut places = BlockPlaces::default();
        for (part, one) in list.iter().enumerate() {
            let (node, block) = (starts[part], first_blocks[part]);
            starts.push(node + one.free().len());
            first_blocks.push(block + one.rows().blocks());
            places.parts.push((node, block, one.rows().clone()));
        }
        Self {
            matrix: vec![[0.0; ENTRIES]; first_blocks[list.len()]],
            scales: vec![[1.0; COMPONENTS]; list.len()],
            volumes,
            places: Arc::new(places),
            list,
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
        let counts = self.list.iter();
        let counts = counts.map(|part| of_levels!(part, one => one.levels.len()));
        counts.max().unwrap_or(0)
    }

    /// Bytes of all levels.
    pub(super) fn bytes(&self) -> usize {
        let parts = self.list.iter();
        parts.map(|part| of_levels!(part, one => one.bytes())).sum()
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
        for (part, one) in self.list.iter().enumerate() {
            let (x, blocks) = (&x[self.nodes(part)], &self.matrix[self.blocks(part)]);
            for (block, (node, other)) in blocks.iter().zip(one.rows().entries()) {
                for (column, value) in block.chunks_exact(COMPONENTS).zip(&x[other]) {
                    let along: f64 = column.iter().zip(&x[node]).map(|(a, x)| a * x).sum();
                    sum += along * value;
                }
            }
        }
        sum
    }

    /// Makes the grids of the present matrix.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        for part in 0..self.list.len() {
            let blocks = self.blocks(part);
            let (blocks, one) = (&self.matrix[blocks], &mut self.list[part]);
            one.write(|block| blocks[block].map(|entry| entry as f32));
            let volumes = &mut self.volumes;
            of_levels!(one, one => volumes.take_out(part, blocks, &mut one.levels[0]));
            one.prepare()?;
        }
        Ok(())
    }
}

impl Operator for Parts {
    fn apply(&mut self, x: &[f32], product: &mut [f64]) {
        for part in 0..self.list.len() {
            let nodes = self.nodes(part);
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let (rows, blocks) = (self.list[part].rows(), &self.matrix[self.blocks(part)]);
            let (x_of_part, _) = x[own.clone()].as_chunks();
            let (product_of_part, _) = product[own].as_chunks_mut();
            rows.multiply(blocks, x_of_part, product_of_part, add_double::<f32>);
            self.volumes.apply(part, nodes.start, x, product);
        }
    }

    fn precondition(&mut self, r: &[f64], x: &mut [f32]) {
        let behind = COMPONENTS * self.node_count();
        for part in 0..self.list.len() {
            let (nodes, volumes) = (self.nodes(part), self.volumes.range(part));
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let of_pressures = behind + volumes.start..behind + volumes.end;
            let one = &mut self.list[part];
            let rhs = one.rhs_mut().as_flattened_mut().iter_mut();
            for (value, r) in rhs.zip(&r[own.clone()]) {
                *value = *r as f32;
            }
            let rhs = one.rhs_of_pressures_mut().iter_mut();
            for (value, r) in rhs.zip(&r[of_pressures.clone()]) {
                *value = *r as f32;
            }
            one.cycle();
            x[own].copy_from_slice(one.x().as_flattened());
            x[of_pressures].copy_from_slice(one.pressures());
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

// The finest grids are in the form in which products read them.
const _: () = assert!(size_of::<Block>() == 64);
