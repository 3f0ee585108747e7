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

fn solver(system: &System, unknowns: Option<&[Unknown]>) -> Solver {
    Solver::new(Plan::new(
        system.order(),
        &system.rows,
        &system.cols,
        unknowns,
    ))
}

/// Greatest entry of `b − A x` against those of A, x and b.
fn error(system: &System, solver: &mut Solver) -> f64 {
    let a = system.dense();
    let right = DVector::from_fn(system.order(), |i, _| (1.0 + i as f64).sin());
    let mut x = right.clone();
    solver.solve(x.as_mut_slice());
    assert!(x.amax() > 0.0);
    (&right - &a * &x).amax() / (a.amax() * x.amax() + right.amax())
}

/// The inertia is that of dense eigenvalues and the solution keeps its residual, in the order of stages and in any other.
fn check(system: &System, expected: Inertia) {
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

/// Many states and few inputs.
const CONDENSED: Horizon = Horizon {
    intervals: 6,
    states: 20,
    inputs: 1,
    limits: 0,
    has_border: false,
    own: 20.0,
};

/// The place of the first diagonal entry of an equation.
fn first_equation(system: &System) -> usize {
    let is_equation = |i: u32| system.unknowns[i as usize] == Unknown::Equality;
    let mut places = system.rows.iter().zip(&system.cols);
    let found = places.position(|(&i, &j)| i == j && is_equation(i));
    found.expect("a diagonal of equations")
}

#[test]
fn many_states_and_few_inputs_are_condensed() {
    let mut random = Random(8);
    let shapes = [
        CONDENSED,
        Horizon {
            has_border: true,
            ..CONDENSED
        },
        Horizon {
            limits: 1,
            ..CONDENSED
        },
        Horizon {
            limits: 1,
            has_border: true,
            states: 30,
            inputs: 2,
            ..CONDENSED
        },
    ];
    for shape in shapes {
        for terminal in [0, 2] {
            let mut system = System::of_horizon(shape, 1.0, &mut random);
            for _ in 0..terminal {
                let row = system.order();
                system.unknowns.push(Unknown::Equality);
                let last = shape.intervals * (shape.states + shape.inputs);
                for state in last - shape.states..last {
                    system.push(row, state, random.number());
                }
                system.push(row, row, 0.0);
            }
            let expected = system.inertia();
            check(&system, expected);
            let mut solver = solver(&system, Some(&system.unknowns));
            assert_eq!(solver.factor(&system.entries), expected);
            assert_eq!(solver.statistics().condensed, 1);
            let error = error(&system, &mut solver);
            assert!(error < 1e-12, "{error:e}");
            // With a diagonal the equations determine no state; once it is gone they do again.
            let place = first_equation(&system);
            system.entries[place] = -1e-3;
            assert_eq!(solver.factor(&system.entries), system.inertia());
            assert_eq!(solver.statistics().condensed, 1);
            system.entries[place] = 0.0;
            assert_eq!(solver.factor(&system.entries), expected);
            assert_eq!(solver.statistics().condensed, 2);
        }
    }
}

/// Multiplies what equations hold of earlier stages.
fn grow(system: &mut System, shape: Horizon, factor: f64) {
    let width = (shape.states + shape.inputs) as u32;
    for e in 0..system.entries.len() {
        let (row, col) = (system.rows[e], system.cols[e]);
        let first = shape.intervals as u32 * width;
        if row >= first && col < first {
            let stage = (row - first) / shape.states as u32;
            if col / width < stage {
                system.entries[e] *= factor;
            }
        }
    }
}

/// An unstable motion multiplies an input by about 100 from stage to stage: in the ninth no digit is right.
#[test]
fn growth_along_the_horizon_is_noticed() {
    let mut random = Random(9);
    let shape = Horizon {
        intervals: 9,
        ..CONDENSED
    };
    let mut system = System::of_horizon(shape, 1.0, &mut random);
    grow(&mut system, shape, 400.0);
    let mut solver = solver(&system, Some(&system.unknowns));
    let inertia = solver.factor(&system.entries);
    // As many negative eigenvalues as equations, but for those of a curvature that is negative in the inputs that are left.
    let equations = shape.intervals * shape.states;
    let range = equations..=equations + shape.intervals;
    assert!(range.contains(&inertia.negative), "{inertia:?}");
    assert_eq!(solver.statistics().condensed, 0);
    let error = error(&system, &mut solver);
    assert!(error < 1e-9, "{error:e}");
}

/// Growth that a great direct response hides shows in what is solved. The matrix is factorised as a whole, and says nothing of the next one.
#[test]
fn a_matrix_behind_one_that_is_not_condensed_exactly_is_condensed() {
    let mut random = Random(12);
    let shape = Horizon {
        intervals: 9,
        ..CONDENSED
    };
    let first = (shape.intervals * (shape.states + shape.inputs)) as u32;
    let mut inexact = 0;
    for _ in 0..10 {
        let harmless = System::of_horizon(shape, 1.0, &mut random);
        let mut system = harmless.clone();
        grow(&mut system, shape, 50.0);
        let mut places = system.rows.iter().zip(&system.cols);
        let is_of_input = |(&i, &j): (&u32, &u32)| i >= first && j < first && is_input(shape, j);
        let last = places.rposition(is_of_input).expect("inputs in equations");
        system.entries[last] *= 1e14;
        let mut solver = solver(&system, Some(&system.unknowns));
        solver.factor(&system.entries);
        assert_eq!(solver.is_whole(), solver.statistics().repeated > 0);
        inexact += usize::from(solver.is_whole());
        let error = error(&system, &mut solver);
        assert!(error < 1e-9, "{error:e}");
        assert_eq!(solver.factor(&harmless.entries), harmless.inertia());
        assert!(!solver.is_whole());
        let error = self::error(&harmless, &mut solver);
        assert!(error < 1e-12, "{error:e}");
    }
    assert!(inexact > 4, "{inexact}");
}

/// Better factors than condensed ones are asked for: the first time for one matrix, then for twice as many behind it as the time before.
#[test]
fn matrices_behind_one_that_needs_better_factors_are_condensed_again() {
    let mut random = Random(13);
    let systems = [0; 6].map(|_| System::of_horizon(CONDENSED, 1.0, &mut random));
    let mut solver = solver(&systems[0], Some(&systems[0].unknowns));
    let mut are_whole = Vec::new();
    for request in 0..3 {
        for (i, system) in systems.iter().enumerate() {
            assert_eq!(solver.factor(&system.entries), system.inertia());
            if i == 0 {
                assert!(!solver.is_whole(), "request {request}");
                solver.improve();
                assert_eq!(solver.factor(&system.entries), system.inertia());
                assert!(solver.is_whole(), "request {request}");
            }
            are_whole.push(solver.is_whole());
            let error = error(system, &mut solver);
            assert!(error < 1e-12, "{error:e}");
        }
    }
    let counts = are_whole
        .chunks(6)
        .map(|part| part.iter().filter(|&&is| is).count());
    assert_eq!(counts.collect::<Vec<_>>(), [1, 2, 4]);
    solver.improve();
    solver.restart();
    solver.factor(&systems[5].entries);
    assert!(!solver.is_whole());
}

fn is_input(shape: Horizon, variable: u32) -> bool {
    (variable as usize) % (shape.states + shape.inputs) < shape.inputs
}

#[test]
fn singular_blocks_are_not_condensed() {
    let mut random = Random(10);
    let mut system = System::of_horizon(CONDENSED, 1.0, &mut random);
    let width = (CONDENSED.states + CONDENSED.inputs) as u32;
    let first = CONDENSED.intervals as u32 * width;
    // A state of the first stage that its own equations do not hold, but the next ones do.
    let state = CONDENSED.inputs as u32;
    for e in 0..system.entries.len() {
        let own = first..first + CONDENSED.states as u32;
        if own.contains(&system.rows[e]) && system.cols[e] == state {
            system.entries[e] = 0.0;
        }
    }
    let expected = system.inertia();
    assert_eq!(expected.zero, 0);
    let mut solver = solver(&system, Some(&system.unknowns));
    assert_eq!(solver.factor(&system.entries), expected);
    let error = error(&system, &mut solver);
    assert!(error < 1e-9, "{error:e}");
}

#[test]
fn systems_without_inputs_are_factorised_as_they_are() {
    let mut random = Random(11);
    let lone = Horizon {
        inputs: 0,
        ..CONDENSED
    };
    let system = System::of_horizon(lone, 1.0, &mut random);
    let expected = system.inertia();
    assert!(expected.negative > 0);
    let mut solver = solver(&system, Some(&system.unknowns));
    assert_eq!(solver.factor(&system.entries), expected);
    let error = error(&system, &mut solver);
    assert!(error < 1e-9, "{error:e}");
}
