//! Waypoints: a closed form, places and orientations on the way of a trunk, and what messages say of wrong ones.

use crate::loads::{assert_refused, cart, solved};
use nalgebra::Vector3;
use proboscis::control::problem::{Control, Duration, Task, Waypoint};
use proboscis::files::read_problem;
use proboscis::nlp::Status;
use proboscis::prelude::{Body, GROUND, Joint, Load, State, System, X};
use proboscis::tasks::{SolveRequest, solve};
use proboscis::workflow::{Iterate, Optimum};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// 1 m at half time and back, by the coordinate of the joint.
fn there_and_back(intervals: usize, coordinates: &str) -> (System, Control) {
    let (system, mut control) = cart(intervals, &[], coordinates);
    let proboscis::control::problem::BoundaryState::JointAngles { angles, .. } = &mut control.goal
    else {
        panic!("a goal of joints");
    };
    angles.insert(0, 0.0);
    control.waypoints = vec![Waypoint {
        part: 0.5,
        name: "waypoint".into(),
        angles: BTreeMap::from([(0, 1000.0)]),
        ..Waypoint::default()
    }];
    (system, control)
}

#[test]
fn there_and_back_costs_its_closed_form_with_order_two() {
    // Each half is a motion from rest to rest by 1 m in 0.5 s: 2 · 12/0.5³ = 192 N² s.
    for coordinates in ["reduced", "redundant"] {
        let errors = [20, 40].map(|intervals| {
            let (system, control) = there_and_back(intervals, coordinates);
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            let there = optimum.motion.joints[intervals / 2][0];
            assert!((there - 1000.0).abs() < 1e-6, "{there}");
            assert!(optimum.motion.joints[intervals][0].abs() < 1e-6);
            optimum.solution.objective - 192.0
        });
        assert!(
            errors[0].abs() < 5.0 && errors[1].abs() > 1e-4,
            "{errors:?}"
        );
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.2, "{coordinates}: {errors:?}");
    }
}

#[test]
fn a_free_duration_has_waypoints_at_its_parts() {
    let (system, mut control) = there_and_back(20, "reduced");
    control.duration = Duration::Free {
        min: 500.0,
        max: 2000.0,
        guess: 1000.0,
    };
    let optimum = solved(&system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    // Effort falls with the duration.
    let times = &optimum.motion.times;
    assert!((times[20] - 2000.0).abs() < 1e-3, "{}", times[20]);
    assert!((optimum.motion.joints[10][0] - 1000.0).abs() < 1e-6);
}

#[test]
fn a_weight_trades_the_distance_for_effort_as_its_closed_form_with_order_two() {
    // To pass d on the way costs 192 d² N² s, and to miss 1 m by the rest W (1 − d)²: with W = 64, d = 1/4 and 48 in all.
    for coordinates in ["reduced", "redundant"] {
        let errors = [20, 40].map(|intervals| {
            let (system, mut control) = there_and_back(intervals, coordinates);
            let waypoints = std::mem::take(&mut control.waypoints);
            control.objective.quantities = waypoints[0].costs(64e-6);
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            let passed = optimum.motion.joints[intervals / 2][0];
            assert!((passed - 250.0).abs() < 3.0, "{passed}");
            optimum.solution.objective - 48.0
        });
        assert!(errors[0].abs() > 1e-3, "{errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.2, "{coordinates}: {errors:?}");
    }
}

#[test]
fn what_a_waypoint_that_is_a_cost_misses_is_told() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let near = r#"control.waypoints=[{ "time": "0.1 s", "weight": 1e-3, "markers": { "tip": ["20 mm", null, "40 mm"] }, "joint_angles": { "joint1": "5 deg" } }]"#;
    let changes = [near.to_owned(), "control.intervals=40".into()];
    let loaded = read_problem(&path, &changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    assert!(control.waypoints.is_empty() && control.objective.quantities.len() == 3);
    let request = SolveRequest::default();
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let result = solve(&loaded.system, &control, request, go_on).unwrap();
    assert!(result.verdict.is_solved);
    assert!(result.final_values.is_empty());
    let values = &result.waypoint_values;
    let names: Vec<&str> = values.iter().map(|value| value.name.as_str()).collect();
    assert_eq!(names, ["tip_x", "tip_z", "joint1"]);
    let optimum = &result.optimum;
    // 0.1 s lies between the instants 13 and 14.
    let map = &optimum.model.action.map;
    let tip = map.placed(&optimum.motion.z[13]).x[optimum.model.markers[0]];
    for (value, (at, asked)) in values.iter().zip([(tip.x, 20.0), (tip.z, 40.0)]) {
        assert!((1e3 * value.reached - at).abs() < 1e-9, "{value:?} {at}");
        assert!((value.deviation - (value.reached - 1e-3 * asked).abs()).abs() < 1e-12);
        assert!(
            value.deviation > 1e-6 && value.time == Some(0.0975),
            "{value:?}"
        );
    }
    let lines: Vec<String> = result.remarks.lines().collect();
    let told = |words: &str| lines.iter().any(|line| line.contains(words));
    assert!(
        told("tip_x passes at 0.0975 s at ") && told("mm of its waypoint"),
        "{lines:?}"
    );
    assert!(
        told("lies between two instants: it is reached at 0.0975 s"),
        "{lines:?}"
    );
}

fn trunk(waypoints: &str) -> Optimum {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let change = format!("control.waypoints={waypoints}");
    let loaded = read_problem(&path, &[change, "control.intervals=40".into()]).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let optimum = solved(&loaded.system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    optimum
}

#[test]
fn the_tip_of_a_trunk_and_its_direction_are_reached_on_the_way() {
    let tip = |optimum: &Optimum, k: usize| {
        let map = &optimum.model.action.map;
        map.placed(&optimum.motion.z[k]).x[optimum.model.markers[0]]
    };
    let plain = trunk("[]");
    let without = tip(&plain, 20);
    let at = without.x + 15.0;
    let place =
        format!(r#"[{{ "time": "0.15 s", "markers": {{ "tip": ["{at} mm", null, null] }} }}]"#);
    let optimum = trunk(&place);
    let found = tip(&optimum, 20).x;
    assert!((found - at).abs() < 1e-6, "{found}, not {at}");
    assert!(optimum.solution.objective > plain.solution.objective);
    let turned = r#"[{ "part": 0.5, "orientations": { "segment6": { "axis": [0, 0, 1], "towards": [0, 0, 1] } } }]"#;
    let optimum = trunk(turned);
    let direction = |optimum: &Optimum| {
        let pose = &optimum.motion.poses[20][5];
        let reference = optimum.model.system.bodies[5].pose();
        pose.directors * (reference.directors.transpose() * Vector3::z())
    };
    assert!((direction(&plain) - Vector3::z()).norm() > 1e-3);
    assert!((direction(&optimum) - Vector3::z()).norm() < 1e-7);
}

#[test]
fn a_waypoint_between_two_instants_is_told() {
    let (system, mut control) = there_and_back(20, "reduced");
    control.waypoints[0].part = 0.52;
    let (_, boundary) =
        proboscis::control::BoundaryConditions::resolve(&system, &control, 50.0).unwrap();
    assert_eq!(
        boundary.notes,
        ["waypoint lies between two instants: it is reached at 0.5 s"]
    );
}

#[test]
fn wrong_waypoints_have_one_message_with_their_place() {
    for (waypoint, place, words) in [
        (
            r#"{ "time": "0.15 s" }"#,
            "control.waypoints[0]",
            "a waypoint without a place",
        ),
        (
            r#"{ "time": "0.3 s", "markers": { "tip": [0, 0, 0] } }"#,
            "waypoints[0].time",
            "before the end",
        ),
        (
            r#"{ "part": 1.5, "markers": { "tip": [0, 0, 0] } }"#,
            "waypoints[0].part",
            "below 1",
        ),
        (
            r#"{ "markers": { "tip": [0, 0, 0] } }"#,
            "waypoints[0]",
            "\"time\"",
        ),
        (
            r#"{ "part": 0.5, "markers": { "tap": [0, 0, 0] } }"#,
            "markers.tap",
            "\"tip\"",
        ),
        (
            r#"{ "part": 0.5, "joint_angles": { "joint9": 0 } }"#,
            "joint_angles.joint9",
            "a joint",
        ),
        (
            r#"{ "part": 0.5, "weight": 0, "joint_angles": { "joint1": 0 } }"#,
            "waypoints[0].weight",
            "a positive weight",
        ),
        (
            r#"{ "part": 0.5, "weight": 1, "orientations": { "segment6": { "axis": [0, 0, 1], "angle": 0.1 } } }"#,
            "waypoints[0].orientations",
            "exactly",
        ),
    ] {
        let change = format!("control.waypoints=[{waypoint}]");
        assert_refused("elephant_trunk", &change, place, words);
    }
    let place = r#"{ "time": "0.1 s", "joint_angles": { "joint1": 0 } }"#;
    let change = format!("control.waypoints=[{place}]");
    assert_refused("pair_time", &change, "waypoints[0].time", "\"part\"");
}

#[test]
fn a_program_passes_a_place_too() {
    let mut system = System::new("cart");
    let body = system.add(Body::sphere(10.0).mass(1000.0));
    let slide = system.add(Joint::prismatic(X).between(GROUND, body));
    let motor = system.add(Load::motor(slide));
    let optimum = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -100.0..=100.0)
        .effort(1.0)
        .start(State::Reference)
        .goal(State::Joints(vec![(slide, 0.0)]))
        .joint_passes(slide, 1000.0, 0.5)
        .solve(&system)
        .unwrap();
    assert!((optimum.objective - 192.0).abs() < 5.0);
    let near = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -100.0..=100.0)
        .effort(1.0)
        .start(State::Reference)
        .goal(State::Joints(vec![(slide, 0.0)]))
        .joint_passes_near(slide, 1000.0, 0.5, 64e-6)
        .solve(&system)
        .unwrap();
    assert!((near.objective - 48.0).abs() < 1.5, "{}", near.objective);
    assert!((near.waypoint_values[0].deviation - 0.75).abs() < 3e-3);
    let wrong = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -100.0..=100.0)
        .effort(1.0)
        .start(State::Reference)
        .joint_passes(slide, 1000.0, 1.5)
        .solve(&system);
    assert!(wrong.unwrap_err().to_string().contains("below 1"));
}
