//! Flexible GMRES with a fixed restart (Y. Saad, SIAM J. Sci. Comput. 14, 1993): the preconditioner may be in single precision.

use crate::math::{IsOver, Stopped};

/// Vectors between restarts.
const RESTART: usize = 20;
/// Iterations after which it is given up.
pub(super) const LIMIT: usize = 150;

/// A matrix with a preconditioner.
pub(super) trait Operator {
    /// Writes A x.
    fn apply(&mut self, x: &[f32], product: &mut [f64]);

    /// Writes an approximation of A⁻¹ r.
    fn precondition(&mut self, r: &[f64], x: &mut [f32]);

    /// Returns true if the equations stand for a smaller system, whose residual is the one to become small.
    fn is_reduced(&self) -> bool {
        false
    }

    /// Turns a residual into that of the smaller system.
    fn reduce(&self, _residual: &mut [f64]) {}
}

/// Storage of the iteration, laid out once.
#[derive(Debug)]
pub(super) struct Krylov {
    basis: Vec<Vec<f64>>,
    directions: Vec<Vec<f32>>,
    /// Columns of the triangular factor of the Hessenberg matrix.
    columns: Vec<[f64; RESTART + 1]>,
    rotations: [[f64; 2]; RESTART],
    /// Right-hand side of the least squares.
    left: [f64; RESTART + 1],
    /// A residual, where equations stand for a smaller system.
    reduced: Vec<f64>,
}

/// Outcome of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Iterated {
    pub(super) iterations: usize,
    /// Norm of the right-hand side.
    whole: f64,
    /// Norm of the residual relative to that of the right-hand side.
    pub(super) residual: f64,
}

/// Sum of products, in a fixed order.
pub(super) fn dot<T: Copy + Into<f64>>(a: &[T], b: &[T]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_parts, b_parts) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = a_parts.remainder().iter().zip(b_parts.remainder());
    let rest: f64 = rest.map(|(a, b)| (*a).into() * (*b).into()).sum();
    for (a, b) in a_parts.zip(b_parts) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += (*a).into() * (*b).into();
        }
    }
    sums.iter().sum::<f64>() + rest
}

pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

impl Krylov {
    pub(super) fn new(size: usize) -> Self {
        Self {
            basis: vec![vec![0.0; size]; RESTART + 1],
            directions: vec![vec![0.0; size]; RESTART],
            columns: vec![[0.0; RESTART + 1]; RESTART],
            rotations: [[0.0; 2]; RESTART],
            left: [0.0; RESTART + 1],
            reduced: Vec::new(),
        }
    }

    /// Solves from zero: `rhs` becomes the residual, `x` the solution.
    pub(super) fn solve(
        &mut self,
        operator: &mut impl Operator,
        rhs: &mut [f64],
        x: &mut [f64],
        tolerance: f64,
        is_over: IsOver<'_>,
    ) -> Result<Iterated, Stopped> {
        x.fill(0.0);
        let whole = norm(rhs);
        let mut iterated = Iterated {
            iterations: 0,
            whole,
            residual: if whole == 0.0 { 0.0 } else { 1.0 },
        };
        // Not finite numbers end it too.
        while iterated.residual > tolerance && iterated.iterations < LIMIT {
            let before = norm(rhs);
            self.round(operator, rhs, x, tolerance, &mut iterated, is_over)?;
            if iterated.residual.is_nan() || norm(rhs) > 0.9 * before {
                iterated.residual = f64::INFINITY;
            }
            if iterated.residual.is_infinite() {
                break;
            }
        }
        Ok(iterated)
    }

    /// One round up to a restart.
    fn round(
        &mut self,
        operator: &mut impl Operator,
        rhs: &mut [f64],
        x: &mut [f64],
        tolerance: f64,
        iterated: &mut Iterated,
        is_over: IsOver<'_>,
    ) -> Result<(), Stopped> {
        let whole = iterated.whole;
        self.left = [0.0; RESTART + 1];
        self.left[0] = norm(rhs);
        let scale = self.left[0].recip();
        for (v, r) in self.basis[0].iter_mut().zip(&*rhs) {
            *v = r * scale;
        }
        let mut count = 0;
        while count < RESTART && iterated.iterations < LIMIT {
            if is_over() {
                return Err(Stopped);
            }
            self.extend(operator, count);
            count += 1;
            iterated.iterations += 1;
            let left = self.left[count].abs() / whole;
            if left.is_nan()
                || left <= tolerance && self.is_enough(operator, count, tolerance * whole)
            {
                break;
            }
        }
        self.leave(count, rhs);
        self.combine(count, x);
        iterated.residual = self.size(operator, rhs) / whole;
        Ok(())
    }

    /// Norm of a residual, of the smaller system where the equations stand for one.
    fn size(&mut self, operator: &impl Operator, residual: &[f64]) -> f64 {
        if !operator.is_reduced() {
            return norm(residual);
        }
        self.reduced.clear();
        self.reduced.extend_from_slice(residual);
        operator.reduce(&mut self.reduced);
        norm(&self.reduced)
    }

    /// Returns true if the residual of a smaller system is small too.
    fn is_enough(&mut self, operator: &impl Operator, count: usize, most: f64) -> bool {
        if !operator.is_reduced() {
            return true;
        }
        let mut residual = std::mem::take(&mut self.reduced);
        residual.resize(self.basis[0].len(), 0.0);
        self.leave(count, &mut residual);
        operator.reduce(&mut residual);
        let size = norm(&residual);
        self.reduced = residual;
        size <= most
    }

    /// Adds a vector to the basis, and a column to the least squares.
    fn extend(&mut self, operator: &mut impl Operator, at: usize) {
        let (known, rest) = self.basis.split_at_mut(at + 1);
        let (new, direction) = (&mut rest[0], &mut self.directions[at]);
        operator.precondition(&known[at], direction);
        operator.apply(direction, new);
        let mut column = [0.0; RESTART + 1];
        for (entry, vector) in column.iter_mut().zip(&*known) {
            *entry = dot(new, vector);
            for (value, part) in new.iter_mut().zip(vector) {
                *value -= *entry * part;
            }
        }
        let length = norm(new);
        column[at + 1] = length;
        if length > 0.0 {
            let scale = length.recip();
            new.iter_mut().for_each(|value| *value *= scale);
        }
        for (i, [c, s]) in self.rotations[..at].iter().enumerate() {
            let [a, b] = [column[i], column[i + 1]];
            column[i] = c * a + s * b;
            column[i + 1] = c * b - s * a;
        }
        let hypotenuse = column[at].hypot(column[at + 1]);
        let [c, s] = [column[at] / hypotenuse, column[at + 1] / hypotenuse];
        self.rotations[at] = [c, s];
        column[at] = hypotenuse;
        column[at + 1] = 0.0;
        self.left[at + 1] = -s * self.left[at];
        self.left[at] *= c;
        self.columns[at] = column;
    }

    /// Adds the combination of directions with the least residual; the factors stay in `left`.
    fn combine(&mut self, count: usize, x: &mut [f64]) {
        for i in (0..count).rev() {
            let behind: f64 = (i + 1..count)
                .map(|j| self.columns[j][i] * self.left[j])
                .sum();
            self.left[i] = (self.left[i] - behind) / self.columns[i][i];
        }
        for (factor, direction) in self.left[..count].iter().zip(&self.directions) {
            for (x, part) in x.iter_mut().zip(direction) {
                *x += factor * f64::from(*part);
            }
        }
    }

    /// Makes `rhs` the residual of least norm, which is a combination of the basis.
    fn leave(&mut self, count: usize, rhs: &mut [f64]) {
        let mut factors = [0.0; RESTART + 1];
        factors[count] = self.left[count];
        for (i, [c, s]) in self.rotations[..count].iter().enumerate().rev() {
            let [a, b] = [factors[i], factors[i + 1]];
            factors[i] = c * a - s * b;
            factors[i + 1] = s * a + c * b;
        }
        rhs.fill(0.0);
        for (factor, vector) in factors[..=count].iter().zip(&self.basis) {
            for (value, part) in rhs.iter_mut().zip(vector) {
                *value += factor * part;
            }
        }
    }
}
