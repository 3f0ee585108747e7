//! Levels from the finest to the coarsest, and one V-cycle through them.

use crate::sparse::multigrid::node_grid::{COMPONENTS, GridLevel};
use crate::sparse::{Direct, Singular};

/// A level of so few nodes is solved directly.
pub(super) const COARSEST: usize = 100;

/// Levels of one part.
#[derive(Debug)]
pub(super) struct Hierarchy<L> {
    /// Ordered, the finest first.
    pub(super) levels: Vec<L>,
    coarsest: Direct,
    values: Vec<f64>,
    rhs: Vec<f64>,
}

impl<L: GridLevel> Hierarchy<L> {
    /// Of levels without matrices, the finest first.
    pub(super) fn new(levels: Vec<L>) -> Self {
        let last = &levels[levels.len() - 1];
        let size = COMPONENTS * last.free().len();
        let mut entries = Vec::new();
        last.visit(&mut |row, col, _| entries.push((row, col)));
        Self {
            coarsest: Direct::new(size, &entries),
            values: vec![0.0; entries.len()],
            rhs: vec![0.0; size],
            levels,
        }
    }

    /// Makes all coarse matrices from that of the finest level.
    ///
    /// # Errors
    /// A diagonal block or the coarsest matrix is singular.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        for fine in 0..self.levels.len() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            let level = &mut above[fine];
            level.invert().map_err(|column| Singular { column })?;
            if let Some(coarse) = below.first_mut() {
                level.coarsen(coarse);
            }
        }
        let mut values = self.values.iter_mut();
        self.levels[self.levels.len() - 1].visit(&mut |row, col, found| {
            let value = values.next().expect("entries are those of the pattern");
            *value = match found == 0.0 && row == col {
                true => 1.0,
                false => found,
            };
        });
        self.coarsest.factor(&self.values)
    }

    /// One V-cycle for the right-hand side of the finest level.
    pub(super) fn cycle(&mut self) {
        let coarsest = self.levels.len() - 1;
        for fine in 0..coarsest {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            above[fine].sweep_down();
            above[fine].restrict(&mut below[0]);
        }
        let last = &mut self.levels[coarsest];
        let given = last.condensed_rhs().as_flattened();
        for (value, from) in self.rhs.iter_mut().zip(given) {
            *value = f64::from(*from);
        }
        self.coarsest.solve_roughly(&mut self.rhs);
        let found = self.rhs.chunks_exact(COMPONENTS);
        last.take_solution(found.map(|x| std::array::from_fn(|component| x[component] as f32)));
        for fine in (0..coarsest).rev() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            above[fine].correct(&below[0]);
            above[fine].sweep_up();
        }
    }

    /// Bytes of all levels.
    pub(super) fn bytes(&self) -> usize {
        self.levels.iter().map(GridLevel::bytes).sum()
    }
}
