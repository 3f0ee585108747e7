//! Pressures of elements on one level, which make multigrid serve nearly incompressible blocks.
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
//! gradients with symmetric sweeps solve for q: pressures whose signs alternate from element to element hardly move anything, and sweeps
//! alone leave them.

use crate::sparse::multigrid::node_grid::{AtNode, Block, COMPONENTS, Field, NodeBlock, add};
use std::fmt::Debug;
use std::ops::Range;

/// Residual of a correction relative to that of none, in the norm of the sweeps.
const RESIDUAL: f64 = 0.1;
/// Iterations for one correction.
const LIMIT: usize = 40;

/// Elements of a level, with the matrix S between their pressures.
pub(super) trait Elements: Debug {
    /// Zero for each element.
    fn field(&self) -> Field<f32>;

    /// Number of derivatives of all volumes by places of nodes.
    fn slopes(&self) -> usize;

    /// Those of one element.
    fn range(&self, element: usize) -> Range<usize>;

    /// Nodes of an element, in the order of its derivatives.
    fn nodes(&self, element: usize) -> impl Iterator<Item = usize>;

    /// Element of the next coarser level that one is a part of.
    fn parent(&self, element: usize) -> usize;

    /// Makes S of B, C and the inverse of the diagonal blocks.
    fn couple(&mut self, slopes: &[AtNode], compliance: &[f32], blocks: &[Block]);

    /// Entry of S on the diagonal.
    fn diagonal(&self, element: usize) -> f32;

    /// Product of one row of S.
    fn product(&self, element: usize, x: &Field<f32>) -> f32;

    /// Bytes of its lists and of those of pressures.
    fn bytes(&self) -> usize;
}

/// The pressures of a level.
#[derive(Debug)]
pub(super) struct Pressures<E> {
    pub(super) elements: E,
    /// B, by element and node.
    pub(super) slopes: Vec<AtNode>,
    /// C; zero where there is no element.
    pub(super) compliance: Vec<f32>,
    /// Inverse of the diagonal of S; zero where there is no element.
    inverse: Vec<f32>,
    /// g.
    pub(super) rhs: Field<f32>,
    pub(super) p: Field<f32>,
    residual: Field<f32>,
    correction: Field<f32>,
    /// The correction that a sweep makes of the residual.
    swept: Field<f32>,
    direction: Field<f32>,
    /// S times the direction.
    product: Field<f32>,
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += f64::from(*a) * f64::from(*b);
        }
    }
    sums.iter().sum::<f64>() + rest
}

impl<E: Elements> Pressures<E> {
    /// Pressures without values.
    pub(super) fn new(elements: E) -> Self {
        let count = elements.field().nodes().len();
        Self {
            slopes: vec![AtNode::default(); elements.slopes()],
            compliance: vec![0.0; count],
            inverse: vec![0.0; count],
            rhs: elements.field(),
            p: elements.field(),
            residual: elements.field(),
            correction: elements.field(),
            swept: elements.field(),
            direction: elements.field(),
            product: elements.field(),
            elements,
        }
    }

    /// Makes S, with the inverse of its diagonal.
    pub(super) fn prepare(&mut self, blocks: &[Block]) {
        self.elements.couple(&self.slopes, &self.compliance, blocks);
        let lists = self.inverse.iter_mut().zip(&self.compliance);
        for (element, (inverse, compliance)) in lists.enumerate() {
            *inverse = match *compliance == 0.0 {
                true => 0.0,
                false => self.elements.diagonal(element).recip(),
            };
        }
    }

    /// Makes its residual the right-hand side of the next coarser level.
    pub(super) fn restrict(&self, coarse: &mut Self) {
        let sums = coarse.rhs.nodes_mut();
        sums.fill(0.0);
        let residuals = self.residual.nodes().iter().zip(&self.compliance);
        for (element, (residual, compliance)) in residuals.enumerate() {
            if *compliance != 0.0 {
                sums[self.elements.parent(element)] += residual;
            }
        }
    }

    /// Adds the pressures of the next coarser level.
    pub(super) fn add_coarse(&mut self, coarse: &Self) {
        let lists = self.p.nodes_mut().iter_mut().zip(&self.compliance);
        for (element, (p, compliance)) in lists.enumerate() {
            if *compliance != 0.0 {
                *p += coarse.p.nodes()[self.elements.parent(element)];
            }
        }
    }

    /// B x of one element.
    #[inline(always)]
    fn along(&self, element: usize, x: &Field) -> f32 {
        let mut sums = AtNode::default();
        let slopes = self.slopes[self.elements.range(element)].iter();
        for (slopes, node) in slopes.zip(self.elements.nodes(element)) {
            let there = &x.values[x.margin + node];
            for (sum, (slope, x)) in sums.iter_mut().zip(slopes.iter().zip(there)) {
                *sum += slope * x;
            }
        }
        sums.iter().sum()
    }

    /// Adds −Bᵀ p to a field.
    pub(super) fn subtract_forces(&self, to: &mut Field) {
        self.subtract(&self.p, to);
    }

    fn subtract(&self, p: &Field<f32>, to: &mut Field) {
        for (element, p) in p.nodes().iter().enumerate() {
            let slopes = self.slopes[self.elements.range(element)].iter();
            for (slopes, node) in slopes.zip(self.elements.nodes(element)) {
                let there = &mut to.values[to.margin + node];
                for (sum, slope) in there.iter_mut().zip(slopes) {
                    *sum -= slope * p;
                }
            }
        }
    }

    /// Writes g − B x + C p.
    pub(super) fn leave(&mut self, x: &Field) {
        for element in 0..self.compliance.len() {
            let along = self.along(element, x);
            let compliance = self.compliance[element] * self.p.nodes()[element];
            self.residual.nodes_mut()[element] = self.rhs.nodes()[element] - along + compliance;
        }
    }

    /// Adds Bᵀ C⁻¹ g to forces, which makes them those of displacements alone.
    pub(super) fn condense(&mut self, forces: &mut Field) {
        let lists = self.rhs.nodes().iter().zip(&self.compliance);
        for (p, (rhs, compliance)) in self.correction.nodes_mut().iter_mut().zip(lists) {
            *p = match *compliance == 0.0 {
                true => 0.0,
                false => -(rhs / compliance),
            };
        }
        self.subtract(&self.correction, forces);
    }

    /// Makes pressures those that belong to displacements.
    pub(super) fn follow(&mut self, x: &Field) {
        for element in 0..self.compliance.len() {
            let change = self.along(element, x) - self.rhs.nodes()[element];
            self.p.nodes_mut()[element] = match self.compliance[element] == 0.0 {
                true => 0.0,
                false => change / self.compliance[element],
            };
        }
    }

    /// Adds Bᵀ C⁻¹ B to a matrix, whose block of the rows and columns of two nodes is found by `block`.
    pub(super) fn add_to(
        &self,
        matrix: &mut [NodeBlock],
        block: impl Fn(usize, usize) -> Option<usize>,
    ) {
        for (element, compliance) in self.compliance.iter().enumerate() {
            if *compliance == 0.0 {
                continue;
            }
            let factor = f64::from(*compliance).recip();
            let slopes = &self.slopes[self.elements.range(element)];
            for (row, own) in self.elements.nodes(element).zip(slopes) {
                for (column, there) in self.elements.nodes(element).zip(slopes) {
                    let block = block(row, column).expect("nodes of an element are coupled");
                    for (entry, sum) in matrix[block].iter_mut().enumerate() {
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
        self.solve();
        for (p, q) in self.p.values.iter_mut().zip(&self.correction.values) {
            *p += q;
        }
        forces.values.fill(AtNode::default());
        self.subtract(&self.correction, forces);
        for ((x, force), block) in x.nodes_mut().iter_mut().zip(forces.nodes()).zip(blocks) {
            add(x, block, force);
        }
    }

    /// Solves S q = −residual; the residual is lost.
    fn solve(&mut self) {
        let residual = self.residual.nodes_mut().iter_mut();
        residual.for_each(|value| *value = -*value);
        self.correction.values.fill(0.0);
        let mut square = self.sweep();
        self.direction.values.copy_from_slice(&self.swept.values);
        let enough = RESIDUAL * RESIDUAL * square.abs();
        for _ in 0..LIMIT {
            for element in 0..self.compliance.len() {
                let product = self.elements.product(element, &self.direction);
                self.product.nodes_mut()[element] = product;
            }
            let (direction, product) = (self.direction.nodes(), self.product.nodes());
            let factor = square / dot(direction, product);
            // Nothing is left, or nothing can be said.
            if !factor.is_finite() {
                break;
            }
            let factor = factor as f32;
            let corrections = self.correction.nodes_mut().iter_mut();
            let both = corrections.zip(self.residual.nodes_mut());
            for ((q, residual), (direction, product)) in both.zip(direction.iter().zip(product)) {
                *q += factor * direction;
                *residual -= factor * product;
            }
            let next = self.sweep();
            if next.is_nan() || next.abs() <= enough {
                break;
            }
            let ratio = (next / square) as f32;
            let directions = self.direction.nodes_mut().iter_mut();
            for (direction, swept) in directions.zip(self.swept.nodes()) {
                *direction = swept + ratio * *direction;
            }
            square = next;
        }
    }

    /// Sweeps forwards and backwards; returns the product of the residual with what that makes of it.
    fn sweep(&mut self) -> f64 {
        self.swept.values.fill(0.0);
        for element in 0..self.compliance.len() {
            self.relax(element);
        }
        for element in (0..self.compliance.len()).rev() {
            self.relax(element);
        }
        dot(self.residual.nodes(), self.swept.nodes())
    }

    /// Solves the equation of one element.
    #[inline(always)]
    fn relax(&mut self, element: usize) {
        let left = self.residual.nodes()[element] - self.elements.product(element, &self.swept);
        self.swept.nodes_mut()[element] += self.inverse[element] * left;
    }
}
