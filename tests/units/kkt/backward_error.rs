//! Backward errors against those of dense matrices.

use super::Trial;
use crate::kkt::graph::Pattern;
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
            let pattern = Pattern::new(&rows, &cols);
            let found = trial.backward_error(pattern, &entries);
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
    let pattern = Pattern::new(&[0, 1], &[0, 1]);
    let error = trial.backward_error(pattern, &[1.0, 1.0]);
    assert_eq!(error, f64::INFINITY);
}
