//! Sweeps of block Gauss–Seidel over slabs of node planes, in two colours: slabs of one colour do not touch, and are swept at once.
//!
//! Slabs follow from the grid alone, so that results are the same for any number of threads.

use crate::sparse::multigrid::field::{Block, Field, add};
use crate::sparse::multigrid::node_grid::{COMPONENTS, NEIGHBOURS, OWN};
use std::ops::Range;

/// Neighbours in the plane below come before the others, then those of the own plane.
const BELOW: usize = 9;
const ABOVE: usize = 18;
/// Planes of a grid, and its nodes, from which on it is swept in slabs.
const PLANES: usize = 16;
const NODES: usize = 4096;
/// Slabs of such a grid.
const SLABS: usize = 4;

/// Node planes one above the other, with the unknowns there and in the planes next to them.
#[derive(Clone, Debug)]
pub(super) struct Slab {
    planes: Range<usize>,
    /// True if it is swept down after its neighbours, and up before them.
    pub(super) is_second: bool,
    x: Field,
}

/// Equations of the nodes of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equations<'a> {
    pub(super) counts: [usize; 3],
    pub(super) offsets: &'a [isize; NEIGHBOURS],
    pub(super) matrix: &'a [Block],
    /// Inverse of the diagonal blocks.
    pub(super) inverse: &'a [Block],
    pub(super) rhs: &'a Field,
}

/// The slabs of a grid, from below.
pub(super) fn slabs([n_x, n_y, n_z]: [usize; 3]) -> Vec<Slab> {
    let count = match n_z >= PLANES && n_x * n_y * n_z >= NODES {
        true => SLABS,
        false => 1,
    };
    let slab = |i: usize| {
        let planes = i * n_z / count..(i + 1) * n_z / count;
        Slab {
            is_second: i % 2 == 1,
            x: Field::new([n_x, n_y, planes.len() + 2]),
            planes,
        }
    };
    (0..count).map(slab).collect()
}

impl Slab {
    /// The first node of its planes.
    pub(super) fn first_node(&self, [n_x, n_y, _]: [usize; 3]) -> usize {
        n_x * n_y * self.planes.start
    }

    /// Takes the unknowns of its planes and of those next to them.
    pub(super) fn take(&mut self, [n_x, n_y, n_z]: [usize; 3], x: &Field) {
        let plane = n_x * n_y;
        let first = self.planes.start.saturating_sub(1);
        let from = plane * first..plane * n_z.min(self.planes.end + 1);
        // Its own planes begin behind one.
        let to = plane * (first + 1 - self.planes.start);
        self.x.nodes_mut()[to..to + from.len()].copy_from_slice(&x.nodes()[from]);
    }

    /// Hands back the unknowns of its planes.
    pub(super) fn hand_back(&self, [n_x, n_y, _]: [usize; 3], x: &mut Field) {
        let plane = n_x * n_y;
        let to = plane * self.planes.start..plane * self.planes.end;
        let from = &self.x.nodes()[plane..plane + to.len()];
        x.nodes_mut()[to].copy_from_slice(from);
    }

    /// Returns true if the planes below, and above, one of its own are swept down before it.
    fn swept(&self, plane: usize) -> [bool; 2] {
        let is_last = plane + 1 == self.planes.end;
        [
            plane > self.planes.start || self.is_second,
            is_last && self.is_second,
        ]
    }
}

impl Equations<'_> {
    /// Nodes of a plane.
    fn nodes(&self, plane: usize) -> Range<usize> {
        let [n_x, n_y, _] = self.counts;
        n_x * n_y * plane..n_x * n_y * (plane + 1)
    }

    /// Sum over neighbours of a node of their blocks times their unknowns; the node is at a place in a list of these.
    #[inline(always)]
    fn sum(
        &self,
        node: usize,
        (at, x): (usize, &[[f32; COMPONENTS]]),
        neighbours: impl Iterator<Item = usize>,
    ) -> [f32; COMPONENTS] {
        let blocks = &self.matrix[NEIGHBOURS * node..][..NEIGHBOURS];
        let mut sum = [0.0; COMPONENTS];
        for neighbour in neighbours {
            let there = (at as isize + self.offsets[neighbour]) as usize;
            add(&mut sum, &blocks[neighbour], &x[there]);
        }
        sum
    }

    /// Solves the equations of a node, of which its neighbours have this sum.
    #[inline(always)]
    fn solved(&self, node: usize, sum: [f32; COMPONENTS]) -> [f32; COMPONENTS] {
        let rhs = self.rhs.values[node + self.rhs.margin];
        let left: [f32; COMPONENTS] = std::array::from_fn(|c| rhs[c] - sum[c]);
        let mut solution = [0.0; COMPONENTS];
        add(&mut solution, &self.inverse[node], &left);
        solution
    }

    /// Place in a slab of the first node of one of its planes.
    fn first_place(&self, slab: &Slab, plane: usize) -> usize {
        slab.x.margin + self.nodes(plane + 1 - slab.planes.start).start
    }

    /// A forward sweep over a slab from zero: neighbours behind have no part in it.
    pub(super) fn forward(&self, slab: &mut Slab) {
        for plane in slab.planes.clone() {
            let first = self.first_place(slab, plane);
            let swept = slab.swept(plane);
            for (place, node) in self.nodes(plane).enumerate() {
                let at = first + place;
                let x = (at, &slab.x.values[..]);
                let sum = match swept {
                    [true, false] => self.sum(node, x, 0..OWN),
                    [true, true] => self.sum(node, x, (0..OWN).chain(ABOVE..NEIGHBOURS)),
                    [false, _] => self.sum(node, x, BELOW..OWN),
                };
                slab.x.values[at] = self.solved(node, sum);
            }
        }
    }

    /// Writes the part of the right-hand side that a forward sweep over a slab leaves, node by node.
    pub(super) fn leave(&self, slab: &Slab, x: &Field, residual: &mut [[f32; COMPONENTS]]) {
        let nodes = slab.planes.clone().flat_map(|plane| {
            let swept = slab.swept(plane);
            self.nodes(plane).map(move |node| (node, swept))
        });
        for ((node, swept), residual) in nodes.zip(residual) {
            let x = (node + x.margin, &x.values[..]);
            let sum = match swept {
                [true, false] => self.sum(node, x, OWN + 1..NEIGHBOURS),
                [true, true] => self.sum(node, x, OWN + 1..ABOVE),
                [false, _] => self.sum(node, x, (0..BELOW).chain(OWN + 1..NEIGHBOURS)),
            };
            *residual = sum.map(|s| -s);
        }
    }

    /// Writes what any field leaves of the right-hand side at the nodes of a slab.
    pub(super) fn leave_all(&self, slab: &Slab, x: &Field, residual: &mut [[f32; COMPONENTS]]) {
        let nodes = slab.planes.clone().flat_map(|plane| self.nodes(plane));
        for (node, residual) in nodes.zip(residual) {
            let sum = self.sum(node, (node + x.margin, &x.values), 0..NEIGHBOURS);
            let rhs = self.rhs.values[node + self.rhs.margin];
            *residual = std::array::from_fn(|c| rhs[c] - sum[c]);
        }
    }

    /// A backward sweep over a slab.
    pub(super) fn backward(&self, slab: &mut Slab) {
        for plane in slab.planes.clone().rev() {
            let first = self.first_place(slab, plane);
            for (place, node) in self.nodes(plane).enumerate().rev() {
                let at = first + place;
                let others = (0..OWN).chain(OWN + 1..NEIGHBOURS);
                let sum = self.sum(node, (at, &slab.x.values), others);
                slab.x.values[at] = self.solved(node, sum);
            }
        }
    }
}

/// Splits a list by node into those of the slabs.
pub(super) fn split<'l>(
    slabs: &'l [Slab],
    [n_x, n_y, _]: [usize; 3],
    list: &'l mut [[f32; COMPONENTS]],
) -> impl Iterator<Item = (&'l Slab, &'l mut [[f32; COMPONENTS]])> {
    let mut rest = list;
    slabs.iter().map(move |slab| {
        let (own, behind) = std::mem::take(&mut rest).split_at_mut(n_x * n_y * slab.planes.len());
        rest = behind;
        (slab, own)
    })
}
