//! Feedback from measurements that do not tell the state: the filter of the file against a naive recursion, and a loop that closes over it.

use crate::commands::summary;
use crate::feedback::solved;
use crate::runs::{read, refused, run, workshop};
use nalgebra::DMatrix;
use serde_json::Value;
use std::fs;

const OBSERVER: &str = "feedback.observer={\"markers\":{\"tip\":\"0.1 mm\"}}";
const LASTING: &str = "feedback.observer={\"markers\":{\"tip\":\"0.1 mm\"},\"lasting\":0.02}";
const NO_INTEGRAL: &str = "feedback.weights.integral=0";

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).unwrap();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

/// One step of `P₊ = A P Aᵀ + W − A P Cᵀ (C P Cᵀ + R)⁻¹ C P Aᵀ`, and `M = P Cᵀ (C P Cᵀ + R)⁻¹`, with the drift of a lasting torque in N m.
fn naive(filter: &Value, p: &DMatrix<f64>, drift: Option<f64>) -> [DMatrix<f64>; 2] {
    let [a, b, c] = ["by_state", "by_inputs", "output"].map(|key| matrix(&filter[key]));
    // 0.05 of the range of a square of 3 kV, 0.1 of 100 degrees/s, 0.1 mm.
    let mut w = &b * b.transpose() * (0.05_f64 * 9e6).powi(2);
    w[(1, 1)] += 10.0_f64.to_radians().powi(2);
    if let Some(drift) = drift {
        w[(2, 2)] += drift * drift;
        assert!((a[(2, 2)] - 1.0).abs() < 1e-12 && a[(2, 0)] == 0.0 && a[(1, 2)] > 0.0);
    }
    let r = DMatrix::identity(3, 3) * 1e-4_f64.powi(2);
    let toward = p * c.transpose();
    let m = &toward * (&c * &toward + r).try_inverse().unwrap();
    let next = &a * (p - &m * toward.transpose()) * a.transpose() + w;
    [m, next]
}

fn is_near(found: &Value, expected: &DMatrix<f64>) {
    let found = matrix(found);
    let size = expected.amax();
    assert!(size > 1.0);
    let off = (found - expected).amax();
    assert!(off < 1e-6 * size, "{off} of {size}");
}

#[test]
fn the_filter_is_that_of_a_naive_recursion_and_closes_the_loop() {
    let folder = workshop();
    let here = folder.path();
    let solve = [
        "solve",
        "problems/pair_feedback.json",
        "-o",
        "pair",
        "--no-report",
    ];
    let (status, out, err) = run(here, &[&solve[..], &["--set", OBSERVER]].concat());
    assert_eq!(status, 0, "{out}{err}");
    assert!(here.join("pair/feedback.c").exists());
    let radius = summary(here, "pair")["feedback"]["observer_radius"]
        .as_f64()
        .unwrap();
    assert!(0.1 < radius && radius < 0.9, "{radius}");
    let file = read(here.join("pair/feedback.json"));
    let observer = &file["observer"];
    assert_eq!(
        observer["readings"][1],
        serde_json::json!({ "marker": ["tip", 1] })
    );
    let steps = observer["intervals"].as_array().unwrap();
    assert_eq!(steps.len(), 20);
    let mut p = DMatrix::identity(2, 2);
    let settle = |filter: &Value, p: &mut DMatrix<f64>| {
        (0..400).for_each(|_| *p = naive(filter, p, None)[1].clone());
    };
    settle(&steps[0], &mut p);
    for step in steps {
        let [m, next] = naive(step, &p, None);
        is_near(&step["gain"], &m);
        p = next;
    }
    let held = &observer["held"];
    settle(held, &mut p);
    is_near(&held["gain"], &naive(held, &p, None)[0]);

    let simulate = |name: &str, noise: &str| {
        let controller =
            format!("simulate.controller={{\"feedback\":\"../pair\",\"noise\":{noise}}}");
        let stiffer = "scene.materials.silicone.shear_modulus=\"110 kPa\"";
        let (status, out, err) = run(
            here,
            &[
                "simulate",
                "problems/pair_closed_loop.json",
                "-o",
                name,
                "--set",
                &controller,
                "--set",
                stiffer,
            ],
        );
        assert_eq!(status, 0, "{out}{err}");
        summary(here, name)["closed_loop"]["markers"]["tip"].clone()
    };
    let last = |tip: &Value, of: &str| tip[of]["last"].as_f64().unwrap();
    let quiet = simulate("quiet", "{}");
    assert!(last(&quiet, "open_loop") > 5e-4, "{quiet}");
    assert!(
        last(&quiet, "feedback") < 0.2 * last(&quiet, "open_loop"),
        "{quiet}"
    );
    let [noisy, again, other] = ["1", "1", "2"].map(|seed| {
        simulate(
            "noisy",
            &format!("{{\"length\":\"0.1 mm\",\"seed\":{seed}}}"),
        )
    });
    assert_eq!(noisy, again);
    assert!(noisy != other && noisy != quiet);
    assert!(
        last(&noisy, "feedback") < 0.4 * last(&noisy, "open_loop"),
        "{noisy}"
    );
}

/// Entries of a list of matrices as of a naive recursion, in which the torque drifts by 0.02 of the greatest that a muscle makes; the loop then ends at
/// the goal, also under a load that the model does not know.
#[test]
fn lasting_forces_are_found_and_held_against() {
    let folder = workshop();
    let here = folder.path();
    solved(
        here,
        "problems/pair_feedback.json",
        "pair",
        &[LASTING, NO_INTEGRAL],
    );
    let observer = &read(here.join("pair/feedback.json"))["observer"];
    assert_eq!(
        observer["lasting"]["forces"][0],
        serde_json::json!({ "on": "coordinate of joint1", "unit": "N m" })
    );
    let torques = matrix(&observer["lasting"]["by_inputs"]);
    assert!(torques[(0, 0)] * torques[(0, 1)] < 0.0, "{torques}");
    let drift = Some(0.02 * 9e6 * torques.amax());
    let steps = observer["intervals"].as_array().unwrap();
    let mut p = DMatrix::identity(3, 3) * 1e-4;
    (0..3000).for_each(|_| p = naive(&steps[0], &p, drift)[1].clone());
    for step in steps {
        let [m, next] = naive(step, &p, drift);
        is_near(&step["gain"], &m);
        p = next;
    }
    for change in [
        "scene.materials.silicone.shear_modulus=\"110 kPa\"",
        "scene.gravity=[2.0,0,0]",
    ] {
        let controller = "simulate.controller={\"feedback\":\"../pair\"}";
        let arguments = [
            "simulate",
            "problems/pair_closed_loop.json",
            "-o",
            "loaded",
            "--set",
            controller,
            "--set",
            change,
        ];
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        let tip = &summary(here, "loaded")["closed_loop"]["markers"]["tip"];
        let last = |of: &str| tip[of]["last"].as_f64().unwrap();
        assert!(last("open_loop") > 2e-4 && last("feedback") < 1e-7, "{tip}");
    }
}

/// A marker on the axis of the joint does not move with it.
#[test]
fn an_observer_that_sees_nothing_has_no_gains() {
    let folder = workshop();
    let here = folder.path();
    let marker = "scene.markers=[{\"name\":\"axis\",\"body\":\"segment1\",\"at\":[0,0,0]}]";
    let observer = "feedback={\"observer\":{\"markers\":{\"axis\":\"0.1 mm\"}}}";
    let arguments = [
        "solve",
        "problems/pair_feedback.json",
        "-o",
        "blind",
        "--no-report",
        "--set",
        marker,
        "--set",
        observer,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        err.contains("no observer: the state is not observable"),
        "{err}"
    );
    assert!(!here.join("blind/feedback.json").exists());
}

/// The corrections that act over the delay have the numbers of their intervals from 0 on, as in messages and names of unknowns.
#[test]
fn columns_of_corrections_count_intervals_from_0() {
    let folder = workshop();
    let here = folder.path();
    let delay = "feedback.delay=\"20 ms\"";
    let arguments = [
        "solve",
        "problems/pair_feedback.json",
        "-o",
        "late",
        "--no-report",
        "--set",
        delay,
    ];
    let (status, out, err) = run(here, &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let table = fs::read_to_string(here.join("late/feedback.csv")).unwrap();
    let titles = table.lines().find(|line| !line.starts_with('#')).unwrap();
    let has = |k: usize| {
        let name = format!("by correction of muscle1^2 in interval {k} ");
        titles.contains(&name)
    };
    assert_eq!([0, 1, 2].map(has), [true, true, false], "{titles}");
}

/// Readings so exact that rounding hides what they tell have another reason than readings that tell nothing.
#[test]
fn an_observer_of_too_exact_readings_tells_that_rounding_hides_the_state() {
    let folder = workshop();
    let here = folder.path();
    let solved = |deviation: &str| {
        let observer =
            format!("feedback={{\"observer\":{{\"markers\":{{\"tip\":\"{deviation}\"}}}}}}");
        let arguments = [
            "solve",
            "problems/pair_feedback.json",
            "-o",
            "exact",
            "--no-report",
            "--set",
            &observer,
        ];
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        err
    };
    let err = solved("1e-6 um");
    assert!(err.contains("no observer: rounding hides"), "{err}");
    assert!(!err.contains("the state is not observable"), "{err}");
    let err = solved("1 um");
    assert!(err.contains("the observer finds the state"), "{err}");
}

#[test]
fn wrong_observers_are_refused() {
    let folder = workshop();
    let here = folder.path();
    for (observer, told) in [
        ("{}", &["feedback.observer", "joints"][..]),
        (
            "{\"markers\":{\"top\":\"1 mm\"}}",
            &["markers.top", "marker"],
        ),
        ("{\"markers\":{\"tip\":\"0 mm\"}}", &["markers.tip"]),
        (
            "{\"joints\":{\"joint1\":\"-1 deg\"}}",
            &["joints.joint1", "positive"],
        ),
        ("{\"joints\":{\"joint1\":\"1 mm\"}}", &["joints.joint1"]),
        (
            "{\"joints\":{\"joint1\":\"1 deg\"},\"rates\":-1}",
            &["observer.rates"],
        ),
        (
            "{\"joints\":{\"joint1\":\"1 deg\"},\"lasting\":0}",
            &["observer.lasting", "positive"],
        ),
        (
            "{\"joints\":{\"joint1\":\"1 deg\"},\"lasting\":0.1}",
            &["weights.integral", "constant disturbances"],
        ),
    ] {
        let set = format!("feedback.observer={observer}");
        refused(
            here,
            &["solve", "problems/pair_feedback.json", "--set", &set],
            told,
        );
    }
    solved(here, "problems/pair_feedback.json", "pair", &[OBSERVER]);
    let text = fs::read_to_string(here.join("pair/feedback.json")).unwrap();
    let simulate = |controller: &str, told: &[&str]| {
        let set = format!("simulate.controller={controller}");
        refused(
            here,
            &["simulate", "problems/pair_closed_loop.json", "--set", &set],
            told,
        );
    };
    simulate(
        "{\"feedback\":\"../pair\",\"sample\":\"5 ms\"}",
        &["controller.sample", "10 ms", "observer"],
    );
    for (from, to, told) in [
        (
            "[\"tip\", 1]",
            "[\"tip\", 3]",
            &["readings", "0, 1 or 2"][..],
        ),
        (
            "[\"tip\", 1]",
            "[\"top\", 1]",
            &["top", "this robot does not have"],
        ),
        (
            "\"by_inputs\": [",
            "\"by_inputs\": [[0.0], ",
            &["by_inputs", "rows"],
        ),
    ] {
        assert!(text.contains(from), "{from}");
        fs::write(here.join("wrong.json"), text.replacen(from, to, 1)).unwrap();
        simulate("{\"feedback\":\"../wrong.json\"}", told);
    }
}
