//! Random systems: the inertia is that of dense eigenvalues, in any order of elimination.

use crate::horizon::System;
use nalgebra::DMatrix;
use proboscis::kkt::{Inertia, Plan, Solver, Unknown};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::cell::Cell;

/// Eigenvalues below the first part of the largest are zero; there are none up to the second one.
const GAP: [f64; 2] = [1e-13, 1e-7];

fn inertia(a: DMatrix<f64>) -> Option<Inertia> {
    let eigenvalues = a.symmetric_eigenvalues();
    let [zero, other] = GAP.map(|part| part * eigenvalues.amax());
    let is_clear = |e: &f64| e.abs() <= zero || e.abs() > other;
    eigenvalues.iter().all(is_clear).then(|| Inertia {
        negative: eigenvalues.iter().filter(|&&e| e < -zero).count(),
        zero: eigenvalues.iter().filter(|e| e.abs() <= zero).count(),
    })
}

fn of_dense(a: &DMatrix<f64>) -> System {
    let mut system = System {
        rows: Vec::new(),
        cols: Vec::new(),
        entries: Vec::new(),
        unknowns: vec![Unknown::Variable(0); a.nrows()],
    };
    for i in 0..a.nrows() {
        for j in 0..=i {
            if a[(i, j)] != 0.0 || i == j {
                system.push(i, j, a[(i, j)]);
            }
        }
    }
    system
}

/// Numbers of which about every third is not zero.
fn sparse(rows: usize, cols: usize) -> impl Strategy<Value = DMatrix<f64>> {
    let entry = prop_oneof![2 => Just(0.0), 1 => -3.0..3.0_f64];
    prop::collection::vec(entry, rows * cols)
        .prop_map(move |entries| DMatrix::from_vec(rows, cols, entries))
}

/// The same of whole numbers, so that products of them are exact.
fn whole(rows: usize, cols: usize) -> impl Strategy<Value = DMatrix<f64>> {
    prop::collection::vec(select(vec![-1.0, 0.0, 0.0, 0.0, 1.0, 2.0]), rows * cols)
        .prop_map(move |entries| DMatrix::from_vec(rows, cols, entries))
}

/// Symmetric, with zeros in places of the diagonal.
fn indefinite() -> impl Strategy<Value = DMatrix<f64>> {
    (2..40_usize).prop_flat_map(|n| sparse(n, n).prop_map(|b| &b + b.transpose()))
}

/// A block of variables with an indefinite Hessian, and equations without a diagonal.
fn saddle_point() -> impl Strategy<Value = DMatrix<f64>> {
    (3..25_usize)
        .prop_flat_map(|n| (Just(n), 1..n))
        .prop_flat_map(|(n, m)| (sparse(n, n), sparse(m, n)))
        .prop_map(|(b, j)| {
            let (n, m) = (b.nrows(), j.nrows());
            let mut a = DMatrix::zeros(n + m, n + m);
            a.view_mut((0, 0), (n, n)).copy_from(&(&b + b.transpose()));
            a.view_mut((n, 0), (m, n)).copy_from(&j);
            a.view_mut((0, n), (n, m)).copy_from(&j.transpose());
            a
        })
}

/// `B D Bᵀ` with fewer columns than rows, so that eigenvalues are zero.
fn deficient() -> impl Strategy<Value = DMatrix<f64>> {
    (3..30_usize)
        .prop_flat_map(|n| (Just(n), 1..n))
        .prop_flat_map(|(n, r)| {
            let signs = prop::collection::vec(select(vec![-1.0, 1.0, 3.0]), r);
            (whole(n, r), signs)
        })
        .prop_map(|(b, signs)| {
            let mut scaled = b.clone();
            for (mut column, sign) in scaled.column_iter_mut().zip(signs) {
                column *= sign;
            }
            scaled * b.transpose()
        })
}

/// Returns true if factors found the inertia. In the place of a zero eigenvalue an error of rounding may have either sign.
fn is(found: Inertia, expected: Inertia) -> bool {
    let range = expected.negative..=expected.negative + expected.zero;
    found.zero <= expected.zero && range.contains(&found.negative)
}

/// The inertia by factors in an order of minimum degree, and in stages of some unknowns each, of A and of `P A Pᵀ`.
fn factored(a: &DMatrix<f64>, order: &[usize], width: usize) -> Result<(), TestCaseError> {
    let Some(expected) = inertia(a.clone()) else {
        return Err(TestCaseError::reject("eigenvalues between zero and not"));
    };
    prop_assume!(expected.negative > 0);
    let permuted = DMatrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(order[i], order[j])]);
    for a in [a, &permuted] {
        let mut system = of_dense(a);
        for (i, unknown) in system.unknowns.iter_mut().enumerate() {
            *unknown = Unknown::Variable((i / width) as u32);
        }
        for unknowns in [None, Some(system.unknowns.as_slice())] {
            let plan = Plan::new(a.nrows(), &system.rows, &system.cols, unknowns);
            let mut solver = Solver::new(plan);
            // The second time with scales and rules that the matrix has taught.
            for _ in 0..2 {
                let found = solver.factor(&system.entries);
                prop_assert!(is(found, expected), "{found:?} {expected:?}");
            }
        }
    }
    Ok(())
}

/// Checks matrices of one kind, the same in every run; how many of them are singular.
fn check(matrices: impl Strategy<Value = DMatrix<f64>>) -> usize {
    let cases = matrices.prop_flat_map(|a| {
        let n = a.nrows();
        let order = Just((0..n).collect::<Vec<_>>()).prop_shuffle();
        (Just(a), order, 1..=n)
    });
    let singular = Cell::new(0);
    let check = |(a, order, width): (DMatrix<f64>, Vec<usize>, usize)| {
        let is_singular = inertia(a.clone()).is_some_and(|expected| expected.zero > 0);
        singular.set(singular.get() + usize::from(is_singular));
        factored(&a, &order, width)
    };
    let config = Config {
        failure_persistence: None,
        ..Config::default()
    };
    let random = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    let mut runner = TestRunner::new_with_rng(config, random);
    runner.run(&cases, check).unwrap();
    singular.get()
}

#[test]
fn indefinite_systems_have_the_inertia_of_dense_eigenvalues() {
    check(indefinite());
}

#[test]
fn saddle_points_have_the_inertia_of_dense_eigenvalues() {
    assert!(check(saddle_point()) > 10);
}

#[test]
fn deficient_systems_have_the_signs_of_the_other_eigenvalues() {
    assert!(check(deficient()) > 100);
}
