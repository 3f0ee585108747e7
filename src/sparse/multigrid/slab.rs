//! Sweeps of block Gauss–Seidel over slabs of nodes, in two colours: slabs of one colour do not touch, and are swept at once.
//!
//! Slabs of a box are planes of its nodes, one above the other; a mesh is one slab. They follow from the nodes alone, so that results are the
//! same for any number of threads.

use crate::math::join;
use crate::sparse::multigrid::node_grid::{AtNode, Block, solved};
use crate::sparse::multigrid::triangles::{BlockMatrix, Couplings};
use std::ops::Range;

/// Planes of a box, and its nodes, from which on it is swept in slabs.
const PLANES: usize = 16;
const NODES: usize = 4096;
/// Slabs of such a box.
const SLABS: usize = 4;

/// Nodes that are swept one after the other, with the unknowns there and at the nodes next to them.
#[derive(Clone, Debug)]
pub(super) struct Slab {
    nodes: Range<usize>,
    /// Its nodes and those next to them.
    window: Range<usize>,
    /// True if it is swept down after its neighbours, and up before them.
    is_second: bool,
    /// Unknowns of the window.
    x: Vec<AtNode>,
}

/// Equations of the nodes of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations<'a> {
    pub(super) matrix: &'a BlockMatrix,
    /// Inverse of the diagonal blocks.
    pub(super) inverse: &'a [Block],
    pub(super) rhs: &'a [AtNode],
}

impl Slab {
    fn new(nodes: Range<usize>, window: Range<usize>, is_second: bool) -> Self {
        Self {
            x: vec![AtNode::default(); window.len()],
            nodes,
            window,
            is_second,
        }
    }

    /// So many nodes as one slab.
    pub(super) fn whole(nodes: usize) -> Vec<Self> {
        vec![Self::new(0..nodes, 0..nodes, false)]
    }

    /// The slabs of a box, from below.
    pub(super) fn of_box([n_x, n_y, n_z]: [usize; 3]) -> Vec<Self> {
        let count = match n_z >= PLANES && n_x * n_y * n_z >= NODES {
            true => SLABS,
            false => 1,
        };
        let slab = |i: usize| {
            let [start, end] = [i, i + 1].map(|i| i * n_z / count);
            let nodes = |planes: Range<usize>| n_x * n_y * planes.start..n_x * n_y * planes.end;
            let window = start.saturating_sub(1)..n_z.min(end + 1);
            Self::new(nodes(start..end), nodes(window), i % 2 == 1)
        };
        (0..count).map(slab).collect()
    }

    /// The neighbours that are swept down before a node: the first ones of those before it and of those behind it; all after them are too.
    #[inline(always)]
    fn swept(&self, [before, behind]: &[Couplings<'_>; 2]) -> [usize; 2] {
        match self.is_second {
            true => [0, place_from(behind.columns, self.nodes.end)],
            false => [
                place_from(before.columns, self.nodes.start),
                behind.columns.len(),
            ],
        }
    }
}

/// Place of the first of some ascending columns from a node on; as a rule all are before it, or none.
#[inline(always)]
fn place_from(columns: &[u32], node: usize) -> usize {
    match columns {
        [first, ..] if *first as usize >= node => 0,
        [.., last] if (*last as usize) < node => columns.len(),
        _ => columns.partition_point(|&column| (column as usize) < node),
    }
}

/// Calls `sweep` with all slabs of one colour, at once.
fn each(slabs: &mut [Slab], is_second: bool, x: &mut [AtNode], sweep: impl Fn(&mut Slab) + Sync) {
    let of_colour = |slab: &&mut Slab| slab.is_second == is_second;
    for slab in slabs.iter_mut().filter(of_colour) {
        slab.x.copy_from_slice(&x[slab.window.clone()]);
    }
    let mut of_one = slabs.iter_mut().filter(of_colour);
    match (of_one.next(), of_one.next()) {
        (Some(a), Some(b)) => _ = join(|| sweep(a), || sweep(b)),
        (Some(a), None) => sweep(a),
        _ => {}
    }
    for slab in slabs.iter().filter(|slab| slab.is_second == is_second) {
        let own = &slab.x[slab.nodes.start - slab.window.start..][..slab.nodes.len()];
        x[slab.nodes.clone()].copy_from_slice(own);
    }
}

impl Equations<'_> {
    /// A forward sweep from zero: neighbours behind have no part in it.
    pub(super) fn sweep_forward(&self, slabs: &mut [Slab], x: &mut [AtNode]) {
        for is_second in [false, true] {
            each(slabs, is_second, x, |slab| self.forward(slab));
        }
    }

    fn forward(&self, slab: &mut Slab) {
        let first = slab.window.start;
        for node in slab.nodes.clone() {
            let couplings = self.matrix.couplings(node);
            let (swept, [before, behind]) = (slab.swept(&couplings), couplings);
            let mut sum = AtNode::default();
            before.from(swept[0]).add_to(&mut sum, first, &slab.x);
            behind.from(swept[1]).add_to(&mut sum, first, &slab.x);
            slab.x[node - first] = solved(&self.inverse[node], &self.rhs[node], &sum);
        }
    }

    /// Writes what a forward sweep leaves of the right-hand side: neighbours behind have had no part in it, unless the solution was changed
    /// after it.
    pub(super) fn leave(
        &self,
        slabs: &[Slab],
        is_changed: bool,
        x: &[AtNode],
        residual: &mut [AtNode],
    ) {
        let half = residual.len() / 2;
        let (lower, upper) = residual.split_at_mut(half);
        let leave = |start: usize, residual: &mut [AtNode]| {
            let end = start + residual.len();
            for slab in slabs {
                for node in slab.nodes.start.max(start)..slab.nodes.end.min(end) {
                    residual[node - start] = match is_changed {
                        true => {
                            let product = self.matrix.product(node, x);
                            std::array::from_fn(|c| self.rhs[node][c] - product[c])
                        }
                        false => self.not_swept(slab, node, x).map(|sum| -sum),
                    };
                }
            }
        };
        join(|| leave(0, lower), || leave(half, upper));
    }

    /// The sum of the neighbours that had no part in a forward sweep.
    #[inline(always)]
    fn not_swept(&self, slab: &Slab, node: usize, x: &[AtNode]) -> AtNode {
        let couplings = self.matrix.couplings(node);
        let (swept, [before, behind]) = (slab.swept(&couplings), couplings);
        let mut sum = AtNode::default();
        before.before(swept[0]).add_to(&mut sum, 0, x);
        behind.before(swept[1]).add_to(&mut sum, 0, x);
        sum
    }

    /// A backward sweep, which reads the matrix backward too.
    pub(super) fn sweep_backward(&self, slabs: &mut [Slab], x: &mut [AtNode]) {
        for is_second in [true, false] {
            each(slabs, is_second, x, |slab| self.backward(slab));
        }
    }

    fn backward(&self, slab: &mut Slab) {
        let first = slab.window.start;
        for node in slab.nodes.clone().rev() {
            let [before, behind] = self.matrix.couplings(node);
            let mut sum = AtNode::default();
            behind.add_backward_to(&mut sum, first, &slab.x);
            before.add_backward_to(&mut sum, first, &slab.x);
            slab.x[node - first] = solved(&self.inverse[node], &self.rhs[node], &sum);
        }
    }
}
