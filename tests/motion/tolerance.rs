//! Steps whose lengths a tolerance controls.

use crate::common::{at_reference, trunk};
use assert_cmd::Command;
use proboscis::dynamics::{
    DiscreteTrajectory, Lengths, Solving, Start, StepControl, StepError, go_on, simulate_by,
};
use proboscis::model::{Coordinates, Model};
use serde_json::Value;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

#[test]
fn steps_by_a_tolerance_keep_it() {
    let model = Model::new(trunk(3), Some(Coordinates::Reduced), 5.0, &[]).unwrap();
    let start = Start::at_rest(&model, at_reference(&model));
    let voltages = |from: f64, to: f64| {
        let middle = 0.5 * (from + to);
        let on = if middle < 150.0 { 2000.0 } else { 500.0 };
        model.scalars(&[on, 0.0, 0.0, 1500.0, on, 0.0])
    };
    let run = |tolerance: f64| -> (DiscreteTrajectory, Option<StepError>) {
        let control = StepControl {
            duration: 400.0,
            first: 4.0,
            tolerance,
            switches: &[150.0, 400.0],
        };
        let begun = DiscreteTrajectory::at(&start);
        let lengths = Lengths::Controlled(control);
        go_on(
            Solving::default(),
            &model,
            begun,
            lengths,
            &voltages,
            |_| ControlFlow::Continue(()),
        )
    };
    let go_on = |_: &_| ControlFlow::Continue(());
    let (exact, _) = simulate_by(
        Solving::default(),
        &model,
        &start,
        0.05,
        8000,
        voltages,
        go_on,
    );
    let end = exact.z.last().unwrap();
    let mut before = usize::MAX;
    for tolerance in [1e-4, 1e-3, 1e-2] {
        let (discrete, failure) = run(tolerance);
        assert_eq!(failure, None);
        let steps = discrete.intervals();
        assert_eq!(*discrete.times.last().unwrap(), 400.0);
        assert!(
            discrete.times.contains(&150.0),
            "steps end where voltages switch"
        );
        let lengths: Vec<f64> = discrete.times.windows(2).map(|w| w[1] - w[0]).collect();
        let [least, most] = [
            lengths.iter().copied().fold(f64::INFINITY, f64::min),
            lengths.iter().copied().fold(0.0, f64::max),
        ];
        assert!(least > 0.0 && most > 5.0 * least, "{least} to {most}");
        let error = discrete.z[steps]
            .iter()
            .zip(end)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        println!(
            "{tolerance:e}: {steps} steps from {least} to {most} ms, {error:e}, {:?}",
            discrete.report
        );
        assert!(error < 2.0 * tolerance && steps < before, "{error:e}");
        before = steps;
    }
}

/// Exit status, standard error and `summary.json` of a run in a folder that writes into `out`.
fn program(folder: &Path, words: &[&str], out: &str) -> (i32, String, Value) {
    let mut command = Command::cargo_bin("proboscis").unwrap();
    let output = command
        .current_dir(folder)
        .args(words)
        .args(["-o", out])
        .output()
        .unwrap();
    let summary = fs::read_to_string(folder.join(out).join("summary.json")).unwrap_or_default();
    let err = String::from_utf8(output.stderr).unwrap();
    (
        output.status.code().unwrap(),
        err,
        serde_json::from_str(&summary).unwrap_or_default(),
    )
}

#[test]
fn a_motion_in_unequal_steps_serves_where_others_do() {
    let folder = tempfile::tempdir().unwrap();
    let problem = |name: &str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("problems")
            .join(name);
        path.to_str().unwrap().to_owned()
    };
    let [constant, control] = ["pair_constant.json", "pair.json"].map(problem);
    let run = |words: &[&str], out: &str| program(folder.path(), words, out);
    let (status, err, auto) = run(
        &["simulate", &constant, "--set", "simulate.step=\"auto\""],
        "auto",
    );
    assert_eq!(
        (status, auto["tolerance"].as_f64()),
        (0, Some(1e-3)),
        "{err}"
    );
    let table = fs::read_to_string(folder.path().join("auto/trajectory.csv")).unwrap();
    let times: Vec<f64> = table
        .lines()
        .skip(2)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect();
    let lengths: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let most = lengths.iter().copied().fold(0.0, f64::max);
    let least = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least > 0.0 && most > 2.0 * least, "{least} to {most}");
    // As voltages, compared with itself in equal steps.
    let voltages = "simulate.voltages={\"solution\":\"auto/solution.json\"}";
    let (status, err, again) = run(
        &[
            "simulate",
            &constant,
            "--set",
            voltages,
            "--set",
            "simulate.step=\"1 ms\"",
        ],
        "again",
    );
    assert_eq!(status, 0, "{err}");
    assert!(again["comparison"].is_object(), "{again}");
    // As a guess: the same optimum as from the guess of the problem.
    let (status, err, plain) = run(&["solve", &control], "plain");
    assert_eq!(status, 0, "{err}");
    let guess = "control.guess={\"solution\":\"auto/solution.json\"}";
    let (status, err, guessed) = run(&["solve", &control, "--set", guess], "guessed");
    assert_eq!(status, 0, "{err}");
    let [a, b] = [&plain, &guessed].map(|s| s["objective"].as_f64().unwrap());
    assert!((a - b).abs() < 1e-6 * a, "{a} against {b}");
}

#[test]
fn steps_by_a_tolerance_are_refused_where_there_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let problem = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_constant.json");
    let auto = "simulate.step=\"auto\"";
    for (words, told) in [
        (
            vec![
                "--set",
                auto,
                "--set",
                "simulate.integrator=\"implicit_euler\"",
            ],
            "only the midpoint rule chooses its steps",
        ),
        (
            vec!["--set", auto, "--set", "simulate.tolerance=0"],
            "a tolerance from 1e-9 to below 1",
        ),
        (
            vec!["--set", "simulate.tolerance=1e-3"],
            "a tolerance only where the step is \"auto\"",
        ),
        (
            vec!["--set", auto, "--estimate-error"],
            "\"auto\" has a \"tolerance\" instead",
        ),
        (
            vec!["--set", "simulate.step=\"fast\""],
            "does not begin with a number",
        ),
    ] {
        let mut all = vec!["simulate", problem.to_str().unwrap()];
        all.extend(words);
        let (status, err, summary) = program(folder.path(), &all, "out");
        assert_eq!((status, &summary), (2, &Value::Null), "{all:?}: {err}");
        assert!(err.contains(told), "{all:?}: {err}");
    }
}

/// Local errors of third order: a hundredth of the tolerance takes ten times the steps, of bodies that turn freely too.
#[test]
fn steps_of_turning_bodies_grow_with_the_root_of_the_tolerance() {
    let folder = tempfile::tempdir().unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/satellite.json");
    let satellite = path.to_str().unwrap();
    let steps = ["1e-4", "1e-6"].map(|tolerance| {
        let tolerance = format!("simulate.tolerance={tolerance}");
        let auto = "simulate.step=\"auto\"";
        let duration = "simulate.duration=50 ms";
        let words = [
            "simulate", satellite, "--set", auto, "--set", &tolerance, "--set", duration,
        ];
        let (status, err, summary) = program(folder.path(), &words, "out");
        assert_eq!(status, 0, "{err}");
        summary["steps"].as_u64().unwrap()
    });
    assert!(steps[0] > 50 && steps[1] < 13 * steps[0], "{steps:?}");
}

/// The first step behind a jump of voltages may be much longer than its change of rates over a long time would admit.
#[test]
fn a_long_motion_begins_with_a_jump_of_voltages() {
    let folder = tempfile::tempdir().unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair_constant.json");
    let auto = "simulate.step=\"auto\"";
    let duration = "simulate.duration=100 s";
    let pair = path.to_str().unwrap();
    let words = [
        "simulate",
        pair,
        "--set",
        auto,
        "--set",
        duration,
        "--no-report",
    ];
    let (status, err, summary) = program(folder.path(), &words, "out");
    assert_eq!(status, 0, "{err}");
    assert_eq!(summary["is_confirmed"], true, "{summary}");
    assert!(summary["estimated_error"].as_f64().unwrap() < 1e-3);
}
