//! Spherical joints and free bodies in reduced coordinates: three turns behind a chart.

use crate::common::cases::{control, joints};
use crate::common::random::Random;
use crate::common::systems::{ball, satellite};
use crate::common::{at_reference, joint, placed, trunk, with_velocities};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use proboscis::control::problem::Duration;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::dynamics::Start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Model};
use proboscis::nlp::differences;
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

const BOTH: [Coordinates; 2] = [Coordinates::Reduced, Coordinates::Redundant];

fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| size * random.unit())
}

/// Coordinates far from the charts, and charts far from the reference.
fn anywhere(model: &Model, random: &mut Random) -> Vec<f64> {
    let mut z = at_reference(model);
    let n = model.coordinate_count();
    for value in &mut z[..n] {
        *value += 0.8 * random.unit();
    }
    for chart in z[n..].chunks_mut(4) {
        let q = UnitQuaternion::from_scaled_axis(vector(random, 3.0));
        chart.copy_from_slice(&[q.w, q.i, q.j, q.k]);
    }
    z
}

#[test]
fn screws_and_charts_of_robots() {
    let count = |system: System| {
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        assert_eq!(model.coordinates, Coordinates::Reduced);
        (model.coordinate_count(), at_reference(&model).len())
    };
    assert_eq!(count(trunk(3)), (3, 3));
    assert_eq!(count(ball()), (5, 5 + 4));
    assert_eq!(count(satellite()), (6 + 1 + 3, 10 + 2 * 4));
    // A joint that lets everything move is none.
    let mut free = satellite();
    let at = free.bodies[0].centre;
    free.joints
        .push(joint("nothing", JointKind::Floating, None, 0, at));
    assert_eq!(count(free), (10, 18));
    let model = Model::new(satellite(), None, 1.0, &[]).unwrap();
    let names: Vec<String> = (0..10)
        .map(|i| model.variables.unknown(i).to_string())
        .collect();
    assert_eq!(names[0], "coordinate of joint2");
    assert_eq!(names[2], "rotation about y of joint3");
    assert_eq!(names[6], "displacement along z of segment1");
    assert!(model.is_length(6) && !model.is_length(7) && !model.is_length(2));
}

#[test]
fn nothing_moves_when_charts_follow() {
    for system in [ball(), satellite()] {
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let mut random = Random(5);
        let z = anywhere(&model, &mut random);
        let before = placed(&model, &z);
        let mut after = before.clone();
        assert!(model.action.map.recentre(&mut after));
        let charted = model.action.map.tree.charted();
        assert!(
            charted
                .iter()
                .flatten()
                .all(|&c| z[c] != 0.0 && after.z[c] == 0.0)
        );
        let moved = before.x.iter().zip(&after.x).map(|(a, b)| (a - b).amax());
        let moved = moved.fold(0.0, f64::max);
        println!("moved by {moved:e}");
        assert!(moved < 1e-12, "{moved:e}");
        for chart in after.z[model.coordinate_count()..].chunks(4) {
            let norm = chart.iter().map(|q| q * q).sum::<f64>();
            assert!((norm - 1.0).abs() < 1e-15);
        }
        // Poses tell the same configuration.
        let poses = model.poses(&before);
        let values = model.read_joints(&poses, &vec![0.0; model.joint_readings.len()]);
        let back = placed(&model, &model.coordinates_of_poses(&poses, &values));
        for (a, b) in poses.iter().zip(model.poses(&back)) {
            assert!((a.centre - b.centre).amax() < 1e-10);
            assert!((a.directors - b.directors).amax() < 1e-12);
        }
    }
}

#[test]
fn derivatives_far_from_charts_are_differences() {
    for system in [ball(), satellite()] {
        let mut control = control(&system, 3);
        control.start = joints(&[]);
        let (model, boundary) = BoundaryConditions::resolve(&system, &control, 10.0).unwrap();
        let mut initial = guess(&model, &boundary, &control, 10.0, None);
        let mut random = Random(7);
        // Each instant has charts of its own.
        for z in &mut initial.discrete.z[1..] {
            *z = anywhere(&model, &mut random);
        }
        let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
        let x = program.start(&initial).x;
        let report = differences::check(&mut program, &x, 5);
        println!("{}: {report}", system.name);
        assert!(report.is_consistent(), "{report}");
        let decoded = program.decode(&x);
        assert_eq!(decoded.z, initial.discrete.z);
    }
}

#[test]
fn velocities_of_bodies_are_rates_of_coordinates() {
    let mut system = satellite();
    // A ball between segments, one before the other in the list of bodies, and a hinge in between.
    system.gravity = None;
    let (linear, angular) = (
        Vector3::new(0.02, -0.01, 0.03),
        Vector3::new(0.4, -0.2, 0.1),
    );
    let other = Vector3::new(-0.3, 0.1, 0.5);
    let velocities = BTreeMap::from([(0, [linear, angular]), (2, [Vector3::zeros(), other])]);
    for coordinates in BOTH {
        let model = Model::new(system.clone(), Some(coordinates), 1.0, &[]).unwrap();
        let none = vec![0.0; 2];
        let rates = model.rates_at(&none, &none, &velocities).unwrap();
        let z = at_reference(&model);
        let by_rates = Start::with_rates(&model, z.clone(), &rates);
        // The second segment moves like the first; the third turns about the ball between both.
        let centre = |b: usize| system.bodies[b].centre;
        let moved = |at: &Vector3<f64>| linear + angular.cross(&(at - centre(0)));
        let ball = system.joints[1].at;
        let twists = [
            [linear, angular],
            [moved(&centre(1)), angular],
            [moved(&ball) + other.cross(&(centre(2) - ball)), other],
        ];
        let by_twists = with_velocities(&model, z, &twists);
        let size = by_twists
            .momentum
            .iter()
            .fold(0.0_f64, |m, p| m.max(p.abs()));
        for (a, b) in by_rates.momentum.iter().zip(&by_twists.momentum) {
            assert!((a - b).abs() < 1e-12 * size, "{a} {b} of {size}");
        }
        assert!(size > 1.0);
        // The second segment hangs on a hinge.
        let wrong = BTreeMap::from([(1, [linear, angular])]);
        assert_eq!(model.rates_at(&none, &none, &wrong), Err(1));
    }
}

#[test]
fn charts_are_exchanged_and_the_configuration_stays() {
    for system in [ball(), satellite()] {
        let model = Model::new(system, None, 1.0, &[]).unwrap();
        let map = &model.action.map;
        let mut random = Random(3);
        let (z, other) = (anywhere(&model, &mut random), anywhere(&model, &mut random));
        let mut taken = z.clone();
        map.take_charts(&other, &mut taken);
        let mut wrong = taken.clone();
        wrong[model.coordinate_count()] += 0.1;
        assert!(map.has_unit_charts(&taken) && !map.has_unit_charts(&wrong));
        assert_eq!(
            taken[model.coordinate_count()..],
            other[model.coordinate_count()..]
        );
        assert!(map.tree.angle_from_charts(&taken) > 1.0);
        let (a, b) = (placed(&model, &z), placed(&model, &taken));
        for (a, b) in a.x.iter().zip(&b.x) {
            assert!((a - b).amax() < 1e-12 * 300.0);
        }
        // Half way between two configurations the rotation has half of the angle.
        let mut mean = z.clone();
        map.mean_of_charts(&[(0.5, &z), (0.5, &other)], &mut mean);
        let [from, half, to] = [&z, &mean, &other].map(|z| {
            let body = model.system.bodies.len() - 1;
            let joint = model.poses(&placed(&model, z));
            let parent = joint[body.saturating_sub(1)].directors;
            (joint[0].directors, parent.tr_mul(&joint[body].directors))
        });
        let [a, b, c] = [from.0, half.0, to.0];
        let angle = |a: &Matrix3<f64>, b: &Matrix3<f64>| {
            Rotation3::from_matrix_unchecked(a.tr_mul(b)).angle()
        };
        let whole = angle(&a, &c);
        assert!((angle(&a, &b) - 0.5 * whole).abs() < 1e-9 && whole > 0.5);
        assert!((angle(&b, &c) - 0.5 * whole).abs() < 1e-9);
    }
}

#[test]
fn a_satellite_turns_by_bending_its_trunk_in_both_coordinates() {
    let mut system = trunk(3);
    system.joints.remove(0);
    system.muscles.drain(..2);
    let intervals = 8;
    let mut problem = control(&system, intervals);
    problem.duration = Duration::Given(200.0);
    problem.start = joints(&[]);
    problem.goal = joints(&[(0, 0.3), (1, -0.2)]);
    problem.solver.tolerance = 1e-9;
    // The second solve starts from the solution of the first, which is of other coordinates.
    let mut earlier = None;
    let optima = BOTH.map(|coordinates| {
        problem.coordinates = Some(coordinates);
        let nothing = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
        let before = earlier.as_ref();
        let found = optimise(&system, &problem, before, SolveLimits::default(), nothing);
        let found = found.unwrap();
        assert!(found.solution.status.is_solved(), "{}", found.word());
        let ends = [0, intervals].map(|k| found.motion.poses[k][0].directors);
        let turned = Rotation3::from_matrix_unchecked(ends[0].tr_mul(&ends[1])).angle();
        assert!(turned > 0.05, "{turned}");
        // A solution starts a solve in either coordinates.
        for other in BOTH {
            problem.coordinates = Some(other);
            let (model, boundary) = BoundaryConditions::resolve(&system, &problem, 25.0).unwrap();
            let initial = guess(&model, &boundary, &problem, 25.0, Some(&found.motion));
            let track = Trajectory::from_discrete(&model, &initial.discrete);
            for (a, b) in track
                .poses
                .iter()
                .flatten()
                .zip(found.motion.poses.iter().flatten())
            {
                assert!((a.centre - b.centre).amax() < 1e-9);
                assert!((a.directors - b.directors).amax() < 1e-10);
            }
        }
        earlier = Some(found.motion.clone());
        (found.solution.objective, found.motion)
    });
    let [(a, reduced), (b, redundant)] = &optima;
    println!("objectives {a} {b}");
    assert!((a - b).abs() < 1e-7 * a.abs() && a.abs() > 1e-3);
    let (last, other) = (&reduced.poses[intervals], &redundant.poses[intervals]);
    for (a, b) in last.iter().zip(other) {
        assert!((a.directors - b.directors).amax() < 1e-5);
    }
}
