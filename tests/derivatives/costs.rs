//! Costs of quantities: their sum is the trapezoidal rule over markers and joints read off the poses, and the Hessian of the objective
//! alone is that of differences, the interval length included.

use crate::common::cases::control;
use crate::common::random::Random;
use crate::common::systems::branched;
use crate::common::tracked::{measured, tracked};
use nalgebra::Vector3;
use proboscis::control::problem::{Control, CostFunction, Duration, During, QuantityCost};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::math::Signal;
use proboscis::model::system::System;
use proboscis::model::{Coordinates, Model, Quantity, What};
use proboscis::nlp::Nlp;
use std::f64::consts::{PI, TAU};

/// The value of a signal, written once more.
fn follow(signal: &Signal, t: f64) -> f64 {
    match signal {
        Signal::Constant(value) => *value,
        Signal::Ramp {
            from,
            to,
            start,
            duration,
        } => from + (to - from) * ((t - start) / duration).clamp(0.0, 1.0),
        Signal::Sine {
            mean,
            amplitude,
            frequency,
            phase,
        } => mean + amplitude * (TAU * frequency * t + phase).sin(),
        Signal::Table { times, values } => {
            let mut sum = values[0];
            for k in 1..times.len() {
                let part = (t - times[k - 1]) / (times[k] - times[k - 1]);
                sum += (values[k] - values[k - 1]) * part.clamp(0.0, 1.0);
            }
            sum
        }
        Signal::Steps { ends, values } => values[ends.iter().filter(|end| **end <= t).count()],
    }
}

/// The place of a marker on a body, from the poses of the bodies of the scene.
fn marker(system: &System, model: &Model, z: &[f64], marker: usize) -> Vector3<f64> {
    let point = &system.markers[marker].point;
    let body = point.body.unwrap();
    let pose = &model.poses(&model.action.map.placed(z))[body];
    let of = &system.bodies[body];
    pose.centre + pose.directors * of.directors.transpose() * (point.at - of.centre)
}

fn deviation(system: &System, model: &Model, z: &[f64], cost: &QuantityCost, t: f64) -> f64 {
    let CostFunction::Square { reference } = &cost.function else {
        unreachable!("not squared here");
    };
    match cost.quantity.what {
        What::Place { marker: m, axis } => marker(system, model, z, m)[axis] - follow(reference, t),
        What::Joint { joint, .. } => {
            let instant = model.action.map.placed(z);
            let value = model.joints(&instant, &vec![0.0; model.joint_readings.len()])[joint];
            let e = value - follow(reference, t);
            match cost.quantity.period(system) {
                Some(_) => (e + PI).rem_euclid(TAU) - PI,
                None => e,
            }
        }
        _ => unreachable!("not followed here"),
    }
}

/// A program at a random point, and its model.
pub(crate) fn at_random<R>(
    control: &Control,
    read: impl FnOnce(&Model, &mut Transcription<'_>, Vec<f64>) -> R,
) -> R {
    let system = branched();
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(&system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let mut random = Random(17);
    let noisy = |x: &f64| x + 0.07 * random.unit();
    let x = program.start(&initial).x.iter().map(noisy).collect();
    read(&model, &mut program, x)
}

/// Free or given duration in both coordinates; long enough for both halves of a horizon, which has them where its duration is given.
fn problems() -> Vec<Control> {
    let mut list = Vec::new();
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        for intervals in [3, 17] {
            let mut given = control(&branched(), intervals);
            given.duration = Duration::Given(36.0);
            given.coordinates = Some(coordinates);
            given.objective = tracked(&[0, 1], &[(0, true), (1, false), (2, true)]);
            // Some of them at the end only.
            for cost in given.objective.quantities.iter_mut().step_by(4) {
                cost.during = During::End;
            }
            if intervals == 3 {
                let mut free = given.clone();
                free.duration = Duration::Free {
                    min: 10.0,
                    max: 90.0,
                    guess: 36.0,
                };
                list.push(free);
            }
            list.push(given);
        }
    }
    list
}

#[test]
fn the_sum_is_the_trapezoidal_rule() {
    let system = branched();
    for control in problems() {
        at_random(&control, |model, program, x| {
            let motion = program.decode(&x);
            let mut expected = 0.0;
            for cost in &control.objective.quantities {
                let squares: Vec<f64> = (0..motion.z.len())
                    .map(|k| {
                        let t = motion.times[k];
                        deviation(&system, model, &motion.z[k], cost, t).powi(2)
                    })
                    .collect();
                assert!(squares.iter().sum::<f64>() > 1e-3, "{cost:?}");
                let pairs = squares.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
                expected += cost.weight
                    * match cost.during {
                        During::Motion => pairs.sum::<f64>() * motion.times[1] / 1e3,
                        During::End => squares[motion.z.len() - 1],
                        During::At(_) => unreachable!("no waypoint"),
                    };
            }
            let mut without = control.clone();
            without.objective.quantities.clear();
            let effort = at_random(&without, |_, program, x| program.objective(&x));
            let found = program.objective(&x) - effort;
            assert!(expected > 0.1, "{expected}");
            assert!(
                (found - expected).abs() < 1e-11 * expected,
                "{found} {expected}"
            );
        });
    }
}

/// The Hessian of the objective alone is that of differences of its gradient.
pub(crate) fn compare_hessian(program: &mut Transcription<'_>, x: &[f64]) {
    let n = x.len();
    let none = vec![0.0; program.constraints().lower.len()];
    let structure = program.hessian_structure();
    let mut values = vec![0.0; structure.rows.len()];
    // Constraints come first at this point, so that instants are placed by others too.
    program.constraint(x, &mut none.clone());
    program.hessian(x, 1.0, &none, &mut values);
    let mut hessian = vec![0.0; n * n];
    for ((&i, &j), value) in structure.rows.iter().zip(&structure.cols).zip(values) {
        hessian[i as usize * n + j as usize] += value;
    }
    let largest = hessian.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    assert!(largest > 0.1, "{largest}");
    let (mut above, mut below) = (vec![0.0; n], vec![0.0; n]);
    let step = 1e-5;
    for j in 0..n {
        let moved = |by: f64| {
            let mut x = x.to_vec();
            x[j] += by;
            x
        };
        program.gradient(&moved(step), &mut above);
        program.gradient(&moved(-step), &mut below);
        for i in j..n {
            let expected = (above[i] - below[i]) / (2.0 * step);
            let found = hessian[i * n + j];
            let names = || [i, j].map(|i| program.variable_name(i));
            assert!(
                (found - expected).abs() < 1e-7 * largest,
                "{:?}: {found} {expected}",
                names()
            );
        }
    }
    // The gradient is that of differences of the objective.
    let mut gradient = vec![0.0; n];
    program.gradient(x, &mut gradient);
    let largest = gradient.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    for (j, found) in gradient.into_iter().enumerate() {
        let mut at = |by: f64| {
            let mut x = x.to_vec();
            x[j] += by;
            program.objective(&x)
        };
        let expected = (at(step) - at(-step)) / (2.0 * step);
        let error = (found - expected).abs();
        assert!(error < 1e-7 * largest, "{j}: {found} {expected}");
    }
}

#[test]
fn the_hessian_of_the_objective_alone_is_that_of_its_differences() {
    for control in problems() {
        at_random(&control, |_, program, x| compare_hessian(program, &x));
    }
}

#[test]
fn measured_costs_have_the_derivatives_of_their_values() {
    let short = |control: &Control| control.intervals < 10;
    for mut control in problems().into_iter().filter(short) {
        control.objective.quantities =
            measured(&[0, 1, 3], &[(0, true), (1, false)], &[0], &[1, 3]);
        at_random(&control, |_, program, x| compare_hessian(program, &x));
    }
}

#[test]
fn signals_have_the_derivatives_of_their_values() {
    let step = 1e-4;
    for signal in crate::common::tracked::signals(0.3, 2.0) {
        for t in [1.0, 5.3, 16.2, 20.9, 33.1, 60.0] {
            let [value, rate, second] = signal.derivatives(t);
            let [before, here, after] = [-step, 0.0, step].map(|by| follow(&signal, t + by));
            assert!((value - here).abs() < 1e-14);
            assert!((rate - (after - before) / (2.0 * step)).abs() < 1e-8);
            let expected = (after - 2.0 * here + before) / (step * step);
            assert!((second - expected).abs() < 1e-6, "{signal:?} at {t}");
        }
    }
}

#[test]
fn an_angle_is_compared_without_its_full_turns() {
    let quantity = Quantity::joint(0, 0.0);
    let value = |by: f64| {
        let mut control = control(&branched(), 3);
        control.objective = tracked(&[], &[(0, true)]);
        let CostFunction::Square { reference } = &mut control.objective.quantities[0].function
        else {
            unreachable!("a square");
        };
        *reference = Signal::Constant(0.2 + by);
        assert_eq!(control.objective.quantities[0].quantity, quantity);
        at_random(&control, |_, program, x| program.objective(&x))
    };
    let plain = value(0.0);
    assert!(plain > 1e-3);
    assert!((value(TAU) - plain).abs() < 1e-12 * plain);
    assert!((value(PI) - plain).abs() > 0.1);
}
