//! The grids of a box, from the finest to the coarsest.

use crate::sparse::multigrid::axis::coarsening;
use crate::sparse::multigrid::galerkin::{coarse_matrix, correct, restrict};
use crate::sparse::multigrid::hierarchy::{COARSEST, Hierarchy};
use crate::sparse::multigrid::level::Level;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, GridLevel, NEIGHBOURS, NodeGrid, free_components, indices, node_at, offsets,
};
use crate::sparse::multigrid::pressures::Pressures;

impl Hierarchy<Level> {
    /// The grids of a box without matrices.
    pub(super) fn of(grid: &NodeGrid) -> Self {
        let free = grid.unknowns.iter().map(free_components).collect();
        Self::between(&grid.planes, free, grid.has_pressures)
    }

    /// The grids between these planes, with a bit for each component of a node without a given value.
    pub(super) fn between(finest: &[Vec<f64>; 3], mut free: Vec<u8>, has_pressures: bool) -> Self {
        let mut planes = finest.clone();
        let mut levels = Vec::new();
        loop {
            let transfer = match free.len() > COARSEST {
                true => coarsening(&planes),
                false => None,
            };
            let Some(axes) = &transfer else {
                levels.push(Level::new(planes, free, None, has_pressures));
                return Self::new(levels);
            };
            let counts = planes.each_ref().map(Vec::len);
            let next = [0, 1, 2].map(|axis| axes[axis].kept.len());
            let kept = |node: usize| {
                let at = indices(next, node);
                node_at(counts, [0, 1, 2].map(|axis| axes[axis].kept[at[axis]]))
            };
            let coarse = (0..next.iter().product()).map(|node| free[kept(node)]);
            let coarse = coarse.collect();
            let of_axis = |axis: usize| {
                let kept = axes[axis].kept.iter();
                kept.map(|&plane| planes[axis][plane]).collect()
            };
            let coarse_planes = [0, 1, 2].map(of_axis);
            levels.push(Level::new(planes, free, transfer, has_pressures));
            (planes, free) = (coarse_planes, coarse);
        }
    }
}

impl GridLevel for Level {
    fn invert(&mut self) -> Result<(), usize> {
        Self::invert(self)
    }

    fn coarsen(&mut self, coarse: &mut Self) {
        coarse_matrix(self, coarse);
    }

    fn sweep_down(&mut self) {
        Self::sweep_down(self);
    }

    fn restrict(&self, coarse: &mut Self) {
        restrict(self, coarse);
    }

    fn correct(&mut self, coarse: &Self) {
        correct(self, coarse);
    }

    fn sweep_up(&mut self) {
        Self::sweep_up(self);
    }

    fn free(&self) -> &[u8] {
        &self.free
    }

    fn condensed_rhs(&mut self) -> &[[f32; COMPONENTS]] {
        if let Some(pressures) = &self.pressures {
            pressures.condense(&mut self.rhs);
        }
        self.rhs.nodes()
    }

    fn take_solution(&mut self, found: impl Iterator<Item = [f32; COMPONENTS]>) {
        let given = self.free.iter().zip(found);
        for (x, (free, from)) in self.x.nodes_mut().iter_mut().zip(given) {
            *x = std::array::from_fn(|component| match free & (1 << component) {
                0 => 0.0,
                _ => from[component],
            });
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.follow(&self.x);
        }
    }

    fn visit(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let with_volumes = self.pressures.as_ref().map(|pressures| {
            let mut matrix = Vec::with_capacity(self.matrix.blocks());
            let rows = (0..self.free.len()).flat_map(|node| self.matrix.grid_row(node));
            matrix.extend(rows.map(|block| block.map(f64::from)));
            pressures.add_to(&mut matrix);
            matrix
        });
        let offsets = offsets(self.counts);
        for node in 0..self.free.len() {
            for (neighbour, block) in self.matrix.grid_row(node).enumerate() {
                if !is_inside(self.counts, node, neighbour) {
                    continue;
                }
                let block = match &with_volumes {
                    Some(matrix) => matrix[NEIGHBOURS * node + neighbour],
                    None => block.map(f64::from),
                };
                let other = (node as isize + offsets[neighbour]) as usize;
                for (entry, value) in block.iter().enumerate() {
                    let (row, col) = (entry % COMPONENTS, entry / COMPONENTS);
                    visit(COMPONENTS * node + row, COMPONENTS * other + col, *value);
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        let of_pressures = self.pressures.as_ref().map_or(0, Pressures::bytes);
        size_of::<Block>() * (self.matrix.blocks() + self.free.len()) + of_pressures
    }
}

/// Returns true if a neighbour of a node is a node of the grid.
fn is_inside(counts: [usize; 3], node: usize, neighbour: usize) -> bool {
    let at = indices(counts, node);
    let step = |axis: usize, divisor: usize| {
        let there = at[axis] + neighbour / divisor % 3;
        (1..=counts[axis]).contains(&there)
    };
    step(0, 1) && step(1, 3) && step(2, 9)
}
