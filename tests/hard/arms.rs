//! Arms: parallel and aligned axes, the end of the reach.

use crate::joints::found_times;
use crate::page::{Case, Verdict};
use crate::program::{Run, difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::Series;
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

/// An arm of segments along y with the given axes, four muscles about each joint.
fn arm(axes: &[[f64; 3]]) -> Value {
    let mut scene = json!({
        "name": "arm", "materials": { "silicone": silicone() }, "bodies": [], "joints": [], "muscles": [],
        "markers": [{ "name": "tip", "body": format!("segment{}", axes.len()), "at": [0, 0.05 * axes.len() as f64, 0] }],
    });
    let mut push = |list: &str, entry: Value| scene[list].as_array_mut().unwrap().push(entry);
    for (i, axis) in axes.iter().enumerate() {
        let child = format!("segment{}", i + 1);
        let parent = if i == 0 {
            "ground".to_owned()
        } else {
            format!("segment{i}")
        };
        let base = 0.05 * i as f64;
        push(
            "bodies",
            json!({
                "name": child, "mass": "30 g", "position": [0, base + 0.025, 0],
                "cylinder": { "length": "50 mm", "radius": "20 mm", "axis": [0, 1, 0] },
            }),
        );
        push(
            "joints",
            json!({
                "name": format!("joint{}", i + 1), "revolute": { "axis": axis },
                "parent": parent, "child": child, "at": [0, base, 0],
            }),
        );
        for (k, [x, z]) in [[0.015, 0.0], [-0.015, 0.0], [0.0, 0.015], [0.0, -0.015]]
            .iter()
            .enumerate()
        {
            push(
                "muscles",
                json!({
                    "name": format!("muscle{}", 4 * i + k + 1), "material": "silicone",
                    "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um",
                    "from": { "body": parent, "at": [x, base - 0.02, z] }, "to": { "body": child, "at": [x, base + 0.02, z] },
                }),
            );
        }
    }
    scene
}

fn tip(found: &Run) -> [Vec<f64>; 3] {
    ["tip_x", "tip_y", "tip_z"].map(|name| found.column(name))
}

#[test]
fn an_arm_with_parallel_axes() {
    let scene = arm(&[[0.0, 0.0, 1.0]; 3]);
    let to = |place: [f64; 3]| {
        run(
            &scene,
            &control("0.6 s", 20, json!({ "markers": { "tip": place } })),
        )
    };
    let within = to([-0.02, 0.147, 0.0]).solved();
    let [x, y, z] = tip(&within);
    assert!((x.last().unwrap() + 20.0).abs() < 1e-6 && (y.last().unwrap() - 147.0).abs() < 1e-6);
    assert!(largest(&z) < 1e-12);
    let outside = to([-0.02, 0.145, 0.01]);
    assert_eq!((outside.exit, outside.status()), (1, "infeasible"));
    assert!(
        outside
            .err
            .contains("goal z of marker tip: violated by 10.00 mm"),
        "{}",
        outside.err
    );
    let beyond = tip(&outside);
    Case {
        name: "singular-arm-parallel",
        title: "An arm whose axes are all parallel",
        law: "It moves in a plane. A goal in the plane is reached to 1e-6 mm; one 10 mm beside it is infeasible, and the row that misses \
              10 mm is named. The goal's Jacobian lacks a rank in both.",
        verdict: Verdict::Both,
        seen: vec![
            format!("in the plane: objective {:.6} kV² s", within.number(&["objective"])),
            format!("beside it: {}", outside.err.trim().replace('\n', "; ")),
        ],
        x: Axis::linear("tip x [mm]", Extent::Padded),
        y: Axis::linear("tip y [mm]", Extent::Padded),
        curves: vec![
            Series::curve("goal in the plane", points(&x, &y), hue(0)),
            Series::curve("goal beside it", points(&beyond[0], &beyond[1]), hue(1)).dashed(Dash::Dashed),
        ],
    }
    .record();
}

#[test]
fn an_arm_with_aligned_axes() {
    let scene = arm(&[[0.0, 1.0, 0.0]; 3]);
    // Twisted by a small angle its muscles hardly lengthen: to first order nothing holds it.
    let rest = run(&scene, &equilibrium(json!({ "muscle1": "1 kV" })));
    assert_eq!(rest.exit, 1);
    let words = rest.refusal();
    assert!(
        words.contains("coordinate of joint1 is not determined"),
        "{words}"
    );
    let planned = run(
        &scene,
        &control(
            "0.6 s",
            20,
            json!({ "joint_angles": { "joint1": "0.3 rad" } }),
        ),
    );
    assert_eq!(planned.exit, 2);
    assert!(
        planned
            .refusal()
            .contains("control.start: no unique equilibrium"),
        "{}",
        planned.err
    );
    // In motion inertia determines everything, and the tip stays on the axis.
    let task = simulate_from("0.5 s", "2 ms", json!({ "joint1": "0.5 rad" }), json!({}));
    let motion = run(&scene, &task).solved();
    let [x, y, z] = tip(&motion);
    let angle = motion.column("joint1");
    assert!(angle.last().unwrap() < &0.49);
    assert!(
        largest(&x) < 1e-12 && largest(&z) < 1e-12 && difference(&y, &vec![150.0; y.len()]) < 1e-12
    );
    let times = motion.column("time");
    let curve = |i: usize| {
        let name = format!("joint{i}");
        Series::curve(
            name.clone(),
            points(&times, &motion.column(&name)),
            hue(i - 1),
        )
    };
    Case {
        name: "singular-arm-aligned",
        title: "An arm whose axes are one line",
        law: "Muscles along the line resist a twist to second order only: an equilibrium is refused and names the first joint. In motion \
              inertia determines all angles, the twist comes back, and the tip stays in its place to rounding.",
        verdict: Verdict::Both,
        seen: vec![
            format!("equilibrium: {words}"),
            format!("optimal control: {}", planned.refusal()),
            format!("simulation: joint1 from 0.5 rad to {:.4} rad, the tip moves by less than 1e-12 mm", angle.last().unwrap()),
        ],
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint angle [rad]", Extent::Padded),
        curves: (1..=3).map(curve).collect(),
    }
    .record();
}

#[test]
fn an_arm_at_the_end_of_its_reach() {
    let scene = arm(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let to = |y: f64| {
        run(
            &scene,
            &control("0.6 s", 20, json!({ "markers": { "tip": [0, y, 0] } })),
        )
    };
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, y) in [0.1499, 0.15, 0.151, 0.16].into_iter().enumerate() {
        let found = to(y);
        let path = found.column("tip_y");
        if y <= 0.15 {
            let found = found.solved();
            assert!((path.last().unwrap() - 1e3 * y).abs() < 1e-5);
            seen.push(format!(
                "{} mm: reached, objective {:.3e} kV² s",
                1e3 * y,
                found.number(&["objective"])
            ));
        } else {
            assert_eq!((found.exit, found.status()), (1, "infeasible"));
            let missing = 1e3 * y - 150.0;
            let row = "goal y of marker tip: violated by ";
            let told = found
                .err
                .split(row)
                .nth(1)
                .and_then(|text| text.split(' ').next());
            let told: f64 = told.expect("the row is named").parse().unwrap();
            assert!((told - missing).abs() < 5e-5 * missing, "{}", found.err);
            seen.push(format!(
                "{} mm: {}",
                1e3 * y,
                found.err.trim().replace('\n', "; ")
            ));
        }
        let name = format!("goal at {} mm", 1e3 * y);
        curves.push(Series::curve(
            name,
            points(&found_times(path.len()), &path),
            hue(i),
        ));
    }
    Case {
        name: "singular-arm-straight",
        title: "An arm asked to the end of its reach and beyond",
        law: "Straight, no joint moves the tip of 150 mm along the arm: the Jacobian of the goal is singular at the solution. 149.9 mm and \
              150 mm are reached; beyond, the problem is infeasible and tells how many mm are missing.",
        verdict: Verdict::Both,
        seen,
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("tip y [mm]", Extent::Padded),
        curves,
    }
    .record();
}
