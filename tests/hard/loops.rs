//! Closed loops and joints with more constraints than they need.

use crate::page::{Case, Verdict};
use crate::program::{difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

/// Crank, coupler and rocker in a plane, a muscle from the ground to the crank; `kinds` of the joints in the middle.
fn four_bar(kinds: [&str; 2]) -> Value {
    let corners = [[0.0, 0.0], [0.03, -0.08], [0.11, -0.10], [0.10, 0.0]];
    let place = |[x, y]: [f64; 2]| json!([x, y, 0]);
    let bar = |name: &str, a: [f64; 2], b: [f64; 2]| {
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        json!({
            "name": name, "mass": "100 g", "position": place([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]),
            "cylinder": { "length": x.hypot(y), "radius": "5 mm", "axis": [x, y, 0] },
        })
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str, at: [f64; 2]| {
        let mut joint = json!({ "name": name, "parent": parent, "child": child, "at": place(at) });
        joint[kind] = if kind == "revolute" {
            json!({ "axis": [0, 0, 1] })
        } else {
            json!({})
        };
        joint
    };
    let [o, a, b, c] = corners;
    json!({
        "name": "four-bar", "gravity": [0, -9.81, 0], "materials": { "silicone": silicone() },
        "bodies": [bar("crank", o, a), bar("coupler", a, b), bar("rocker", c, b)],
        "joints": [
            joint("hinge1", "revolute", "ground", "crank", o),
            joint("hinge2", kinds[0], "crank", "coupler", a),
            joint("hinge3", kinds[1], "coupler", "rocker", b),
            joint("hinge4", "revolute", "ground", "rocker", c),
        ],
        "muscles": [{
            "name": "muscle1", "material": "silicone", "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
            "from": { "body": "ground", "at": place(c) }, "to": { "body": "crank", "at": [0.015, -0.04, 0] },
        }],
    })
}

/// Turn of the crank from the reference to an angle.
fn turn_crank() -> Value {
    let mut task = control(
        "0.2 s",
        10,
        json!({ "joint_angles": { "hinge1": "0.05 rad" } }),
    );
    task["control"]["start"] = json!({ "joint_angles": {} });
    task
}

#[test]
fn a_plane_loop_names_its_redundant_constraints() {
    let plane = four_bar(["revolute", "revolute"]);
    // Three equations of four hinges with parallel axes follow from the others; the last hinge closes the loop.
    let named = "hinge4 axis 1, hinge4 axis 2, hinge4 point z follow from the others";
    let mut seen = Vec::new();
    let motion = run(&plane, &simulate("1 s", "5 ms", json!({})));
    assert_eq!((motion.exit, motion.status()), (1, "step_failed"));
    let rest = run(&plane, &equilibrium(json!({ "muscle1": "1 kV" })));
    assert_eq!(rest.exit, 1);
    let planned = run(
        &plane,
        &control(
            "0.2 s",
            10,
            json!({ "rest_at_voltages": { "muscle1": "1 kV" } }),
        ),
    );
    assert_eq!(planned.exit, 2);
    for (what, refused) in [
        ("simulation", motion),
        ("equilibrium", rest),
        ("rest as a start of optimal control", planned),
    ] {
        let words = refused.refusal();
        assert!(
            words.contains("constraints are redundant") && words.contains(named),
            "{words}"
        );
        seen.push(format!("{what}: {words}"));
    }
    // Between given angles Ipopt bears redundant equations: the optimum is that of the loop with two ball joints, which has none.
    let hinges = run(&plane, &turn_crank()).solved();
    let balls = four_bar(["spherical", "spherical"]);
    let other = run(&balls, &turn_crank()).solved();
    let [a, b] = [&hinges, &other].map(|run| run.number(&["objective"]));
    assert!(a > 0.01 && (a / b - 1.0).abs() < 1e-5, "{a} and {b}");
    let [u, v] = [&hinges, &other].map(|run| run.column("hinge1"));
    assert!(largest(&u) > 0.04 && difference(&u, &v) < 1e-5);
    seen.push(format!(
        "optimal control between angles: objective {a:.7} kV² s, {b:.7} kV² s with ball joints"
    ));
    // That loop moves, on its constraints.
    let swings = run(&balls, &simulate("1 s", "5 ms", json!({}))).solved();
    let angle = swings.column("hinge1");
    assert!(largest(&angle) > 0.1);
    assert!(largest(&swings.column("constraint_violation")) < 1e-11);
    let curve = |name: &str, run: &crate::program::Run, colour| {
        Series::curve(
            name,
            points(&run.column("time"), &run.column("hinge1")),
            hue(colour),
        )
    };
    Case {
        name: "redundant-loop",
        title: "A plane four-bar of four hinges",
        law: "Three of its constraints follow from the others. Simulation and equilibrium are refused and name the three. Optimal control between \
              given angles has the same optimum as with two ball joints in place of hinges, to 1e-5, which has no redundancy and \
              can be simulated.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("crank [rad]", Extent::Padded),
        curves: vec![
            curve("optimum, four hinges", &hinges, 0).marked(Mark::Disc),
            curve("optimum, two balls", &other, 1).dashed(Dash::Dashed),
        ],
    }
    .record();
}

#[test]
fn a_joint_written_twice_is_named() {
    let mut scene = four_bar(["revolute", "spherical"]);
    let joints = scene["joints"].as_array_mut().unwrap();
    joints.pop();
    let mut again = joints[0].clone();
    again["name"] = json!("again");
    joints.insert(1, again);
    let named = [
        "again axis 1",
        "again axis 2",
        "again point x",
        "again point y",
        "again point z",
    ]
    .join(", ");
    let motion = run(&scene, &simulate("1 s", "5 ms", json!({})));
    let rest = run(&scene, &equilibrium(json!({})));
    let planned = run(&scene, &turn_crank());
    let mut seen = Vec::new();
    for (what, refused) in [
        ("simulation", &motion),
        ("equilibrium", &rest),
        ("optimal control", &planned),
    ] {
        assert_eq!(refused.exit, 1, "{what}");
        let words = refused.refusal();
        assert!(words.contains(&named), "{what}: {words}");
        seen.push(format!("{what}: {words}"));
    }
    // Once, it moves.
    scene["joints"].as_array_mut().unwrap().remove(1);
    let once = run(&scene, &simulate("1 s", "5 ms", json!({}))).solved();
    let angle = once.column("hinge1");
    assert!(largest(&angle) > 0.1);
    Case {
        name: "redundant-joint",
        title: "A joint that is written twice",
        law: "All five constraints of the second one follow from the first. Simulation, equilibrium and optimal control are refused, and each \
              names the five; with one of the two the same scene moves.",
        verdict: Verdict::Refusal,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("crank [rad]", Extent::Padded),
        curves: Vec::new(),
    }
    .record();
}
