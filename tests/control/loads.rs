//! Loads that are sought: a closed form, bounds, and what messages say of wrong ones.

use nalgebra::Vector3;
use proboscis::System;
use proboscis::control::problem::{Control, Task};
use proboscis::files::read_problem;
use proboscis::nlp::Status;
use proboscis::prelude::{Body, Contact, GROUND, Joint, Load, Simulation, State, X, Y};
use proboscis::workflow::{Optimum, SolveLimits, optimise};
use std::ops::ControlFlow;
use std::path::Path;

pub(crate) fn loaded(changes: &[String]) -> (System, Control) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/swing_up.json");
    let loaded = read_problem(&path, changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    (loaded.system, *control)
}

pub(crate) fn solved(system: &System, control: &Control) -> Optimum {
    let limits = SolveLimits::default();
    optimise(system, control, None, limits, &mut |_| {
        ControlFlow::Continue(())
    })
    .unwrap()
}

/// 1 kg on a slide along x that a motor moves by 1 m in 1 s, from rest to rest; with light oscillators of these frequencies in Hz on it,
/// which end at rest.
pub(crate) fn cart(intervals: usize, frequencies: &[f64], coordinates: &str) -> (System, Control) {
    // So light that the force is the acceleration of the cart to 1e-7.
    let light = 1e-8;
    let mut bodies = vec![serde_json::json!({
        "name": "cart", "mass": 1.0, "sphere": { "radius": 0.01 }, "position": [0, 0, 0],
    })];
    let mut joints = vec![serde_json::json!({
        "name": "shoulder", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart",
        "at": [0, 0, 0],
    })];
    let mut goal = serde_json::json!({ "shoulder": 1.0 });
    for (k, frequency) in frequencies.iter().enumerate() {
        let stiffness = light * (std::f64::consts::TAU * frequency).powi(2);
        bodies.push(serde_json::json!({
            "name": format!("mass{k}"), "mass": light, "sphere": { "radius": 0.01 },
            "position": [0, 0.1, 0],
        }));
        joints.push(serde_json::json!({
            "name": format!("swing{k}"), "prismatic": { "axis": [1, 0, 0] }, "parent": "cart",
            "child": format!("mass{k}"), "at": [0, 0.1, 0], "stiffness": stiffness,
        }));
        goal[format!("swing{k}")] = serde_json::json!(0.0);
    }
    loaded(&[
        format!("scene.bodies={}", serde_json::json!(bodies)),
        format!("scene.joints={}", serde_json::json!(joints)),
        "scene.gravity=[0, 0, 0]".to_owned(),
        "control.duration=1 s".to_owned(),
        format!("control.intervals={intervals}"),
        "control.loads={}".to_owned(),
        r#"scene.loads=[{"name": "motor", "joint": "shoulder"}]"#.to_owned(),
        "scene.markers=[]".to_owned(),
        r#"control.load_bounds={"motor": ["-90 N", "90 N"]}"#.to_owned(),
        format!(
            "control.goal={}",
            serde_json::json!({ "joint_angles": goal })
        ),
        format!("control.coordinates={coordinates:?}"),
    ])
}

#[test]
fn least_effort_moves_a_mass_as_its_closed_form_with_order_two() {
    // F = 6 − 12 t, ∫F² = 12 N² s.
    for coordinates in ["reduced", "redundant"] {
        let errors = [20, 40].map(|intervals| {
            let (system, control) = cart(intervals, &[], coordinates);
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            optimum.solution.objective - 12.0
        });
        assert!(
            errors[0].abs() < 0.1 && errors[1].abs() > 1e-6,
            "{errors:?}"
        );
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.1, "{coordinates}: {errors:?}");
    }
}

#[test]
fn least_effort_slides_a_mass_against_friction_that_sticks() {
    // F = 6 − 12 t + μ N with a normal force of 1 N and μ = 0.5, ∫F² = 12.25 N² s.
    let (mut system, control) = cart(40, &[], "reduced");
    let centre = (GROUND, Vector3::zeros(), 0.0);
    let floor = Contact::on_plane(centre, (GROUND, Y * 0.1, Y)).stiffness(10.0);
    let floor = floor.friction(0.5).slip_speed(0.02).stick(0.2);
    let mut floor = floor.named("floor");
    floor.round.centre.body = Some(0);
    system.components.contacts.push(floor);
    let optimum = solved(&system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    let error = optimum.solution.objective - 12.25;
    println!("{error} after {}", optimum.solution.iterations.len());
    // Friction grows over 0.2 mm, which take less than 0.01 s: up to 2 · 6.5 N · 0.5 N · 0.01 s are missing.
    assert!((-0.065..0.02).contains(&error), "{error}");
}

#[test]
fn a_pendulum_swings_up_against_a_wind_within_the_bounds_of_its_motor() {
    let (system, control) = loaded(&[]);
    let optimum = solved(&system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    let motor = optimum.motion.voltages.iter().map(|row| row[0]);
    let largest = motor.fold(0.0, |m: f64, torque| m.max(torque.abs()));
    assert!((100.0..=150.0 + 1e-4).contains(&largest), "{largest} N mm");
    let wind = optimum.motion.voltages.iter().map(|row| row[1]);
    for (k, force) in wind.enumerate() {
        let time = 20.0 * (k as f64 + 0.5);
        let exact = 0.05 * (std::f64::consts::TAU * time / 400.0).sin();
        assert!((force - exact).abs() < 1e-12, "{force} {exact}");
    }
}

/// One message says where a changed problem is wrong, and what is expected.
pub(crate) fn assert_refused(name: &str, change: &str, place: &str, words: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    let said = read_problem(&path, &[change.to_owned()])
        .unwrap_err()
        .to_string();
    assert!(said.contains(place) && said.contains(words), "{said}");
}

#[test]
fn a_wrong_load_has_one_message_with_its_place() {
    for (change, place, words) in [
        (
            r#"control.load_bounds={"moter": ["0 N m", "1 N m"]}"#,
            "control.load_bounds.moter",
            "the name of a load",
        ),
        (
            r#"control.load_bounds={"motor": ["0 N", "1 N m"]}"#,
            "control.load_bounds.motor[0]",
            "a torque",
        ),
        (
            r#"control.load_bounds={"motor": ["2 N m", "1 N m"]}"#,
            "control.load_bounds.motor[1]",
            "an upper bound",
        ),
        (
            r#"control.load_bounds={"wind": ["0 N", "1 N"]}"#,
            "control.load_bounds.wind",
            "a load that is sought",
        ),
        (
            r#"scene.loads=[{"name": "motor", "joint": "elbow"}]"#,
            "loads[0].joint",
            "the name of a joint",
        ),
        (
            r#"scene.loads=[{"name": "motor", "joint": "shoulder", "direction": [1, 0, 0]}]"#,
            "loads[0].direction",
            "no such key",
        ),
    ] {
        assert_refused("swing_up", change, place, words);
    }
}

#[test]
fn what_jumps_or_holds_a_goal_needs_a_duration_that_is_given() {
    let free = r#"control.duration={"min": "1 s", "max": "2 s", "guess": "1.2 s"}"#;
    let refused = |name: &str, change: &str, place: &str, words: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        let said = read_problem(&path, &[free.to_owned(), change.to_owned()]).unwrap_err();
        let said = said.to_string();
        assert!(said.contains(place) && said.contains(words), "{said}");
    };
    let rest = r#"control.goal={"rest_at_voltages": {}}"#;
    refused(
        "swing_up",
        rest,
        "control.loads.wind",
        "while the goal rests under it",
    );
    let ramp = |end: &str| {
        let changes = [
            free.to_owned(),
            rest.to_owned(),
            format!(
                r#"control.loads={{"wind": {{"ramp": {{"to": "1 N", "duration": "{end}"}}}}}}"#
            ),
        ];
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/swing_up.json");
        read_problem(&path, &changes).map(|_| ())
    };
    assert!(ramp("1.1 s").is_err() && ramp("1 s").is_ok());
    let table = r#"control.voltages={"time": [0, 0.1], "voltages": {"muscle1": ["1 kV"]}}"#;
    refused(
        "identify_pair",
        table,
        "control.voltages",
        "functions of time",
    );
}

#[test]
fn a_wrong_load_of_a_block_has_one_message_with_its_place() {
    for (load, place, words) in [
        (r#""kind": "pressure""#, "loads[0]", "exactly one of"),
        (r#""face": "z_min""#, "loads[0]", "\"surface_charge\""),
        (
            r#""kind": "pressure", "face": "z_min", "direction": [0, 0, 1]"#,
            "loads[0].direction",
            "acts along the normal",
        ),
        (
            r#""kind": "traction", "face": "z_min""#,
            "loads[0]",
            "the direction of the force",
        ),
        (
            r#""kind": "traction", "face": "x_min", "direction": [0, 0, 1]"#,
            "loads[0]",
            "a part of the surface that moves",
        ),
        (
            r#""kind": "traction", "face": "z_max", "direction": [0, 0, 1], "follows": true"#,
            "loads[0].follows",
            "a force at a point and a pressure follow",
        ),
        (
            r#""kind": "pressure", "plane": { "z": "1 mm" }"#,
            "loads[0]",
            "a part of the surface of the block",
        ),
        (
            r#""kind": "surface_charge", "face": "z_min""#,
            "loads[0]",
            "other than those of this electrode",
        ),
        (
            r#""kind": "body_force", "face": "z_min", "direction": [0, 0, 1]"#,
            "loads[0].face",
            "in the whole block",
        ),
    ] {
        let change = format!(r#"scene.loads=[{{"name": "air", "solid": "beam", {load}}}]"#);
        assert_refused("pressed_beam", &change, place, words);
    }
    let change = r#"simulate.loads={"air": "1 N"}"#;
    assert_refused("pressed_beam", change, "simulate.loads.air", "a stress");
}

/// A pressure that is sought brings the tip of a beam to a place at rest.
#[test]
fn a_sought_pressure_bends_a_beam() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pressed_beam_control.json");
    let loaded = read_problem(&path, &[]).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let found = solved(&loaded.system, &control);
    let n = found.motion.times.len() - 1;
    let instant = found.model.action.map.placed(&found.motion.z[n]);
    let tip = instant.x[found.model.markers[0]];
    assert!((tip.z - 9.0).abs() < 1e-6, "{tip}");
    let air = loaded.system.first_load();
    let most = found
        .motion
        .voltages
        .iter()
        .map(|row| row[air].abs())
        .fold(0.0, f64::max);
    // MPa.
    assert!(most > 5e-6 && most < 1e-3, "{most}");
}

#[test]
fn the_library_moves_the_same_mass_with_a_motor() {
    let mut system = System::new("slide");
    let mass = system.add(Body::sphere(1.0).mass(1000.0));
    let joint = system.add(Joint::prismatic(X).between(GROUND, mass));
    let motor = system.add(Load::motor(joint));
    let idle = system.add(Load::force(mass, 0.0 * X, X));
    let control = proboscis::Control::over(1000.0, 20)
        .start(State::Reference)
        .goal(State::Joints(vec![(joint, 1000.0)]))
        .effort(1.0);
    let steered = control
        .clone()
        .load_within(motor, -90.0..=90.0)
        .solve(&system)
        .unwrap();
    let (system_of_file, control_of_file) = cart(20, &[], "reduced");
    let expected = solved(&system_of_file, &control_of_file);
    let expected = expected.solution.objective;
    assert!(steered.is_solved() && expected > 11.0);
    assert!((steered.objective - expected).abs() < 1e-8 * expected);

    // A constant force of the other load does the same as that of the motor.
    let given = |load| {
        let run = Simulation::over(1000.0).step(10.0).load(load, 2.0);
        run.run(&system).unwrap().joint(joint)
    };
    let [by_motor, by_force] = [motor, idle].map(given);
    let last = by_motor.len() - 1;
    assert!((by_motor[last] - 1000.0).abs() < 1e-6, "{}", by_motor[last]);
    assert!((by_motor[last] - by_force[last]).abs() < 1e-9);

    let both = control.load_within(motor, -1.0..=1.0).load(motor, 1.0);
    let said = both.solve(&system).unwrap_err().to_string();
    assert!(said.contains("given and sought"), "{said}");
}

#[test]
fn an_objective_counts_loads_in_their_units() {
    // Given ones cost nothing.
    let bounds = r#"control.load_bounds={"motor": [-0.1, 0.1], "wind": [-1, 1]}"#;
    for (change, expected) in [
        ("control.loads={}", vec!["(N m)² s"]),
        (r#"control.loads={"wind": "0.1 N"}"#, vec!["(N m)² s"]),
        (bounds, vec!["(N m)² s", "N² s"]),
    ] {
        let changes = ["control.loads={}".to_owned(), change.to_owned()];
        let (system, control) = loaded(&changes);
        assert_eq!(control.objective_units(&system), expected);
    }
}

#[test]
fn least_effort_leaves_oscillators_at_rest_as_the_gramian_says() {
    for (frequencies, exact) in [
        (&[2.0][..], 14.150_639_28),
        (&[1.6, 2.4], 12.708_192_71),
        (&[1.6, 2.0, 2.4], 46.891_754_45),
    ] {
        let errors = [160, 320].map(|intervals| {
            let (system, control) = cart(intervals, frequencies, "reduced");
            let optimum = solved(&system, &control);
            assert_eq!(optimum.solution.status, Status::Solved);
            optimum.solution.objective - exact
        });
        println!("{frequencies:?}: {errors:?}");
        assert!(errors[0].abs() > 1e-4, "{errors:?}");
        let ratio = errors[0] / errors[1];
        assert!((ratio - 4.0).abs() < 0.2, "{frequencies:?}: {errors:?}");
        // Richardson's extrapolation.
        let limit = (4.0 * errors[1] - errors[0]) / 3.0;
        assert!(limit.abs() < 1e-4 * exact, "{frequencies:?}: {limit:e}");
    }
}

/// One or two rods that a motor of this bound in N m swings up.
fn swing_up(rods: usize, bound: f64) -> (System, Control) {
    let (mut bodies, mut joints, mut goal) = (Vec::new(), Vec::new(), serde_json::Map::new());
    for k in 0..rods {
        let top = -0.3 * k as f64;
        let parent = k
            .checked_sub(1)
            .map_or("ground".to_owned(), |k| format!("rod{k}"));
        bodies.push(serde_json::json!({
            "name": format!("rod{k}"), "mass": 0.2, "position": [0, top - 0.15, 0],
            "cylinder": { "radius": 0.005, "length": 0.3, "axis": [0, 1, 0] },
        }));
        joints.push(serde_json::json!({
            "name": format!("hinge{k}"), "revolute": { "axis": [0, 0, 1] }, "parent": parent,
            "child": format!("rod{k}"), "at": [0, top, 0],
        }));
        let angle = if k == 0 { "180 deg" } else { "0 deg" };
        goal.insert(format!("hinge{k}"), serde_json::json!(angle));
    }
    loaded(&[
        format!("scene.bodies={}", serde_json::json!(bodies)),
        format!("scene.joints={}", serde_json::json!(joints)),
        r#"scene.loads=[{"name": "motor", "joint": "hinge0"}]"#.to_owned(),
        "scene.markers=[]".to_owned(),
        "control.loads={}".to_owned(),
        r#"control.start={"joint_angles": {"hinge0": 0}}"#.to_owned(),
        format!(
            "control.goal={}",
            serde_json::json!({ "joint_angles": goal })
        ),
        format!(r#"control.load_bounds={{"motor": [-{bound}, {bound}]}}"#),
        r#"control.solver={"tolerance": 1e-12, "ipopt": {"bound_relax_factor": 0}}"#.to_owned(),
    ])
}

#[test]
fn a_motor_swings_up_one_and_two_rods_with_the_effort_of_an_independent_program() {
    let text = include_str!("../reference/motor.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    for (rods, name) in [(1, "one"), (2, "two")] {
        let [bound, exact] = ["bound", "objective"].map(|key| reference[name][key].as_f64());
        let exact = exact.unwrap();
        let (system, control) = swing_up(rods, bound.unwrap());
        let optimum = solved(&system, &control);
        assert_eq!(optimum.solution.status, Status::Solved);
        let found = optimum.solution.objective;
        // Two rods have several optima: one that is no worse will do.
        let is_one = rods == 1;
        assert!(found < (1.0 + 1e-8) * exact, "{found:e} {exact:e}");
        assert!(
            !is_one || found > (1.0 - 1e-8) * exact,
            "{found:e} {exact:e}"
        );
        let torques = optimum.motion.voltages.iter().map(|row| row[0].abs());
        let at_bound = torques.filter(|torque| *torque > 999.0 * bound.unwrap());
        assert!(at_bound.count() > 5, "the bound is active");
    }
}
