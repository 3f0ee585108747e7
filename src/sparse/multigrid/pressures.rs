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

use crate::sparse::multigrid::krylov::dot;
use crate::sparse::multigrid::node_grid::{AtNode, Block, COMPONENTS, CORNERS, NodeBlock, add};
use std::fmt::Debug;
use std::ops::Range;

/// Residual of a correction relative to that of none, in the norm of the sweeps.
const RESIDUAL: f64 = 0.1;
/// Iterations for one correction.
const LIMIT: usize = 40;

/// Values of elements, with room for neighbours beyond the first and the last ones.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) values: Vec<f32>,
    pub(super) margin: usize,
}

impl Field {
    /// Zero for so many elements.
    pub(super) fn new(count: usize, margin: usize) -> Self {
        Self {
            values: vec![0.0; count + 2 * margin],
            margin,
        }
    }

    /// The elements without the margins.
    pub(super) fn inner(&self) -> &[f32] {
        &self.values[self.margin..self.values.len() - self.margin]
    }

    /// The elements without the margins.
    pub(super) fn inner_mut(&mut self) -> &mut [f32] {
        let end = self.values.len() - self.margin;
        &mut self.values[self.margin..end]
    }
}

/// Interpolation from the next coarser level.
pub(super) trait Interpolation {
    /// Calls `visit` with each coarse node from which a node is interpolated, and what becomes there of a derivative by the place of the node.
    fn each_parent(&self, node: usize, slopes: &AtNode, visit: impl FnMut(usize, AtNode));
}

/// Elements of a level, with the matrix S between their pressures.
pub(super) trait Elements: Debug {
    /// Zero for each element.
    fn field(&self) -> Field;

    /// Number of derivatives of all volumes by places of nodes.
    fn slopes(&self) -> usize;

    /// Those of one element.
    fn range(&self, element: usize) -> Range<usize>;

    /// Nodes of an element, in the order of its derivatives.
    fn nodes(&self, element: usize) -> impl Iterator<Item = usize>;

    /// Elements of a node with the places of their derivatives by it, in the order in which their volumes are taken out of its row.
    fn of_node(&self, node: usize) -> impl Iterator<Item = [usize; 2]>;

    /// Element of the next coarser level that one is a part of.
    fn parent(&self, element: usize) -> usize;

    /// Number of entries of S.
    fn entries(&self) -> usize;

    /// Entry of S of two elements, each with the place of its derivative by a node of both.
    fn entry(&self, row: [usize; 2], column: [usize; 2]) -> usize;

    /// Product of the row of an element of S.
    fn product(&self, element: usize, schur: &[f32], x: &Field) -> f32;
}

/// The pressures of a level.
#[derive(Debug)]
pub(super) struct Pressures<E> {
    pub(super) elements: E,
    /// B, by element and node.
    pub(super) slopes: Vec<AtNode>,
    /// C; zero where there is no element.
    pub(super) compliance: Vec<f32>,
    /// S.
    schur: Vec<f32>,
    /// Inverse of the diagonal of S; zero where there is no element.
    inverse: Vec<f32>,
    /// g.
    pub(super) rhs: Field,
    pub(super) p: Field,
    residual: Field,
    correction: Field,
    /// The correction that a sweep makes of the residual.
    swept: Field,
    direction: Field,
    /// S times the direction.
    product: Field,
}

/// The symmetric part of a block times derivatives.
fn times_symmetric_part(block: &Block, slopes: &AtNode) -> AtNode {
    std::array::from_fn(|row| {
        let pairs = (0..COMPONENTS).map(|col| {
            let pair = [COMPONENTS * col + row, COMPONENTS * row + col].map(|entry| block[entry]);
            0.5 * (pair[0] + pair[1]) * slopes[col]
        });
        pairs.sum()
    })
}

impl<E: Elements> Pressures<E> {
    /// Pressures without values.
    pub(super) fn new(elements: E) -> Self {
        let count = elements.field().inner().len();
        Self {
            slopes: vec![AtNode::default(); elements.slopes()],
            compliance: vec![0.0; count],
            schur: vec![0.0; elements.entries()],
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

    /// Bytes of its numbers.
    pub(super) fn bytes(&self) -> usize {
        let of_element = size_of::<[f32; 9]>() * self.compliance.len();
        size_of_val(&self.slopes[..]) + size_of_val(&self.schur[..]) + of_element
    }

    /// Takes the volume of an element with these nodes.
    pub(super) fn take(
        &mut self,
        element: usize,
        nodes: &[usize; CORNERS],
        slopes: &[AtNode; CORNERS],
        compliance: f32,
    ) {
        self.compliance[element] = compliance;
        let first = self.elements.range(element).start;
        for (node, slopes) in nodes.iter().zip(slopes) {
            let place = self.elements.nodes(element).position(|own| own == *node);
            self.slopes[first + place.expect("a node of the element")] = *slopes;
        }
    }

    /// Makes S with the inverse of the diagonal blocks, and the inverse of its diagonal.
    pub(super) fn prepare(&mut self, blocks: &[Block]) {
        let Self {
            elements,
            slopes,
            compliance,
            schur,
            inverse,
            ..
        } = self;
        schur.fill(0.0);
        for (element, inverse) in inverse.iter_mut().enumerate() {
            *inverse = 0.0;
            if compliance[element] == 0.0 {
                continue;
            }
            let first = elements.range(element).start;
            let own = elements.entry([element, first], [element, first]);
            schur[own] = compliance[element];
            for (place, node) in (first..).zip(elements.nodes(element)) {
                let moved = times_symmetric_part(&blocks[node], &slopes[place]);
                for other in elements.of_node(node) {
                    let products = moved.iter().zip(&slopes[other[1]]).map(|(a, b)| a * b);
                    schur[elements.entry([element, place], other)] += products.sum::<f32>();
                }
            }
            *inverse = schur[own].recip();
        }
    }

    /// Writes the slopes and compliances of the next coarser level, where an element takes in those that it consists of; `free` has a bit for
    /// each component of its nodes that moves.
    pub(super) fn coarsen(
        &self,
        interpolation: &impl Interpolation,
        free: &[u8],
        coarse: &mut Self,
    ) {
        coarse.slopes.fill(AtNode::default());
        coarse.compliance.fill(0.0);
        for (element, compliance) in self.compliance.iter().enumerate() {
            if *compliance == 0.0 {
                continue;
            }
            let parent = self.elements.parent(element);
            coarse.compliance[parent] += compliance;
            let first = coarse.elements.range(parent).start;
            let places = self
                .elements
                .range(element)
                .zip(self.elements.nodes(element));
            for (place, node) in places {
                interpolation.each_parent(node, &self.slopes[place], |node, moved| {
                    let to = coarse.elements.nodes(parent).position(|own| own == node);
                    let to = &mut coarse.slopes[first + to.expect("a node of the element")];
                    for (component, sum) in to.iter_mut().enumerate() {
                        if free[node] & 1 << component != 0 {
                            *sum += moved[component];
                        }
                    }
                });
            }
        }
    }

    /// Makes its residual the right-hand side of the next coarser level.
    pub(super) fn restrict(&self, coarse: &mut Self) {
        let sums = coarse.rhs.inner_mut();
        sums.fill(0.0);
        let residuals = self.residual.inner().iter().zip(&self.compliance);
        for (element, (residual, compliance)) in residuals.enumerate() {
            if *compliance != 0.0 {
                sums[self.elements.parent(element)] += residual;
            }
        }
    }

    /// Adds the pressures of the next coarser level.
    pub(super) fn add_coarse(&mut self, coarse: &Self) {
        let lists = self.p.inner_mut().iter_mut().zip(&self.compliance);
        for (element, (p, compliance)) in lists.enumerate() {
            if *compliance != 0.0 {
                *p += coarse.p.inner()[self.elements.parent(element)];
            }
        }
    }

    /// B x of one element; zero where there is no element, as its nodes may lie beyond the list.
    #[inline(always)]
    fn along(&self, element: usize, x: &[AtNode]) -> f32 {
        let mut sums = AtNode::default();
        if self.compliance[element] == 0.0 {
            return 0.0;
        }
        let slopes = self.slopes[self.elements.range(element)].iter();
        for (slopes, node) in slopes.zip(self.elements.nodes(element)) {
            let there = &x[node];
            for (sum, (slope, x)) in sums.iter_mut().zip(slopes.iter().zip(there)) {
                *sum += slope * x;
            }
        }
        sums.iter().sum()
    }

    /// Adds −Bᵀ p to a field.
    pub(super) fn subtract_forces(&self, to: &mut [AtNode]) {
        self.subtract(&self.p, to);
    }

    fn subtract(&self, p: &Field, to: &mut [AtNode]) {
        let there = |(element, _): &(usize, &f32)| self.compliance[*element] != 0.0;
        for (element, p) in p.inner().iter().enumerate().filter(there) {
            let slopes = self.slopes[self.elements.range(element)].iter();
            for (slopes, node) in slopes.zip(self.elements.nodes(element)) {
                for (sum, slope) in to[node].iter_mut().zip(slopes) {
                    *sum -= slope * p;
                }
            }
        }
    }

    /// Writes g − B x + C p.
    pub(super) fn leave(&mut self, x: &[AtNode]) {
        for element in 0..self.compliance.len() {
            let along = self.along(element, x);
            let compliance = self.compliance[element] * self.p.inner()[element];
            self.residual.inner_mut()[element] = self.rhs.inner()[element] - along + compliance;
        }
    }

    /// Adds Bᵀ C⁻¹ g to forces, which makes them those of displacements alone.
    pub(super) fn condense(&mut self, forces: &mut [AtNode]) {
        let lists = self.rhs.inner().iter().zip(&self.compliance);
        for (p, (rhs, compliance)) in self.correction.inner_mut().iter_mut().zip(lists) {
            *p = match *compliance == 0.0 {
                true => 0.0,
                false => -(rhs / compliance),
            };
        }
        self.subtract(&self.correction, forces);
    }

    /// Makes pressures those that belong to displacements.
    pub(super) fn follow(&mut self, x: &[AtNode]) {
        for element in 0..self.compliance.len() {
            let change = self.along(element, x) - self.rhs.inner()[element];
            self.p.inner_mut()[element] = match self.compliance[element] == 0.0 {
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
    pub(super) fn correct(&mut self, x: &mut [AtNode], blocks: &[Block], forces: &mut [AtNode]) {
        self.leave(x);
        self.solve();
        for (p, q) in self.p.values.iter_mut().zip(&self.correction.values) {
            *p += q;
        }
        forces.fill(AtNode::default());
        self.subtract(&self.correction, forces);
        for ((x, force), block) in x.iter_mut().zip(&*forces).zip(blocks) {
            add(x, block, force);
        }
    }

    /// Solves S q = −residual; the residual is lost.
    fn solve(&mut self) {
        let residual = self.residual.inner_mut().iter_mut();
        residual.for_each(|value| *value = -*value);
        self.correction.values.fill(0.0);
        let mut square = self.sweep();
        self.direction.values.copy_from_slice(&self.swept.values);
        let enough = RESIDUAL * RESIDUAL * square.abs();
        for _ in 0..LIMIT {
            for element in 0..self.compliance.len() {
                let product = self.elements.product(element, &self.schur, &self.direction);
                self.product.inner_mut()[element] = product;
            }
            let (direction, product) = (self.direction.inner(), self.product.inner());
            let factor = square / dot(direction, product);
            // Nothing is left, or nothing can be said.
            if !factor.is_finite() {
                break;
            }
            let factor = factor as f32;
            let corrections = self.correction.inner_mut().iter_mut();
            let both = corrections.zip(self.residual.inner_mut());
            for ((q, residual), (direction, product)) in both.zip(direction.iter().zip(product)) {
                *q += factor * direction;
                *residual -= factor * product;
            }
            let next = self.sweep();
            if next.is_nan() || next.abs() <= enough {
                break;
            }
            let ratio = (next / square) as f32;
            let directions = self.direction.inner_mut().iter_mut();
            for (direction, swept) in directions.zip(self.swept.inner()) {
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
        dot(self.residual.inner(), self.swept.inner())
    }

    /// Solves the equation of one element.
    #[inline(always)]
    fn relax(&mut self, element: usize) {
        let product = self.elements.product(element, &self.schur, &self.swept);
        let left = self.residual.inner()[element] - product;
        self.swept.inner_mut()[element] += self.inverse[element] * left;
    }
}
