//! Observations along a motion against their formulas.

use crate::common::{at_reference, bare, body, column, columns, joint, motion, placed, trunk};
use nalgebra::{Matrix3, Vector3};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{DiscreteTrajectory, Start, observations, observed};
use proboscis::math::Stopped;
use proboscis::model::system::{JointKind, VACUUM_PERMITTIVITY};
use proboscis::model::{Coordinates, Model};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn stretches_and_charges_follow_their_formulas() {
    let h = 5.0;
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let model = Model::new(trunk(2), Some(coordinates), h, &[]).unwrap();
        let voltages = [2000.0, 0.0, 700.0, 1500.0];
        let start = Start::at_rest(&model, at_reference(&model));
        let discrete = motion(&model, &start, h, 40, &model.scalars(&voltages));
        let seen = observations(&model, &discrete);
        let instants: Vec<_> = discrete.z.iter().map(|z| placed(&model, z)).collect();
        for (m, muscle) in model.system.muscles.iter().enumerate() {
            let span = |k: usize| instants[k].x[model.spans[m]];
            let stretch = column(&seen, &format!("{}_stretch", muscle.name));
            assert!(stretch.iter().any(|s| (s - 1.0).abs() > 0.01));
            let charge = column(&seen, &format!("{}_charge", muscle.name));
            // Q = −2 V₀ [c₁ + c₂ I − ε₀/(2I)] V/t² in the middle between two instants.
            let between = |k: usize, l: usize| {
                let i = (0.5 * (span(k) + span(l))).norm_squared() / 1600.0;
                let bracket = VACUUM_PERMITTIVITY * (-2.0 + i - 0.5 / i);
                -2.0 * 4000.0 * bracket * voltages[m] / (0.05 * 0.05)
            };
            for k in 0..=40 {
                assert!((stretch[k] - span(k).norm() / 40.0).abs() < 1e-14);
                // At an instant: the mean of the intervals beside it, at the ends its own.
                let exact = match k {
                    0 | 40 => between(k, k),
                    _ => 0.5 * (between(k - 1, k) + between(k, k + 1)),
                };
                assert!((charge[k] - exact).abs() <= 1e-13 * exact.abs());
                assert!(exact >= 0.0 && (exact > 0.0) == (voltages[m] > 0.0));
            }
        }
    }
}

/// A long motion is observed in pieces; its end alone, whose pieces begin elsewhere, has the same bits.
#[test]
fn pieces_of_a_long_motion_join() {
    let (h, steps, begun) = (5.0, 700, 100);
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let model = Model::new(trunk(2), Some(coordinates), h, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let scalars = model.scalars(&[2000.0, 0.0, 700.0, 1500.0]);
        let whole = motion(&model, &start, h, steps, &scalars);
        let end = DiscreteTrajectory {
            times: whole.times[begun..].to_vec(),
            z: whole.z[begun..].to_vec(),
            scalars: whole.scalars[begun..].to_vec(),
            ..DiscreteTrajectory::default()
        };
        let mut moving = 0;
        let [seen, of_end] = [&whole, &end].map(|d| observed(&model, d, &|| false).unwrap());
        for (whole, end) in seen.iter().zip(of_end) {
            assert_eq!(whole.values.len(), steps + 1);
            moving += usize::from(whole.values[begun] != whole.values[steps]);
            // Dissipated energy counts from the start.
            let is_sum = end.name == "dissipated_energy";
            for k in 2..end.values.len() {
                let [a, b] = [&whole.values[begun..], &end.values].map(|v| match is_sum {
                    true => v[k] - v[k - 1],
                    false => v[k],
                });
                match is_sum {
                    true => assert!((a - b).abs() < 1e-12 * whole.values[steps]),
                    false => assert_eq!(a.to_bits(), b.to_bits(), "{} at {k}", end.name),
                }
            }
        }
        assert!(moving > 8);
        // It is asked before each piece, and nothing remains of a part.
        let asked = AtomicUsize::new(0);
        let is_over = || asked.fetch_add(1, Ordering::SeqCst) >= 2;
        assert_eq!(observed(&model, &whole, &is_over), Err(Stopped));
        assert_eq!(asked.into_inner(), 3);
    }
}

#[test]
fn the_first_row_is_the_start() {
    let h = 5.0;
    let rates = [2e-3, -3e-3];
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut scene = trunk(2);
        scene.gravity = Some(Vector3::new(0.0, -9.81e-3, 0.0));
        let model = Model::new(scene, Some(coordinates), h, &[]).unwrap();
        let by_coordinate = match coordinates {
            Coordinates::Reduced => rates.to_vec(),
            Coordinates::Redundant => model
                .rates_at(&[0.1, 0.2], &rates, &Default::default())
                .unwrap(),
        };
        let start = Start::with_rates(&model, model.coordinates_at(&[0.1, 0.2]), &by_coordinate);
        let discrete = motion(
            &model,
            &start,
            h,
            10,
            &model.scalars(&[1000.0, 0.0, 0.0, 500.0]),
        );
        let seen = observations(&model, &discrete);
        // ½ p·v, and the momentum of the centres of bodies and muscles, from differences of poses a short time apart.
        let kinetic: f64 = start
            .momentum
            .iter()
            .zip(&by_coordinate)
            .map(|(p, v)| 0.5 * p * v)
            .sum();
        assert!(kinetic > 1e-3);
        assert!((column(&seen, "kinetic_energy")[0] - kinetic).abs() < 1e-12 * kinetic);
        let moved = |t: f64| {
            let z = model.coordinates_at(&[0.1 + t * rates[0], 0.2 + t * rates[1]]);
            let instant = placed(&model, &z);
            let poses = model.poses(&instant);
            let bodies = model.system.bodies.iter().zip(&poses);
            let mut moment: Vector3<f64> = bodies.map(|(b, pose)| pose.centre * b.mass).sum();
            for muscle in &model.system.muscles {
                for end in [&muscle.from, &muscle.to] {
                    let place = end.body.map_or(end.at, |b| {
                        let rest = model.reference[b];
                        poses[b].point(&rest.local(&end.at))
                    });
                    moment += place * (0.5 * muscle.mass().unwrap());
                }
            }
            moment
        };
        let d = 0.01;
        let exact = (moved(d) - moved(-d)) / (2.0 * d);
        let linear = columns(&seen, "linear_momentum")[0];
        assert!(exact.norm() > 0.1);
        assert!(
            (linear - exact).norm() < 1e-8 * exact.norm(),
            "{linear} against {exact}"
        );

        // Without recorded momenta, as after an optimisation, the first interval tells them.
        let bare = DiscreteTrajectory {
            momenta: Vec::new(),
            ..discrete.clone()
        };
        for (a, b) in seen
            .columns
            .iter()
            .zip(&observations(&model, &bare).columns)
        {
            for (x, y) in a.values.iter().zip(&b.values) {
                assert!(
                    (x - y).abs() < 1e-9 * (1.0 + x.abs()),
                    "{}: {x} against {y}",
                    a.name
                );
            }
        }

        // The total is the sum of its parts.
        let sum = |k: usize| {
            [
                "kinetic_energy",
                "gravity_energy",
                "muscle_electroelasticity_energy",
            ]
            .iter()
            .map(|name| column(&seen, name)[k])
            .sum::<f64>()
        };
        for (k, total) in column(&seen, "total_energy").iter().enumerate() {
            assert!((sum(k) - total).abs() < 1e-12 * total.abs().max(1.0));
        }
    }
}

#[test]
fn angles_go_on_beyond_a_turn() {
    let wheel = body(
        "wheel",
        1.0,
        [1.0, 1.0, 2.0],
        Vector3::zeros(),
        Matrix3::identity(),
    );
    let axle = joint(
        "axle",
        JointKind::Revolute { axis: Vector3::z() },
        None,
        0,
        Vector3::zeros(),
    );
    let weld = joint("weld", JointKind::Fixed, Some(0), 1, Vector3::x());
    let rim = body("rim", 0.1, [0.1; 3], Vector3::x(), Matrix3::identity());
    let scene = bare(vec![wheel, rim], vec![weld, axle], None);
    let [reduced, redundant] = [Coordinates::Reduced, Coordinates::Redundant].map(|coordinates| {
        let model = Model::new(scene.clone(), Some(coordinates), 0.5, &[]).unwrap();
        let rates = match coordinates {
            Coordinates::Reduced => vec![1.0],
            Coordinates::Redundant => model
                .rates_at(&[0.0; 2], &[0.0, 1.0], &Default::default())
                .unwrap(),
        };
        let start = Start::with_rates(&model, at_reference(&model), &rates);
        let discrete = motion(&model, &start, 0.5, 60, &[]);
        Trajectory::from_discrete(&model, &discrete)
    });
    // sin Δθ = h θ̇: a steady turn, a little faster than the exact one.
    let step = 0.5_f64.asin();
    for (k, (a, b)) in reduced.joints.iter().zip(&redundant.joints).enumerate() {
        assert_eq!((a.len(), b.len()), (1, 1));
        assert!((a[0] - step * k as f64).abs() < 1e-11);
        assert!((a[0] - b[0]).abs() < 1e-10, "{} against {}", a[0], b[0]);
    }
    assert!(redundant.joints[60][0] > 4.0 * TAU);
}

/// A pendulum of one bob with its hinge at the origin, under gravity.
fn pendulum(coordinates: Coordinates, h: f64) -> Model {
    let bob = body(
        "bob",
        25.0,
        [900.0, 500.0, 800.0],
        Vector3::new(0.0, -40.0, 0.0),
        Matrix3::identity(),
    );
    let hinge = joint(
        "hip",
        JointKind::Revolute { axis: Vector3::z() },
        None,
        0,
        Vector3::zeros(),
    );
    let gravity = Some(Vector3::new(0.0, -9.81e-3, 0.0));
    let scene = bare(vec![bob], vec![hinge], gravity);
    Model::new(scene, Some(coordinates), h, &[]).unwrap()
}

#[test]
fn what_hangs_still_has_no_momentum_and_no_kinetic_energy() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        for h in [5.0, 2.5] {
            let model = pendulum(coordinates, h);
            let start = Start::at_rest(&model, model.coordinates_at(&[0.0]));
            let discrete = motion(&model, &start, h, 20, &[]);
            let seen = observations(&model, &discrete);
            // p⁺ alone is −m g h/2.
            let weight = 25.0 * 9.81e-3;
            assert!(weight * h / 2.0 > 0.1);
            for name in ["linear_momentum", "angular_momentum"] {
                for p in columns(&seen, name) {
                    assert!(p.norm() < 1e-9 * weight * h, "{coordinates:?}: {name} {p}");
                }
            }
            let kinetic = column(&seen, "kinetic_energy");
            assert!(kinetic.iter().all(|e| e.abs() < 1e-15), "{kinetic:?}");
        }
    }
}

#[test]
fn momenta_and_kinetic_energies_of_a_pendulum_are_those_of_its_instants() {
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let ends = |steps: usize| {
            let h = 200.0 / steps as f64;
            let model = pendulum(coordinates, h);
            let start = Start::at_rest(&model, model.coordinates_at(&[1.0]));
            let discrete = motion(&model, &start, h, steps, &[]);
            let seen = observations(&model, &discrete);
            // In the middle, and at the last instant.
            [steps / 2, steps].map(|k| {
                let p = columns(&seen, "linear_momentum")[k];
                let l = columns(&seen, "angular_momentum")[k];
                [p.x, p.y, l.z, column(&seen, "kinetic_energy")[k]]
            })
        };
        // The exact pendulum by its first integral and a quadrature: I θ̇ = −√(2 m g l I (cos θ − cos θ₀)).
        let (m, l, g) = (25.0, 40.0, 9.81e-3);
        let inertia = 800.0 + m * l * l;
        let (mut angle, mut rate) = (1.0_f64, 0.0_f64);
        let slope = |angle: f64| -m * g * l * angle.sin() / inertia;
        let exact: Vec<[f64; 4]> = [100.0, 200.0]
            .map(|_| {
                let (count, h) = (20_000, 100.0 / 20_000.0);
                for _ in 0..count {
                    // Classical Runge–Kutta.
                    let k1 = (rate, slope(angle));
                    let k2 = (rate + 0.5 * h * k1.1, slope(angle + 0.5 * h * k1.0));
                    let k3 = (rate + 0.5 * h * k2.1, slope(angle + 0.5 * h * k2.0));
                    let k4 = (rate + h * k3.1, slope(angle + h * k3.0));
                    angle += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
                    rate += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
                }
                let speed = m * l * rate;
                let along = [angle.cos() * speed, angle.sin() * speed];
                [
                    along[0],
                    along[1],
                    inertia * rate,
                    0.5 * inertia * rate * rate,
                ]
            })
            .to_vec();
        let [coarse, fine] = [40, 80].map(ends);
        for at in 0..2 {
            for i in 0..4 {
                let size = exact[at][i].abs();
                let [a, b] = [&coarse, &fine].map(|of| (of[at][i] - exact[at][i]).abs());
                println!("{coordinates:?} {at} {i}: {size} {a:e} {b:e}");
                assert!(size > 0.01);
                // Second order: the error falls to a quarter.
                assert!(
                    b < 0.3 * a && a < 0.02 * size,
                    "{at} {i}: {a:e}, {b:e} of {size}"
                );
            }
        }
    }
}
