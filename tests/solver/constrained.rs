//! Systems with constraints and their multipliers in each stage, against dense eigenvalues and against factors along the horizon.

use crate::common::cases::rest_to_rest;
use crate::common::trunk;
use crate::horizon::System;
use crate::matrices::Random;
use nalgebra::DVector;
use proboscis::control::problem::Control;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::kkt::{Plan, Solver, Unknown};
use proboscis::model::Coordinates;
use proboscis::nlp::{Nlp, Stage};

/// Mechanics in redundant coordinates, with random numbers.
#[derive(Clone, Copy)]
struct Chain {
    instants: usize,
    coordinates: usize,
    constraints: usize,
    inputs: usize,
    has_border: bool,
    /// Inequalities of each instant with their slacks.
    limits: usize,
}

const CHAIN: Chain = Chain {
    instants: 4,
    coordinates: 12,
    constraints: 10,
    inputs: 3,
    has_border: false,
    limits: 0,
};

/// Unknowns of a chain at each instant.
struct Places {
    coordinates: Vec<Vec<usize>>,
    multipliers: Vec<Vec<usize>>,
    balances: Vec<Vec<usize>>,
    constraints: Vec<Vec<usize>>,
}

/// Coordinates, multipliers and inputs of each instant; balances that couple three instants and hold the multipliers of one; constraints.
/// The Jacobian of the constraints stands in them and, transposed and with other numbers, in the balances.
fn system(chain: Chain, random: &mut Random) -> (System, Places) {
    let mut system = System {
        rows: Vec::new(),
        cols: Vec::new(),
        entries: Vec::new(),
        unknowns: Vec::new(),
    };
    let mut add = |kind: Unknown, count: usize| {
        let begin = system.unknowns.len();
        system.unknowns.resize(begin + count, kind);
        (begin..begin + count).collect::<Vec<_>>()
    };
    let (mut coordinates, mut multipliers, mut inputs) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..chain.instants as u32 {
        coordinates.push(add(Unknown::Variable(2 * k), chain.coordinates));
        multipliers.push(add(Unknown::Multiplier(2 * k + 2), chain.constraints));
        inputs.push(add(Unknown::Variable(2 * k + 1), chain.inputs));
    }
    let border = add(Unknown::Border, usize::from(chain.has_border));
    let slacks = add(Unknown::Slack, chain.limits * chain.instants);
    let (mut balances, mut constraints) = (Vec::new(), Vec::new());
    for _ in 0..chain.instants {
        balances.push(add(Unknown::Equality, chain.coordinates));
        constraints.push(add(Unknown::Equality, chain.constraints));
    }
    let limits = add(Unknown::Inequality, chain.limits * chain.instants);
    let mut put = |a: &[usize], b: &[usize], size: f64| {
        for &i in a {
            for &j in b.iter().filter(|&&j| a != b || j <= i) {
                system.push(i, j, size * random.number());
            }
        }
    };
    for k in 0..chain.instants {
        put(&coordinates[k], &coordinates[k], 1.0);
        put(&coordinates[k], &coordinates[k], 0.5);
        put(&coordinates[k], &multipliers[k], 1.0);
        put(&constraints[k], &coordinates[k], 1.0);
        put(&balances[k], &multipliers[k], 1.0);
        put(&coordinates[k], &inputs[k], 1.0);
        put(&balances[k], &border, 1.0);
        for l in k.saturating_sub(1)..=(k + 1).min(chain.instants - 1) {
            put(&balances[k], &coordinates[l], 1.0);
            put(&balances[k], &inputs[l], 1.0);
            if l < k {
                put(&coordinates[k], &coordinates[l], 1.0);
            }
        }
        for &input in &inputs[k] {
            put(&[input], &[input], 1.0);
        }
        for i in k * chain.limits..(k + 1) * chain.limits {
            put(&[slacks[i]], &[slacks[i]], 1.0);
            put(&[limits[i]], &[slacks[i]], 1.0);
            put(&[limits[i]], &coordinates[k], 1.0);
        }
    }
    put(&border, &border, 1.0);
    // Diagonals that an interior-point method lists, most of them zero.
    for i in 0..system.order() {
        system.push(i, i, 0.0);
    }
    let places = Places {
        coordinates,
        multipliers,
        balances,
        constraints,
    };
    (system, places)
}

fn solver(system: &System, unknowns: Option<&[Unknown]>) -> Solver {
    let (rows, cols) = (&system.rows, &system.cols);
    Solver::new(Plan::new(system.order(), rows, cols, unknowns))
}

fn solution(system: &System, solver: &mut Solver) -> DVector<f64> {
    let mut x = DVector::from_fn(system.order(), |i, _| (1.0 + i as f64).sin());
    solver.solve(x.as_mut_slice());
    x
}

/// Inertia is that of dense eigenvalues, and solutions are those of factors along the horizon. Whether it was condensed.
fn check(system: &System, solver: &mut Solver) -> bool {
    let before = solver.statistics().condensed;
    let expected = system.inertia();
    assert!(expected.negative > 0 && expected.negative < system.order());
    assert_eq!(solver.factor(&system.entries), expected);
    let is_condensed = solver.statistics().condensed > before;
    let mut other = self::solver(system, None);
    assert_eq!(other.factor(&system.entries), expected);
    assert_eq!(other.statistics().condensed, 0);
    if expected.zero == 0 {
        let a = system.dense();
        let [x, y] = [solver, &mut other].map(|solver| solution(system, solver));
        let right = DVector::from_fn(system.order(), |i, _| (1.0 + i as f64).sin());
        let residual = (&right - &a * &x).amax() / (a.amax() * x.amax() + right.amax());
        assert!(residual < 1e-11, "{residual:e}");
        let error = (&x - &y).amax() / y.amax();
        assert!(y.amax() > 0.0 && error < 1e-7, "{error:e}");
    }
    is_condensed
}

/// The place of the last entry on the diagonal of an unknown.
fn diagonal(system: &System, unknown: usize) -> usize {
    let mut places = system.rows.iter().zip(&system.cols);
    let is_there = |(&i, &j): (&u32, &u32)| (i as usize, j as usize) == (unknown, unknown);
    places.rposition(is_there).expect("a diagonal entry")
}

#[test]
fn constraints_and_multipliers_go_first() {
    let mut random = Random(21);
    let chains = [
        CHAIN,
        Chain {
            has_border: true,
            ..CHAIN
        },
        Chain { limits: 2, ..CHAIN },
        Chain {
            inputs: 0,
            instants: 6,
            ..CHAIN
        },
        Chain {
            coordinates: 24,
            constraints: 22,
            instants: 3,
            limits: 1,
            has_border: true,
            ..CHAIN
        },
    ];
    for chain in chains {
        for _ in 0..3 {
            let (mut system, places) = system(chain, &mut random);
            let mut solver = solver(&system, Some(&system.unknowns));
            assert!(check(&system, &mut solver));
            // Values change, and with them which coordinates are determined.
            for entry in &mut system.entries {
                *entry *= 1.0 + 0.9 * random.number();
            }
            assert!(check(&system, &mut solver));
            // A diagonal of multipliers is borne, one of constraints is not, nor is one of multipliers beside one of balances.
            let at = places.multipliers.concat().into_iter();
            let at: Vec<usize> = at.map(|i| diagonal(&system, i)).collect();
            for size in [1e-4, 1e-2, 1.0] {
                at.iter().for_each(|&at| system.entries[at] = size);
                assert!(check(&system, &mut solver), "{size}");
            }
            at[1..].iter().for_each(|&at| system.entries[at] = 0.0);
            assert!(check(&system, &mut solver));
            let beside = diagonal(&system, places.balances[0][0]);
            system.entries[beside] = -1e-3;
            assert!(!check(&system, &mut solver));
            system.entries[at[0]] = 0.0;
            assert!(check(&system, &mut solver));
            system.entries[beside] = 0.0;
            assert!(check(&system, &mut solver));
            let at = diagonal(&system, places.constraints[1][2]);
            system.entries[at] = -1e-3;
            assert!(!check(&system, &mut solver));
            system.entries[at] = 0.0;
            assert!(check(&system, &mut solver));
        }
    }
}

/// Constraints that repeat others leave zero eigenvalues, as many as there are; one that nearly does is solved for exactly.
#[test]
fn constraints_may_depend_on_each_other() {
    let mut random = Random(22);
    for difference in [0.0, 1e-15, 1e-9] {
        let (mut system, places) = system(CHAIN, &mut random);
        let (first, second) = (places.constraints[2][0], places.constraints[2][1]);
        for &i in &places.coordinates[2] {
            let entry = |row: usize| {
                let mut places = system.rows.iter().zip(&system.cols);
                let is_there = |(&a, &b): (&u32, &u32)| (a as usize, b as usize) == (row, i);
                places.position(is_there).unwrap()
            };
            let (from, to) = (entry(first), entry(second));
            system.entries[to] = system.entries[from] * (1.0 + difference * random.number());
        }
        let mut solver = solver(&system, Some(&system.unknowns));
        let inertia = solver.factor(&system.entries);
        if difference < 1e-12 {
            assert_eq!(inertia, system.inertia());
            assert_eq!((inertia.zero, solver.statistics().condensed), (1, 0));
        } else {
            let a = system.dense();
            let x = solution(&system, &mut solver);
            let right = DVector::from_fn(system.order(), |i, _| (1.0 + i as f64).sin());
            let residual = (&right - &a * &x).amax() / (a.amax() * x.amax() + right.amax());
            assert!(
                residual < 1e-11 && x.amax() > 1e6,
                "{residual:e} {}",
                x.amax()
            );
        }
    }
}

/// The system of an interior-point method at a point of the trunk in redundant coordinates, with random costates.
fn of_trunk(segments: usize, intervals: usize, random: &mut Random) -> System {
    let control = Control {
        coordinates: Some(Coordinates::Redundant),
        ..rest_to_rest(segments, intervals, 100.0)
    };
    let h = 100.0 / intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&trunk(segments), &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let x: Vec<f64> = program.start(&initial).x;
    let x: Vec<f64> = x.into_iter().map(|x| x + 1e-3 * random.number()).collect();
    let (hessian, jacobian) = (program.hessian_structure(), program.jacobian_structure());
    let rows = program.constraints().lower.len();
    let costates: Vec<f64> = (0..rows).map(|_| random.number()).collect();
    let (mut h, mut j) = (
        vec![0.0; hessian.rows.len()],
        vec![0.0; jacobian.rows.len()],
    );
    program.hessian(&x, 1.0, &costates, &mut h);
    program.jacobian(&x, &mut j);
    let stages = program
        .stages()
        .expect("stages of a transcription")
        .into_iter();
    let mut unknowns: Vec<Unknown> = stages
        .map(|stage| match stage {
            Stage::Of(stage) => Unknown::Variable(stage),
            Stage::Multiplier(stage) => Unknown::Multiplier(stage),
            Stage::Border => Unknown::Border,
        })
        .collect();
    unknowns.resize(x.len() + rows, Unknown::Equality);
    let mut system = System {
        rows: Vec::new(),
        cols: Vec::new(),
        entries: Vec::new(),
        unknowns,
    };
    let places = hessian.rows.iter().zip(&hessian.cols);
    for ((&row, &col), &value) in places.zip(&h) {
        system.push(row as usize, col as usize, value);
    }
    let places = jacobian.rows.iter().zip(&jacobian.cols);
    for ((&row, &col), &value) in places.zip(&j) {
        system.push(x.len() + row as usize, col as usize, value);
    }
    for i in 0..system.order() {
        let is_bounded = matches!(system.unknowns[i], Unknown::Variable(stage) if stage % 2 == 1);
        system.push(i, i, f64::from(u8::from(is_bounded)));
    }
    system
}

#[test]
fn systems_of_the_trunk_are_exact() {
    let mut random = Random(23);
    for (segments, intervals) in [(1, 4), (2, 3), (3, 3)] {
        let mut system = of_trunk(segments, intervals, &mut random);
        let multipliers = |u: &Unknown| matches!(u, Unknown::Multiplier(_));
        let count = system.unknowns.iter().filter(|u| multipliers(u)).count();
        assert_eq!(count, 11 * segments * (intervals + 1));
        let mut solver = solver(&system, Some(&system.unknowns));
        assert!(check(&system, &mut solver), "{segments} segments");
        // With a multiple of one added to all variables.
        for i in 0..system.order() {
            if system.unknowns[i] != Unknown::Equality {
                let at = diagonal(&system, i);
                system.entries[at] += 1e-2;
            }
        }
        assert!(check(&system, &mut solver), "{segments} segments");
    }
}
