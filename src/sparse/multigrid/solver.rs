//! Solution of systems whose unknowns are components of nodes on box grids.
//!
//! The matrix is held in double precision, by blocks; the grids of the preconditioner are those of an earlier matrix as long as they cost
//! no iterations: they are made anew where a solution took more of them for each digit than the first one did.

use crate::math::{IsOver, Stopped, join};
use crate::sparse::Singular;
use crate::sparse::multigrid::field::Field;
use crate::sparse::multigrid::hierarchy::Hierarchy;
use crate::sparse::multigrid::krylov::{Iterated, Krylov, Operator};
use crate::sparse::multigrid::level::Block;
use crate::sparse::multigrid::node_grid::{
    COMPONENTS, NEIGHBOURS, NodeGrid, OWN, indices, neighbour, offsets,
};
use std::ops::Range;

/// Iterations for each digit, relative to those with fresh grids, above which grids are made anew.
const SLOWER: f64 = 1.4;
/// Entries of a block.
const ENTRIES: usize = COMPONENTS * COMPONENTS;
/// In place of an unknown.
const NONE: u32 = u32::MAX;

/// The iteration does not converge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the iteration with multigrid does not converge")]
pub struct NoSolution;

/// Counts of an iterative solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MultigridReport {
    /// Iterations of all solutions.
    pub iterations: usize,
    /// Times that the coarse matrices were made.
    pub hierarchies: usize,
    /// Number of grids of the largest box.
    pub levels: usize,
    /// Bytes of the grids of the preconditioner.
    pub bytes: usize,
}

impl MultigridReport {
    /// Adds later counts.
    pub fn add(&mut self, later: Self) {
        *self = Self {
            iterations: self.iterations + later.iterations,
            hierarchies: self.hierarchies + later.hierarchies,
            ..later
        };
    }
}

/// A solver of systems on box grids.
#[derive(Debug)]
pub struct Multigrid {
    parts: Parts,
    krylov: Krylov,
    rhs: Vec<f64>,
    x: Vec<f64>,
    /// Component of a node of each unknown; none of those that are held.
    places: Vec<u32>,
    /// Iterations for each digit with fresh grids; none before they are used.
    fresh: Option<f64>,
    is_prepared: bool,
    report: MultigridReport,
}

/// The boxes and their matrix.
#[derive(Debug)]
struct Parts {
    boxes: Vec<Hierarchy>,
    /// First node of each box, and the number of all.
    starts: Vec<usize>,
    /// Blocks by node and neighbour, each by column.
    matrix: Vec<[f64; ENTRIES]>,
    /// Factors of rows and columns of a box by component.
    scales: Vec<[f64; COMPONENTS]>,
}

impl Multigrid {
    /// A solver for the unknowns of these grids, of `size` in all; those of no grid are held at zero. `None` where there are too many nodes to
    /// count their entries.
    ///
    /// # Panics
    /// A grid has not one node for each of its places.
    pub fn new(size: usize, grids: &[NodeGrid]) -> Option<Self> {
        let (mut starts, mut places) = (vec![0], vec![NONE; size]);
        for grid in grids {
            let first = starts[starts.len() - 1];
            let nodes: usize = grid.counts().iter().product();
            assert_eq!(nodes, grid.unknowns.len(), "a box has all of its nodes");
            for (node, unknowns) in grid.unknowns.iter().enumerate() {
                for (component, unknown) in unknowns.iter().enumerate() {
                    if let Some(unknown) = unknown {
                        let place = COMPONENTS * (first + node) + component;
                        places[*unknown as usize] = place as u32;
                    }
                }
            }
            starts.push(first + nodes);
        }
        let nodes = starts[grids.len()];
        if nodes > NONE as usize / (NEIGHBOURS * ENTRIES) {
            return None;
        }
        let boxes: Vec<_> = grids.iter().map(Hierarchy::new).collect();
        let levels = boxes.iter().map(|one| one.levels.len()).max();
        let report = MultigridReport {
            levels: levels.unwrap_or(0),
            bytes: boxes.iter().map(Hierarchy::bytes).sum(),
            ..MultigridReport::default()
        };
        Some(Self {
            krylov: Krylov::new(COMPONENTS * nodes),
            rhs: vec![0.0; COMPONENTS * nodes],
            x: vec![0.0; COMPONENTS * nodes],
            parts: Parts {
                matrix: vec![[0.0; ENTRIES]; NEIGHBOURS * nodes],
                scales: vec![[1.0; COMPONENTS]; boxes.len()],
                boxes,
                starts,
            },
            places,
            fresh: None,
            is_prepared: false,
            report,
        })
    }

    /// Place of an entry among [`values_mut`](Self::values_mut); `None` where it couples what are no neighbours, or something that is held.
    pub fn slot(&self, row: usize, col: usize) -> Option<usize> {
        let [row, col] = [row, col].map(|unknown| self.places[unknown]);
        if row == NONE || col == NONE {
            return None;
        }
        let [row, col] = [row, col].map(|place| place as usize);
        let [node, other] = [row, col].map(|place| place / COMPONENTS);
        let starts = &self.parts.starts;
        let part = starts.partition_point(|&start| start <= node) - 1;
        let range = starts[part]..starts[part + 1];
        if !range.contains(&other) {
            return None;
        }
        let counts = self.parts.boxes[part].levels[0].counts;
        let [at, there] = [node, other].map(|node| indices(counts, node - range.start));
        let block = NEIGHBOURS * node + neighbour(at, there)?;
        Some(ENTRIES * block + COMPONENTS * (col % COMPONENTS) + row % COMPONENTS)
    }

    /// Returns true if an unknown is held.
    pub fn holds(&self, unknown: usize) -> bool {
        self.places[unknown] == NONE
    }

    /// Entries of the matrix, which the next solution belongs to: all of them are to be written.
    pub fn values_mut(&mut self) -> &mut [f64] {
        self.parts.matrix.as_flattened_mut()
    }

    /// Counts since the last call.
    pub fn counted(&mut self) -> MultigridReport {
        let counted = self.report;
        (self.report.iterations, self.report.hierarchies) = (0, 0);
        counted
    }

    /// Takes the values that were written.
    ///
    /// # Errors
    /// A diagonal block is singular.
    pub fn take_values(&mut self) -> Result<(), Singular> {
        if self.is_prepared {
            self.parts.scale();
            return Ok(());
        }
        self.parts.find_scales();
        self.parts.scale();
        self.prepare()
    }

    fn prepare(&mut self) -> Result<(), Singular> {
        self.parts.prepare()?;
        self.report.hierarchies += 1;
        (self.fresh, self.is_prepared) = (None, true);
        Ok(())
    }

    /// Makes the grids anew with the next values.
    pub fn forget(&mut self) {
        self.is_prepared = false;
    }

    /// Norm of a right-hand side as the iteration measures it.
    pub fn size(&mut self, rhs: &[f64]) -> f64 {
        self.load(rhs);
        crate::sparse::multigrid::krylov::norm(&self.rhs)
    }

    /// Solves in place to a residual relative to that of zero.
    ///
    /// # Errors
    /// It was time to stop, or the iteration does not converge.
    pub fn solve(
        &mut self,
        rhs: &mut [f64],
        tolerance: f64,
        is_over: IsOver<'_>,
    ) -> Result<Result<(), NoSolution>, Stopped> {
        let was_fresh = self.fresh.is_none();
        let mut iterated = self.iterate(rhs, tolerance, is_over)?;
        if !was_fresh && iterated.residual > tolerance && self.prepare().is_ok() {
            iterated = self.iterate(rhs, tolerance, is_over)?;
        }
        // NaN is no solution either.
        if !(iterated.residual <= tolerance) {
            self.is_prepared = false;
            return Ok(Err(NoSolution));
        }
        if iterated.residual > 0.0 {
            let for_digit = iterated.iterations as f64 / -iterated.residual.log10();
            let fresh = *self.fresh.get_or_insert(for_digit);
            self.is_prepared = for_digit <= SLOWER * fresh;
        }
        for (value, &place) in rhs.iter_mut().zip(&self.places) {
            *value = match place {
                NONE => 0.0,
                place => self.x[place as usize] * self.parts.scale_of(place as usize),
            };
        }
        Ok(Ok(()))
    }

    fn iterate(
        &mut self,
        rhs: &[f64],
        tolerance: f64,
        is_over: IsOver<'_>,
    ) -> Result<Iterated, Stopped> {
        self.load(rhs);
        let Self {
            parts,
            krylov,
            rhs,
            x,
            report,
            ..
        } = self;
        let iterated = krylov.solve(parts, rhs, x, tolerance, is_over)?;
        report.iterations += iterated.iterations;
        Ok(iterated)
    }

    /// Writes a right-hand side by nodes, scaled.
    fn load(&mut self, rhs: &[f64]) {
        self.rhs.fill(0.0);
        for (value, &place) in rhs.iter().zip(&self.places) {
            if place != NONE {
                let place = place as usize;
                self.rhs[place] = value * self.parts.scale_of(place);
            }
        }
    }
}

impl Parts {
    fn nodes(&self, part: usize) -> Range<usize> {
        self.starts[part]..self.starts[part + 1]
    }

    fn scale_of(&self, place: usize) -> f64 {
        let part = match self.boxes.len() {
            1 => 0,
            _ => {
                self.starts
                    .partition_point(|&start| start <= place / COMPONENTS)
                    - 1
            }
        };
        self.scales[part][place % COMPONENTS]
    }

    /// Finds scales that make the mean of the diagonal one: of all displacements of a box, and of its potentials.
    fn find_scales(&mut self) {
        for part in 0..self.boxes.len() {
            let mut sums = [[0.0; 2]; COMPONENTS];
            for node in self.nodes(part) {
                let own = &self.matrix[NEIGHBOURS * node + OWN];
                for (component, [sum, count]) in sums.iter_mut().enumerate() {
                    let diagonal = own[(COMPONENTS + 1) * component].abs();
                    *sum += diagonal;
                    *count += f64::from(u8::from(diagonal > 0.0));
                }
            }
            let scale = |parts: Range<usize>| {
                let (sum, count) = sums[parts]
                    .iter()
                    .fold((0.0, 0.0), |(s, c), [sum, count]| (s + sum, c + count));
                let mean: f64 = sum / count;
                // A power of two rounds nothing.
                if mean > 0.0 && mean.is_finite() {
                    (-0.5 * mean.log2()).round().exp2()
                } else {
                    1.0
                }
            };
            let displacement = scale(0..3);
            self.scales[part] = [displacement, displacement, displacement, scale(3..4)];
        }
    }

    /// Multiplies rows and columns by their factors.
    fn scale(&mut self) {
        for part in 0..self.boxes.len() {
            let factors = self.scales[part];
            let products: [f64; ENTRIES] = std::array::from_fn(|entry| {
                factors[entry % COMPONENTS] * factors[entry / COMPONENTS]
            });
            let blocks = self.nodes(part);
            let blocks = NEIGHBOURS * blocks.start..NEIGHBOURS * blocks.end;
            for block in &mut self.matrix[blocks] {
                for (entry, product) in block.iter_mut().zip(&products) {
                    *entry *= product;
                }
            }
        }
    }

    /// Makes the grids of the present matrix.
    fn prepare(&mut self) -> Result<(), Singular> {
        for part in 0..self.boxes.len() {
            let nodes = self.nodes(part);
            let blocks = &self.matrix[NEIGHBOURS * nodes.start..NEIGHBOURS * nodes.end];
            let finest = &mut self.boxes[part].levels[0].matrix;
            for (to, from) in finest.iter_mut().zip(blocks) {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = *from as f32;
                }
            }
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
        }
    }

    fn precondition(&mut self, r: &[f64], x: &mut [f32]) {
        for part in 0..self.boxes.len() {
            let nodes = self.nodes(part);
            let finest = &mut self.boxes[part].levels[0];
            let own = COMPONENTS * nodes.start..COMPONENTS * nodes.end;
            let field = finest.rhs.nodes_mut().as_flattened_mut();
            for (value, r) in field.iter_mut().zip(&r[own.clone()]) {
                *value = *r as f32;
            }
            self.boxes[part].cycle();
            let field = self.boxes[part].levels[0].x.nodes().as_flattened();
            x[own].copy_from_slice(field);
        }
    }
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

// The finest grids are in the form in which products read them.
const _: () = assert!(size_of::<Block>() == 64);
