//! Joints: many revolutions, forty bodies, axes that are parallel, aligned, or at the end of their reach.

use crate::page::{Case, Verdict};
use crate::program::{Run, difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::{Dash, hue};
use serde_json::{Value, json};

#[test]
fn a_joint_turns_many_times() {
    let wheel = json!({
        "name": "wheel",
        "bodies": [{
            "name": "rod", "mass": "1 kg", "position": ["50 mm", 0, 0],
            "cylinder": { "length": "100 mm", "radius": "5 mm", "axis": [1, 0, 0] },
        }],
        "joints": [{ "name": "hinge", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "rod", "at": [0, 0, 0] }],
    });
    let steps = 20_000;
    // The discrete momentum is J sin Δθ/h: every step turns by the same angle (physics.md, 6.1).
    let turn = 0.5_f64.asin();
    let expected: Vec<f64> = (0..=steps).map(|k| f64::from(k) * turn).collect();
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, coordinates) in ["reduced", "redundant"].into_iter().enumerate() {
        let mut task = simulate_from("100 s", "5 ms", json!({}), json!({ "hinge": "100 rad/s" }));
        task["simulate"]["coordinates"] = json!(coordinates);
        let motion = run(&wheel, &task).solved();
        let found = motion.column("hinge");
        let error = difference(&found, &expected);
        assert!(found.last().unwrap() / std::f64::consts::TAU > 1600.0);
        assert!(error < 1e-7, "{coordinates}: {error:e}");
        seen.push(format!(
            "{coordinates}: {:.1} revolutions, largest error {error:.1e} rad",
            found.last().unwrap() / std::f64::consts::TAU
        ));
        let errors = found
            .iter()
            .zip(&expected)
            .map(|(a, b)| (a - b).abs() + 1e-16);
        let list: Vec<[f64; 2]> = motion
            .column("time")
            .iter()
            .zip(errors)
            .map(|(t, e)| [t * 1e-3, e])
            .step_by(50)
            .collect();
        curves.push(Series::curve(coordinates, list, hue(i)));
    }
    Case {
        name: "revolutions",
        title: "A joint that turns 1600 times",
        law: "A free rotor turns by arcsin(h ω) in each step, for ever: the angle is neither wrapped nor lost, and after 20 000 steps right \
              to 1e-7 rad in both kinds of coordinates.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("time [s]", Extent::Tight),
        y: Axis::log("error of the angle [rad]"),
        curves,
    }
    .record();
}

#[test]
fn a_chain_of_forty_bodies() {
    let mut scene = trunk(40, silicone());
    scene["gravity"] = json!([0.3, -9.81, 0.2]);
    let motion = |coordinates: &str| {
        let voltages = json!({ "muscle2": "1 kV", "muscle41": "2 kV" });
        let mut task = simulate("0.2 s", "5 ms", voltages);
        task["simulate"]["coordinates"] = json!(coordinates);
        let motion = run(&scene, &task).solved();
        assert_eq!(motion.number(&["halved_steps"]), 0.0);
        motion
    };
    let (reduced, redundant) = (motion("reduced"), motion("redundant"));
    let mut worst: f64 = 0.0;
    let mut angle: f64 = 0.0;
    for joint in 1..=40 {
        let name = format!("joint{joint}");
        let [a, b] = [&reduced, &redundant].map(|run| run.column(&name));
        worst = worst.max(difference(&a, &b));
        angle = angle.max(largest(&a));
    }
    assert!(angle > 0.1 && worst < 1e-9, "{worst:e} of {angle}");
    let violation = largest(&redundant.column("constraint_violation"));
    assert!(violation < 1e-10, "{violation:e}");
    // Hung up, it rests under a voltage and is stable; muscles of both sides of one joint pull at one joint alone.
    let mut hung = trunk(40, silicone());
    hung["chain"]["axis"] = json!([0, -1, 0]);
    hung["gravity"] = json!([0, -9.81, 0]);
    let rest = run(&hung, &equilibrium(json!({ "muscle2": "1 kV" }))).solved();
    assert_eq!(rest.summary["is_stable"], true);
    let first = rest.summary["joints"]["joint1"].as_f64().unwrap();
    assert!(first > 1e-3);
    let times = reduced.column("time");
    let curve = |joint: usize| {
        let name = format!("joint{joint}");
        Series::curve(
            name.clone(),
            points(&times, &reduced.column(&name)),
            hue(joint / 8),
        )
    };
    Case {
        name: "forty-bodies",
        title: "A chain of forty bodies with eighty muscles",
        law: "40 joint angles and 480 directors with 440 multipliers give the same motion to 1e-9 rad; constraints stay at rounding. Hung up, \
              it has a stable equilibrium.",
        verdict: Verdict::Answer,
        seen: vec![
            format!("largest angle {angle:.3} rad, largest difference of both coordinates {worst:.1e} rad"),
            format!("largest constraint violation {violation:.1e} mm, over 2000 mm"),
        ],
        x: Axis::linear("time [ms]", Extent::Tight),
        y: Axis::linear("joint angle [rad]", Extent::Padded),
        curves: [1, 9, 17, 25, 33].into_iter().map(curve).collect(),
    }
    .record();
}

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

/// Times in ms of the instants of 0.6 s in 20 intervals.
fn found_times(count: usize) -> Vec<f64> {
    (0..count).map(|k| 30.0 * k as f64).collect()
}

/// The pendulum IFToMM A01, 1 m long and let go level, as an exact solution has it: time in s, place of the mass in m.
const BY_OTHERS: [[f64; 3]; 3] = [
    [1.0, 0.986_291_751_1, -0.165_010_853_1],
    [5.0, -0.942_305_435_0, -0.334_754_338_4],
    [10.0, -0.275_087_462_6, -0.961_419_205_1],
];

#[test]
fn a_pendulum_goes_where_the_benchmark_of_others_says() {
    // A point mass has no moments of inertia: so small a sphere has a billionth of m L².
    let scene = json!({
        "name": "pendulum", "gravity": [0, -9.81, 0],
        "bodies": [{ "name": "mass", "mass": "1 kg", "position": [-1, 0, 0], "sphere": { "radius": "50 um" } }],
        "joints": [{ "name": "hinge", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "mass", "at": [0, 0, 0] }],
        "markers": [{ "name": "end", "body": "mass", "at": [-1, 0, 0] }],
    });
    let mut seen = Vec::new();
    let mut curves = Vec::new();
    for (i, (name, integrator, steps)) in [
        ("midpoint", json!("midpoint"), [2.5, 1.25]),
        ("Galerkin, degree 2", json!({ "galerkin": 2 }), [20.0, 10.0]),
        (
            "Galerkin, degree 3",
            json!({ "galerkin": 3 }),
            [200.0, 100.0],
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let errors = steps.map(|step: f64| {
            let mut task = simulate("10 s", &format!("{step} ms"), json!({}));
            task["simulate"]["integrator"] = integrator.clone();
            let found = run(&scene, &task).solved();
            let [x, y] = ["end_x", "end_y"].map(|name| found.column(name));
            let apart = |&[time, a, b]: &[f64; 3]| {
                let k = (1e3 * time / step).round() as usize;
                (x[k] / 1e3 - a).hypot(y[k] / 1e3 - b)
            };
            if step == steps[1] && i == 0 {
                let path = x.iter().zip(&y).take(1900).map(|(x, y)| [x / 1e3, y / 1e3]);
                curves.push(Series::curve("midpoint", path.collect(), hue(0)));
            }
            BY_OTHERS.iter().map(apart).fold(0.0, f64::max)
        });
        let order = (errors[0] / errors[1]).log2();
        seen.push(format!(
            "{name}, steps of {} and {} ms: {:.1e} and {:.1e} m beside, order {order:.2}",
            steps[0], steps[1], errors[0], errors[1]
        ));
        let expected = [2.0, 4.0, 6.0][i];
        assert!(
            (order - expected).abs() < 0.4,
            "{name}: {errors:?}, {order}"
        );
        assert!(errors[1] < 1e-2, "{name}: {errors:?}");
    }
    let marks = BY_OTHERS.iter().map(|row| [row[1], row[2]]).collect();
    curves.push(
        Series::curve("exact at 1, 5 and 10 s", marks, hue(1))
            .marked(Mark::Disc)
            .unjoined(),
    );
    Case {
        name: "pendulum-by-others",
        title: "The pendulum of the IFToMM benchmark",
        law: "A01: 1 kg on 1 m, let go level. Three instants of ten seconds are met, with errors that fall with the order of the method.",
        verdict: Verdict::Answer,
        seen,
        x: Axis::linear("x [m]", Extent::Padded),
        y: Axis::linear("y [m]", Extent::Padded),
        curves,
    }
    .record();
}
