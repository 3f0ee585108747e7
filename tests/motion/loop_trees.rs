//! Closed loops in the joint coordinates of a spanning tree: the same motions, states of rest and reactions as in directors.

use crate::closed_loop::{AXIAL, bar};
use crate::common::random::Random;
use crate::common::{bare, column, distance, joint, motion, placed, problem};
use crate::redundant_loops::{holds, plane_four_bar};
use nalgebra::{Rotation3, Vector3};
use proboscis::control::problem::BoundaryState;
use proboscis::control::resolve_start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{DiscreteTrajectory, energies, observations, stable_equilibrium};
use proboscis::math::Signal;
use proboscis::model::system::{JointKind, JointSpring, System};
use proboscis::model::{Coordinates, Model, Role};
use serde_json::{Value, json};
use std::collections::BTreeMap;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

fn models(system: &System, h: f64) -> [Model; 2] {
    BOTH.map(|coordinates| Model::new(system.clone(), Some(coordinates), h, &[]).unwrap())
}

fn file(name: &str) -> Value {
    let folder = format!("{}/problems", env!("CARGO_MANIFEST_DIR"));
    let scene = std::fs::read_to_string(format!("{folder}/scenes/{name}.json")).unwrap();
    let mut scene: Value = serde_json::from_str(&scene).unwrap();
    scene.as_object_mut().unwrap().remove("$schema");
    scene
}

/// The motion of a system with rates of some joints at the start.
fn moved(
    model: &Model,
    rates: &[(usize, f64)],
    steps: usize,
    scalars: &[f64],
) -> DiscreteTrajectory {
    let state = BoundaryState::JointAngles {
        angles: BTreeMap::new(),
        rates: rates.iter().copied().collect(),
        velocities: BTreeMap::new(),
    };
    let start = resolve_start(model, &state).unwrap();
    motion(model, &start, model.multiplier_time, steps, scalars)
}

/// The largest differences of poses and of joint coordinates between both motions, which look alike.
fn compared(models: &[Model; 2], motions: &[DiscreteTrajectory; 2], length: f64) -> [f64; 2] {
    let both = [0, 1].map(|i| Trajectory::from_discrete(&models[i], &motions[i]));
    let seen = [0, 1].map(|i| observations(&models[i], &motions[i]));
    let rows = both[0].joints.iter().zip(&both[1].joints);
    let joints = rows.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b).abs()));
    let columns = seen[0]
        .columns
        .iter()
        .filter(|column| !column.name.starts_with("constraint"));
    for own in columns {
        let other = column(&seen[1], &own.name);
        let size = other
            .iter()
            .fold(1e-3, |most: f64, value| most.max(value.abs()));
        let pairs = own.values.iter().zip(other);
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
        // Impulses of joint springs outside the tree, half a step apart, are momenta of instants in one of the two.
        let limit = if own.name.contains("momentum") {
            3e-4
        } else {
            1e-9
        };
        assert!(most < limit, "{}: {most:e}", own.name);
    }
    [
        distance(&both[0], &both[1], length),
        joints.fold(0.0, f64::max),
    ]
}

/// A chain of bodies whose ends are on the ground, by random joints of `freedoms` in all, with springs on some and a pendulum on one.
fn random_loop(random: &mut Random) -> System {
    let kinds = loop {
        let count = 4 + (2.0 * (random.unit() + 1.0)) as usize;
        let mut kind = || {
            let axis = random.vector().normalize();
            match (4.0 * (random.unit() + 1.0)) as usize {
                0 | 1 => JointKind::Revolute { axis },
                2 => JointKind::Prismatic { axis },
                3 | 4 => JointKind::Spherical,
                5 => JointKind::Cylindrical { axis },
                6 => JointKind::Planar { normal: axis },
                _ => {
                    let other = axis.cross(&Vector3::new(0.3, 0.5, -0.8)).normalize();
                    JointKind::Universal {
                        axes: [axis, other],
                    }
                }
            }
        };
        let kinds: Vec<JointKind> = (0..count).map(|_| kind()).collect();
        let freedoms: usize = kinds.iter().map(JointKind::freedoms).sum();
        if (7..=9).contains(&freedoms) {
            break kinds;
        }
    };
    let places: Vec<Vector3<f64>> = (0..kinds.len())
        .map(|i| Vector3::x() * i as f64 * 0.4 + random.vector() * 0.5)
        .collect();
    let last = kinds.len() - 1;
    let mut bodies: Vec<_> = (0..last)
        .map(|i| {
            bar(
                &format!("bar{i}"),
                1.0 + 0.1 * i as f64,
                AXIAL,
                places[i],
                places[i + 1],
            )
        })
        .collect();
    let mut joints: Vec<_> = (0..=last)
        .map(|i| {
            let parent = i.checked_sub(1);
            let child = i.min(last - 1);
            let parent = parent.filter(|_| i < last);
            joint(&format!("j{i}"), kinds[i], parent, child, places[i])
        })
        .collect();
    for joint in joints.iter_mut().filter(|joint| joint.has_coordinate()) {
        joint.spring = (random.unit() > 0.0).then_some(JointSpring {
            stiffness: 2.0,
            rest: 0.1,
        });
    }
    let tip = places[1] + random.vector();
    bodies.push(bar("pendulum", 0.5, AXIAL, places[1], tip));
    joints.push(joint(
        "hook",
        JointKind::Spherical,
        Some(0),
        last,
        places[1],
    ));
    // The tree grows in the order of the scene.
    let from = (random.unit().abs() * joints.len() as f64) as usize;
    joints.rotate_left(from);
    bare(bodies, joints, Some(Vector3::new(0.0, -9.81, 0.0)))
}

#[test]
fn random_loops_move_alike_in_both_coordinates() {
    let mut random = Random(12);
    let mut worst = [0.0_f64; 2];
    for number in 0..50 {
        let system = random_loop(&mut random);
        let models = models(&system, 0.004);
        let [tree, directors] = [0, 1].map(|i| models[i].action.map.unknowns());
        assert!(tree < directors / 2, "{tree} {directors}");
        let motions = [0, 1].map(|i| moved(&models[i], &[], 25, &[]));
        for (model, motion) in models.iter().zip(&motions) {
            holds(model, motion);
        }
        let found = compared(&models, &motions, 1.0);
        let moved = (motions[0].z[25][0] - motions[0].z[0][0]).abs();
        println!("{number}: {tree} for {directors} unknowns, {moved:.2}, {found:?}");
        assert!(found.iter().all(|apart| *apart < 1e-9), "{found:?}");
        (0..2).for_each(|i| worst[i] = worst[i].max(found[i]));
    }
    println!("worst: {worst:?}");
}

#[test]
fn a_tree_of_a_loop_has_the_constraints_of_the_joint_that_closes_it() {
    let axis = Vector3::z();
    let hinges = plane_four_bar(&Rotation3::identity(), [JointKind::Revolute { axis }; 2]);
    let [tree, _] = models(&hinges, 0.01);
    let names = |role| tree.variables.with(role).iter().map(|one| one.name.clone());
    let coordinates: Vec<_> = names(Role::Coordinate).collect();
    assert_eq!(
        coordinates,
        ["hinge1", "hinge2", "hinge3"].map(|name| format!("coordinate of {name}"))
    );
    let multipliers: Vec<_> = names(Role::Multiplier).collect();
    assert_eq!(multipliers, ["hinge4 point 1", "hinge4 point 2"]);
    // Energy at midpoints: bounded by O(h²).
    let drifts = [0.01, 0.005].map(|h| {
        let [tree, _] = models(&hinges, h);
        let steps = (2.0 / h) as usize;
        let discrete = moved(&tree, &[(0, 0.5)], steps, &[]);
        holds(&tree, &discrete);
        let energy = |k: usize| {
            let [a, b] = [k, k + 1].map(|k| placed(&tree, &discrete.z[k]));
            energies(&tree, &a, &b, &[], h).total()
        };
        let all: Vec<f64> = (0..steps).map(energy).collect();
        all.iter().map(|e| (e - all[0]).abs()).fold(0.0, f64::max)
    });
    println!("energy of the four-bar in a tree: {drifts:?}");
    assert!(((drifts[0] / drifts[1]).log2() - 2.0).abs() < 0.3);
}

#[test]
fn a_four_bar_and_a_slider_crank_move_and_rest_alike() {
    let mut four_bar = file("four_bar");
    four_bar["joints"][2]["stiffness"] = json!("0.1 N m/rad");
    for (scene, input, steps) in [(four_bar, 2000.0, 60), (file("slider_crank"), 100.0, 60)] {
        let task = json!({ "scene": scene, "simulate": { "duration": "10 ms", "step": "1 ms" } });
        let (system, _) = problem(&task);
        let models = models(&system, 2.0);
        let scalars = models[0].scalars(&[input]);
        let motions = [0, 1].map(|i| moved(&models[i], &[(0, 1e-3)], steps, &scalars));
        let found = compared(&models, &motions, models[0].length());
        println!("{}: {found:?}", system.name);
        assert!(found.iter().all(|apart| *apart < 1e-9), "{found:?}");
        if system.muscles.is_empty() {
            continue;
        }
        let rests = models.each_ref().map(|model| {
            let zero = model.reference_coordinates();
            let found = stable_equilibrium(model, &zero, &scalars).unwrap();
            assert_eq!(found.unstable, Some(0));
            let period = found.slowest_period(model).unwrap();
            (model.poses(&placed(model, &found.z)), period)
        });
        let pairs = rests[0].0.iter().zip(&rests[1].0);
        let apart = pairs
            .map(|(a, b)| (a.centre - b.centre).amax())
            .fold(0.0, f64::max);
        let periods = (rests[0].1 / rests[1].1 - 1.0).abs();
        println!("at rest: {apart:e}, periods {periods:e}");
        assert!(apart < 1e-9 * models[0].length() && periods < 1e-5);
    }
}

#[test]
fn a_prescribed_joint_drives_a_loop_alike_wherever_it_is_cut() {
    let axis = Vector3::z();
    for driven in 0..4 {
        let mut system = plane_four_bar(&Rotation3::identity(), [JointKind::Revolute { axis }; 2]);
        system.joints[driven].motion = Some(Signal::Sine {
            mean: 0.0,
            amplitude: 0.2,
            frequency: 0.5,
            phase: 0.0,
        });
        let models = models(&system, 0.005);
        let motions = [0, 1].map(|i| moved(&models[i], &[], 80, &[]));
        let found = compared(&models, &motions, 1.0);
        println!("joint {driven}: {found:?}");
        assert!(found.iter().all(|apart| *apart < 1e-9), "{found:?}");
    }
}
