//! Joints: many revolutions, forty bodies, axes that are parallel, aligned, or at the end of their reach.

use crate::page::{Case, Verdict};
use crate::program::{difference, largest, points, run};
use crate::scenes::*;
use proboscis::report::axes::{Axis, Extent};
use proboscis::report::lines::{Mark, Series};
use proboscis::report::style::hue;
use serde_json::json;

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
    // The discrete momentum is J sin Δθ/h: every step turns by the same angle (docs/theory.md, 6.5).
    let turn = 0.5_f64.asin();
    let expected: Vec<f64> = (0..=steps).map(|k| f64::from(k) * turn).collect();
    let (mut curves, mut seen) = (Vec::new(), Vec::new());
    for (i, coordinates) in ["reduced", "redundant"].into_iter().enumerate() {
        let mut task = simulate_from("100 s", "5 ms", json!({}), json!({ "hinge": "100 rad/s" }));
        task["simulate"]["coordinates"] = json!(coordinates);
        task["output"] = json!({ "every": "5 ms" });
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

/// Times in ms of the instants of 0.6 s in 20 intervals.
pub(crate) fn found_times(count: usize) -> Vec<f64> {
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
            task["output"] = json!({ "every": format!("{step} ms") });
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
