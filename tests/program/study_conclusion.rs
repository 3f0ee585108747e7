//! Conclusions and costs of studies, of results that are made up.

use nalgebra::Vector3;
use proboscis::study::compare::judge;
use proboscis::study::costs::{conclusion, cost_table};
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

/// Conclusion and costs of a study whose points have these errors in mm and median times in ms.
fn said(study: &Study, points: &[[(f64, f64); 4]], change: impl Fn(&mut Results<'_>)) -> Said {
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
        study,
        methods: (0..points.len())
            .map(|m| (0..STEPS.len()).map(|k| done(m, k)).collect())
            .collect(),
        reference: Vec::new(),
        is_interrupted: false,
    };
    change(&mut results);
    let judged = judge(&results);
    let table = cost_table(&results, &judged);
    let cells = |line: &str| -> Vec<String> {
        let cells = line.split("  ").map(str::trim);
        cells
            .filter(|cell| !cell.is_empty())
            .map(str::to_owned)
            .collect()
    };
    Said {
        conclusion: conclusion(&results, &judged),
        rows: table.lines().map(cells).collect(),
    }
}

/// The sentence and the cells of the table.
struct Said {
    conclusion: String,
    rows: Vec<Vec<String>>,
}

impl Said {
    /// The cells of one column by method.
    fn column(&self, name: &str) -> Vec<&str> {
        let at = self.rows[0].iter().position(|cell| cell == name).unwrap();
        self.rows[1..].iter().map(|row| &*row[at]).collect()
    }
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
fn the_table_has_order_costs_least_error_and_status() {
    let (_folder, study) = study(&["midpoint"]);
    // 1 mm: between 1.6 mm in 10 ms and 0.4 mm in 20 ms, 10 ms · 2^(ln 1.6 / ln 4).
    let said = said(&study, &[falling(1.6, 2, 10.0)], nothing);
    assert_eq!(
        said.conclusion,
        "4 of 4 points have an answer; error of the place at the end: 1.0 mm costs least by `midpoint`, 0.013 s."
    );
    let row = [
        "end", "midpoint", "2.00", "0.0126", "–", "–", "25 µm", "resolved",
    ];
    assert_eq!(said.rows[1], row);
    assert_eq!(said.rows.len(), 2);
}

#[test]
fn the_cheapest_method_has_a_star_and_so_have_those_that_do_not_differ_clearly() {
    let (_folder, study) = study(&["quick", "slow", "as quick"]);
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 2, 35.0),
        falling(1.6, 2, 10.05),
    ];
    let of = said(&study, &points, nothing);
    assert_eq!(
        of.column("cost at 1e-2 [s]"),
        ["0.0126*", "0.0443", "0.0127*"]
    );
    assert_eq!(of.column("cost at 1e-4 [s]"), ["–"; 3]);
    assert!(
        of.conclusion
            .ends_with(": 1.0 mm costs least by `quick` and `as quick`, 0.013 s."),
        "{}",
        of.conclusion
    );
    let starred = |of: &Said| {
        let costs = of.column("cost at 1e-2 [s]");
        costs
            .iter()
            .map(|cost| cost.ends_with('*'))
            .collect::<Vec<_>>()
    };
    // Clearly longer, by a factor too small to be told.
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 2, 11.5),
        falling(1.6, 2, 11.8),
    ];
    assert_eq!(starred(&said(&study, &points, nothing)), [true; 3]);
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
    let of = said(&study, &points, scattered);
    assert_eq!(starred(&of), [true, true, false]);
}

#[test]
fn an_accuracy_that_one_or_no_method_reaches_is_told() {
    let (_folder, study) = study(&["fine", "coarse"]);
    let points = [falling(1.6, 2, 10.0), falling(40.0, 1, 10.0)];
    let of = said(&study, &points, nothing);
    assert!(
        of.conclusion
            .ends_with(": 1.1 mm costs least by `fine`, 0.012 s."),
        "{}",
        of.conclusion
    );
    assert_eq!(of.column("cost at 1e-2 [s]"), ["0.0122*", "–"]);
    // The markers get 1.7 m from their start where errors are so large.
    let points = [falling(1600.0, 2, 10.0), falling(1700.0, 2, 10.0)];
    let of = said(&study, &points, nothing);
    assert!(
        of.conclusion
            .ends_with(": 17 mm is not reached, the least error is 25 mm by `fine`."),
        "{}",
        of.conclusion
    );
    assert_eq!(of.column("cost at 1e-2 [s]"), ["–"; 2]);
    assert_eq!(of.column("least error"), ["25 mm", "27 mm"]);
}

#[test]
fn errors_that_rise_and_limits_without_an_order_are_told() {
    let (_folder, study) = study(&["clean", "levels off"]);
    let points = [
        falling(1.6, 2, 10.0),
        [(8.0, 10.0), (2.0, 20.0), (1.5, 40.0), (1.8, 80.0)],
    ];
    let of = said(&study, &points, nothing);
    assert_eq!(of.column("order"), ["2.00", "–"]);
    assert_eq!(of.column("status"), ["resolved", "errors rise, no order"]);
    // Falling, but by no power of the step.
    let points = [
        falling(1.6, 2, 10.0),
        [(8.0, 10.0), (1.0, 20.0), (0.5, 40.0), (0.48, 80.0)],
    ];
    let of = said(&study, &points, nothing);
    assert_eq!(of.column("status"), ["resolved", "no order"]);
    // A reference without an order is the finest value itself.
    let points = [
        [(8.0, 10.0), (2.0, 20.0), (1.5, 40.0), (1.8, 80.0)],
        falling(1.6, 2, 10.0),
    ];
    let of = said(&study, &points, nothing);
    let told = of.column("status");
    assert!(
        told.iter()
            .all(|status| status.ends_with("limit not extrapolated")),
        "{told:?}"
    );
}

#[test]
fn each_method_has_the_order_that_its_errors_show() {
    let (_folder, study) = study(&["midpoint", "spoilt", "nearly"]);
    let points = [
        falling(1.6, 2, 10.0),
        falling(1.6, 1, 10.0),
        [(1.6, 10.0), (0.5, 20.0), (0.15, 40.0), (0.045, 80.0)],
    ];
    let of = said(&study, &points, nothing);
    assert_eq!(of.column("order"), ["2.00", "1.00", "1.72"]);
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
    let of = said(&study, &points, |results| fail(results, 1, 0));
    assert!(
        of.conclusion.starts_with("7 of 8 points have an answer; "),
        "{}",
        of.conclusion
    );
    assert_eq!(of.column("order"), ["2.00"; 2]);
    assert_eq!(
        of.column("status"),
        ["resolved", "1 of 4 without an answer"]
    );
    let of = said(&study, &points, |results| {
        (0..2).for_each(|m| (0..4).for_each(|k| fail(results, m, k)));
        results.is_interrupted = true;
    });
    assert_eq!(
        of.conclusion,
        "0 of 8 points have an answer (interrupted); error of the place at the end: no error is known."
    );
    assert_eq!(
        of.column("status"),
        ["4 of 4 without an answer, no order"; 2]
    );
    // A step that was halved is no step of its size: an error that does not fit leaves the order as it is.
    points[0][1].0 = 0.6;
    let spoilt = said(&study, &points, nothing);
    assert_ne!(spoilt.column("order"), ["2.00"; 2]);
    let of = said(&study, &points, |results| {
        results.methods[0][1].seen.as_mut().unwrap().halved = 3;
    });
    assert_eq!(of.column("order"), ["2.00"; 2]);
    assert_eq!(
        of.column("status"),
        ["1 of 4 with halved steps", "resolved"]
    );
}
