//! Motions under functions of time: the order of every method, and steps by a tolerance, against Galerkin's method on a fine grid.

use crate::common::random::Random;
use crate::robots::{Parts, robot, system};
use crate::seeds;
use proboscis::control::problem::{BoundaryState, Simulation, Voltages};
use proboscis::control::resolve_start;
use proboscis::dynamics::{DiscreteTrajectory, Drive, Integrator, Lengths, Solving, go_on};
use proboscis::math::Signal;
use proboscis::model::Model;
use proboscis::model::system::{InputKind, Source, System};
use proboscis::workflow::{integrate, solved};
use std::ops::ControlFlow;

/// Parts of the robots that move.
const PARTS: Parts = Parts {
    weight: true,
    ball_joints: false,
    tendons: false,
    viscosity: true,
    bodies: 3,
};

/// Voltages as functions of time, evaluated here by themselves.
struct Signals<'a> {
    model: &'a Model,
    signals: &'a [Signal],
}

impl Drive for Signals<'_> {
    fn at(&self, [from, to]: [f64; 2], part: f64) -> Vec<f64> {
        let time = from + part.clamp(1e-13, 1.0 - 1e-13) * (to - from);
        let row: Vec<f64> = self.signals.iter().map(|s| s.at(time)).collect();
        self.model.scalars(&row)
    }
}

fn task(signals: &[Signal], duration: f64, tolerance: Option<f64>) -> Simulation {
    Simulation {
        duration,
        step: 1.0,
        tolerance,
        start: BoundaryState::JointAngles {
            angles: Default::default(),
            rates: Default::default(),
            velocities: Default::default(),
        },
        voltages: Voltages::from(signals.to_vec()),
        coordinates: None,
        solving: Solving::default(),
        controller: None,
    }
}

/// The motion by Galerkin's method of degree 3 with each step between the times in `parts` parts.
fn exact(model: &Model, signals: &[Signal], times: &[f64], parts: usize) -> DiscreteTrajectory {
    let start = resolve_start(model, &task(signals, 1.0, None).start).unwrap();
    let split = |ends: &[f64]| {
        let (from, step) = (ends[0], (ends[1] - ends[0]) / parts as f64);
        (1..=parts)
            .map(move |k| from + step * k as f64)
            .collect::<Vec<_>>()
    };
    let all: Vec<f64> = std::iter::once(times[0])
        .chain(times.windows(2).flat_map(split))
        .collect();
    let solving = Solving {
        integrator: Integrator::Galerkin { degree: 3 },
        ..Solving::default()
    };
    let drive = Signals { model, signals };
    let begun = DiscreteTrajectory::at(&start);
    let lengths = Lengths::Between(&all);
    let (motion, failure) = go_on(solving, model, begun, lengths, &drive, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    motion
}

/// Greatest distance of joint angles and places (rad, lengths of the system) at all instants of a motion from those of one in parts of its
/// steps.
fn apart(
    model: &Model,
    motion: &DiscreteTrajectory,
    fine: &DiscreteTrajectory,
    parts: usize,
) -> f64 {
    let [motion, fine] = [motion, fine].map(|discrete| solved(model, discrete, None));
    let mut worst = 0.0_f64;
    for k in 0..motion.times.len() {
        for (a, b) in motion.joints[k].iter().zip(&fine.joints[parts * k]) {
            worst = worst.max((a - b).abs());
        }
        for (a, b) in motion.poses[k].iter().zip(&fine.poses[parts * k]) {
            worst = worst.max((a.centre - b.centre).norm() / model.length());
        }
    }
    worst
}

/// Greatest distance of a motion from the exact one: the steps of the latter become shorter until they change it by less than a twentieth.
fn true_error(model: &Model, signals: &[Signal], motion: &DiscreteTrajectory) -> f64 {
    let error = |parts: usize| {
        let fine = exact(model, signals, &motion.times, parts);
        apart(model, motion, &fine, parts)
    };
    let mut last = error(1);
    for parts in [2, 4, 8, 16] {
        let finer = error(parts);
        if (finer - last).abs() <= 0.05 * finer {
            return finer;
        }
        last = finer;
    }
    last
}

/// A function of time for each source; loads are small numbers of N and N mm.
fn signals(system: &System, random: &mut Random) -> Vec<Signal> {
    let sources = system.sources();
    let largest = |source: &Source| match source.kind {
        InputKind::Voltage => 1500.0,
        InputKind::Force => 0.15,
        InputKind::Torque => 3.0,
        other => panic!("no robot has a {}", other.name()),
    };
    let of = |source: &Source| signal(random, largest(source));
    sources.iter().map(of).collect()
}

/// Constants, ramps, sines, switches and tables up to a size, with corners on whole milliseconds.
fn signal(random: &mut Random, largest: f64) -> Signal {
    let [a, b, c] = [0; 3].map(|_| random.between(0.0, largest));
    let start = random.between(5.0, 30.0).floor();
    match random.between(0.0, 5.0) as usize {
        0 => Signal::Constant(a),
        1 => Signal::Ramp {
            from: a,
            to: b,
            start,
            duration: 20.0,
        },
        2 => Signal::Ramp {
            from: a,
            to: b,
            start,
            duration: 0.0,
        },
        3 => Signal::Table {
            times: vec![0.0, start, start + 25.0],
            values: vec![a, b, c],
        },
        _ => Signal::Sine {
            mean: a,
            amplitude: 0.4 * b,
            frequency: random.between(0.01, 0.04),
            phase: random.between(0.0, 6.0),
        },
    }
}

#[test]
fn steps_by_a_tolerance_keep_it_under_functions_of_time() {
    let (mut above, mut count, mut worst) = (Vec::new(), 0, 0.0_f64);
    let mut unconfirmed = 0;
    seeds(1000, 30, &[1_795_623_191], |seed| {
        let parts = Parts {
            viscosity: seed % 2 == 0,
            ball_joints: seed % 3 == 0,
            ..PARTS
        };
        let system = system(&robot(seed, parts).scene);
        let random = &mut Random(seed);
        let signals: Vec<Signal> = signals(&system, random);
        let tolerance = [1e-3, 1e-4, 1e-5][(seed % 3) as usize];
        let task = task(&signals, 60.0, Some(tolerance));
        let run = integrate(&system, &task, |_, _| ControlFlow::Continue(())).unwrap();
        assert_eq!(run.failure, None, "{seed}");
        let told = run.error.expect("it came to its end");
        let error = true_error(&run.model, &signals, &run.discrete);
        count += 1;
        unconfirmed += usize::from(!told.is_confirmed);
        worst = worst.max(error / tolerance);
        if error > tolerance {
            above.push((seed, error / tolerance, told));
        }
        // What is told of a motion is that it is below the tolerance.
        let is_told = told.error >= 0.5 * error || error <= 0.5 * tolerance;
        assert!(
            !told.is_confirmed || is_told,
            "{seed}: {told:?}, in truth {error:e}"
        );
    });
    println!(
        "{count} motions, {} above: {above:?}; worst {worst}, {unconfirmed} not confirmed",
        above.len()
    );
    assert!(20 * above.len() <= count && worst <= 2.0);
    assert!(10 * unconfirmed <= count);
}

#[test]
fn every_method_has_its_order_under_ramps_and_sines() {
    let signals = |count: usize| -> Vec<Signal> {
        let of = |k: usize| match k % 2 {
            0 => Signal::Sine {
                mean: 900.0,
                amplitude: 600.0,
                frequency: 0.02,
                phase: 0.3 * k as f64,
            },
            _ => Signal::Ramp {
                from: 0.0,
                to: 1400.0,
                start: 16.0,
                duration: 16.0,
            },
        };
        (0..count).map(of).collect()
    };
    let methods = [
        (Integrator::Midpoint, 2.0, 64),
        (Integrator::Galerkin { degree: 2 }, 4.0, 16),
        (Integrator::Galerkin { degree: 3 }, 6.0, 7),
        (
            Integrator::GeneralisedAlpha {
                spectral_radius: 0.8,
            },
            2.0,
            128,
        ),
        (Integrator::ImplicitEuler, 1.0, 512),
    ];
    for seed in [1, 2] {
        let system = system(&robot(seed, PARTS).scene);
        let model = Model::new(system.clone(), None, 1.0, &[]).unwrap();
        let signals = signals(system.sources().len());
        let ends = [0.0, 16.0, 32.0, 48.0];
        let fine = exact(&model, &signals, &ends, 256);
        for (integrator, order, steps) in methods {
            let error = |steps: usize| {
                let mut task = task(&signals, 48.0, None);
                task.solving.integrator = integrator;
                task.step = 16.0 / steps as f64;
                let run = integrate(&system, &task, |_, _| ControlFlow::Continue(())).unwrap();
                assert_eq!(run.failure, None);
                let last = |discrete: &DiscreteTrajectory| {
                    let z = discrete.z.last().unwrap().iter().enumerate();
                    let z = z.take(model.coordinate_count());
                    // What muscles remember has a lower order with Galerkin's method.
                    let places = z.filter(|&(i, _)| !model.is_memory(i));
                    places.map(|(_, &z)| z).collect::<Vec<_>>()
                };
                let both = last(&run.discrete).into_iter().zip(last(&fine));
                both.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            let [coarse, finer] = [error(steps), error(2 * steps)];
            let observed = (coarse / finer).log2();
            println!(
                "{seed} {}: {coarse:e} {finer:e} order {observed}",
                integrator.name()
            );
            assert!(finer > 1e-13, "nothing to see");
            // Where errors of two orders cancel it is more.
            assert!(observed > order - 0.35, "{}: {observed}", integrator.name());
        }
    }
}
