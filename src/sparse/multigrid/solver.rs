//! Solution of systems whose unknowns are components of nodes on box grids and of meshes.
//!
//! The matrix is held in double precision, by blocks; the grids of the preconditioner are those of an earlier matrix as long as they cost
//! no iterations: they are made anew where a solution took more of them for each digit than the first one did.
//!
//! Values of the matrix of a solver: the volumes of elements, and copies of all.

use crate::math::{IsOver, Stopped};
use crate::sparse::Singular;
use crate::sparse::multigrid::krylov::{Iterated, Krylov, norm};
use crate::sparse::multigrid::node_grid::{
    COMPONENTS, CORNERS, ENTRIES, ElementVolume, GridNode, NEIGHBOURS, NodeBlock, NodeGrid, PLANES,
    indices,
};
use crate::sparse::multigrid::parts::{Part, Parts, products};
use crate::sparse::multigrid::stiffness::{LowestModes, Workspace, lowest_modes};
use crate::sparse::multigrid::triangles::{BlockPlaces, NodeMesh};
use std::sync::Arc;

/// Iterations for each digit, relative to those with fresh grids, above which grids are made anew.
const SLOWER: f64 = 1.4;
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

/// A solver of systems on box grids and meshes.
#[derive(Debug)]
pub struct Multigrid {
    pub(super) parts: Parts,
    krylov: Krylov,
    rhs: Vec<f64>,
    /// The solution found last, by nodes, then by elements.
    pub(super) x: Vec<f64>,
    /// Component of a node of each unknown; none of those that are held.
    places: Vec<u32>,
    /// Iterations for each digit with fresh grids; none before they are used.
    fresh: Option<f64>,
    is_prepared: bool,
    report: MultigridReport,
}

impl Multigrid {
    /// A solver for the unknowns of these grids and meshes, of `size` in all; those of neither are held at zero. `None` where there are too many
    /// nodes to count their entries.
    ///
    /// # Panics
    /// A grid has not one node for each of its places.
    pub fn new(size: usize, grids: &[NodeGrid], meshes: &[NodeMesh]) -> Option<Self> {
        let (mut nodes, mut places) = (0, vec![NONE; size]);
        for grid in grids {
            let count: usize = grid.counts().iter().product();
            assert_eq!(count, grid.unknowns.len(), "a box has all of its nodes");
        }
        let of_grids = grids.iter().map(|grid| &grid.unknowns);
        for list in of_grids.chain(meshes.iter().map(|mesh| &mesh.unknowns)) {
            for (place, unknown) in list.as_flattened().iter().enumerate() {
                if let Some(unknown) = unknown {
                    places[*unknown as usize] = (COMPONENTS * nodes + place) as u32;
                }
            }
            nodes += list.len();
        }
        let planes = grids.iter().map(NodeGrid::counts);
        let across = planes.clone().flat_map(|[x, y, _]| [x, y]).max();
        let above: usize = planes.map(|[_, _, z]| z + 2).sum();
        if nodes > NONE as usize / NEIGHBOURS || across.max(Some(above)) > Some(PLANES) {
            return None;
        }
        let parts = Parts::new(grids, meshes);
        let report = MultigridReport {
            levels: parts.levels(),
            bytes: parts.bytes(),
            ..MultigridReport::default()
        };
        let all = COMPONENTS * nodes + parts.volumes.list.len();
        Some(Self {
            krylov: Krylov::new(all),
            rhs: vec![0.0; all],
            x: vec![0.0; all],
            parts,
            places,
            fresh: None,
            is_prepared: false,
            report,
        })
    }

    /// Places of blocks among [`lend`](Self::lend).
    pub fn block_places(&self) -> Arc<BlockPlaces> {
        self.parts.places.clone()
    }

    /// Node and component of an unknown; `None` where it is held.
    pub fn place(&self, unknown: usize) -> Option<(GridNode, usize)> {
        let place = self.places[unknown];
        if place == NONE {
            return None;
        }
        let (node, component) = (place as usize / COMPONENTS, place as usize % COMPONENTS);
        let (list, starts) = (&self.parts.list, &self.parts.starts);
        let part = starts.partition_point(|&start| start <= node) - 1;
        let Some(counts) = list[part].counts() else {
            return Some((GridNode::of_mesh(node), component));
        };
        let planes = list[..part].iter().filter_map(Part::counts);
        let below: usize = planes.map(|[_, _, z]| z + 2).sum();
        let local = node - starts[part];
        let block = self.parts.first_blocks[part] + list[part].rows().range(local).start;
        let at = indices(counts, local);
        Some((GridNode::on_box(node, block, counts, at, below), component))
    }

    /// Place of an entry among [`values_mut`](Self::values_mut); `None` where it couples what are no neighbours, or something that is held.
    pub fn slot(&self, row: usize, col: usize) -> Option<usize> {
        let (node, row) = self.place(row)?;
        let (other, col) = self.place(col)?;
        let block = self.parts.places.block(node, other)?;
        Some(ENTRIES * block + COMPONENTS * col + row)
    }

    /// Entries of the matrix, which the next solution belongs to: all of them are to be written.
    pub fn values_mut(&mut self) -> &mut [f64] {
        self.parts.matrix.as_flattened_mut()
    }

    /// The blocks of the matrix, by node and neighbour, to be written anew and handed back.
    pub fn lend(&mut self) -> Vec<NodeBlock> {
        std::mem::take(&mut self.parts.matrix)
    }

    /// Takes the blocks back; [`take_values`](Self::take_values) makes them the matrix.
    ///
    /// # Panics
    /// They are not those that were lent.
    pub fn hand_back(&mut self, matrix: Vec<NodeBlock>) {
        let blocks = self.parts.first_blocks.last();
        assert_eq!(Some(&matrix.len()), blocks, "the blocks that were lent");
        self.parts.matrix = matrix;
    }

    /// Entry on the diagonal of an unknown, as it was written; zero of one that is held.
    pub fn diagonal(&self, unknown: usize) -> f64 {
        match self.places[unknown] as usize {
            place if place == NONE as usize => 0.0,
            place => {
                let block = &self.parts.matrix[self.parts.places.diagonal(place / COMPONENTS)];
                block[(COMPONENTS + 1) * (place % COMPONENTS)]
            }
        }
    }

    /// Product of the matrix that was written with a vector on either side.
    pub fn along(&self, direction: &[f64]) -> f64 {
        let mut by_node = vec![[0.0; COMPONENTS]; self.parts.node_count()];
        for (value, &place) in direction.iter().zip(&self.places) {
            if place != NONE {
                by_node[place as usize / COMPONENTS][place as usize % COMPONENTS] = *value;
            }
        }
        self.parts.along(&by_node)
    }

    /// Leaves of the matrix that was written the entries between last components alone.
    pub fn keep_last_components(&mut self) {
        for block in &mut self.parts.matrix {
            block[..ENTRIES - 1].fill(0.0);
        }
        self.parts.volumes.list.fill(ElementVolume::default());
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

    /// Finds the lowest modes of displacements that potentials follow, of the symmetric part of the values that were taken times a factor; `None`
    /// where they are not found.
    ///
    /// # Errors
    /// It was time to stop.
    pub fn lowest_modes(
        &mut self,
        factor: f64,
        is_over: IsOver<'_>,
    ) -> Result<Option<LowestModes>, Stopped> {
        self.parts.symmetrise();
        let workspace = Workspace {
            krylov: &mut self.krylov,
            rhs: &mut self.rhs,
            x: &mut self.x,
            iterations: &mut self.report.iterations,
        };
        let Ok(Some(pairs)) = lowest_modes(&mut self.parts, workspace, factor, is_over)? else {
            return Ok(None);
        };
        let lowest = self.places.iter().map(|&place| match place as usize {
            place if place == NONE as usize => 0.0,
            place => pairs.vectors[place / COMPONENTS][0][place % COMPONENTS],
        });
        let lowest: Vec<f64> = lowest.collect();
        let largest = lowest.iter().fold(0.0, |m, value| f64::max(m, value.abs()));
        Ok(Some(LowestModes {
            bounds: std::array::from_fn(|v| pairs.residuals[v] + pairs.errors[v]),
            quotients: pairs.quotients,
            errors: pairs.errors,
            iterations: pairs.iterations,
            lowest: lowest.iter().map(|value| value / largest).collect(),
        }))
    }

    /// Makes the grids anew with the next values.
    pub fn forget(&mut self) {
        self.is_prepared = false;
    }

    /// Norm of a right-hand side as the iteration measures it.
    pub fn size(&mut self, rhs: &[f64]) -> f64 {
        self.load(rhs);
        norm(&self.rhs)
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
        if iterated.residual.is_nan() || iterated.residual > tolerance {
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
            let rows = one.rows();
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
