//! Pressures of elements on one grid, which make multigrid serve nearly incompressible blocks.
//!
//! A matrix A + Bᵀ C⁻¹ B has the derivatives B of the volumes of elements, and a great stiffness C⁻¹ against their changes. Multigrid
//! of this sum stalls; of displacements u and pressures p with
//!
//! ```text
//! A u + Bᵀ p = f,      B u − C p = g
//! ```
//!
//! it does not. Behind a sweep over displacements S q = B u − C p − g gives a correction q of pressures, and −D⁻¹ Bᵀ q that of
//! displacements, with the diagonal blocks D of A and S = C + B D⁻¹ Bᵀ (D. Braess, R. Sarazin, Appl. Numer. Math. 23, 1997). Conjugate
//! gradients solve for q: pressures whose signs alternate from element to element hardly move anything, and sweeps alone leave them.
//!
//! Elements count like their first nodes; there is none where a node is a last one along an axis.

use crate::sparse::multigrid::axis::Axis;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, CORNERS, Field, NEIGHBOURS, OWN, corners, indices, neighbour_of, node_at,
};
use crate::sparse::multigrid::pressure_correction::{Lists, Schur, correct};

/// Rows of neighbours, three in each.
const ROWS: usize = NEIGHBOURS / 3;

type Slopes = [[f32; COMPONENTS]; CORNERS];

/// The pressures of a grid.
#[derive(Debug)]
pub(super) struct Pressures {
    counts: [usize; 3],
    corners: [usize; CORNERS],
    /// B, by element.
    pub(super) slopes: Vec<Slopes>,
    /// C; zero where there is no element.
    pub(super) compliance: Vec<f32>,
    /// S, by element and neighbour.
    schur: Vec<[f32; NEIGHBOURS]>,
    /// Inverse of its diagonal; zero where there is no element.
    inverse: Vec<f32>,
    /// g.
    pub(super) rhs: Field<f32>,
    pub(super) p: Field<f32>,
    pub(super) residual: Field<f32>,
    correction: Field<f32>,
    swept: Field<f32>,
    direction: Field<f32>,
    product: Field<f32>,
}

impl Pressures {
    /// Pressures without values of a grid of so many nodes.
    pub(super) fn new(counts: [usize; 3]) -> Self {
        let nodes = counts.iter().product();
        let field = || Field::new(counts);
        Self {
            counts,
            corners: corners(counts),
            slopes: vec![Slopes::default(); nodes],
            compliance: vec![0.0; nodes],
            schur: vec![[0.0; NEIGHBOURS]; nodes],
            inverse: vec![0.0; nodes],
            rhs: field(),
            p: field(),
            residual: field(),
            correction: field(),
            swept: field(),
            direction: field(),
            product: field(),
        }
    }

    /// Bytes of its lists.
    pub(super) fn bytes(&self) -> usize {
        let of_one = size_of::<Slopes>() + size_of::<[f32; NEIGHBOURS + 9]>();
        self.slopes.len() * of_one
    }

    /// Makes S, with the inverse of the diagonal blocks.
    pub(super) fn prepare(&mut self, blocks: &[Block]) {
        for element in 0..self.slopes.len() {
            let row = &mut self.schur[element];
            row.fill(0.0);
            row[OWN] = self.compliance[element];
            if self.compliance[element] == 0.0 {
                self.inverse[element] = 0.0;
                continue;
            }
            for corner in 0..CORNERS {
                let node = element + self.corners[corner];
                let own = &self.slopes[element][corner];
                let block = &blocks[node];
                let moved: [f32; COMPONENTS] = std::array::from_fn(|row| {
                    let entry = |col: usize| block[COMPONENTS * col + row];
                    let turned = |col: usize| block[COMPONENTS * row + col];
                    let each =
                        (0..COMPONENTS).map(|col| 0.5 * (entry(col) + turned(col)) * own[col]);
                    each.sum()
                });
                for of_other in 0..CORNERS {
                    let Some(other) = node.checked_sub(self.corners[of_other]) else {
                        continue;
                    };
                    // The node is one corner of both.
                    let neighbour = neighbour_of(of_other, corner);
                    let there = &self.slopes[other][of_other];
                    let product: f32 = moved.iter().zip(there).map(|(a, b)| a * b).sum();
                    row[neighbour] += product;
                }
            }
            self.inverse[element] = row[OWN].recip();
        }
    }

    /// Writes the slopes and compliances of a coarser grid: an element takes in those that it consists of.
    pub(super) fn coarsen(&self, axes: &[Axis; 3], coarse: &mut Self) {
        coarse.slopes.fill(Slopes::default());
        coarse.compliance.fill(0.0);
        for (element, slopes) in self.slopes.iter().enumerate() {
            let Some(parent) = self.parent(axes, element) else {
                continue;
            };
            let to = node_at(coarse.counts, parent);
            coarse.compliance[to] += self.compliance[element];
            let at = indices(self.counts, element);
            for (corner, slopes) in slopes.iter().enumerate() {
                let weights = [0, 1, 2].map(|axis| {
                    let plane = at[axis] + (corner >> axis & 1);
                    let mut weights = [0.0; 2];
                    for &(coarse, weight) in &axes[axis].parents[plane] {
                        if weight > 0.0 {
                            weights[coarse - parent[axis]] += weight;
                        }
                    }
                    weights
                });
                for of_coarse in 0..CORNERS {
                    let weight: f32 = (0..3)
                        .map(|axis| weights[axis][of_coarse >> axis & 1])
                        .product();
                    for (sum, slope) in coarse.slopes[to][of_coarse].iter_mut().zip(slopes) {
                        *sum += weight * slope;
                    }
                }
            }
        }
    }

    /// Leaves out the slopes by values that are given on this grid; `free` has a bit for each component of a node that is not.
    pub(super) fn hold(&mut self, free: &[u8]) {
        for (element, slopes) in self.slopes.iter_mut().enumerate() {
            for (slopes, corner) in slopes.iter_mut().zip(&self.corners) {
                let free = free.get(element + corner).copied().unwrap_or_default();
                for (component, slope) in slopes.iter_mut().enumerate() {
                    if free & (1 << component) == 0 {
                        *slope = 0.0;
                    }
                }
            }
        }
    }

    /// Axis indices of the coarser element that an element is part of; `None` where there is no element.
    fn parent(&self, axes: &[Axis; 3], element: usize) -> Option<[usize; 3]> {
        if self.compliance[element] == 0.0 {
            return None;
        }
        let at = indices(self.counts, element);
        let below = |axis: usize| axes[axis].kept.partition_point(|&kept| kept <= at[axis]) - 1;
        Some([below(0), below(1), below(2)])
    }

    /// Makes its residual the right-hand side of a coarser grid.
    pub(super) fn restrict(&self, axes: &[Axis; 3], coarse: &mut Self) {
        coarse.rhs.nodes_mut().fill(0.0);
        for (element, residual) in self.residual.nodes().iter().enumerate() {
            if let Some(parent) = self.parent(axes, element) {
                coarse.rhs.nodes_mut()[node_at(coarse.counts, parent)] += residual;
            }
        }
    }

    /// Adds the pressures of a coarser grid.
    pub(super) fn add_coarse(&mut self, axes: &[Axis; 3], coarse: &Self) {
        for element in 0..self.slopes.len() {
            if let Some(parent) = self.parent(axes, element) {
                let found = coarse.p.nodes()[node_at(coarse.counts, parent)];
                self.p.nodes_mut()[element] += found;
            }
        }
    }

    /// B x of one element.
    #[inline(always)]
    fn along(&self, element: usize, x: &Field) -> f32 {
        let mut sums = [0.0; COMPONENTS];
        for (slopes, corner) in self.slopes[element].iter().zip(&self.corners) {
            let there = &x.values[x.margin + element + corner];
            for (sum, (slope, x)) in sums.iter_mut().zip(slopes.iter().zip(there)) {
                *sum += slope * x;
            }
        }
        sums.iter().sum()
    }

    /// Adds −Bᵀ p to a field.
    pub(super) fn subtract_forces(&self, to: &mut Field) {
        Self::subtract(&self.slopes, &self.corners, &self.p, to);
    }

    fn subtract(slopes: &[Slopes], corners: &[usize; CORNERS], p: &Field<f32>, to: &mut Field) {
        for (element, (slopes, p)) in slopes.iter().zip(p.nodes()).enumerate() {
            for (slopes, corner) in slopes.iter().zip(corners) {
                let there = &mut to.values[to.margin + element + corner];
                for (sum, slope) in there.iter_mut().zip(slopes) {
                    *sum -= slope * p;
                }
            }
        }
    }

    /// Writes g − B x + C p.
    pub(super) fn leave(&mut self, x: &Field) {
        for element in 0..self.slopes.len() {
            let along = self.along(element, x);
            let compliance = self.compliance[element] * self.p.nodes()[element];
            self.residual.nodes_mut()[element] = self.rhs.nodes()[element] - along + compliance;
        }
    }

    /// Adds Bᵀ C⁻¹ g to forces, which makes them those of displacements alone.
    pub(super) fn condense(&self, forces: &mut Field) {
        for (element, slopes) in self.slopes.iter().enumerate() {
            if self.compliance[element] == 0.0 {
                continue;
            }
            let p = self.rhs.nodes()[element] / self.compliance[element];
            for (slopes, corner) in slopes.iter().zip(&self.corners) {
                let there = &mut forces.values[forces.margin + element + corner];
                for (sum, slope) in there.iter_mut().zip(slopes) {
                    *sum += slope * p;
                }
            }
        }
    }

    /// Makes pressures those that belong to displacements.
    pub(super) fn follow(&mut self, x: &Field) {
        for element in 0..self.slopes.len() {
            let change = self.along(element, x) - self.rhs.nodes()[element];
            self.p.nodes_mut()[element] = match self.compliance[element] == 0.0 {
                true => 0.0,
                false => change / self.compliance[element],
            };
        }
    }

    /// Adds Bᵀ C⁻¹ B to a matrix.
    pub(super) fn add_to(&self, matrix: &mut [[f64; COMPONENTS * COMPONENTS]]) {
        for (element, slopes) in self.slopes.iter().enumerate() {
            if self.compliance[element] == 0.0 {
                continue;
            }
            let factor = f64::from(self.compliance[element]).recip();
            for (corner, own) in slopes.iter().enumerate() {
                let rows = NEIGHBOURS * (element + self.corners[corner]);
                for (other, there) in slopes.iter().enumerate() {
                    let block = &mut matrix[rows + neighbour_of(corner, other)];
                    for (entry, sum) in block.iter_mut().enumerate() {
                        let pair = [own[entry % COMPONENTS], there[entry / COMPONENTS]];
                        *sum += factor * f64::from(pair[0]) * f64::from(pair[1]);
                    }
                }
            }
        }
    }

    /// Corrects pressures, and displacements; `forces` is overwritten, `blocks` are the inverse of the diagonal ones.
    pub(super) fn correct(&mut self, x: &mut Field, blocks: &[Block], forces: &mut Field) {
        self.leave(x);
        correct(self);
        for (p, q) in self.p.values.iter_mut().zip(&self.correction.values) {
            *p += q;
        }
        forces.values.fill([0.0; COMPONENTS]);
        Self::subtract(&self.slopes, &self.corners, &self.correction, forces);
        for ((x, force), block) in x.nodes_mut().iter_mut().zip(forces.nodes()).zip(blocks) {
            super::node_grid::add(x, block, force);
        }
    }

    /// First places in a list of each row of neighbours of an element.
    #[inline(always)]
    fn rows(&self, element: usize) -> [usize; ROWS] {
        let [n_x, n_y, _] = self.counts;
        // The margin keeps them in the list.
        let first = self.swept.margin + element - n_x * n_y - n_x - 1;
        std::array::from_fn(|row| first + n_x * (row % 3 + n_y * (row / 3)))
    }

    /// Solves the equation of one element.
    #[inline(always)]
    fn relax(&mut self, element: usize) {
        let rows = self.rows(element);
        let at = self.swept.margin + element;
        let x = &mut self.swept.values;
        let own = x[at];
        let mut sums = [0.0; ROWS];
        for (row, sum) in sums.iter_mut().enumerate() {
            let entries = &self.schur[element][3 * row..3 * row + 3];
            let there = &x[rows[row]..rows[row] + 3];
            *sum = entries[0] * there[0] + entries[1] * there[1] + entries[2] * there[2];
        }
        let sum: f32 = sums.iter().sum();
        x[at] = own + self.inverse[element] * (self.residual.values[at] - sum);
    }
}

impl Schur for Pressures {
    fn lists(&mut self) -> Lists<'_> {
        Lists {
            residual: self.residual.nodes_mut(),
            correction: self.correction.nodes_mut(),
            swept: self.swept.nodes_mut(),
            direction: self.direction.nodes_mut(),
            product: self.product.nodes_mut(),
        }
    }

    fn multiply(&mut self) {
        for element in 0..self.schur.len() {
            let rows = self.rows(element);
            let x = &self.direction.values;
            let mut sums = [0.0; ROWS];
            for (row, sum) in sums.iter_mut().enumerate() {
                let entries = &self.schur[element][3 * row..3 * row + 3];
                let there = &x[rows[row]..rows[row] + 3];
                *sum = entries[0] * there[0] + entries[1] * there[1] + entries[2] * there[2];
            }
            self.product.nodes_mut()[element] = sums.iter().sum();
        }
    }

    fn sweep(&mut self) {
        self.swept.values.fill(0.0);
        for element in 0..self.schur.len() {
            self.relax(element);
        }
        for element in (0..self.schur.len()).rev() {
            self.relax(element);
        }
    }
}
