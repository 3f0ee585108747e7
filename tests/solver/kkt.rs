//! Factors of systems along a horizon against dense eigenvalues and residuals.

use crate::horizon::{Horizon, System};
use crate::matrices::Random;
use nalgebra::DVector;
use proboscis::kkt::{Inertia, Plan, Solver, Unknown};
use std::thread;

const PLAIN: Horizon = Horizon {
    intervals: 7,
    states: 4,
    inputs: 3,
    limits: 0,
    has_border: false,
    own: 0.0,
};

pub(crate) fn solver(system: &System, unknowns: Option<&[Unknown]>) -> Solver {
    Solver::new(Plan::new(
        system.order(),
        &system.rows,
        &system.cols,
        unknowns,
    ))
}

/// Greatest entry of `b − A x` against those of A, x and b.
pub(crate) fn error(system: &System, solver: &mut Solver) -> f64 {
    let a = system.dense();
    let right = DVector::from_fn(system.order(), |i, _| (1.0 + i as f64).sin());
    let mut x = right.clone();
    solver.solve(x.as_mut_slice());
    assert!(x.amax() > 0.0);
    (&right - &a * &x).amax() / (a.amax() * x.amax() + right.amax())
}

/// The inertia is that of dense eigenvalues and the solution keeps its residual, in the order of stages and in any other.
pub(crate) fn check(system: &System, expected: Inertia) {
    assert!(expected.negative > 0 && expected.negative < system.order());
    for unknowns in [Some(system.unknowns.as_slice()), None] {
        let mut solver = solver(system, unknowns);
        assert_eq!(solver.factor(&system.entries), expected);
        if expected.zero == 0 {
            let error = error(system, &mut solver);
            assert!(error < 1e-9, "{error:e}");
        }
    }
}

#[test]
fn inertia_is_that_of_dense_eigenvalues() {
    let mut random = Random(1);
    let shapes = [
        PLAIN,
        Horizon { limits: 2, ..PLAIN },
        Horizon {
            has_border: true,
            ..PLAIN
        },
        Horizon {
            limits: 3,
            has_border: true,
            states: 2,
            ..PLAIN
        },
        Horizon {
            intervals: 1,
            states: 50,
            ..PLAIN
        },
        Horizon {
            intervals: 3,
            states: 30,
            limits: 5,
            ..PLAIN
        },
        Horizon {
            intervals: 40,
            states: 1,
            inputs: 1,
            ..PLAIN
        },
    ];
    for shape in shapes {
        for diagonal in [1.0, 1e4] {
            for _ in 0..4 {
                let system = System::of_horizon(shape, diagonal, &mut random);
                let expected = system.inertia();
                assert_eq!(expected.zero, 0);
                check(&system, expected);
            }
        }
    }
}

#[test]
fn pivots_wait_where_diagonals_are_zero() {
    let mut random = Random(2);
    let shape = Horizon { inputs: 4, ..PLAIN };
    let system = System::of_horizon(shape, 0.0, &mut random);
    check(&system, system.inertia());
    let mut solver = solver(&system, Some(&system.unknowns));
    solver.factor(&system.entries);
    assert!(solver.statistics().delays > 0, "{:?}", solver.statistics());
}

/// Rows that repeat others, and unknowns without entries, are found, all of them.
#[test]
fn singular_systems_tell_how_many_eigenvalues_are_zero() {
    let mut random = Random(3);
    for copies in 1..6 {
        for _ in 0..4 {
            let mut system = System::of_horizon(PLAIN, 1.0, &mut random);
            let first = PLAIN.intervals * (PLAIN.states + PLAIN.inputs);
            for copy in 0..copies {
                let (row, new) = ((first + 5 * copy) as u32, system.order());
                system.unknowns.push(Unknown::Equality);
                for e in 0..system.entries.len() {
                    let (i, j, value) = (system.rows[e], system.cols[e], system.entries[e]);
                    if i == row && j != row {
                        system.push(new, j as usize, value);
                    }
                }
                system.push(new, new, 0.0);
            }
            system.unknowns.push(Unknown::Variable(3));
            system.push(system.order() - 1, system.order() - 1, 0.0);
            let expected = system.inertia();
            assert_eq!(expected.zero, copies + 1);
            check(&system, expected);
        }
    }
}

/// By Sylvester's law scaling changes no sign, whatever it does to the numbers.
#[test]
fn inertia_survives_bad_scales() {
    let mut random = Random(4);
    for _ in 0..6 {
        let shape = Horizon { limits: 1, ..PLAIN };
        let mut system = System::of_horizon(shape, 1.0, &mut random);
        let expected = system.inertia();
        let scales: Vec<f64> = (0..system.order())
            .map(|_| 10.0_f64.powf(8.0 * random.number()))
            .collect();
        for e in 0..system.entries.len() {
            let (i, j) = (system.rows[e] as usize, system.cols[e] as usize);
            system.entries[e] *= scales[i] * scales[j];
        }
        check(&system, expected);
    }
}

/// Dense, with all pivots in one front: several panels, pairs, and groups of rows that are not full.
#[test]
fn large_fronts_are_exact() {
    let mut random = Random(5);
    for order in [1, 2, 7, 31, 64, 65, 133, 200] {
        let system = System::full(order, |i, j| {
            let value = random.number();
            if i == j { 0.01 * value } else { value }
        });
        let expected = system.inertia();
        let mut solver = solver(&system, Some(&system.unknowns));
        assert_eq!(solver.factor(&system.entries), expected);
        let error = error(&system, &mut solver);
        assert!(error < 1e-11, "{order}: {error:e}");
    }
}

#[test]
fn what_is_no_number_counts_as_singular() {
    let mut system = System::of_horizon(PLAIN, 1.0, &mut Random(6));
    let expected = system.inertia();
    let mut solver = solver(&system, Some(&system.unknowns));
    for bad in [f64::NAN, f64::INFINITY] {
        let good = std::mem::replace(&mut system.entries[17], bad);
        let inertia = solver.factor(&system.entries);
        assert_eq!((inertia.negative, inertia.zero), (0, system.order()));
        let mut x = vec![1.0; system.order()];
        solver.solve(&mut x);
        assert!(x.iter().all(|x| x.is_nan()));
        system.entries[17] = good;
        assert_eq!(solver.factor(&system.entries), expected);
    }
}

#[test]
fn threads_find_the_same_bits() {
    let mut random = Random(7);
    let shape = Horizon {
        intervals: 30,
        limits: 2,
        has_border: true,
        ..PLAIN
    };
    let system = System::of_horizon(shape, 1.0, &mut random);
    let solution = || {
        let mut solver = solver(&system, Some(&system.unknowns));
        (0..20)
            .map(|_| {
                solver.factor(&system.entries);
                let mut x: Vec<f64> = (0..system.order()).map(|i| i as f64).collect();
                solver.solve(&mut x);
                x
            })
            .collect::<Vec<_>>()
    };
    let expected = solution();
    thread::scope(|scope| {
        let others: Vec<_> = (0..4).map(|_| scope.spawn(solution)).collect();
        for other in others {
            assert!(other.join().unwrap() == expected);
        }
    });
}
