//! A simulated motion satisfies the equality constraints of its transcription to the tolerance of Newton's method.
//!
//! Newton ends when an update is below 1e-9, so the error left is of order 1e-18 and rounding decides. Rows are scaled by
//! the largest entry of their kind in the Jacobian, so a row of 1e-12 moves a coordinate of order one by 1e-12.

use crate::common::cases::{control, hold, joints};
use crate::common::random::Random;
use crate::common::systems::{BRANCHED_VOLTAGES, blocks, branched};
use crate::common::trunk;
use proboscis::control::problem::{BoundaryState, Duration, Rest};
use proboscis::control::{BoundaryConditions, Row, Transcription, guess};
use proboscis::dynamics::{Start, simulate};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::nlp::Nlp;
use std::ops::ControlFlow;

const INTERVALS: usize = 25;
const STEP: f64 = 6.0;

fn law(
    name: &str,
    system: &System,
    coordinates: Coordinates,
    free: bool,
    voltage: impl Fn(usize) -> Vec<f64>,
) {
    let mut control = control(system, INTERVALS);
    control.coordinates = Some(coordinates);
    control.start =
        BoundaryState::RestAtVoltages(vec![0.0; system.sources().len()], Rest::Everything);
    control.goal = joints(&[]);
    let duration = STEP * INTERVALS as f64;
    control.duration = if free {
        Duration::Free {
            min: 1.0,
            max: 1e3,
            guess: duration,
        }
    } else {
        Duration::Given(duration)
    };
    let (model, boundary) = BoundaryConditions::resolve(system, &control, STEP).unwrap();
    let start = Start {
        rates: None,
        ..boundary.start.clone()
    };
    let scalars = |from: f64, _: f64| model.scalars(&voltage((from / STEP).round() as usize));
    let (mut discrete, failure) = simulate(&model, &start, STEP, INTERVALS, scalars, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    assert_eq!(
        discrete.report.halved, 0,
        "{name}: all steps are those of the grid"
    );
    let n = model.coordinate_count();
    discrete.z[INTERVALS][n..].fill(0.0);
    let first = &discrete.z[0][..n];
    let moved = discrete
        .z
        .iter()
        .flat_map(|z| z[..n].iter().zip(first).map(|(a, b)| (a - b).abs()));
    assert!(moved.fold(0.0, f64::max) > 0.05, "{name} moves");

    let initial = guess(&model, &boundary, &control, STEP, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let x = program.encode(&discrete, STEP);
    let rows = program.unknowns().rows.clone();
    let mut g = vec![0.0; rows.len()];
    program.constraint(&x, &mut g);
    let mut worst = 0.0_f64;
    for (row, (value, r)) in rows.iter().zip(g.iter().zip(0..)) {
        match *row {
            // At the end the motion is not at rest: the row is minus the momentum there, in the scale of the rows of i.
            Row::Instant { k: INTERVALS, i } if i < n => {
                let scale = momentum_scale(&mut program, &x, i);
                let momentum = discrete.momenta[INTERVALS][i] * scale;
                assert!(
                    (value - momentum).abs() < 1e-12 * (1.0 + momentum.abs()),
                    "{value} against {momentum}"
                );
            }
            Row::Instant { .. } | Row::Interval { .. } => {
                assert!(
                    value.abs() < 1e-12,
                    "{name} {coordinates:?}: {} is {value:e}",
                    program.constraint_name(r)
                );
                worst = worst.max(value.abs());
            }
            Row::Time { .. } | Row::Limit { .. } => unreachable!("there are none"),
        }
    }
    println!("{name} {coordinates:?}: largest row {worst:.1e}");
    // Any other voltages violate them.
    discrete.scalars[3][0] += 50.0;
    let x = program.encode(&discrete, STEP);
    program.constraint(&x, &mut g);
    assert!(g.iter().any(|value| value.abs() > 1e-7), "{name}");
}

/// Scale of the rows of coordinate i: scaled over unscaled costates.
fn momentum_scale(program: &mut Transcription<'_>, x: &[f64], i: usize) -> f64 {
    let mut costates = proboscis::nlp::Multipliers {
        constraints: vec![0.0; program.unknowns().rows.len()],
        lower: vec![0.0; x.len()],
        upper: vec![0.0; x.len()],
    };
    let row = program.unknowns().row(INTERVALS, i).unwrap();
    costates.constraints[row] = 1.0;
    program.costates(&costates).rows[row]
}

#[test]
fn simulated_motions_are_feasible() {
    let random_voltages = |count: usize, seed: u64| {
        let mut random = Random(seed);
        let table: Vec<Vec<f64>> = (0..INTERVALS)
            .map(|_| (0..count).map(|_| random.between(0.0, 2e3)).collect())
            .collect();
        move |k: usize| table[k].clone()
    };
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        for free in [false, true] {
            law("trunk, constant", &trunk(3), coordinates, free, |_| hold(3));
            law(
                "trunk, random",
                &trunk(3),
                coordinates,
                free,
                random_voltages(6, 1),
            );
            law("branched, constant", &branched(), coordinates, free, |_| {
                BRANCHED_VOLTAGES.map(|v| 2.0 * v).to_vec()
            });
            law(
                "branched, random",
                &branched(),
                coordinates,
                free,
                random_voltages(4, 2),
            );
            let of_blocks = |v: Vec<f64>| [v, vec![8e4]].concat();
            law("blocks, constant", &blocks(), coordinates, free, |_| {
                of_blocks(hold(2))
            });
            let random = random_voltages(4, 3);
            law("blocks, random", &blocks(), coordinates, free, |k| {
                of_blocks(random(k))
            });
        }
    }
}
