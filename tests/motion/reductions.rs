//! Joint coordinates and directors with multipliers tell the same motion.

use crate::common::cases::hold;
use crate::common::systems::blocks;
use crate::common::{distance, motion, placed, trunk};
use crate::tree::{JOINTS, RATES, VOLTAGES, tree, undamped};
use nalgebra::Vector3;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{Start, observations};
use proboscis::model::system::System;
use proboscis::model::{Coordinates, Model};

/// A motion from given joint coordinates and rates in some coordinates.
fn run(
    system: &System,
    coordinates: Coordinates,
    joints: &[f64],
    rates: &[f64],
    h: f64,
    steps: usize,
    voltages: &[f64],
) -> (Model, proboscis::dynamics::DiscreteTrajectory) {
    let model = Model::new(system.clone(), Some(coordinates), h, &[]).unwrap();
    let z = model.coordinates_at(joints);
    let rates = match coordinates {
        Coordinates::Reduced => model.coordinates_at(rates)[..model.coordinate_count()].to_vec(),
        Coordinates::Redundant => model.rates_at(joints, rates, &Default::default()).unwrap(),
    };
    let start = match system.solids.is_empty() {
        true => Start::with_rates(&model, z, &rates),
        // Rates of joints say nothing of nodes.
        false => Start::at_rest(&model, z),
    };
    let discrete = motion(&model, &start, h, steps, &model.scalars(voltages));
    (model, discrete)
}

/// Largest difference of the motions in both coordinates, and the motion.
fn compare(
    system: &System,
    joints: &[f64],
    rates: &[f64],
    h: f64,
    steps: usize,
    voltages: &[f64],
) -> (f64, Trajectory) {
    let [reduced, redundant] = [Coordinates::Reduced, Coordinates::Redundant]
        .map(|c| run(system, c, joints, rates, h, steps, voltages));
    let [a, b] = [&reduced, &redundant].map(|(m, discrete)| Trajectory::from_discrete(m, discrete));
    // What is observed agrees as well; momenta of reduced coordinates hold no reactions of the ground.
    let [seen, other] = [&reduced, &redundant].map(|(m, discrete)| observations(m, discrete));
    for (x, y) in seen.columns.iter().zip(&other.columns) {
        assert_eq!(x.name, y.name);
        if x.name == "constraint_violation" {
            continue;
        }
        let size = x.values.iter().fold(1e-3_f64, |m, v| m.max(v.abs()));
        for (k, (u, v)) in x.values.iter().zip(&y.values).enumerate() {
            assert!(
                (u - v).abs() < 1e-7 * size,
                "{} at {k}: {u} against {v}",
                x.name
            );
        }
    }
    (distance(&a, &b, reduced.0.length()), a)
}

#[test]
fn of_the_trunk() {
    let voltages: Vec<f64> = (0..12)
        .map(|m| [2000.0, 0.0, 500.0, 1200.0][m % 4])
        .collect();
    let joints = [0.1, -0.05, 0.08, 0.0, -0.1, 0.2];
    let rates = [1e-3, 2e-3, -1e-3, 0.0, 3e-3, -2e-3];
    let (difference, trajectory) = compare(&trunk(6), &joints, &rates, 5.0, 200, &voltages);
    println!("trunk: {difference:e}");
    for (i, start) in joints.iter().enumerate() {
        let swing = trajectory.joints.iter().map(|u| (u[i] - start).abs());
        assert!(swing.fold(0.0, f64::max) > 0.02);
    }
    assert!(difference < 1e-9, "{difference:e}");
}

#[test]
fn dampers_agree_to_second_order() {
    // Reduced coordinates damp the difference of a joint coordinate, redundant ones the turn of vectors at the midpoint.
    let system = tree();
    assert!(system.joints.iter().filter(|j| j.damping.is_some()).count() == 3);
    let seen = |coordinates: Coordinates, n: usize| {
        let h = 240.0 / n as f64;
        let (model, discrete) = run(&system, coordinates, &JOINTS, &RATES, h, n, &VOLTAGES);
        let seen = observations(&model, &discrete);
        let column = |name: &str| {
            let found = seen.columns.iter().find(|c| c.name == name);
            found.unwrap().values.clone()
        };
        let names = [
            "angular_momentum_x",
            "angular_momentum_z",
            "dissipated_energy",
        ];
        let columns = names.map(column);
        (columns, Trajectory::from_discrete(&model, &discrete))
    };
    let (model, discrete) = run(
        &undamped(),
        Coordinates::Reduced,
        &JOINTS,
        &RATES,
        1.5,
        160,
        &VOLTAGES,
    );
    let free = Trajectory::from_discrete(&model, &discrete);
    let effect = distance(&free, &seen(Coordinates::Reduced, 160).1, 100.0);
    println!("without dampers: {effect}");
    assert!(effect > 1e-2, "{effect}");
    let differences = [160, 320, 640].map(|n| {
        let [(a, reduced), (b, redundant)] =
            [Coordinates::Reduced, Coordinates::Redundant].map(|c| seen(c, n));
        let mut all = vec![distance(&reduced, &redundant, 100.0)];
        all.extend(a.iter().zip(&b).map(|(a, b)| {
            let size = a.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            let apart = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max) / size
        }));
        all
    });
    let [coarse, middle, fine] = &differences;
    for (i, ((a, b), c)) in coarse.iter().zip(middle).zip(fine).enumerate() {
        println!("{i}: {a:e} {b:e} {c:e}");
        assert!(*a < 1e-2 && *c > 1e-9, "{i}: {a:e} {c:e}");
        assert!(((b / c).log2() - 2.0).abs() < 0.2, "{i}: {a:e} {b:e} {c:e}");
    }
}

#[test]
fn of_a_tree_with_everything() {
    let (difference, trajectory) = compare(&undamped(), &JOINTS, &RATES, 3.0, 200, &VOLTAGES);
    println!("tree: {difference:e}");
    for (i, start) in JOINTS.iter().enumerate().take(4) {
        let swing = trajectory
            .joints
            .iter()
            .map(|u| (u[i] - start).abs())
            .fold(0.0, f64::max);
        println!("  joint {i} moves by {swing}");
        assert!(swing > 0.02);
    }
    assert!(difference < 1e-9, "{difference:e}");
}

#[test]
fn in_any_order_of_the_joints_and_either_direction() {
    let system = undamped();
    let (_, expected) = compare(&system, &JOINTS, &RATES, 3.0, 50, &VOLTAGES);

    // The joints from the leaves to the root.
    let mut shuffled = system.clone();
    let order = [3, 1, 4, 2, 0];
    shuffled.joints = order.iter().map(|&j| system.joints[j].clone()).collect();
    let [joints, rates] = [JOINTS, RATES].map(|list| order.map(|j| list[j]));
    let (difference, trajectory) = compare(&shuffled, &joints, &rates, 3.0, 50, &VOLTAGES);
    assert!(difference < 1e-9, "{difference:e}");
    assert!(distance(&expected, &trajectory, 100.0) < 1e-9);

    // Parent and child exchanged: a turn of one in the other is the opposite turn of the other in the one, and so is a
    // displacement, whose axis then turns with the other body.
    for reversed in [vec![2], vec![1], vec![3, 4]] {
        let (swapped, joints, rates) = exchanged(&system, &reversed);
        let (difference, trajectory) = compare(&swapped, &joints, &rates, 3.0, 50, &VOLTAGES);
        let other = distance(&expected, &trajectory, 100.0);
        println!("reversed {reversed:?}: {difference:e}, {other:e}");
        assert!(difference < 1e-9, "{difference:e}");
        assert!(other < 1e-9, "{other:e}");
    }
}

/// The system with parent and child of some joints exchanged, and the same joint coordinates and rates.
fn exchanged(system: &System, reversed: &[usize]) -> (System, [f64; 5], [f64; 5]) {
    let mut swapped = system.clone();
    let (mut joints, mut rates) = (JOINTS, RATES);
    for &j in reversed {
        let joint = &mut swapped.joints[j];
        let parent = joint.parent.expect("joints to the ground stay");
        (joint.parent, joint.child) = (Some(joint.child), parent);
        joints[j] = -joints[j];
        rates[j] = -rates[j];
    }
    (swapped, joints, rates)
}

#[test]
fn dampers_on_joint_coordinates_know_no_direction() {
    let motion = |system: &System, joints: &[f64; 5], rates: &[f64; 5]| {
        let (model, discrete) = run(
            system,
            Coordinates::Reduced,
            joints,
            rates,
            3.0,
            50,
            &VOLTAGES,
        );
        Trajectory::from_discrete(&model, &discrete)
    };
    let expected = motion(&tree(), &JOINTS, &RATES);
    for reversed in [[1], [3]] {
        let (swapped, joints, rates) = exchanged(&tree(), &reversed);
        let other = distance(&expected, &motion(&swapped, &joints, &rates), 100.0);
        assert!(other < 1e-9, "{other:e}");
    }
}

#[test]
fn of_segments_with_blocks() {
    let system = blocks();
    assert_eq!(system.sources().len(), 5);
    let mut voltages = hold(2);
    voltages.push(8e4);
    // Turned joints would crush the thin blocks, whose nodes start at their reference places.
    let (joints, rates) = ([0.0; 2], [0.0; 2]);
    let (difference, trajectory) = compare(&system, &joints, &rates, 2.0, 20, &voltages);
    println!("blocks: {difference:e}");
    for (i, start) in joints.iter().enumerate() {
        let swing = trajectory.joints.iter().map(|u| (u[i] - start).abs());
        assert!(swing.fold(0.0, f64::max) > 0.01);
    }
    assert!(difference < 1e-9, "{difference:e}");
    // All nodes of all blocks, glued ones too.
    let [a, b] = [Coordinates::Reduced, Coordinates::Redundant].map(|coordinates| {
        let (model, discrete) = run(&system, coordinates, &joints, &rates, 2.0, 20, &voltages);
        let nodes = |z: &Vec<f64>| -> Vec<Vector3<f64>> {
            let instant = placed(&model, z);
            let places = model.solids.iter().map(|c| c.places(&instant.x));
            places.flatten().collect()
        };
        let potentials: Vec<Vec<f64>> = discrete.scalars.clone();
        (discrete.z.iter().map(nodes).collect::<Vec<_>>(), potentials)
    });
    let mut moved = 0.0_f64;
    for (k, (x, y)) in a.0.iter().zip(&b.0).enumerate() {
        for (n, (x, y)) in x.iter().zip(y).enumerate() {
            moved = moved.max((x - a.0[0][n]).amax());
            assert!(
                (x - y).amax() < 1e-9 * 60.0,
                "{k} {n}: {:e}",
                (x - y).amax()
            );
        }
    }
    assert!(moved > 1.0, "{moved}");
    for (a, b) in a.1.iter().flatten().zip(b.1.iter().flatten()) {
        assert!((a - b).abs() < 1e-9 * (1.0 + a.abs()), "{a} {b}");
    }
}
