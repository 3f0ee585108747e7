//! Systems whose equations determine many unknowns: condensed where that is exact, factorised as a whole where it is not.

use crate::horizon::{Horizon, System};
use crate::kkt::{check, error, solver};
use crate::matrices::Random;
use proboscis::kkt::Unknown;

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
