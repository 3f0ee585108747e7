//! Sweeps of block Gauss–Seidel over slabs of node planes, in two colours: slabs of one colour do not touch, and are swept at once.
//!
//! Slabs follow from the grid alone, so that results are the same for any number of threads.

use crate::sparse::multigrid::node_grid::{AtNode, Block, Field, NEIGHBOURS, OWN, add, solved};
use crate::sparse::multigrid::triangles::Triangles;
use std::ops::Range;

/// Neighbours before a node in its plane come behind those in the plane below, those behind it there before those in the plane above.
const BELOW: usize = 9;
const BESIDE: usize = OWN - BELOW;
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
    pub(super) matrix: &'a Triangles,
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

    /// The neighbours that are swept down before the nodes of a plane: the first ones of those before a node and of those behind it; all
    /// after them are too.
    fn swept(&self, plane: usize) -> [usize; 2] {
        let is_below = plane > self.planes.start || self.is_second;
        let is_above = plane + 1 == self.planes.end && self.is_second;
        [
            if is_below { 0 } else { BELOW },
            if is_above { BESIDE } else { OWN },
        ]
    }
}

impl Equations<'_> {
    /// Nodes of a plane.
    fn nodes(&self, plane: usize) -> Range<usize> {
        let [n_x, n_y, _] = self.counts;
        n_x * n_y * plane..n_x * n_y * (plane + 1)
    }

    /// Some of the blocks of a node with the neighbours before it, and the way to these in a list.
    #[inline(always)]
    fn lower(
        &self,
        node: usize,
        of: Range<usize>,
    ) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let offsets = &self.offsets[..OWN];
        self.matrix
            .lower(places(node, &of))
            .iter()
            .zip(&offsets[of])
    }

    /// Some of the blocks of a node with the neighbours behind it, and the way to these in a list.
    #[inline(always)]
    fn upper(
        &self,
        node: usize,
        of: Range<usize>,
    ) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let offsets = &self.offsets[OWN + 1..];
        self.matrix
            .upper(places(node, &of))
            .iter()
            .zip(&offsets[of])
    }

    /// The values of a node, of which its neighbours have this sum.
    #[inline(always)]
    fn solved(&self, node: usize, sum: &AtNode) -> AtNode {
        let rhs = &self.rhs.values[node + self.rhs.margin];
        solved(&self.inverse[node], rhs, sum)
    }

    /// Place in a slab of the first node of one of its planes.
    fn first_place(&self, slab: &Slab, plane: usize) -> usize {
        slab.x.margin + self.nodes(plane + 1 - slab.planes.start).start
    }

    /// A forward sweep over a slab from zero: neighbours behind have no part in it.
    pub(super) fn forward(&self, slab: &mut Slab) {
        for plane in slab.planes.clone() {
            let first = self.first_place(slab, plane);
            let [lower, upper] = slab.swept(plane);
            for (place, node) in self.nodes(plane).enumerate() {
                let (at, x) = (first + place, &slab.x.values[..]);
                let mut sum = AtNode::default();
                add_all(&mut sum, self.lower(node, lower..OWN), at, x);
                add_all(&mut sum, self.upper(node, upper..OWN), at, x);
                slab.x.values[first + place] = self.solved(node, &sum);
            }
        }
    }

    /// Writes the part of the right-hand side that a forward sweep over a slab leaves, node by node.
    pub(super) fn leave(&self, slab: &Slab, x: &Field, residual: &mut [AtNode]) {
        let nodes = slab.planes.clone().flat_map(|plane| {
            let swept = slab.swept(plane);
            self.nodes(plane).map(move |node| (node, swept))
        });
        for ((node, [lower, upper]), residual) in nodes.zip(residual) {
            let (at, x) = (node + x.margin, &x.values[..]);
            let mut sum = AtNode::default();
            add_all(&mut sum, self.lower(node, 0..lower), at, x);
            add_all(&mut sum, self.upper(node, 0..upper), at, x);
            *residual = sum.map(|s| -s);
        }
    }

    /// Writes what any field leaves of the right-hand side at the nodes of a slab.
    pub(super) fn leave_all(&self, slab: &Slab, x: &Field, residual: &mut [AtNode]) {
        let nodes = slab.planes.clone().flat_map(|plane| self.nodes(plane));
        for (node, residual) in nodes.zip(residual) {
            let (at, x) = (node + x.margin, &x.values[..]);
            let mut sum = AtNode::default();
            add_all(&mut sum, self.lower(node, 0..OWN), at, x);
            add(&mut sum, self.matrix.diagonal(node), &x[at]);
            add_all(&mut sum, self.upper(node, 0..OWN), at, x);
            let rhs = self.rhs.values[node + self.rhs.margin];
            *residual = std::array::from_fn(|c| rhs[c] - sum[c]);
        }
    }

    /// A backward sweep over a slab, which reads the matrix backward too.
    pub(super) fn backward(&self, slab: &mut Slab) {
        for plane in slab.planes.clone().rev() {
            let first = self.first_place(slab, plane);
            for (place, node) in self.nodes(plane).enumerate().rev() {
                let (at, x) = (first + place, &slab.x.values[..]);
                let mut sum = AtNode::default();
                add_all(&mut sum, self.upper(node, 0..OWN).rev(), at, x);
                add_all(&mut sum, self.lower(node, 0..OWN).rev(), at, x);
                slab.x.values[first + place] = self.solved(node, &sum);
            }
        }
    }
}

/// Places in a triangle of some neighbours of a node.
fn places(node: usize, of: &Range<usize>) -> Range<usize> {
    OWN * node + of.start..OWN * node + of.end
}

/// A block, and the way to the unknowns that it multiplies.
type Coupling<'m> = (&'m Block, &'m isize);

/// Adds blocks times unknowns of neighbours; the node is at a place in a list of these.
#[inline(always)]
fn add_all<'m>(
    sum: &mut AtNode,
    couplings: impl Iterator<Item = Coupling<'m>>,
    at: usize,
    x: &[AtNode],
) {
    for (block, offset) in couplings {
        add(sum, block, &x[(at as isize + offset) as usize]);
    }
}

/// Splits a list by node into those of the slabs.
pub(super) fn split<'l>(
    slabs: &'l [Slab],
    [n_x, n_y, _]: [usize; 3],
    list: &'l mut [AtNode],
) -> impl Iterator<Item = (&'l Slab, &'l mut [AtNode])> {
    let mut rest = list;
    slabs.iter().map(move |slab| {
        let (own, behind) = std::mem::take(&mut rest).split_at_mut(n_x * n_y * slab.planes.len());
        rest = behind;
        (slab, own)
    })
}
