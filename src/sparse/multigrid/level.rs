//! One grid of the hierarchy: its matrix in single precision and the sweeps of block Gauss–Seidel.
//!
//! Entries of blocks are by column. Rows and columns of components with given values are zero.

use crate::math::join;
use crate::sparse::multigrid::axis::Axis;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, Field, NEIGHBOURS, inverse_of, offsets,
};
use crate::sparse::multigrid::pressures::Pressures;
use crate::sparse::multigrid::slab::{Equations, Slab, slabs, split};
use crate::sparse::multigrid::triangles::Triangles;

/// A grid of the hierarchy.
#[derive(Debug)]
pub(super) struct Level {
    /// Places of the node planes.
    pub(super) planes: [Vec<f64>; 3],
    pub(super) counts: [usize; 3],
    offsets: [isize; NEIGHBOURS],
    /// For each node, a bit for each component without a given value.
    pub(super) free: Vec<u8>,
    pub(super) matrix: Triangles,
    /// Inverse of the diagonal blocks; rows and columns of given values are zero.
    inverse: Vec<Block>,
    /// Transfer to the next coarser grid; none of the coarsest.
    pub(super) transfer: Option<[Axis; 3]>,
    pub(super) rhs: Field,
    pub(super) x: Field,
    pub(super) residual: Field,
    /// Pressures of elements, where they resist changes of volume.
    pub(super) pressures: Option<Pressures>,
    slabs: Vec<Slab>,
}

impl Level {
    /// A grid of the nodes at these planes without a matrix.
    pub(super) fn new(
        planes: [Vec<f64>; 3],
        free: Vec<u8>,
        transfer: Option<[Axis; 3]>,
        has_pressures: bool,
    ) -> Self {
        let (nodes, counts) = (free.len(), planes.each_ref().map(Vec::len));
        Self {
            planes,
            offsets: offsets(counts),
            matrix: Triangles::of_grid(nodes),
            inverse: vec![[0.0; COMPONENTS * COMPONENTS]; nodes],
            rhs: Field::new(counts),
            x: Field::new(counts),
            residual: Field::new(counts),
            slabs: slabs(counts),
            pressures: has_pressures.then(|| Pressures::new(counts)),
            counts,
            free,
            transfer,
        }
    }

    /// Inverts the diagonal blocks; returns the node whose block is singular, if there is one.
    pub(super) fn invert(&mut self) -> Result<(), usize> {
        for field in [&mut self.rhs, &mut self.x, &mut self.residual] {
            field.values.fill([0.0; COMPONENTS]);
        }
        for (node, inverse) in self.inverse.iter_mut().enumerate() {
            *inverse = inverse_of(self.matrix.diagonal(node)).ok_or(node)?;
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.prepare(&self.inverse);
        }
        Ok(())
    }

    /// Calls `sweep` with all slabs of one colour, at once.
    fn each(&mut self, is_second: bool, sweep: impl Fn(&Equations<'_>, &mut Slab) + Sync) {
        let Self {
            counts, x, slabs, ..
        } = self;
        let of_colour = |slab: &&mut Slab| slab.is_second == is_second;
        for slab in slabs.iter_mut().filter(of_colour) {
            slab.take(*counts, x);
        }
        let equations = Equations {
            counts: *counts,
            offsets: &self.offsets,
            matrix: &self.matrix,
            inverse: &self.inverse,
            rhs: &self.rhs,
        };
        let mut of_one = slabs.iter_mut().filter(of_colour);
        match (of_one.next(), of_one.next()) {
            (Some(a), Some(b)) => _ = join(|| sweep(&equations, a), || sweep(&equations, b)),
            (Some(a), None) => sweep(&equations, a),
            _ => {}
        }
        for slab in slabs.iter().filter(|slab| slab.is_second == is_second) {
            slab.hand_back(*counts, x);
        }
    }

    /// A forward sweep from zero, then what it leaves of the right-hand side: the neighbours behind have had no part in it.
    pub(super) fn sweep_down(&mut self) {
        for is_second in [false, true] {
            self.each(is_second, |equations, slab| equations.forward(slab));
        }
        let has_pressures = self.correct_pressures(true);
        let equations = Equations {
            counts: self.counts,
            offsets: &self.offsets,
            matrix: &self.matrix,
            inverse: &self.inverse,
            rhs: &self.rhs,
        };
        let (counts, x) = (self.counts, &self.x);
        let (lower, upper) = self.slabs.split_at(self.slabs.len() / 2);
        let nodes = upper[0].first_node(counts);
        let (below, above) = self.residual.nodes_mut().split_at_mut(nodes);
        let leave = |slabs: &[Slab], residual: &mut [[f32; COMPONENTS]]| {
            for (slab, residual) in split(slabs, counts, residual) {
                match has_pressures {
                    true => equations.leave_all(slab, x, residual),
                    false => equations.leave(slab, x, residual),
                }
            }
        };
        match lower.is_empty() {
            true => leave(upper, above),
            false => _ = join(|| leave(lower, below), || leave(upper, above)),
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.subtract_forces(&mut self.residual);
            pressures.leave(&self.x);
        }
    }

    /// Corrects pressures behind a sweep, from zero or from those there are; returns false where there are none.
    fn correct_pressures(&mut self, is_from_zero: bool) -> bool {
        let Some(pressures) = &mut self.pressures else {
            return false;
        };
        if is_from_zero {
            pressures.p.values.fill(0.0);
        }
        pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        true
    }

    /// A backward sweep; pressures act as forces.
    pub(super) fn sweep_up(&mut self) {
        if let Some(pressures) = &self.pressures {
            pressures.subtract_forces(&mut self.rhs);
        }
        for is_second in [true, false] {
            self.each(is_second, |equations, slab| equations.backward(slab));
        }
        self.correct_pressures(false);
    }
}
