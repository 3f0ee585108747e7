//! The lowest eigenvalues of a symmetric matrix with a preconditioner, four at once, by LOBPCG (A. V. Knyazev, SIAM J. Sci. Comput. 23, 2001).
//!
//! Each iteration finds the best vectors among combinations of the present ones, their preconditioned residuals, and the last changes. An
//! eigenvalue is within the length of the residual A x − θ x of the quotient θ of a vector x of length one.

use crate::math::{IsOver, Stopped};
use crate::sparse::multigrid::node_grid::COMPONENTS;
use nalgebra::{DMatrix, SymmetricEigen};

/// Number of vectors.
pub(super) const COUNT: usize = 4;
/// Limit of iterations, and that where a quotient is below zero, which says enough.
const LIMIT: usize = 150;
const BELOW: usize = 30;
/// Part of the lowest eigenvalue below which its residual has to fall.
const ACCURACY: f64 = 0.1;
/// Directions that are combinations of others up to this part are left out.
const DEPENDENT: f64 = 1e-12;

/// Values of all vectors at a node, by vector.
pub(super) type AtNode = [[f64; COMPONENTS]; COUNT];

/// A symmetric matrix with a preconditioner.
pub(super) trait SymmetricMatrix {
    /// Writes the products; returns how far each may be off, or `None` where they cannot be computed.
    fn apply(
        &mut self,
        x: &[AtNode],
        product: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<Option<[f64; COUNT]>, Stopped>;

    /// Least number of iterations where no quotient is below zero: random vectors hold little of a mode at first.
    fn least_iterations(&self) -> usize;

    /// Writes approximations of A⁻¹ r.
    fn precondition(
        &mut self,
        r: &[AtNode],
        x: &mut [AtNode],
        is_over: IsOver<'_>,
    ) -> Result<(), Stopped>;
}

/// Vectors with their quotients.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    /// Ascending.
    pub(super) quotients: [f64; COUNT],
    /// Lengths of the residuals.
    pub(super) residuals: [f64; COUNT],
    /// Errors of the products of the matrix.
    pub(super) errors: [f64; COUNT],
    pub(super) vectors: Vec<AtNode>,
    pub(super) iterations: usize,
}

/// Blocks of vectors: the present ones, their preconditioned residuals, the last changes.
struct Search {
    vectors: [Vec<AtNode>; 3],
    products: [Vec<AtNode>; 3],
    residual: Vec<AtNode>,
}

/// Finds the lowest eigenvalues from these vectors on; `None` where the matrix has no products, or the vectors depend on each other.
pub(super) fn lowest(
    matrix: &mut impl SymmetricMatrix,
    start: Vec<AtNode>,
    is_over: IsOver<'_>,
) -> Result<Option<Pairs>, Stopped> {
    let zero = || vec![AtNode::default(); start.len()];
    let mut search = Search {
        products: [zero(), zero(), zero()],
        residual: zero(),
        vectors: [zero(), zero(), zero()],
    };
    search.vectors[0] = start;
    let [x, ..] = &search.vectors;
    if (matrix.apply(x, &mut search.products[0], is_over)?).is_none() {
        return Ok(None);
    }
    let mut iterations = 0;
    let mut blocks = 1;
    loop {
        let Some(quotients) = search.improve(blocks) else {
            return Ok(None);
        };
        let residuals = search.leave(&quotients);
        let [least, limit] = match quotients[0] < 0.0 {
            true => [0, BELOW],
            false => [matrix.least_iterations(), LIMIT],
        };
        if iterations >= limit || (iterations >= least && are_found(&quotients, &residuals)) {
            break;
        }
        let Search {
            vectors: [x, w, _],
            products,
            residual,
        } = &mut search;
        matrix.precondition(residual, w, is_over)?;
        project(x, w);
        if matrix.apply(w, &mut products[1], is_over)?.is_none() {
            return Ok(None);
        }
        iterations += 1;
        blocks = if iterations == 1 { 2 } else { 3 };
    }
    // The sums above gather rounding: products anew.
    let [x, ..] = &search.vectors;
    let Some(errors) = matrix.apply(x, &mut search.products[0], is_over)? else {
        return Ok(None);
    };
    let Some(quotients) = search.improve(1) else {
        return Ok(None);
    };
    Ok(Some(Pairs {
        residuals: search.leave(&quotients),
        quotients,
        errors: [errors.into_iter().fold(0.0, f64::max); COUNT],
        iterations,
        vectors: search.vectors.into_iter().next().expect("there are three"),
    }))
}

/// Returns true if the signs of all eigenvalues near the quotients are known, and the lowest one is accurate.
fn are_found(quotients: &[f64; COUNT], residuals: &[f64; COUNT]) -> bool {
    let mut pairs = quotients.iter().zip(residuals);
    residuals[0] <= ACCURACY * quotients[0].abs() && pairs.all(|(q, r)| *r < q.abs())
}

impl Search {
    /// Replaces the vectors by the best combinations of so many blocks; returns their quotients.
    fn improve(&mut self, blocks: usize) -> Option<[f64; COUNT]> {
        let own = gram(&self.vectors[..blocks], &self.vectors[..blocks]);
        let of_matrix = gram(&self.vectors[..blocks], &self.products[..blocks]);
        let (quotients, factors) = best(&of_matrix, &own)?;
        for list in [&mut self.vectors, &mut self.products] {
            combine(list, &factors);
        }
        Some(quotients)
    }

    /// Leaves the residuals of the vectors, and returns their lengths.
    fn leave(&mut self, quotients: &[f64; COUNT]) -> [f64; COUNT] {
        let mut squares = [0.0; COUNT];
        let pairs = self.vectors[0].iter().zip(&self.products[0]);
        for (residual, (x, product)) in self.residual.iter_mut().zip(pairs) {
            for v in 0..COUNT {
                for c in 0..COMPONENTS {
                    residual[v][c] = product[v][c] - quotients[v] * x[v][c];
                    squares[v] += residual[v][c] * residual[v][c];
                }
            }
        }
        squares.map(f64::sqrt)
    }
}

fn dot(a: &[f64; COMPONENTS], b: &[f64; COMPONENTS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Products of all vectors of some blocks with those of others.
fn gram(a: &[Vec<AtNode>], b: &[Vec<AtNode>]) -> DMatrix<f64> {
    let mut sums = DMatrix::zeros(COUNT * a.len(), COUNT * b.len());
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            let mut block = [[0.0; COUNT]; COUNT];
            for (a, b) in a.iter().zip(b) {
                for (sums, a) in block.iter_mut().zip(a) {
                    for (sum, b) in sums.iter_mut().zip(b) {
                        *sum += dot(a, b);
                    }
                }
            }
            let mut view = sums.view_mut((COUNT * i, COUNT * j), (COUNT, COUNT));
            for (row, values) in block.iter().enumerate() {
                for (col, value) in values.iter().enumerate() {
                    view[(row, col)] = *value;
                }
            }
        }
    }
    sums
}

/// Lowest quotients of combinations of vectors with these products by a matrix, and among themselves; and the factors.
fn best(of_matrix: &DMatrix<f64>, own: &DMatrix<f64>) -> Option<([f64; COUNT], DMatrix<f64>)> {
    let size = own.nrows();
    let lengths: Vec<f64> = (0..size).map(|i| own[(i, i)].sqrt()).collect();
    let scale = |i: usize| {
        if lengths[i] > 0.0 {
            lengths[i].recip()
        } else {
            0.0
        }
    };
    let scaled = |of: &DMatrix<f64>| {
        DMatrix::from_fn(size, size, |i, j| {
            0.5 * (of[(i, j)] + of[(j, i)]) * scale(i) * scale(j)
        })
    };
    let own = scaled(own);
    if !own.iter().chain(of_matrix).all(|value| value.is_finite()) {
        return None;
    }
    let among = SymmetricEigen::new(own);
    let kept: Vec<usize> = (0..size)
        .filter(|&i| among.eigenvalues[i] > DEPENDENT)
        .collect();
    if kept.len() < COUNT {
        return None;
    }
    let basis = DMatrix::from_fn(size, kept.len(), |i, k| {
        let value = among.eigenvalues[kept[k]];
        among.eigenvectors[(i, kept[k])] / value.sqrt()
    });
    let pairs = SymmetricEigen::new(basis.transpose() * scaled(of_matrix) * &basis);
    let mut order: Vec<usize> = (0..kept.len()).collect();
    order.sort_by(|&i, &j| pairs.eigenvalues[i].total_cmp(&pairs.eigenvalues[j]));
    let quotients = std::array::from_fn(|v| pairs.eigenvalues[order[v]]);
    let vectors = basis * pairs.eigenvectors.select_columns(&order[..COUNT]);
    let factors = DMatrix::from_fn(size, COUNT, |i, v| scale(i) * vectors[(i, v)]);
    Some((quotients, factors))
}

/// Replaces the first block by combinations of all that have factors, and the third by the part of them that is not of the first.
fn combine([x, w, p]: &mut [Vec<AtNode>; 3], factors: &DMatrix<f64>) {
    let blocks = factors.nrows() / COUNT;
    let add = |sum: &mut AtNode, block: usize, from: &AtNode| {
        for (v, sum) in sum.iter_mut().enumerate() {
            for (u, from) in from.iter().enumerate() {
                let factor = factors[(COUNT * block + u, v)];
                for (sum, value) in sum.iter_mut().zip(from) {
                    *sum += factor * value;
                }
            }
        }
    };
    for ((x, w), p) in x.iter_mut().zip(w).zip(p) {
        let mut change = AtNode::default();
        if blocks > 1 {
            add(&mut change, 1, w);
        }
        if blocks > 2 {
            add(&mut change, 2, p);
        }
        let mut all = change;
        add(&mut all, 0, x);
        (*x, *p) = (all, change);
    }
}

/// Takes from vectors their parts along others, which are orthonormal.
fn project(x: &[AtNode], w: &mut [AtNode]) {
    for _ in 0..2 {
        let mut along = [[0.0; COUNT]; COUNT];
        for (x, w) in x.iter().zip(&*w) {
            for (sums, w) in along.iter_mut().zip(w) {
                for (sum, x) in sums.iter_mut().zip(x) {
                    *sum += dot(w, x);
                }
            }
        }
        for (x, w) in x.iter().zip(&mut *w) {
            for (parts, w) in along.iter().zip(w) {
                for (part, x) in parts.iter().zip(x) {
                    for (w, x) in w.iter_mut().zip(x) {
                        *w -= part * x;
                    }
                }
            }
        }
    }
}
