//! The stiffness of displacements that potentials follow, and its lowest modes, of the matrix of a solver.
//!
//! With a matrix c [[K, B], [Bᵀ, −C]] of displacements u and potentials, potentials that follow are C⁻¹ Bᵀ u, and the stiffness is K + B C⁻¹ Bᵀ.

use crate::math::{IsOver, Random, Stopped};
use crate::sparse::Singular;
use crate::sparse::multigrid::krylov::Krylov;
use crate::sparse::multigrid::lobpcg::{AtNode, COUNT, Pairs, SymmetricMatrix, lowest};
use crate::sparse::multigrid::node_grid::{COMPONENTS, NodeBlock, add_double};
use crate::sparse::multigrid::parts::{Part, Parts};
use crate::sparse::multigrid::potentials::{POTENTIAL, Potentials};

/// Rounding of a product, relative to the largest entry of the diagonal.
const ROUNDING: f64 = 1e-13;
/// Residual of corrections of nearly incompressible blocks, relative to that of none.
const OF_CORRECTION: f64 = 1e-2;
/// Least number of iterations with such corrections, which are inverse iterations, and with those of one cycle.
const LEAST: [usize; 2] = [4, 8];

/// The lowest modes of a stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct LowestModes {
    /// Quotients of the vectors found, ascending: the lowest eigenvalue is not above the first one.
    pub quotients: [f64; COUNT],
    /// Distance of each within which there is an eigenvalue.
    pub bounds: [f64; COUNT],
    /// Errors of the quotients themselves.
    pub errors: [f64; COUNT],
    /// Iterations.
    pub iterations: usize,
    /// The first vector by unknown, with a largest entry of one; zero at potentials.
    pub lowest: Vec<f64>,
}

impl LowestModes {
    /// Number of eigenvalues below zero, as far as the vectors show it: none only where bounds keep all of them above zero; `None` where
    /// nothing is shown.
    pub fn below_zero(&self) -> Option<usize> {
        let pairs = self.quotients.iter().zip(&self.errors);
        let below = pairs.filter(|(quotient, error)| *quotient + *error < 0.0);
        let mut bounded = self.quotients.iter().zip(&self.bounds);
        match below.count() {
            0 => bounded
                .all(|(quotient, bound)| quotient > bound)
                .then_some(0),
            count => Some(count),
        }
    }
}

/// The stiffness, as a factor times a matrix.
struct Stiffness<'p> {
    parts: &'p mut Parts,
    factor: f64,
    rounding: f64,
    vectors: Vec<AtNode>,
    by_potentials: Vec<AtNode>,
    potentials: Option<Potentials>,
    workspace: Workspace<'p>,
}

/// Storage of solutions with the whole matrix, as they are made for any right-hand side.
pub(super) struct Workspace<'p> {
    pub(super) krylov: &'p mut Krylov,
    pub(super) rhs: &'p mut [f64],
    pub(super) x: &'p mut [f64],
    /// Iterations so far.
    pub(super) iterations: &'p mut usize,
}

/// Finds the lowest modes of a factor times a matrix, whose grids are made.
pub(super) fn lowest_modes(
    parts: &mut Parts,
    workspace: Workspace<'_>,
    factor: f64,
    is_over: IsOver<'_>,
) -> Result<Result<Option<Pairs>, Singular>, Stopped> {
    let potentials = match Potentials::new(parts, -factor.signum()) {
        Ok(found) => found,
        Err(singular) => return Ok(Err(singular)),
    };
    let mut random = Random::new(1);
    let mut start = Vec::new();
    for free in parts.free() {
        let mut at = AtNode::default();
        for component in (0..POTENTIAL).filter(|c| free & 1 << c != 0) {
            for vector in &mut at {
                vector[component] = random.between(-1.0, 1.0);
            }
        }
        start.push(at);
    }
    let mut stiffness = Stiffness {
        vectors: vec![AtNode::default(); start.len()],
        by_potentials: vec![AtNode::default(); if potentials.is_some() { start.len() } else { 0 }],
        rounding: ROUNDING * factor.abs() * parts.largest_diagonal(),
        potentials,
        factor,
        parts,
        workspace,
    };
    lowest(&mut stiffness, start, is_over).map(Ok)
}

impl Parts {
    /// Largest entry on the diagonal of displacements, without scales.
    fn largest_diagonal(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for (node, scales) in self.scales_by_node().enumerate() {
            let own = &self.matrix[self.places.diagonal(node)];
            for component in 0..POTENTIAL {
                let entry = own[(COMPONENTS + 1) * component].abs();
                largest = largest.max(entry / scales[component].powi(2));
            }
        }
        largest
    }

    /// Factors of rows and columns by component, node by node.
    fn scales_by_node(&self) -> impl Iterator<Item = &[f64; COMPONENTS]> {
        let parts = self.scales.iter().enumerate();
        parts.flat_map(|(part, scales)| std::iter::repeat_n(scales, self.nodes(part).len()))
    }

    /// For each node, a bit for each component without a given value.
    pub(super) fn free(&self) -> impl Iterator<Item = u8> {
        self.list.iter().flat_map(Part::free).copied()
    }
}

impl Stiffness<'_> {
    /// Multiplies the vectors.
    fn multiply(&self, product: &mut [AtNode]) {
        for (part, one) in self.parts.list.iter().enumerate() {
            let blocks = &self.parts.matrix[self.parts.blocks(part)];
            let nodes = self.parts.nodes(part);
            let (vectors, product) = (&self.vectors[nodes.clone()], &mut product[nodes]);
            one.rows().multiply(blocks, vectors, product, add);
        }
    }

    /// Returns true if corrections are solutions, and not what one cycle makes.
    ///
    /// One cycle leaves changes of volumes that a great stiffness makes greater than the residual.
    fn are_solutions(&self) -> bool {
        !self.parts.volumes.is_empty() || self.parts.list.iter().any(|part| part.counts().is_none())
    }

    /// Lets potentials follow the displacements with these products, and adds what they do; returns the lengths of that times the part of it that may be off.
    fn follow(
        &mut self,
        product: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<Option<[f64; COUNT]>, Stopped> {
        let Some(potentials) = &mut self.potentials else {
            return Ok(Some([0.0; COUNT]));
        };
        let sign = self.factor.signum();
        let rhs = product.iter().map(|at| at.map(|v| sign * v[POTENTIAL]));
        let Some(relative) = potentials.solve(rhs, is_over)? else {
            return Ok(None);
        };
        for (at, found) in self.vectors.iter_mut().zip(&potentials.solution) {
            for (vector, potential) in at.iter_mut().zip(found) {
                *vector = [0.0; COMPONENTS];
                vector[POTENTIAL] = *potential;
            }
        }
        let mut added = std::mem::take(&mut self.by_potentials);
        self.multiply(&mut added);
        let mut squares = [0.0; COUNT];
        let lists = product.iter_mut().zip(&added);
        for ((product, added), scales) in lists.zip(self.parts.scales_by_node()) {
            for v in 0..COUNT {
                for c in 0..POTENTIAL {
                    product[v][c] += added[v][c];
                    squares[v] += (added[v][c] * self.factor / scales[c]).powi(2);
                }
            }
        }
        self.by_potentials = added;
        Ok(Some(std::array::from_fn(|v| {
            relative[v] * squares[v].sqrt()
        })))
    }
}

impl SymmetricMatrix for Stiffness<'_> {
    fn apply(
        &mut self,
        x: &[AtNode],
        product: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<Option<[f64; COUNT]>, Stopped> {
        if is_over() {
            return Err(Stopped);
        }
        let lists = self.vectors.iter_mut().zip(x);
        for ((to, from), scales) in lists.zip(self.parts.scales_by_node()) {
            *to = from.map(|vector| std::array::from_fn(|c| vector[c] / scales[c]));
        }
        self.multiply(product);
        let Some(errors) = self.follow(product, is_over)? else {
            return Ok(None);
        };
        for (vectors, scales) in product.iter_mut().zip(self.parts.scales_by_node()) {
            for vector in vectors {
                for c in 0..POTENTIAL {
                    vector[c] *= self.factor / scales[c];
                }
                vector[POTENTIAL] = 0.0;
            }
        }
        Ok(Some(errors.map(|error| error + self.rounding)))
    }

    fn least_iterations(&self) -> usize {
        LEAST[usize::from(!self.are_solutions())]
    }

    fn precondition(
        &mut self,
        r: &[AtNode],
        x: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<(), Stopped> {
        for v in 0..COUNT {
            let squares = r.iter().flat_map(|at| at[v]).map(|value| value * value);
            let length = squares.sum::<f64>().sqrt();
            let unit = if length > 0.0 { length.recip() } else { 0.0 };
            match self.are_solutions() {
                true => self.solve(r, unit, v, x, is_over)?,
                false => self.cycle(r, unit, v, x),
            }
        }
        Ok(())
    }
}

impl Stiffness<'_> {
    /// Writes what one cycle makes of a multiple of the residual of a vector.
    fn cycle(&mut self, r: &[AtNode], unit: f64, v: usize, x: &mut [AtNode]) {
        for (part, one) in self.parts.list.iter_mut().enumerate() {
            let scales = &self.parts.scales[part];
            let nodes = self.parts.starts[part]..self.parts.starts[part + 1];
            for (to, from) in one.rhs_mut().iter_mut().zip(&r[nodes.clone()]) {
                *to = std::array::from_fn(|c| (unit * from[v][c] * scales[c]) as f32);
            }
            one.cycle();
            for (to, from) in x[nodes].iter_mut().zip(one.x()) {
                to[v] = std::array::from_fn(|c| f64::from(from[c]) * scales[c]);
                to[v][POTENTIAL] = 0.0;
            }
        }
    }

    /// Writes the solution for a multiple of the residual of a vector, potentials and pressures following, of the accuracy of a correction.
    fn solve(
        &mut self,
        r: &[AtNode],
        unit: f64,
        v: usize,
        x: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<(), Stopped> {
        let Workspace {
            krylov,
            rhs,
            x: found,
            iterations,
        } = &mut self.workspace;
        rhs.fill(0.0);
        for (node, scales) in self.parts.scales_by_node().enumerate() {
            for c in 0..POTENTIAL {
                rhs[COMPONENTS * node + c] = unit * r[node][v][c] * scales[c];
            }
        }
        let iterated = krylov.solve(self.parts, rhs, found, OF_CORRECTION, is_over)?;
        **iterations += iterated.iterations;
        for (node, scales) in self.parts.scales_by_node().enumerate() {
            let found = &found[COMPONENTS * node..];
            x[node][v] = std::array::from_fn(|c| found[c] * scales[c]);
            x[node][v][POTENTIAL] = 0.0;
        }
        Ok(())
    }
}

/// Adds a block times the vectors at a node.
#[inline(always)]
fn add(sums: &mut AtNode, block: &NodeBlock, there: &AtNode) {
    for (sum, vector) in sums.iter_mut().zip(there) {
        add_double(sum, block, vector);
    }
}
