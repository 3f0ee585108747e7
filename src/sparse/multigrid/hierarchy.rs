//! Grids from the finest to the coarsest, and one V-cycle through them.

use crate::sparse::multigrid::axis::coarsening;
use crate::sparse::multigrid::field::Block;
use crate::sparse::multigrid::galerkin::{coarse_matrix, correct, restrict};
use crate::sparse::multigrid::level::Level;
use crate::sparse::multigrid::node_grid::{
    COMPONENTS, NEIGHBOURS, NodeGrid, indices, node_at, offsets,
};
use crate::sparse::multigrid::pressures::Pressures;
use crate::sparse::{Direct, Singular};

/// A grid of so few nodes is solved directly.
const COARSEST: usize = 100;

/// Grids of one box.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// Places of the node planes of the finest grid.
    pub(super) planes: [Vec<f64>; 3],
    /// Ordered, the finest first.
    pub(super) levels: Vec<Level>,
    coarsest: Direct,
    values: Vec<f64>,
    rhs: Vec<f64>,
}

impl Hierarchy {
    /// The grids of a box without matrices.
    pub(super) fn of(grid: &NodeGrid) -> Self {
        let bits = |of: &[Option<u32>; COMPONENTS]| {
            let bits = of.iter().enumerate();
            bits.fold(0, |free, (c, unknown)| {
                free | u8::from(unknown.is_some()) << c
            })
        };
        let free = grid.unknowns.iter().map(bits).collect();
        Self::new(&grid.planes, free, grid.has_pressures)
    }

    /// The grids between these planes, with a bit for each component of a node without a given value.
    pub(super) fn new(finest: &[Vec<f64>; 3], mut free: Vec<u8>, has_pressures: bool) -> Self {
        let mut planes = finest.clone();
        let mut levels = Vec::new();
        loop {
            let counts = planes.each_ref().map(Vec::len);
            let transfer = match free.len() > COARSEST {
                true => coarsening(&planes),
                false => None,
            };
            let Some(axes) = &transfer else {
                levels.push(Level::new(counts, free, None, has_pressures));
                break;
            };
            let next = [0, 1, 2].map(|axis| axes[axis].kept.len());
            let kept = |node: usize| {
                let at = indices(next, node);
                node_at(counts, [0, 1, 2].map(|axis| axes[axis].kept[at[axis]]))
            };
            let coarse = (0..next.iter().product()).map(|node| free[kept(node)]);
            let coarse = coarse.collect();
            for (planes, axis) in planes.iter_mut().zip(axes) {
                *planes = axis.kept.iter().map(|&plane| planes[plane]).collect();
            }
            levels.push(Level::new(counts, free, transfer, has_pressures));
            free = coarse;
        }
        let last = &levels[levels.len() - 1];
        let size = COMPONENTS * last.free.len();
        let entries: Vec<_> = entries(last).map(|(entry, _)| entry).collect();
        Self {
            planes: finest.clone(),
            coarsest: Direct::new(size, &entries),
            values: vec![0.0; entries.len()],
            rhs: vec![0.0; size],
            levels,
        }
    }

    /// Makes all coarse matrices from that of the finest grid.
    ///
    /// # Errors
    /// A diagonal block or the coarsest matrix is singular.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        for fine in 0..self.levels.len() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            if let Some(coarse) = below.first_mut() {
                coarse_matrix(&above[fine], coarse);
            }
            let level = &mut above[fine];
            level.invert().map_err(|column| Singular { column })?;
        }
        let last = &self.levels[self.levels.len() - 1];
        let matrix = with_volumes(last);
        for (value, ((row, col), entry)) in self.values.iter_mut().zip(entries(last)) {
            let found = matrix[entry.0][entry.1];
            *value = match found == 0.0 && row == col {
                true => 1.0,
                false => found,
            };
        }
        self.coarsest.factor(&self.values)
    }

    /// Makes the right-hand side of pressures zero.
    pub(super) fn forget_volumes(&mut self) {
        if let Some(pressures) = &mut self.levels[0].pressures {
            pressures.rhs.values.fill(0.0);
        }
    }

    /// One V-cycle for the right-hand side of the finest grid.
    pub(super) fn cycle(&mut self) {
        let coarsest = self.levels.len() - 1;
        for fine in 0..coarsest {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            above[fine].sweep_down();
            restrict(&above[fine], &mut below[0]);
        }
        let last = &mut self.levels[coarsest];
        if let Some(pressures) = &last.pressures {
            pressures.condense(&mut last.rhs);
        }
        for (value, from) in self.rhs.iter_mut().zip(last.rhs.nodes().as_flattened()) {
            *value = f64::from(*from);
        }
        self.coarsest.solve_roughly(&mut self.rhs);
        let given = last.free.iter().zip(self.rhs.chunks_exact(COMPONENTS));
        for (x, (free, from)) in last.x.nodes_mut().iter_mut().zip(given) {
            *x = std::array::from_fn(|component| match free & (1 << component) {
                0 => 0.0,
                _ => from[component] as f32,
            });
        }
        if let Some(pressures) = &mut last.pressures {
            pressures.follow(&last.x);
        }
        for fine in (0..coarsest).rev() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            correct(&mut above[fine], &below[0]);
            above[fine].sweep_up();
        }
    }

    /// Bytes of all grids.
    pub(super) fn bytes(&self) -> usize {
        let blocks = |level: &Level| level.matrix.len() + level.free.len();
        let of_pressures = |level: &Level| level.pressures.as_ref().map_or(0, Pressures::bytes);
        let of_level = |level: &Level| size_of::<Block>() * blocks(level) + of_pressures(level);
        self.levels.iter().map(of_level).sum()
    }
}

/// The matrix of a grid with the resistance to changes of volume.
fn with_volumes(level: &Level) -> Vec<[f64; COMPONENTS * COMPONENTS]> {
    let matrix = level.matrix.iter().map(|block| block.map(f64::from));
    let mut matrix: Vec<_> = matrix.collect();
    if let Some(pressures) = &level.pressures {
        pressures.add_to(&mut matrix);
    }
    matrix
}

/// Rows and columns of the entries of a matrix, with their block and their place there.
fn entries(level: &Level) -> impl Iterator<Item = ((usize, usize), (usize, usize))> + '_ {
    let counts = level.counts;
    let inside = move |node: usize, neighbour: usize| {
        let at = indices(counts, node);
        let step = |axis: usize, divisor: usize| {
            let there = at[axis] + neighbour / divisor % 3;
            (1..=counts[axis]).contains(&there)
        };
        step(0, 1) && step(1, 3) && step(2, 9)
    };
    (0..NEIGHBOURS * level.free.len())
        .filter(move |block| inside(block / NEIGHBOURS, block % NEIGHBOURS))
        .flat_map(move |block| {
            let (node, neighbour) = (block / NEIGHBOURS, block % NEIGHBOURS);
            let other = (node as isize + offsets(counts)[neighbour]) as usize;
            (0..COMPONENTS * COMPONENTS).map(move |entry| {
                let (row, col) = (entry % COMPONENTS, entry / COMPONENTS);
                let place = (COMPONENTS * node + row, COMPONENTS * other + col);
                (place, (block, entry))
            })
        })
}
