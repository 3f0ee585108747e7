//! Accuracy check of factors: the backward error of a system that is solved with them.

/// A system with the right-hand side b = (1, −1, 1, …).
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    solution: Vec<f64>,
    /// Residual, and the sum of the magnitudes of its terms.
    sums: Vec<[f64; 2]>,
}

impl Trial {
    pub(super) fn new(order: usize) -> Self {
        Self {
            solution: vec![0.0; order],
            sums: vec![[0.0; 2]; order],
        }
    }

    /// The right-hand side, which the solution is to replace.
    pub(super) fn begin(&mut self) -> &mut [f64] {
        let places = self.solution.iter_mut().enumerate();
        places.for_each(|(i, x)| *x = right(i));
        &mut self.solution
    }

    /// The smallest relative change of entries with which the solution x is exact (Oettli and Prager, 1964): the greatest of
    /// `|b − A x| / (|A| |x| + |b|)`.
    pub(super) fn backward_error(
        &mut self,
        (rows, cols): (&[u32], &[u32]),
        entries: &[f64],
    ) -> f64 {
        let (x, sums) = (&self.solution, &mut self.sums);
        let places = sums.iter_mut().enumerate();
        places.for_each(|(i, sum)| *sum = [right(i), 1.0]);
        let mut add = |row: u32, term: f64| {
            let [residual, magnitude] = &mut sums[row as usize];
            *residual -= term;
            *magnitude += term.abs();
        };
        for ((&row, &col), &entry) in rows.iter().zip(cols).zip(entries) {
            add(row, entry * x[col as usize]);
            if row != col {
                add(col, entry * x[row as usize]);
            }
        }
        let errors = self.sums.iter().map(|[r, m]| r.abs() / m);
        let is_known = errors.clone().all(f64::is_finite);
        let greatest = errors.fold(0.0, f64::max);
        if is_known { greatest } else { f64::INFINITY }
    }
}

fn right(i: usize) -> f64 {
    if i.is_multiple_of(2) { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::Trial;
    use nalgebra::{DMatrix, DVector};

    /// The error of some numbers that are no solution, against a dense matrix.
    #[test]
    fn backward_errors_are_those_of_dense_matrices() {
        let n = 90;
        for count in [500, 5000] {
            let places = (0..count).map(|k| [(7 * k + k / 90) % n, (13 * k + k / 700) % n]);
            let places: Vec<[usize; 2]> = places.map(|[i, j]| [i.max(j), i.min(j)]).collect();
            let entries: Vec<f64> = (0..count).map(|k| (0.3 * k as f64).sin()).collect();
            let mut a = DMatrix::zeros(n, n);
            let mut magnitudes = DMatrix::<f64>::zeros(n, n);
            for (&[i, j], entry) in places.iter().zip(&entries) {
                a[(i, j)] += entry;
                magnitudes[(i, j)] += entry.abs();
                if i != j {
                    a[(j, i)] += entry;
                    magnitudes[(j, i)] += entry.abs();
                }
            }
            let side = |k: usize| places.iter().map(|p| p[k] as u32).collect::<Vec<_>>();
            let [rows, cols] = [0, 1].map(side);
            let mut trial = Trial::new(n);
            // The second time nothing of the first is left.
            for scale in [3.0, 1.0] {
                let x = DVector::from_fn(n, |i, _| scale * (1.0 + i as f64).cos());
                let right = trial.begin();
                let b = DVector::from_column_slice(right);
                assert!(b[0] == 1.0 && b[1] == -1.0);
                right.copy_from_slice(x.as_slice());
                let found = trial.backward_error((&rows, &cols), &entries);
                let terms = &magnitudes * x.abs() + b.abs();
                let expected = (&b - &a * &x).abs().component_div(&terms).max();
                assert!(expected > 1e-4);
                assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_no_solution() {
        let mut trial = Trial::new(2);
        trial.begin()[1] = f64::NAN;
        let error = trial.backward_error((&[0, 1], &[0, 1]), &[1.0, 1.0]);
        assert_eq!(error, f64::INFINITY);
    }
}
