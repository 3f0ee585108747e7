//! Factors in single precision, for iterations that correct what they lose.

use crate::matrices::{Matrix, distance};
use proboscis::math::Stopped;
use proboscis::sparse::{Backend, Direct, Precision, Symmetry};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Nodes along each side of a cube; above 5 000 unknowns in all.
const SIDE: usize = 18;

/// Differences between neighbours in a cube of nodes, and `shift` times the unknowns; every fifth row with the other sign, which
/// keeps the matrix quasi-definite.
fn cube(shift: f64, is_definite: bool) -> Matrix {
    let mut matrix = Matrix {
        size: SIDE * SIDE * SIDE,
        symmetry: Symmetry::Symmetric,
        entries: Vec::new(),
        values: Vec::new(),
    };
    let sign = |i: usize| match is_definite || !i.is_multiple_of(5) {
        true => 1.0,
        false => -1.0,
    };
    let mut diagonal = vec![shift; matrix.size];
    for i in 0..matrix.size {
        let places = [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE];
        for (place, stride) in places.into_iter().zip([1, SIDE, SIDE * SIDE]) {
            if place + 1 < SIDE {
                let j = i + stride;
                let value = if sign(i) == sign(j) { -sign(i) } else { 0.3 };
                matrix.both(i, j, value);
                diagonal[i] += 1.0;
                diagonal[j] += 1.0;
            }
        }
    }
    for (i, value) in diagonal.into_iter().enumerate() {
        matrix.push(i, i, sign(i) * value);
    }
    matrix
}

/// A solution and its right-hand side.
fn known(matrix: &Matrix) -> [Vec<f64>; 2] {
    let x: Vec<f64> = (0..matrix.size).map(|i| 1.0 + (i as f64).sin()).collect();
    let rhs = product(matrix, &x);
    [x, rhs]
}

fn product(matrix: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; x.len()];
    for (&(row, col), value) in matrix.entries.iter().zip(&matrix.values) {
        product[row] += value * x[col];
    }
    product
}

fn for_iteration(matrix: &Matrix) -> Direct {
    let place = |i: usize| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE].map(|at| at as f64);
    let places: Vec<_> = (0..matrix.size).map(|i| Some(place(i))).collect();
    Direct::for_iteration(matrix.size, matrix.entries.iter().copied(), &places)
}

#[test]
fn an_iteration_corrects_what_factors_in_single_precision_lose() {
    let matrix = cube(0.1, false);
    let [x, rhs] = known(&matrix);
    let mut direct = for_iteration(&matrix);
    direct.factor(&matrix.values).unwrap();
    assert_eq!(direct.precision(), Precision::Single);
    assert_eq!(direct.method(), "LDLᵀ by fronts in single precision");
    // However small or large a right-hand side is, the same part is lost.
    for unit in [1.0, 1e-200, 1e200] {
        let mut found: Vec<f64> = rhs.iter().map(|value| value * unit).collect();
        direct.solve_roughly(&mut found);
        found.iter_mut().for_each(|value| *value /= unit);
        let lost = distance(&found, &x);
        assert!((1e-9..1e-3).contains(&lost), "{unit}: {lost:e}");
    }
    let mut found = vec![0.0; matrix.size];
    for _ in 0..4 {
        let mut residual = product(&matrix, &found);
        for (residual, rhs) in residual.iter_mut().zip(&rhs) {
            *residual = rhs - *residual;
        }
        direct.solve_roughly(&mut residual);
        for (value, correction) in found.iter_mut().zip(&residual) {
            *value += correction;
        }
    }
    let error = distance(&found, &x);
    assert!(error < 1e-13, "{error:e}");
    let mut double = matrix.direct(Backend::Faer);
    double.factor(&matrix.values).unwrap();
    assert_eq!(direct.negative_pivots(), double.negative_pivots());
    assert!(direct.negative_pivots().unwrap() > 1000);
}

#[test]
fn double_precision_takes_over_where_single_precision_tells_nothing() {
    let matrix = cube(1e-8, true);
    let [x, rhs] = known(&matrix);
    let mut direct = for_iteration(&matrix);
    assert_eq!(direct.precision(), Precision::Single);
    direct.factor(&matrix.values).unwrap();
    assert_eq!(direct.precision(), Precision::Double);
    assert_eq!(direct.method(), "LDLᵀ by fronts");
    let mut found = rhs;
    direct.solve_roughly(&mut found);
    let error = distance(&found, &x);
    assert!(error < 1e-5, "{error:e}");
    assert!(!direct.make_double());
}

#[test]
fn double_precision_stays_where_three_matrices_in_a_row_needed_it() {
    let (fair, poor) = (cube(0.1, true), cube(1e-8, true));
    for in_a_row in 1..=4 {
        let mut direct = for_iteration(&fair);
        direct.factor(&fair.values).unwrap();
        for _ in 0..in_a_row {
            direct.factor(&poor.values).unwrap();
            assert_eq!(direct.precision(), Precision::Double);
        }
        direct.factor(&fair.values).unwrap();
        let expected = match in_a_row {
            1 | 2 => Precision::Single,
            _ => Precision::Double,
        };
        assert_eq!(direct.precision(), expected, "{in_a_row}");
        let [x, mut found] = known(&fair);
        direct.solve_roughly(&mut found);
        assert!(distance(&found, &x) < 1e-3);
    }
}

#[test]
fn a_factorisation_that_is_stopped_is_no_reason_for_double_precision() {
    let matrix = cube(0.1, false);
    let [x, rhs] = known(&matrix);
    let asked = AtomicUsize::new(0);
    for first in [0, 20] {
        let mut direct = for_iteration(&matrix);
        asked.store(0, Ordering::Relaxed);
        let is_over = || asked.fetch_add(1, Ordering::Relaxed) >= first;
        let done = direct.factor_unless(&matrix.values, &is_over);
        assert_eq!(done, Err(Stopped));
        // Each thread asks once more.
        assert!(asked.load(Ordering::Relaxed) < first + 10);
        assert_eq!(direct.negative_pivots(), None);
        direct.factor(&matrix.values).unwrap();
        assert_eq!(direct.precision(), Precision::Single);
        let mut found = rhs.clone();
        direct.solve_roughly(&mut found);
        assert!(distance(&found, &x) < 1e-3);
    }
}

#[test]
fn factors_are_in_double_precision_on_request_and_where_they_are_small() {
    let matrix = cube(0.1, false);
    let [x, rhs] = known(&matrix);
    let mut direct = for_iteration(&matrix);
    assert!(direct.make_double());
    assert!(!direct.make_double());
    direct.factor(&matrix.values).unwrap();
    let mut found = rhs;
    direct.solve_roughly(&mut found);
    let error = distance(&found, &x);
    assert!(error < 1e-12, "{error:e}");
    let few: Vec<(usize, usize)> = (0..100).map(|i| (i, i)).collect();
    let direct = Direct::for_iteration(100, few.into_iter(), &[Some([0.0; 3]); 100]);
    assert_eq!(direct.precision(), Precision::Double);
    // Without places there is no order of elimination for them.
    let direct = Direct::for_iteration(
        matrix.size,
        matrix.entries.iter().copied(),
        &vec![None; matrix.size],
    );
    assert_eq!(direct.precision(), Precision::Double);
    assert_eq!(direct.method(), "faer LDLᵀ");
}

#[test]
fn a_singular_matrix_does_not_change_the_precision_of_the_next() {
    let matrix = cube(0.1, true);
    let [x, rhs] = known(&matrix);
    let mut direct = for_iteration(&matrix);
    direct.factor(&cube(0.0, true).values).unwrap_err();
    direct.factor(&matrix.values).unwrap();
    assert_eq!(direct.precision(), Precision::Single);
    let mut found = rhs;
    direct.solve_roughly(&mut found);
    let lost = distance(&found, &x);
    assert!(lost < 1e-3, "{lost:e}");
}
