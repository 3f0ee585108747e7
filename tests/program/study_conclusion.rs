//! Conclusions of studies in words, of results that are made up.

use nalgebra::Vector3;
use proboscis::study::compare::judge;
use proboscis::study::conclusion::conclusion;
use proboscis::study::outcome::{Observed, RunOutcome};
use proboscis::study::read::{Study, read_study};
use proboscis::study::schedule::{Done, Results};
use serde_json::json;
use std::fs;
use tempfile::TempDir;

/// Steps of all points.
const STEPS: [&str; 4] = ["40 ms", "20 ms", "10 ms", "5 ms"];
/// Way of the marker in mm.
const WAY: f64 = 100.0;

/// A study of the step of a wheel, whose methods are so called; all are compared with the first.
fn study(methods: &[&str]) -> (TempDir, Study) {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, value: serde_json::Value| {
        fs::write(folder.path().join(name), value.to_string()).unwrap();
    };
    write(
        "wheel.json",
        json!({
            "name": "wheel",
            "bodies": [{
                "name": "wheel", "mass": "1 kg", "position": [0, 0, 0],
                "cylinder": { "length": "50 mm", "radius": "100 mm", "axis": [0, 0, 1] }
            }],
            "joints": [{
                "name": "hub", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "wheel", "at": [0, 0, 0]
            }],
            "markers": [{ "name": "rim", "body": "wheel", "at": ["100 mm", 0, 0] }]
        }),
    );
    write(
        "problem.json",
        json!({
            "scene": "wheel.json",
            "simulate": { "duration": "1 s", "step": "40 ms", "start": { "joint_angles": {} } }
        }),
    );
    let methods: Vec<_> = methods.iter().map(|name| json!({ "name": name })).collect();
    write(
        "study.json",
        json!({
            "title": "Made up", "problem": "problem.json", "methods": methods,
            "refine": { "name": "step", "set": { "simulate.step": STEPS } },
            "reference": { "method": methods[0]["name"] },
            "measures": ["end"]
        }),
    );
    let study = read_study(&folder.path().join("study.json")).unwrap();
    (folder, study)
}

/// Conclusion of a study whose points have these errors in mm and median times in ms.
fn said(study: &Study, points: &[[(f64, f64); 4]], change: impl Fn(&mut Results<'_>)) -> String {
    let done = |m: usize, k: usize| {
        let (error, milliseconds) = points[m][k];
        let seen = Observed {
            instants: vec![0.0, 1.0],
            places: vec![vec![Vector3::zeros()], vec![Vector3::new(WAY, error, 0.0)]],
            reference: vec![Vector3::zeros()],
            ..Observed::default()
        };
        Done {
            point: &study.methods[m].points[k],
            first: RunOutcome {
                status: "simulated",
                message: None,
                seconds: 1e-3 * milliseconds,
                is_solved: true,
            },
            seen: Some(seen),
            seconds: [0.98, 0.99, 1.0, 1.01, 1.02]
                .map(|x| 1e-3 * milliseconds * x)
                .into(),
        }
    };
    let mut results = Results {
        methods: (0..points.len())
            .map(|m| (0..STEPS.len()).map(|k| done(m, k)).collect())
            .collect(),
        reference: Vec::new(),
        is_interrupted: false,
    };
    change(&mut results);
    conclusion(study, &results, &judge(study, &results))
}

/// Errors C hᵖ from the first one on, at times that double.
fn falling(error: f64, order: i32, milliseconds: f64) -> [(f64, f64); 4] {
    [0, 1, 2, 3].map(|k| {
        let finer = 2.0_f64.powi(k);
        (error / finer.powi(order), milliseconds * finer)
    })
}

fn nothing(_: &mut Results<'_>) {}

#[test]
fn one_method_has_costs_and_an_order_without_its_name() {
    let (_folder, study) = study(&["midpoint"]);
    // 1 mm: between 1.6 mm in 10 ms and 0.4 mm in 20 ms, 10 ms · 2^(ln 1.6 / ln 4).
    assert_eq!(
        said(&study, &[falling(1.6, 2, 10.0)], nothing),
        "Error of the place at the end: 1.0 mm costs 13 ms; 10 µm is not reached: the least error is 25 µm. \
         Observed order: 2.00."
    );
}

#[test]
fn the_cheapest_method_is_named_with_its_factor_where_times_differ_clearly() {
    let (_folder, study) = study(&["quick", "slow", "as quick"]);
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 2, 35.0),
        falling(1.6, 2, 10.05),
    ];
    assert_eq!(
        said(&study, &points, nothing),
        "Error of the place at the end: 1.0 mm costs least by `quick` and `as quick`, 13 ms without a clear difference (`slow` takes \
         3.5 times as long); 10 µm is not reached by any method: the least error is 25 µm by `quick`. \
         Observed order: `quick`, `slow` and `as quick` 2.00."
    );
    // Clearly longer, by a factor too small to be told.
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 2, 11.5),
        falling(1.6, 2, 11.8),
    ];
    let words = said(&study, &points, nothing);
    assert!(
        words.contains("1.0 mm costs least by `quick`, `slow` and `as quick`, 13 ms to 15 ms without a clear difference;"),
        "{words}"
    );
    // Runs of very different lengths say nothing about which is quicker.
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 2, 15.0),
        falling(1.6, 2, 35.0),
    ];
    let scattered = |results: &mut Results<'_>| {
        for done in &mut results.methods[0] {
            let t = done.seconds[2];
            done.seconds = vec![0.5 * t, 0.7 * t, t, 1.8 * t, 2.0 * t];
        }
    };
    let words = said(&study, &points, scattered);
    assert!(
        words.contains("least by `quick` and `slow`, 13 ms to 19 ms without a clear difference (`as quick` takes 3.5 times"),
        "{words}"
    );
}

#[test]
fn an_accuracy_that_one_or_no_method_reaches_is_told() {
    let (_folder, study) = study(&["fine", "coarse"]);
    let points = [falling(1.6, 2, 10.0), falling(40.0, 1, 10.0)];
    let words = said(&study, &points, nothing);
    assert!(
        words.contains("only `fine` reaches 1.1 mm, in 12 ms; 11 µm is not reached by any"),
        "{words}"
    );
    let points = [falling(160.0, 2, 10.0), falling(400.0, 2, 10.0)];
    let words = said(&study, &points, nothing);
    let start = "Error of the place at the end: ";
    // The markers get 256 mm and more from their start where errors are so large.
    assert!(
        words.starts_with(start)
            && words
                .contains(" is not reached by any method: the least error is 2.5 mm by `fine`."),
        "{words}"
    );
    assert!(!words.contains("cost"), "{words}");
}

#[test]
fn errors_that_rise_are_said_to_rise() {
    let (_folder, study) = study(&["clean", "levels off"]);
    let points = [
        falling(1.6, 2, 10.0),
        [(8.0, 10.0), (2.0, 20.0), (1.5, 40.0), (1.8, 80.0)],
    ];
    let words = said(&study, &points, nothing);
    assert!(
        words.ends_with(
            "Observed order: `clean` 2.00; errors of `levels off` do not fall throughout: from 10 ms to 5 ms they rise from 1.5 mm to 1.8 mm."
        ),
        "{words}"
    );
    // Falling, but by no power of the step.
    let points = [
        falling(1.6, 2, 10.0),
        [(8.0, 10.0), (1.0, 20.0), (0.5, 40.0), (0.48, 80.0)],
    ];
    let words = said(&study, &points, nothing);
    assert!(
        words.ends_with(
            "errors of `levels off` (3.0, 1.0, 0.1) show no single order from point to point."
        ),
        "{words}"
    );
    // A reference without an order is the finest value itself.
    let points = [
        [(8.0, 10.0), (2.0, 20.0), (1.5, 40.0), (1.8, 80.0)],
        falling(1.6, 2, 10.0),
    ];
    let words = said(&study, &points, nothing);
    assert!(
        words.contains(
            "Errors are distances from the finest value of `clean`, as no order is observed, and its own error is estimated from the last differences by the order 0.5."
        ),
        "{words}"
    );
}

#[test]
fn an_order_far_from_that_of_the_method_is_told_beside_it() {
    let (_folder, study) = study(&["midpoint", "spoilt", "nearly"]);
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 1, 10.0),
        [(1.6, 10.0), (0.5, 20.0), (0.15, 40.0), (0.045, 80.0)],
    ];
    let words = said(&study, &points, nothing);
    assert!(
        words.ends_with(
            "Observed order: `midpoint` 2.00, `spoilt` 1.00 (where 2 is expected), `nearly` 1.72."
        ),
        "{words}"
    );
}

#[test]
fn points_that_fail_and_steps_that_are_halved_are_told() {
    let (_folder, study) = study(&["midpoint", "other"]);
    let fail = |results: &mut Results<'_>, m: usize, k: usize| {
        let done = &mut results.methods[m][k];
        done.first.status = "step_failed";
        done.first.is_solved = false;
        done.seen = None;
        done.seconds.clear();
    };
    let mut points = [falling(1.6, 2, 10.0), falling(1.6, 2, 35.0)];
    let words = said(&study, &points, |results| fail(results, 1, 0));
    assert!(
        words.ends_with(
            "`other` 2.00. 1 of 8 points have no answer: `other`, step 40 ms (step failed)."
        ),
        "{words}"
    );
    let words = said(&study, &points, |results| {
        (0..2).for_each(|m| (0..4).for_each(|k| fail(results, m, k)));
        results.is_interrupted = true;
    });
    assert_eq!(
        words,
        "No point has an answer: `midpoint`, step 40 ms (step failed); `midpoint`, step 20 ms (step failed); `midpoint`, step \
         10 ms (step failed); 5 more. It was interrupted: these are the results up to then."
    );
    // A step that was halved is no step of its size: an error that does not fit leaves the order as it is.
    points[0][1].0 = 0.6;
    let spoilt = said(&study, &points, nothing);
    assert!(!spoilt.contains("`midpoint` and `other` 2.00"), "{spoilt}");
    let words = said(&study, &points, |results| {
        results.methods[0][1].seen.as_mut().unwrap().halved = 3;
    });
    assert!(
        words.contains("`midpoint` and `other` 2.00") && !words.contains("rise"),
        "{words}"
    );
    assert!(
        words.ends_with(
            "Steps were halved, so that neither limits nor orders count the point: `midpoint`, step 20 ms (3 steps)."
        ),
        "{words}"
    );
}
