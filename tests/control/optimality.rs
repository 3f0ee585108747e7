//! Laws of the optimum: it is a motion, it is at rest at its end, it satisfies the conditions of Karush, Kuhn and Tucker,
//! and it does not depend on coordinates, on where the solver starts near it, or on whether the time was given or found.

use crate::common::cases::{hold, rest_to_rest};
use crate::common::{numbers, reference, trunk};
use proboscis::control::problem::{Control, Duration, Objective};
use proboscis::control::{BoundaryConditions, Column, Costates, Row, Transcription, guess};
use proboscis::dynamics::{DiscreteTrajectory, simulate};
use proboscis::ipopt::{self, Options, SolverResult, Start};
use proboscis::model::system::System;
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::Nlp;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Data of a solved problem.
pub(crate) struct Optimum {
    pub(crate) model: Model,
    pub(crate) boundary: BoundaryConditions,
    pub(crate) discrete: DiscreteTrajectory,
    pub(crate) h: f64,
    pub(crate) solution: SolverResult,
    pub(crate) costates: Costates,
    pub(crate) columns: Vec<Column>,
    pub(crate) rows: Vec<Row>,
    /// Largest entries of the four conditions: stationarity, rows, complementarity, sign of multipliers.
    pub(crate) conditions: [f64; 4],
    /// Largest multipliers of rows and of bounds.
    pub(crate) multipliers: [f64; 2],
}

pub(crate) fn guessed_step(control: &Control) -> f64 {
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    t / control.intervals as f64
}

/// Solves a problem, from a motion where one is given.
pub(crate) fn solve(
    system: &System,
    control: &Control,
    from: Option<(&DiscreteTrajectory, f64, Option<&Costates>)>,
    start: Start,
) -> Optimum {
    // Multipliers of the motion are in units of the guessed step, whatever step they start from.
    let (model, boundary) =
        BoundaryConditions::resolve(system, control, guessed_step(control)).unwrap();
    let h = from.map_or(guessed_step(control), |(_, h, _)| h);
    let mut initial = guess(&model, &boundary, control, h, None);
    if let Some((discrete, _, costates)) = from {
        initial.discrete = discrete.clone();
        initial.costates = costates.cloned();
    }
    let options = Options {
        tolerance: 1e-10,
        start,
        ..Options::default()
    };
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let point = program.start(&initial);
    let solution = ipopt::solve(&mut program, &point, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let (conditions, multipliers) = karush_kuhn_tucker(&mut program, &solution);
    let discrete = program.decode(&solution.x);
    let h = discrete.times[1];
    let costates = program.costates(&solution.costates);
    let (columns, rows) = (
        program.unknowns().columns.clone(),
        program.unknowns().rows.clone(),
    );
    drop(program);
    Optimum {
        model,
        boundary,
        discrete,
        h,
        solution,
        costates,
        columns,
        rows,
        conditions,
        multipliers,
    }
}

/// ∇f + ∇cᵀy − z_L + z_U at the end of a solve.
pub(crate) fn stationarity(program: &mut Transcription<'_>, solution: &SolverResult) -> Vec<f64> {
    let (x, y) = (&solution.x, &solution.costates);
    let mut gradient = vec![0.0; x.len()];
    program.gradient(x, &mut gradient);
    let entries = program.jacobian_structure();
    let mut values = vec![0.0; entries.rows.len()];
    program.jacobian(x, &mut values);
    for ((&row, &col), value) in entries.rows.iter().zip(&entries.cols).zip(&values) {
        gradient[col as usize] += y.constraints[row as usize] * value;
    }
    let bounds = y.lower.iter().zip(&y.upper);
    let slopes = gradient.iter().zip(bounds);
    slopes
        .map(|(slope, (lower, upper))| slope - lower + upper)
        .collect()
}

/// ∇f + ∇cᵀy − z_L + z_U, c, products of multipliers and distances, and multipliers of the wrong sign.
fn karush_kuhn_tucker(
    program: &mut Transcription<'_>,
    solution: &SolverResult,
) -> ([f64; 4], [f64; 2]) {
    let x = &solution.x;
    let y = &solution.costates;
    let slopes = stationarity(program, solution);
    let bounds = program.variables().clone();
    let mut worst = [0.0_f64; 4];
    for i in 0..x.len() {
        worst[0] = worst[0].max(slopes[i].abs());
        for (z, distance) in [
            (y.lower[i], x[i] - bounds.lower[i]),
            (y.upper[i], bounds.upper[i] - x[i]),
        ] {
            let product = if distance.is_finite() {
                z * distance
            } else {
                z
            };
            worst[2] = worst[2].max(product.abs());
            worst[3] = worst[3].max(-z).max(-distance);
        }
    }
    let mut g = vec![0.0; y.constraints.len()];
    program.constraint(x, &mut g);
    worst[1] = g.iter().fold(0.0, |m, v| m.max(v.abs()));
    let largest = |list: &[f64]| list.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    (
        worst,
        [
            largest(&y.constraints),
            largest(&y.lower).max(largest(&y.upper)),
        ],
    )
}

/// The reference problem of a name.
pub(crate) fn problem(name: &str) -> (System, Control) {
    let (segments, intervals, duration) = match name {
        "pair" | "pair_time" => (1, 20, 200.0),
        "trunk6_n80" => (6, 80, 600.0),
        _ => (6, 40, 600.0),
    };
    let mut control = rest_to_rest(segments, intervals, duration);
    let weight = |effort, rate, duration| Objective {
        effort,
        rate,
        duration,
        ..Objective::default()
    };
    match name {
        "pair_time" => {
            control.objective = weight(0.0, 0.0, 1.0);
            control.duration = Duration::Free {
                min: 2.0,
                max: 600.0,
                guess: 200.0,
            };
        }
        "trunk6_rate" => control.objective = weight(0.0, 1.0, 0.0),
        _ => control.objective = weight(1.0, 0.0, 0.0),
    }
    (trunk(segments), control)
}

const REFERENCES: [&str; 5] = ["pair", "pair_time", "trunk6", "trunk6_n80", "trunk6_rate"];

/// Nodes and voltages of a reference solution, and its interval length in ms.
fn reference_motion(name: &str) -> (DiscreteTrajectory, f64) {
    let file = reference(name);
    let rows = |key: &str, scale: f64| -> Vec<Vec<f64>> {
        let list = file["control"][key].as_array().unwrap();
        list.iter()
            .map(|row| numbers(row).iter().map(|v| v * scale).collect())
            .collect()
    };
    let discrete = DiscreteTrajectory {
        z: rows("theta_rad", 1.0),
        scalars: rows("voltage_kV", 1e3),
        ..DiscreteTrajectory::default()
    };
    (discrete, 1e3 * file["control"]["h"].as_f64().unwrap())
}

pub(crate) fn cold(system: &System, control: &Control) -> Optimum {
    let optimum = solve(system, control, None, Start::Cold);
    assert!(
        optimum.solution.status.is_solved(),
        "{:?}",
        optimum.solution.status
    );
    optimum
}

fn reduced_and_redundant(control: &Control) -> [Control; 2] {
    [Coordinates::Reduced, Coordinates::Redundant].map(|c| Control {
        coordinates: Some(c),
        ..control.clone()
    })
}

#[test]
fn optima_are_motions_that_stay_at_rest() {
    let pair = problem("pair");
    let short = (trunk(2), rest_to_rest(2, 20, 300.0));
    let trunk6 = problem("trunk6");
    let [pair_reduced, pair_redundant] = reduced_and_redundant(&pair.1);
    for (name, system, control) in [
        ("pair", &pair.0, &pair_reduced),
        ("pair, redundant", &pair.0, &pair_redundant),
        ("two segments", &short.0, &short.1),
        ("trunk", &trunk6.0, &trunk6.1),
    ] {
        let optimum = cold(system, control);
        let n = optimum.model.coordinate_count();
        let intervals = control.intervals;
        let held = optimum.model.scalars(&hold(system.bodies.len()));
        let voltages = |from: f64, _: f64| {
            let k = (from / optimum.h).round() as usize;
            optimum.discrete.scalars.get(k).unwrap_or(&held).clone()
        };
        let start = &optimum.boundary.start;
        let (again, failure) = simulate(
            &optimum.model,
            start,
            optimum.h,
            6 * intervals,
            voltages,
            |_| ControlFlow::Continue(()),
        );
        assert_eq!(failure, None);
        let goal = &optimum.discrete.z[intervals][..n];
        let length = |i: usize| {
            if optimum.model.is_length(i) {
                optimum.model.length()
            } else {
                1.0
            }
        };
        let distance = |z: &[f64], to: &[f64]| {
            (0..n)
                .map(|i| (z[i] - to[i]).abs() / length(i))
                .fold(0.0, f64::max)
        };
        assert!(distance(&again.z[0], goal) > 0.05, "{name} goes somewhere");
        let expected = |k: usize| optimum.discrete.z.get(k).map_or(goal, |z| &z[..n]);
        let apart = |k: usize| distance(&again.z[k], expected(k));
        let on_the_way = (0..=intervals).map(apart).fold(0.0, f64::max);
        let at_rest = (intervals..=6 * intervals).map(apart).fold(0.0, f64::max);
        println!("{name}: nodes to {on_the_way:.1e}, at rest to {at_rest:.1e}");
        assert!(
            on_the_way < 1e-7 && at_rest < 1e-7,
            "{name}: {on_the_way:e}, {at_rest:e}"
        );
    }
}

#[test]
fn both_coordinates_have_the_same_optimum_and_costates() {
    let pair = problem("pair");
    for (name, system, control) in [
        ("pair", pair.0, pair.1),
        ("two segments", trunk(2), rest_to_rest(2, 20, 300.0)),
    ] {
        let [reduced, redundant] = reduced_and_redundant(&control).map(|c| cold(&system, &c));
        let (a, b) = (reduced.solution.objective, redundant.solution.objective);
        println!("{name}: {a} and {b}");
        assert!(a > 1e-2 && (a - b).abs() < 1e-6 * a, "{name}: {a} and {b}");
        let worst = |difference: &dyn Fn(usize) -> f64| {
            (0..control.intervals).map(difference).fold(0.0, f64::max)
        };
        let volts = worst(&|k| {
            let pairs = reduced.discrete.scalars[k]
                .iter()
                .zip(&redundant.discrete.scalars[k]);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        });
        println!("{name}: voltages agree to {volts:.1e} V");
        // Voltages near zero do not change the motion to first order: they are as flat as the objective is.
        assert!(volts < 5.0, "{name}: voltages differ by {volts}");
        // y = P l at every inner instant: constraints vary freely, so costates are tangent to them.
        let mut seen = 0.0_f64;
        let mut error = 0.0_f64;
        for k in 1..control.intervals {
            let of = |optimum: &Optimum, n: usize| {
                let mut list = vec![0.0; n];
                for (row, y) in optimum.rows.iter().zip(&optimum.costates.rows) {
                    match *row {
                        Row::Instant { k: at, i } if at == k && i < n => list[i] = *y,
                        _ => {}
                    }
                }
                list
            };
            let l = of(&reduced, reduced.model.coordinate_count());
            let y = of(&redundant, redundant.model.coordinate_count());
            let expected = redundant
                .model
                .rates_at(&reduced.discrete.z[k], &l, &BTreeMap::new())
                .unwrap();
            let size = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            seen = seen.max(size);
            error = expected
                .iter()
                .zip(&y)
                .fold(error, |m, (a, b)| m.max((a - b).abs()));
        }
        println!("{name}: costates agree to {:.1e}", error / seen);
        assert!(error < 1e-4 * seen, "{name}: {error:e} of {seen:e}");
    }
}

#[test]
fn optima_satisfy_the_conditions_of_first_order() {
    for name in ["pair", "pair_time", "trunk6_rate"] {
        let (system, control) = problem(name);
        let controls = if name == "trunk6_rate" {
            vec![control]
        } else {
            reduced_and_redundant(&control).to_vec()
        };
        for control in controls {
            let optimum = cold(&system, &control);
            let [stationarity, rows, complementarity, signs] = optimum.conditions;
            println!(
                "{name} {:?}: {:?}, multipliers {:?}",
                control.coordinates, optimum.conditions, optimum.multipliers
            );
            // The shortest time drives voltages from bound to bound; the others keep off their bounds.
            let [of_rows, of_bounds] = optimum.multipliers;
            assert!(
                of_rows > 1e-3 && (of_bounds > 1e-4 * of_rows.max(1.0)) == (name == "pair_time"),
                "{name}: {of_bounds}"
            );
            // Ipopt's tolerance 1e-10 is relative to multipliers above 100, which ours are not.
            assert!(stationarity < 1e-8, "{name}: stationarity {stationarity:e}");
            assert!(rows < 1e-9, "{name}: rows {rows:e}");
            assert!(
                complementarity < 1e-7,
                "{name}: complementarity {complementarity:e}"
            );
            assert!(signs <= 1e-7, "{name}: signs {signs:e}");
            assert!(optimum.columns.len() == optimum.solution.x.len());
        }
    }
}

#[test]
fn warm_starts_are_short() {
    for name in REFERENCES {
        let (system, control) = problem(name);
        let first = cold(&system, &control);
        let count = |o: &Optimum| {
            assert!(
                o.solution.status.is_solved(),
                "{name}: {:?}",
                o.solution.status
            );
            let (a, b) = (o.solution.objective, first.solution.objective);
            assert!((a - b).abs() < 1e-6 * b, "{name}: {a} against {b}");
            o.solution.iterations.len() - 1
        };
        let from = Some((&first.discrete, first.h, Some(&first.costates)));
        let again = count(&solve(&system, &control, from, Start::PrimalDual));
        let (discrete, h) = reference_motion(name);
        let primal = count(&solve(
            &system,
            &control,
            Some((&discrete, h, None)),
            Start::PRIMAL,
        ));
        println!(
            "{name}: cold {}, own solution {again}, nodes and voltages {primal}",
            count(&first)
        );
        assert!(count(&first) > 8, "{name}: there is something to save");
        assert!(
            again <= 3,
            "{name}: {again} iterations from its own solution"
        );
        assert!(
            primal <= 7,
            "{name}: {primal} iterations from nodes and voltages"
        );
    }
    let (system, control) = problem("pair_time");
    let [_, redundant] = reduced_and_redundant(&control);
    let first = cold(&system, &redundant);
    let from = Some((&first.discrete, first.h, Some(&first.costates)));
    let again = solve(&system, &redundant, from, Start::PrimalDual);
    println!(
        "redundant: {:?} {}",
        again.solution.status,
        again.solution.iterations.len() - 1
    );
    assert!(again.solution.status.is_solved() && again.solution.iterations.len() <= 9);
}
