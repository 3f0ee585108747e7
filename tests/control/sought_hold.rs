//! Goals that are held by inputs found with the motion: an independent program, states of rest of a trunk, and what is refused.

use crate::drivers;
use crate::limits::run;
use crate::loads::{assert_refused, loaded, solved};
use proboscis::control::problem::{BoundaryState, Control, SoughtHold, Task};
use proboscis::dynamics::stable_equilibrium;
use proboscis::files::{read_problem, solution};
use proboscis::nlp::Status;
use proboscis::prelude::{Body, GROUND, Joint, Load, State, System, X};
use proboscis::tasks::{SolveRequest, SolveResult, solve};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// Two rods that hang from each other; a motor at the upper one lifts the lower tip to 0.15 m along x.
fn rods(coordinates: &str) -> (System, Control) {
    let rod = |k: usize| {
        let top = -0.3 * k as f64;
        let parent = ["ground", "rod0"][k];
        let body = serde_json::json!({
            "name": format!("rod{k}"), "mass": 0.2, "position": [0, top - 0.15, 0],
            "cylinder": { "radius": 0.005, "length": 0.3, "axis": [0, 1, 0] },
        });
        let joint = serde_json::json!({
            "name": format!("hinge{k}"), "revolute": { "axis": [0, 0, 1] }, "parent": parent,
            "child": format!("rod{k}"), "at": [0, top, 0],
        });
        (body, joint)
    };
    let (bodies, joints): (Vec<_>, Vec<_>) = (0..2).map(rod).unzip();
    loaded(&[
        format!("scene.bodies={}", serde_json::json!(bodies)),
        format!("scene.joints={}", serde_json::json!(joints)),
        r#"scene.loads=[{"name": "motor", "joint": "hinge0"}]"#.to_owned(),
        r#"scene.markers=[{"name": "tip", "body": "rod1", "at": [0, -0.6, 0]}]"#.to_owned(),
        "control.loads={}".to_owned(),
        "control.intervals=40".to_owned(),
        r#"control.start={"joint_angles": {}}"#.to_owned(),
        r#"control.goal={"markers": {"tip": [0.15, null, null]}, "hold": "find"}"#.to_owned(),
        r#"control.load_bounds={"motor": [-10, 10]}"#.to_owned(),
        r#"control.objective={"effort": 1, "rate": 0.002}"#.to_owned(),
        format!("control.coordinates={coordinates:?}"),
        r#"control.solver={"tolerance": 1e-12}"#.to_owned(),
    ])
}

#[test]
fn a_motor_lifts_rods_to_where_it_holds_them_as_in_an_independent_program() {
    let text = include_str!("../reference/held.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let [exact, torque] = ["objective", "hold"].map(|key| number(&reference[key]));
    // Both rods weigh on the motor: the upper one at half the lever, the lower one, which hangs, at the whole.
    assert!((torque - 1.5 * 0.2 * 9.81 * 0.15).abs() < 1e-9);
    for coordinates in ["reduced", "redundant"] {
        let (system, control) = rods(coordinates);
        let optimum = solved(&system, &control);
        assert_eq!(optimum.solution.status, Status::Solved);
        let found = optimum.solution.objective;
        assert!((found - exact).abs() < 1e-8 * exact, "{found:e} {exact:e}");
        let hold = optimum.motion.hold.as_ref().unwrap()[0] / 1e3;
        assert!((hold - torque).abs() < 1e-8, "{coordinates}: {hold}");
        let last = optimum.motion.voltages.last().unwrap()[0] / 1e3;
        assert!(
            (last - hold).abs() > 1e-3,
            "the motion does not end with it: {last}"
        );
        // Its file has it too.
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("solution.json");
        let texts = solution::written(&optimum.model, &optimum.motion, "solution.npz").unwrap();
        std::fs::write(&file, texts.json).unwrap();
        let read = solution::read(&file, &optimum.model).unwrap();
        let both = [read.hold, optimum.motion.hold.clone()].map(|hold| hold.unwrap()[0]);
        assert!((both[0] / both[1] - 1.0).abs() < 1e-15, "{both:?}");
        for (joint, angle) in optimum.motion.joints[40]
            .iter()
            .zip(reference["angles"].as_array().unwrap())
        {
            assert!((joint - number(angle)).abs() < 1e-7, "{joint} {angle}");
        }
    }
}

#[test]
fn a_finer_grid_starts_from_what_was_found() {
    let (system, control) = rods("reduced");
    let coarse = solved(&system, &control);
    let finer = Control {
        intervals: 80,
        ..control
    };
    let cold = solved(&system, &finer);
    let warm = proboscis::workflow::optimise(
        &system,
        &finer,
        Some(&coarse.motion),
        Default::default(),
        &mut |_| ControlFlow::Continue(()),
    )
    .unwrap();
    assert_eq!(warm.solution.status, Status::Solved);
    let [a, b] = [&cold, &warm].map(|optimum| optimum.solution.objective);
    assert!((a - b).abs() < 1e-8 * a, "{a} {b}");
    let [a, b] = [&cold, &warm].map(|optimum| optimum.solution.iterations.len());
    assert!(b < a, "{b} iterations, and {a} without a guess");
}

fn trunk(goal: &str) -> (System, Control) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/elephant_trunk.json");
    let changes = [
        format!("control.goal={goal}"),
        "control.intervals=30".to_owned(),
    ];
    let loaded = read_problem(&path, &changes).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    (loaded.system, *control)
}

fn in_memory(system: &System, control: &Control) -> SolveResult {
    let request = SolveRequest::default();
    solve(system, control, request, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap()
}

#[test]
fn a_trunk_rests_at_a_place_under_voltages_that_are_found_with_the_motion() {
    let goal = r#"{"markers": {"tip": ["-60 mm", null, "40 mm"]}, "hold": "find"}"#;
    let (system, control) = trunk(goal);
    let result = in_memory(&system, &control);
    assert!(result.verdict.is_solved, "{:?}", result.verdict);
    let optimum = &result.optimum;
    let held = optimum.motion.hold.as_ref().unwrap();
    assert!(held.iter().any(|v| *v > 500.0), "{held:?}");
    assert!(
        held.iter().all(|v| (-1e-3..3000.001).contains(v)),
        "{held:?}"
    );
    // The state of rest under these voltages, found from the reference configuration.
    let model = &optimum.model;
    let zero = model.reference_coordinates();
    let rest = stable_equilibrium(model, &zero, &model.scalars(held)).unwrap();
    let tip = model.action.map.placed(&rest.z).x[model.markers[0]];
    assert!(
        (tip.x + 60.0).abs() < 1e-5 && (tip.z - 40.0).abs() < 1e-5,
        "{tip}"
    );
    let last = optimum.motion.z.last().unwrap();
    let apart = rest.z.iter().zip(last).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart < 1e-7, "{apart}");
    // It is kept, and what keeps it is named.
    let tested = optimum.resimulation.as_ref().unwrap();
    let drift = tested.drift.unwrap();
    assert!(drift.angle < 1e-5 && drift.length < 1e-3, "{drift}");
    let notes: Vec<String> = result.remarks.lines().collect();
    assert!(
        notes
            .iter()
            .any(|n| n.contains("held by inputs that were found with the motion: muscle")),
        "{notes:?}"
    );
    assert!(
        !notes.iter().any(|n| n.contains("nothing holds the goal")),
        "{notes:?}"
    );
    assert_eq!(
        optimum.boundary.goal.rest.as_ref().unwrap().is_stable(),
        Some(true)
    );
}

#[test]
fn a_joint_coordinate_is_held_too() {
    let (system, control) = trunk(r#"{"joint_angles": {"joint1": "6 deg"}, "hold": "find"}"#);
    let optimum = solved(&system, &control);
    assert_eq!(optimum.solution.status, Status::Solved);
    let held = optimum.motion.hold.as_ref().unwrap();
    assert!(held.iter().any(|v| *v > 100.0), "{held:?}");
    let joint = optimum.motion.joints[30][0];
    assert!((joint - 6_f64.to_radians()).abs() < 1e-7, "{joint}");
}

#[test]
fn a_program_finds_what_holds_its_goal() {
    let mut system = System::new("cart");
    let body = system.add(Body::sphere(10.0).mass(1000.0));
    let slide = system.add(Joint::prismatic(X).between(GROUND, body).spring(0.05, 0.0));
    let motor = system.add(Load::motor(slide));
    let optimum = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -100.0..=100.0)
        .effort(1.0)
        .start(State::Reference)
        .goal(State::Joints(vec![(slide, 1000.0)]))
        .find_hold()
        .solve(&system)
        .unwrap();
    assert!(optimum.is_solved(), "{}", optimum.status);
    let hold = optimum.solution.hold.as_ref().unwrap()[0];
    assert!((hold - 50.0).abs() < 1e-6, "{hold} N against the spring");
    let free = proboscis::Control::over(1000.0, 20)
        .load_within(motor, -100.0..=100.0)
        .effort(1.0)
        .start(State::Reference)
        .goal(State::Free)
        .find_hold()
        .solve(&system);
    assert!(free.unwrap_err().to_string().contains("goal.hold"));
}

#[test]
fn what_cannot_be_found_is_refused_with_its_place() {
    for (problem, goal, place, words) in [
        (
            "elephant_trunk",
            r#"{"rest_at_voltages": {}, "hold": "find"}"#,
            "control.goal.hold",
            "joint_angles",
        ),
        (
            "elephant_trunk",
            r#"{"markers": {"tip": [0, 0.3, 0]}, "hold": "seek"}"#,
            "control.goal.hold",
            "find",
        ),
        (
            "elephant_trunk",
            r#"{"joint_angles": {"joint1": 0.1}, "hold": {"muscle1": "1 kV"}}"#,
            "control.goal.hold",
            "markers",
        ),
    ] {
        assert_refused(problem, &format!("control.goal={goal}"), place, words);
    }
}

/// A goal without a hold is left under the last voltages: the program seeks what holds it, unless it is told not to.
#[test]
fn a_goal_that_is_left_is_held_by_inputs_that_are_found_afterwards() {
    let run = |hold: &str| {
        let goal = format!(r#"{{"markers": {{"tip": ["-60 mm", null, "40 mm"]}}{hold}}}"#);
        let (system, control) = trunk(&goal);
        let result = in_memory(&system, &control);
        assert!(result.verdict.is_solved, "{:?}", result.verdict);
        let notes: Vec<String> = result.remarks.lines().collect();
        (result, notes.join("\n"))
    };
    let (left, warned) = run(r#", "hold": "none""#);
    assert!(warned.contains("nothing holds the goal"), "{warned}");
    assert!(left.optimum.motion.hold.is_none());
    let (wanted, _) = run(r#", "hold": "find""#);
    let (found, noted) = run("");
    assert!(noted.contains("held by inputs that were found"), "{noted}");
    assert!(!noted.contains("nothing holds the goal"), "{noted}");
    assert!(found.iterations > left.iterations);
    let [a, b] = [&wanted, &found].map(|result| result.optimum.solution.objective);
    assert!((a - b).abs() < 1e-8 * a, "{a} {b}");
    assert!(left.optimum.solution.objective < a * (1.0 - 1e-6));
}

/// Both rods upright: no torque of the motor keeps them there.
#[test]
fn a_goal_that_nothing_can_hold_is_told() {
    let (system, mut control) = rods("reduced");
    control.goal = BoundaryState::JointAngles {
        angles: [(0, 0.5), (1, 0.5)].into(),
        rates: BTreeMap::new(),
        velocities: BTreeMap::new(),
    };
    control.sought_hold = SoughtHold::WhereLeft;
    let result = in_memory(&system, &control);
    assert!(result.verdict.is_solved, "{:?}", result.verdict);
    let notes: Vec<String> = result.remarks.lines().collect();
    let notes = notes.join("\n");
    assert!(notes.contains("nothing holds the goal"), "{notes}");
    assert!(
        notes.contains("no inputs within the bounds were found that hold the goal"),
        "{notes}"
    );
    assert!(result.optimum.motion.hold.is_none());
}

/// The pair held at −4°, behind circuits or at its sources: the voltage that holds it.
fn held_pair(circuit: &serde_json::Value, coordinates: &str) -> f64 {
    let mut problem = drivers::pair(circuit, serde_json::json!([]), coordinates);
    problem["control"]["duration"] = "0.5 s".into();
    problem["control"]["intervals"] = 60.into();
    problem["control"]["goal"] =
        serde_json::json!({ "joint_angles": { "joint1": "-4 deg" }, "hold": "find" });
    let ran = run("solve", &problem, &["--no-report"]);
    ran.is_solved();
    let text = std::fs::read_to_string(ran.folder.path().join("p/solution.json")).unwrap();
    let solution: serde_json::Value = serde_json::from_str(&text).unwrap();
    let hold = solution["hold"]["muscle1"].as_f64();
    hold.unwrap_or_else(|| panic!("{}", solution["hold"]))
}

#[test]
fn sources_behind_circuits_hold_a_goal_at_what_leak_and_resistor_leave() {
    let circuit = serde_json::json!({ "resistance": "5 MOhm", "leakage": "100 MOhm" });
    let plain = held_pair(&serde_json::Value::Null, "reduced");
    assert!(plain > 500.0, "{plain} V");
    for coordinates in ["reduced", "redundant"] {
        // The current through the leak goes through the resistor too.
        let behind = held_pair(&circuit, coordinates);
        let exact = plain * 105.0 / 100.0;
        println!("{behind} V behind {coordinates} circuits, {exact} V");
        assert!((behind - exact).abs() < 1e-5 * exact, "{behind} {exact}");
    }
}

#[test]
fn nothing_holds_a_stretch_that_relaxes() {
    let mut problem = drivers::pair(&serde_json::Value::Null, serde_json::json!([]), "reduced");
    problem["scene"]["materials"]["silicone"]["maxwell"] =
        serde_json::json!([{ "shear_modulus": "20 kPa", "relaxation_time": "1 s" }]);
    problem["control"]["goal"] =
        serde_json::json!({ "joint_angles": { "joint1": "-4 deg" }, "hold": "find" });
    run("solve", &problem, &[]).is_refused(&["goal.hold", "do not creep"]);
}
