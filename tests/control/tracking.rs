//! Motions that follow: a motion is found again from its joints alone, tips follow paths, ends are free, partly given, or turned.

use crate::common::cases::{control, partly};
use crate::common::timed::in_steps;
use crate::common::tracked::square;
use crate::common::trunk;
use nalgebra::{Rotation3, Vector3};
use proboscis::control::problem::{
    Afterwards, BoundaryState, Control, CostFunction, Duration, During, Guess, Objective,
    Orientation, Task,
};
use proboscis::files::read_problem;
use proboscis::math::Signal;
use proboscis::model::system::{JointKind, System};
use proboscis::model::{Coordinates, Quantity};
use proboscis::workflow::{Iterate, Optimum, SolveLimits, optimise, tracked, trajectory};
use std::ops::ControlFlow;

fn solve(system: &System, control: &Control) -> Optimum {
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let found = optimise(system, control, None, SolveLimits::default(), go_on).unwrap();
    assert!(found.is_solved(), "{}", found.word());
    found
}

/// Rest to anything over `intervals` intervals of 10 ms.
fn free(system: &System, intervals: usize) -> Control {
    Control {
        goal: BoundaryState::Free,
        ..control(system, intervals)
    }
}

fn joint(joint: usize) -> Quantity {
    Quantity::joint(joint, 0.0)
}

/// Place of the tip of a motion at an instant, from the pose of the last body.
fn tip(found: &Optimum, k: usize) -> Vector3<f64> {
    let system = &found.model.system;
    let point = &system.markers[0].point;
    let body = point.body.unwrap();
    let (of, pose) = (&system.bodies[body], &found.motion.poses[k][body]);
    pose.centre + pose.directors * of.directors.transpose() * (point.at - of.centre)
}

#[test]
fn voltages_are_found_again_from_the_motion_of_the_joints() {
    let system = trunk(2);
    let voltages = |k: usize| {
        let s = k as f64 / 20.0;
        vec![0.0, 900.0 + 500.0 * (5.0 * s).sin(), 0.0, 700.0 + 300.0 * s]
    };
    // A motion under known voltages, of the same grid.
    let mut known = free(&system, 20);
    let ends: Vec<f64> = (1..=20).map(|k| 10.0 * f64::from(k)).collect();
    let rows: Vec<Vec<f64>> = (0..=20).map(voltages).collect();
    known.guess = Guess::Simulate(in_steps(&ends, &rows, Afterwards::OfLastInterval));
    let h = 10.0;
    let (model, boundary) =
        proboscis::control::BoundaryConditions::resolve(&system, &known, h).unwrap();
    let discrete = proboscis::control::guess(&model, &boundary, &known, h, None).discrete;
    let motion = proboscis::workflow::solved(&model, &discrete, None);
    assert!(motion.joints[20].iter().all(|angle| angle.abs() > 0.02));
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut problem = free(&system, 20);
        problem.coordinates = Some(coordinates);
        problem.given = [0, 2].map(|s| (s, Signal::Constant(0.0))).into();
        // Nothing but the motion holds the voltages, and at 1e-10 it lets those of the last intervals go by some tenths of a volt.
        problem.solver.tolerance = 1e-12;
        let along = |j: usize| Signal::Table {
            times: motion.times.clone(),
            values: motion.joints.iter().map(|row| row[j]).collect(),
        };
        let quantities = (0..2).map(|j| square(joint(j), 1e3, along(j)));
        problem.objective = Objective {
            quantities: quantities.collect(),
            ..Objective::default()
        };
        let found = solve(&system, &problem);
        assert!(found.solution.objective < 1e-10);
        for k in 0..20 {
            for s in [1, 3] {
                let [a, b] = [&found.motion.voltages[k], &voltages(k)].map(|row| row[s]);
                assert!((a - b).abs() < 0.1, "{a} {b} in interval {k}");
            }
            assert_eq!(found.motion.voltages[k][0], 0.0);
        }
        // Nothing holds the end: its voltages are not known, and it moves.
        assert_eq!(found.motion.hold, None);
        let [before, end] = [19, 20].map(|k| found.motion.joints[k][0]);
        assert!((end - before).abs() > 1e-4);
    }
}

#[test]
fn a_greater_weight_follows_more_closely() {
    let system = trunk(2);
    let sine = |amplitude: f64, frequency: f64| Signal::Sine {
        mean: 0.0,
        amplitude,
        frequency,
        phase: 0.0,
    };
    let place = |axis| Quantity::marker_place(0, axis);
    let error = |weight: f64| {
        let mut problem = free(&system, 40);
        problem.duration = Duration::Given(800.0);
        problem.objective = Objective {
            effort: 1.0,
            quantities: vec![
                square(place(0), weight, sine(8.0, 1.25e-3)),
                square(place(2), weight, sine(4.0, 2.5e-3)),
            ],
            ..Objective::default()
        };
        let found = solve(&system, &problem);
        let deviation = |k: usize| {
            let t = found.motion.times[k];
            let turn = std::f64::consts::TAU * t;
            let at = [8.0 * (1.25e-3 * turn).sin(), 4.0 * (2.5e-3 * turn).sin()];
            let tip = tip(&found, k);
            (tip.x - at[0]).powi(2) + (tip.z - at[1]).powi(2)
        };
        let mean = (0..=40).map(deviation).sum::<f64>() / 41.0;
        mean.sqrt()
    };
    let [little, more, most] = [0.01, 1.0, 100.0].map(error);
    println!("{little} {more} {most}");
    assert!(little > 2.0 * more && more > 2.0 * most && most < 0.6);
}

#[test]
fn a_marker_may_be_asked_for_in_some_directions() {
    let system = trunk(3);
    let mut problem = control(&system, 20);
    problem.duration = Duration::Given(400.0);
    let mut objectives = Vec::new();
    for place in [[Some(20.0), None, None], [Some(20.0), None, Some(10.0)]] {
        problem.goal = partly(&[(0, place)], &[]);
        let found = solve(&system, &problem);
        let end = tip(&found, 20);
        assert!((end.x - 20.0).abs() < 1e-6);
        assert_eq!((end.z - 10.0).abs() < 1e-6, place[2].is_some());
        objectives.push(found.solution.objective);
        // The end is at rest: the last step is small against the largest.
        let step = |k: usize| (tip(&found, k + 1) - tip(&found, k)).norm();
        let largest = (0..20).map(step).fold(0.0, f64::max);
        assert!(step(19) < 0.5 * largest, "{} {largest}", step(19));
    }
    assert!(objectives[0] > 0.0 && objectives[0] < 0.9 * objectives[1]);
}

/// The orientation of a body at the end, relative to the reference.
fn turned(found: &Optimum, body: usize) -> Rotation3<f64> {
    let last = found.motion.poses.last().unwrap();
    let turn = last[body].directors * found.model.system.bodies[body].directors.transpose();
    Rotation3::from_matrix_unchecked(turn)
}

#[test]
fn bodies_come_to_rest_in_the_orientations_asked_for() {
    let system = trunk(3);
    let towards = Vector3::new(0.15, 0.98, 0.1).normalize();
    // What hinges about z, x and z reach, away from where the first and the last one are parallel.
    let [first, second, third] = [
        (Vector3::z_axis(), 0.15),
        (Vector3::x_axis(), 0.2),
        (Vector3::z_axis(), -0.25),
    ]
    .map(|(axis, angle)| Rotation3::from_axis_angle(&axis, angle));
    let full = first * second * third;
    let (about, angle) = full.axis_angle().unwrap();
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let mut problem = control(&system, 40);
        problem.duration = Duration::Given(400.0);
        problem.coordinates = Some(coordinates);
        let axis = Vector3::y();
        problem.goal = partly(&[], &[(2, Orientation::Towards { axis, towards })]);
        let end = turned(&solve(&system, &problem), 2);
        assert!((end * axis - towards).norm() < 1e-7);
        assert!((end * axis - axis).norm() > 0.1);
        let axis = about.into_inner();
        let orientation = Orientation::Turned { axis, angle };
        problem.goal = partly(&[], &[(2, orientation)]);
        let end = turned(&solve(&system, &problem), 2);
        assert!((end.inverse() * full).angle() < 1e-7);
    }
}

#[test]
fn what_no_joint_changes_is_left_out_of_an_orientation_or_refused() {
    // One hinge about z: directions stay in their plane.
    let system = trunk(1);
    assert!(matches!(
        system.joints[0].kind,
        JointKind::Revolute { axis } if (axis - Vector3::z()).norm() < 1e-12
    ));
    let mut problem = control(&system, 20);
    let goal = |axis: Vector3<f64>, towards: Vector3<f64>| {
        let towards = towards.normalize();
        partly(&[], &[(0, Orientation::Towards { axis, towards })])
    };
    let angle = 0.2_f64;
    problem.goal = goal(Vector3::y(), Vector3::new(-angle.sin(), angle.cos(), 0.0));
    let found = solve(&system, &problem);
    let end = found.motion.joints[20][0];
    assert!((end - angle).abs() < 1e-7, "{end}");
    problem.goal = goal(Vector3::z(), Vector3::new(0.3, 0.0, 1.0));
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    let refused = optimise(&system, &problem, None, SolveLimits::default(), go_on);
    let Err(refused) = refused else {
        panic!("no joint turns z away from z");
    };
    let message = refused.to_string();
    assert!(
        message.contains("goal") && message.contains("no joint changes it"),
        "{message}"
    );
}

#[test]
fn a_cost_of_the_end_draws_it_near() {
    let system = trunk(2);
    let ends = [1.0, 1e4].map(|weight| {
        let mut problem = free(&system, 20);
        problem.objective.quantities = vec![proboscis::control::problem::QuantityCost {
            quantity: joint(0),
            weight,
            function: CostFunction::Square {
                reference: Signal::Constant(0.2),
            },
            during: During::End,
        }];
        let found = solve(&system, &problem);
        let squares: f64 = found.motion.voltages.iter().flatten().map(|v| v * v).sum();
        let end = found.motion.joints[20][0];
        let expected = 1e-2 * squares / 1e6 + weight * (end - 0.2).powi(2);
        let objective = found.solution.objective;
        assert!((objective - expected).abs() < 1e-9 * expected && expected > 1e-4);
        (end - 0.2).abs()
    });
    assert!(ends[0] > 0.01 && ends[1] < 1e-3, "{ends:?}");
}

#[test]
fn the_trunk_writes_a_figure_of_eight() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = file.join("problems/elephant_trunk_figure_eight.json");
    let loaded = read_problem(&file, &["control.intervals=60".to_owned()]).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a control problem");
    };
    let found = solve(&loaded.system, &control);
    let motion = trajectory(&found.model, &found.motion);
    let report = tracked(&loaded.system, &control, &motion, None);
    assert_eq!(report.len(), 1);
    assert_eq!(
        (report[0].kind, report[0].name.as_str(), report[0].unit),
        ("marker", "tip", "m")
    );
    // The eight, written out, in mm; deviations by the trapezoidal rule.
    let far = |k: usize| {
        let turn = std::f64::consts::PI * found.motion.times[k] / 1e3;
        let at = [40.0 * turn.sin(), 20.0 * (2.0 * turn).sin()];
        let tip = tip(&found, k);
        (tip.x - at[0]).hypot(tip.z - at[1])
    };
    let all: Vec<f64> = (0..=60).map(far).collect();
    let inner: f64 = all[1..60].iter().map(|far| far * far).sum();
    let ends = 0.5 * (all[0] * all[0] + all[60] * all[60]);
    let rms = ((inner + ends) / 60.0).sqrt();
    let (worst, most) = (1..=60).fold((0, 0.0), |(at, most), k| match all[k] > most {
        true => (k, all[k]),
        false => (at, most),
    });
    let error = report[0].error;
    println!("{rms} mm rms, at most {most} mm");
    assert!(rms > 1e-3 && rms < 0.5 && most < 4.0);
    assert!((1e3 * error.rms - rms).abs() < 1e-9 && (1e3 * error.maximum - most).abs() < 1e-9);
    assert_eq!(error.time_of_maximum, found.motion.times[worst] / 1e3);
    // It goes around both loops.
    let side = |sign: f64| (0..=60).any(|k| sign * tip(&found, k).x > 38.0);
    assert!(side(1.0) && side(-1.0));
}
