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
fn a_plane_loop_moves_without_its_redundant_constraints() {
    let plane = four_bar(["revolute", "revolute"]);
    let balls = four_bar(["spherical", "spherical"]);
    let mut seen = Vec::new();
    // Three equations of four hinges with parallel axes follow from the others; the last hinge closes the loop.
    let tasks = [
        ("simulation", simulate("1 s", "5 ms", json!({})), 1e-9),
        ("optimal control between angles", turn_crank(), 1e-5),
    ];
    let mut turns = Vec::new();
    for (what, task, tolerance) in tasks {
        let [hinges, twin] = [&plane, &balls].map(|scene| run(scene, &task).solved());
        let [u, v] = [&hinges, &twin].map(|run| run.column("hinge1"));
        let apart = difference(&u, &v);
        assert!(largest(&u) > 0.04 && apart < tolerance, "{what}: {apart:e}");
        assert!(largest(&hinges.column("constraint_violation")) < 1e-6);
        seen.push(format!(
            "{what}: crank within {apart:.1e} rad of the loop with two ball joints"
        ));
        turns.push((hinges, twin));
    }
    // What rests stays at rest. The twin has no equilibrium: its coupler turns about itself.
    let pulled = json!({ "muscle1": "1 kV" });
    let rest = run(&plane, &equilibrium(pulled.clone())).solved();
    assert_eq!(rest.status(), "at_rest");
    let mut still = simulate("1 s", "5 ms", pulled.clone());
    still["simulate"]["start"] = json!({ "rest_at_voltages": pulled });
    let still = run(&plane, &still).solved().column("hinge1");
    let drift = still.iter().map(|angle| (angle - still[0]).abs());
    let drift = drift.fold(0.0, f64::max);
    assert!(still[0].abs() > 0.01 && drift < 1e-8, "{still:?}");
    seen.push(format!(
        "equilibrium: crank at {:.6} rad, where it stays within {drift:.1e} rad",
        still[0]
    ));
    let curve = |name: &str, run: &crate::program::Run, colour| {
        Series::curve(
            name,
            points(&run.column("time"), &run.column("hinge1")),
            hue(colour),
        )
    };
    let (hinges, twin) = &turns[0];
    Case {
        name: "redundant-loop",
        title: "A plane four-bar of four hinges",
        law: "Three of its constraints follow from the others along the motion and are left out. Simulation, equilibrium and optimal control give \
              the motion with two ball joints in place of hinges, which has no redundancy, and the constraints that are left out hold.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("crank [rad]", Extent::Padded),
        curves: vec![
            curve("four hinges", hinges, 0).marked(Mark::Disc),
            curve("two hinges, two balls", twin, 1).dashed(Dash::Dashed),
        ],
    }
    .record();
}

#[test]
fn a_joint_written_twice_counts_once() {
    let mut scene = four_bar(["revolute", "spherical"]);
    let joints = scene["joints"].as_array_mut().unwrap();
    joints.pop();
    let mut again = joints[0].clone();
    again["name"] = json!("again");
    joints.insert(1, again);
    let task = simulate("1 s", "5 ms", json!({}));
    let twice = run(&scene, &task).solved();
    scene["joints"].as_array_mut().unwrap().remove(1);
    let once = run(&scene, &task).solved();
    let [u, v] = [&twice, &once].map(|run| run.column("hinge1"));
    let apart = difference(&u, &v);
    assert!(largest(&u) > 0.1 && apart < 1e-4, "{apart:e}");
    let curve = |name: &str, run: &crate::program::Run, colour| {
        let time = run.column("time");
        Series::curve(name, points(&time, &run.column("hinge1")), hue(colour))
    };
    Case {
        name: "redundant-joint",
        title: "A joint that is written twice",
        law: "All five constraints of the second one follow from the first and are left out: the scene moves as with one of the two.",
        verdict: Verdict::Answer,
        seen: vec![format!("the motions differ by {apart:.1e} rad")],
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("crank [rad]", Extent::Padded),
        curves: vec![
            curve("written twice", &twice, 0).marked(Mark::Disc),
            curve("once", &once, 1).dashed(Dash::Dashed),
        ],
    }
    .record();
}
