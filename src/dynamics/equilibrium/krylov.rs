//! Eigenvalues of largest size of a linear map without a matrix, by a Krylov space of several vectors (Arnoldi's method by bands): those that are
//! there several times, as of beams with two planes of symmetry, are found as often.

use crate::dynamics::equilibrium::growing_motions::eigenvalues;
use crate::math::Random;
use nalgebra::{Complex, DMatrix, DVector};

/// Vectors with which the space begins, and with them the most equal eigenvalues that are surely found.
const BAND: usize = 4;
/// Dimensions after which the eigenvalues are looked at.
const COMPARED: usize = 24;
/// Residual of an eigenvalue relative to its size.
const CONVERGED: f64 = 1e-10;
/// Eigenvalues and new vectors below this part of the largest are rounding.
const ROUNDING: f64 = 1e-13;
/// Steps of the inverse iteration for a vector.
const STEPS: i32 = 3;

/// An eigenvalue with its vector, and what is left of its equation relative to its size.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub(super) value: Complex<f64>,
    pub(super) vector: DVector<Complex<f64>>,
    pub(super) residual: f64,
}

/// Choice among the eigenvalues of a space, of descending size.
pub(super) struct Choice {
    /// Those that are wanted.
    pub(super) wanted: Vec<usize>,
    /// True if a larger space would have no others that are wanted.
    pub(super) is_enough: bool,
}

/// A space with the map on it.
#[derive(Debug)]
struct Space {
    basis: Vec<DVector<f64>>,
    /// Columns of the map of the first vectors by all.
    columns: Vec<Vec<f64>>,
}

/// Those eigenvalues of largest size that are chosen, from a space of at most `most` dimensions; where it was large enough their residuals are below 1e-10.
/// `map` gives nothing where it was stopped.
pub(super) fn largest(
    size: usize,
    most: usize,
    mut map: impl FnMut(&DVector<f64>) -> Option<DVector<f64>>,
    choose: impl Fn(&[Complex<f64>]) -> Choice,
) -> Option<Vec<Pair>> {
    let mut random = Random::new(1);
    let mut space = Space {
        basis: Vec::new(),
        columns: Vec::new(),
    };
    for _ in 0..BAND.min(size) {
        // What the map does not reach is of no interest.
        let first = DVector::from_fn(size, |_, _| random.between(-1.0, 1.0));
        let reached = map(&first)?;
        let reached = map(&reached)?;
        space.take(reached);
    }
    loop {
        let j = space.columns.len();
        let is_last = j == space.basis.len() || j >= most;
        if is_last || (j > 0 && j.is_multiple_of(COMPARED)) {
            let (found, is_enough) = space.found(&choose)?;
            let is_exact = found.iter().all(|pair| pair.residual <= CONVERGED);
            if is_last || (is_enough && is_exact) {
                return Some(found);
            }
        }
        let next = map(&space.basis[j])?;
        let column = space.take(next);
        space.columns.push(column);
    }
}

impl Space {
    /// Adds what a vector has beside the space; returns its parts along all vectors.
    fn take(&mut self, mut next: DVector<f64>) -> Vec<f64> {
        let whole = next.norm();
        let mut column = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            for (part, other) in column.iter_mut().zip(&self.basis) {
                let along = other.dot(&next);
                *part += along;
                next.axpy(-along, other, 1.0);
            }
        }
        let length = next.norm();
        if length > ROUNDING * whole && self.basis.len() < next.len() {
            column.push(length);
            self.basis.push(next / length);
        }
        column
    }

    /// Those that are chosen; true if they are enough.
    fn found(&self, choose: impl Fn(&[Complex<f64>]) -> Choice) -> Option<(Vec<Pair>, bool)> {
        let (count, all) = (self.columns.len(), self.basis.len());
        let mut map = DMatrix::<f64>::zeros(all, count);
        for (j, column) in self.columns.iter().enumerate() {
            for (i, value) in column.iter().enumerate() {
                map[(i, j)] = *value;
            }
        }
        let inner = map.rows(0, count).into_owned();
        let mut values = eigenvalues(&inner)?;
        values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let largest = values.first().map_or(0.0, |value| value.norm());
        values.retain(|value| value.norm() > ROUNDING * largest);
        let Choice { wanted, is_enough } = choose(&values);
        let map = map.map(|value| Complex::new(value, 0.0));
        let inner = map.rows(0, count).into_owned();
        let mut random = Random::new(2);
        let mut pairs = Vec::new();
        for value in wanted.into_iter().map(|place| values[place]) {
            // Beside the eigenvalue by rounding, where the matrix has an inverse.
            let shifts = (0..STEPS).map(|k| value * (1.0 + 4.0 * f64::EPSILON * 16_f64.powi(k)));
            let mut found =
                shifts.filter_map(|shift| inverse_iteration(&inner, shift, &mut random));
            let y = found.next()?;
            // The quotient, and what is left of the equation within the space and beyond it.
            let mut left = &map * &y;
            let value = y.dotc(&left.rows(0, count));
            left.rows_mut(0, count)
                .axpy(-value, &y, Complex::new(1.0, 0.0));
            let mut vector = DVector::from_element(self.basis[0].len(), Complex::new(0.0, 0.0));
            for (part, one) in y.iter().zip(&self.basis) {
                vector.zip_apply(one, |sum, entry| *sum += *part * entry);
            }
            pairs.push(Pair {
                value,
                vector,
                residual: left.norm() / value.norm(),
            });
        }
        Some((pairs, is_enough))
    }
}

/// A vector of a matrix near a number, by inverse iteration from a random one; nothing where that is no number.
fn inverse_iteration(
    matrix: &DMatrix<Complex<f64>>,
    shift: Complex<f64>,
    random: &mut Random,
) -> Option<DVector<Complex<f64>>> {
    let count = matrix.nrows();
    let mut shifted = matrix.clone();
    (0..count).for_each(|i| shifted[(i, i)] -= shift);
    let factors = shifted.lu();
    let number = |_, _| Complex::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let mut y = DVector::from_fn(count, number).normalize();
    for _ in 0..STEPS {
        y = factors.solve(&y)?.normalize();
    }
    y.iter().all(|c| c.norm().is_finite()).then_some(y)
}
