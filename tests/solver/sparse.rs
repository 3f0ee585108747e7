//! Direct solvers: every method gives what a dense one gives, names what is not determined, and shares MUMPS with Ipopt.

use crate::matrices::{Matrix, Random, distance};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::common::programs::{HS071_OPTIMUM, HS071_START, hs071};
use nalgebra::DVector;
use proboscis::ipopt::{self, LinearSolver, Options, StartingPoint};
use proboscis::sparse::{Backend, Direct, Symmetry};

use Symmetry::{Symmetric, Unsymmetric};

const BACKENDS: [Backend; 3] = [Backend::Dense, Backend::Faer, Backend::Mumps];
const SYMMETRIES: [Symmetry; 2] = [Symmetric, Unsymmetric];
/// Sizes around the border between dense and sparse methods.
const SIZES: [usize; 4] = [1, 7, 60, 200];

/// Solves with `direct` and compares with a dense LU, up to what the condition leaves.
fn check(direct: &mut Direct, matrix: &Matrix, random: &mut Random) {
    let dense = matrix.dense();
    let singular = dense.singular_values();
    let condition = singular.max() / singular.min();
    assert!(
        condition < 1e8,
        "a test matrix of condition {condition:.1e}"
    );
    let rhs: Vec<f64> = (0..matrix.size).map(|_| random.number()).collect();
    let oracle = dense.lu().solve(&DVector::from_vec(rhs.clone())).unwrap();
    let mut x = rhs;
    direct.factor(&matrix.values).unwrap();
    direct.solve(&mut x);
    let error = distance(&x, oracle.as_slice());
    let tolerance = 1e2 * condition * f64::EPSILON * matrix.size as f64;
    assert!(
        error < tolerance,
        "{}: {error:.1e} > {tolerance:.1e}",
        direct.method()
    );
}

/// All methods for matrices of one kind, with a matrix.
fn every(mut act: impl FnMut(Direct, Matrix, &mut Random)) {
    let mut random = Random(7);
    for size in SIZES {
        for symmetry in SYMMETRIES {
            let matrix = Matrix::random(size, symmetry, &mut random);
            for backend in BACKENDS {
                act(matrix.direct(backend), matrix.clone(), &mut random);
            }
        }
        let matrix = Matrix::quasi_definite(size, &mut random);
        for backend in BACKENDS {
            act(matrix.direct(backend), matrix.clone(), &mut random);
        }
    }
}

#[test]
fn solutions_equal_those_of_a_dense_method() {
    let mut names = BTreeSet::new();
    every(|mut direct, matrix, random| {
        check(&mut direct, &matrix, random);
        names.insert(direct.method());
    });
    assert_eq!(names.len(), 5, "{names:?}");
}

#[test]
fn one_pattern_serves_many_matrices() {
    every(|mut direct, matrix, random| {
        for round in 0..4 {
            // Diagonals of a quasi-definite matrix keep their dominance.
            let factors: Vec<f64> = (0..matrix.size)
                .map(|_| 1.0 + 0.1 * random.number())
                .collect();
            let other = matrix
                .clone()
                .map(|row, col, v| v * factors[row] * factors[col]);
            check(&mut direct, &other, random);
            if round == 1 {
                direct.factor(&vec![0.0; matrix.values.len()]).unwrap_err();
            }
        }
    });
}

#[test]
fn entries_listed_twice_add_up() {
    every(|mut direct, matrix, random| {
        check(&mut direct, &matrix, random);
        let mut twice = matrix.clone();
        for (&(row, col), value) in matrix.entries.iter().zip(&matrix.values) {
            twice.push(row, col, -0.75 * value);
        }
        let backend = match direct.method() {
            name if name.starts_with("dense") => Backend::Dense,
            name if name.starts_with("faer") => Backend::Faer,
            _ => Backend::Mumps,
        };
        check(&mut twice.direct(backend), &twice, random);
    });
}

#[test]
fn inertia_is_that_of_the_eigenvalues() {
    let (mut told, mut negative) = (0, 0);
    every(|mut direct, matrix, _| {
        direct.factor(&matrix.values).unwrap();
        let inertia = direct.negative_pivots();
        assert_eq!(inertia.is_some(), matrix.symmetry == Symmetric);
        if let Some(inertia) = inertia {
            let eigenvalues = matrix.dense().symmetric_eigenvalues();
            let oracle = eigenvalues.iter().filter(|&&value| value < 0.0).count();
            assert_eq!(inertia, oracle, "{}", direct.method());
            assert!(matrix.size < 5 || (0 < oracle && oracle < matrix.size));
            told += 1;
            negative += oracle;
        }
    });
    assert!(told == 24 && negative > 100, "{told} {negative}");
}

#[test]
fn faer_keeps_quasi_definite_matrices_and_gives_others_to_mumps() {
    let mut random = Random(11);
    for (matrix, name) in [
        (Matrix::quasi_definite(200, &mut random), "faer LDLᵀ"),
        (saddle(200), "MUMPS LDLᵀ"),
    ] {
        let mut direct = matrix.direct(Backend::Faer);
        check(&mut direct, &matrix, &mut random);
        assert_eq!(direct.method(), name);
    }
}

/// Pairs of unknowns with nothing on the diagonal.
fn saddle(size: usize) -> Matrix {
    let mut matrix = Matrix {
        size,
        symmetry: Symmetric,
        entries: Vec::new(),
        values: Vec::new(),
    };
    for row in (0..size).step_by(2) {
        matrix.both(row, row + 1, 1.0 + row as f64 / size as f64);
        matrix.both(row, (row + 3) % size, 0.1);
    }
    matrix
}

#[test]
fn what_is_not_determined_is_named() {
    let (hole, pair) = (4, [2, 5]);
    every(|mut direct, matrix, random| {
        if matrix.size < 7 {
            return;
        }
        let name = direct.method();
        let empty = matrix.clone().map(|row, col, value| {
            if row == hole || col == hole {
                0.0
            } else {
                value
            }
        });
        assert_eq!(
            direct.factor(&empty.values).unwrap_err().column,
            hole,
            "{name}"
        );

        // Two unknowns enter everything alike.
        let dense = matrix.dense();
        let alike = |i: usize| if i == pair[1] { pair[0] } else { i };
        let mut twins = Matrix {
            entries: Vec::new(),
            values: Vec::new(),
            ..matrix.clone()
        };
        for row in 0..matrix.size {
            for col in 0..matrix.size {
                let value = match matrix.symmetry {
                    Symmetric => dense[(alike(row), alike(col))],
                    Unsymmetric => dense[(row, alike(col))],
                };
                if value != 0.0 {
                    twins.push(row, col, value);
                }
            }
        }
        let backend = match name {
            name if name.starts_with("dense") => Backend::Dense,
            name if name.starts_with("faer") => Backend::Faer,
            _ => Backend::Mumps,
        };
        let mut direct = twins.direct(backend);
        let singular = direct.factor(&twins.values).unwrap_err();
        assert!(pair.contains(&singular.column), "{name}: {singular}");

        // Two equations say the same.
        let mut twins = Matrix {
            entries: Vec::new(),
            values: Vec::new(),
            ..matrix.clone()
        };
        if matrix.symmetry == Unsymmetric {
            for row in 0..matrix.size {
                for col in 0..matrix.size {
                    twins.push(row, col, dense[(alike(row), col)] + 0.1);
                }
            }
            assert!(
                twins.direct(backend).factor(&twins.values).is_err(),
                "{name}"
            );
        }

        let mut infinite = matrix.clone();
        infinite.values[0] = f64::NAN;
        infinite
            .direct(backend)
            .factor(&infinite.values)
            .unwrap_err();
        check(&mut matrix.direct(backend), &matrix, random);
    });
}

#[test]
fn units_of_rows_and_columns_do_not_matter() {
    let mut solved = 0;
    every(|_, matrix, random| {
        if matrix.size < 7 {
            return;
        }
        // Factors of rows times columns are between 1e-11 and 1e11.
        let mut units = || -> Vec<f64> {
            let unit = |_| 10.0_f64.powf(5.5 * random.number());
            (0..matrix.size).map(unit).collect()
        };
        let cols = units();
        let rows = match matrix.symmetry {
            Symmetric => cols.clone(),
            Unsymmetric => units(),
        };
        let scaled = matrix
            .clone()
            .map(|row, col, value| value * rows[row] * cols[col]);
        let known: Vec<f64> = (0..matrix.size).map(|_| 1.5 + random.number()).collect();
        let product = matrix.dense() * DVector::from_column_slice(&known);
        let rhs: Vec<f64> = product
            .iter()
            .zip(&rows)
            .map(|(value, row)| value * row)
            .collect();
        for backend in BACKENDS {
            let mut direct = scaled.direct(backend);
            direct.factor(&scaled.values).unwrap();
            let mut x = rhs.clone();
            direct.solve(&mut x);
            for (value, col) in x.iter_mut().zip(&cols) {
                *value *= col;
            }
            let error = distance(&x, &known);
            assert!(error < 1e-10, "{}: {error:.1e}", direct.method());
            solved += 1;
        }
    });
    assert_eq!(solved, 3 * 9 * BACKENDS.len());
}

#[test]
fn nothing_is_solved_too() {
    for symmetry in SYMMETRIES {
        for backend in [None].into_iter().chain(BACKENDS.map(Some)) {
            let mut direct = Direct::with(0, &[], symmetry, backend);
            direct.factor(&[]).unwrap();
            direct.solve(&mut []);
            let mut direct = Direct::with(3, &[], symmetry, backend);
            assert_eq!(direct.factor(&[]).unwrap_err().column, 0);
            let entries: Vec<(usize, usize)> = (0..60).map(|i| (i, i)).collect();
            let mut direct = Direct::with(61, &entries, symmetry, backend);
            assert_eq!(direct.factor(&[1.0; 60]).unwrap_err().column, 60);
        }
    }
}

/// Solves hs071, each call of the objective with a factorisation in between; returns their number.
pub(crate) fn ipopt_calls_mumps() -> usize {
    let mut random = Random(3);
    let matrix = Matrix::quasi_definite(60, &mut random);
    let mut direct = matrix.direct(Backend::Mumps);
    let mut program = hs071();
    let count = Arc::new(AtomicUsize::new(0));
    let (mut objective, calls) = (program.f, count.clone());
    program.f = Box::new(move |x| {
        check(&mut direct, &matrix, &mut random);
        calls.fetch_add(1, Ordering::Relaxed);
        objective(x)
    });
    let start = StartingPoint {
        x: HS071_START.to_vec(),
        costates: None,
    };
    let mut go_on = |_: &ipopt::Iteration, _: &ipopt::Reached<'_>| ControlFlow::Continue(());
    let options = Options {
        linear_solver: LinearSolver::Mumps,
        ..Options::default()
    };
    let solution = ipopt::solve(&mut program, &start, &options, &mut go_on).unwrap();
    assert!(solution.status.is_solved());
    assert!((solution.objective - HS071_OPTIMUM).abs() < 1e-6);
    count.load(Ordering::Relaxed)
}

#[test]
fn threads_take_turns_in_mumps_and_ipopt() {
    let worker = |seed: u64| {
        move || {
            let mut random = Random(seed);
            for _ in 0..40 {
                let matrix = Matrix::random(40, SYMMETRIES[random.below(2)], &mut random);
                let mut direct = matrix.direct(Backend::Mumps);
                for _ in 0..3 {
                    check(&mut direct, &matrix, &mut random);
                }
            }
        }
    };
    let threads = [17, 23].map(|seed| thread::spawn(worker(seed)));
    let solver = thread::spawn(|| (0..20).map(|_| ipopt_calls_mumps()).sum::<usize>());
    for thread in threads {
        thread.join().unwrap();
    }
    assert!(solver.join().unwrap() > 100);
}

/// A factor made by one thread serves another.
#[test]
fn factors_travel() {
    let mut random = Random(5);
    let matrix = Matrix::random(60, Symmetric, &mut random);
    let mut direct = matrix.direct(Backend::Mumps);
    check(&mut direct, &matrix, &mut random);
    thread::spawn(move || check(&mut direct, &matrix, &mut random))
        .join()
        .unwrap();
}
