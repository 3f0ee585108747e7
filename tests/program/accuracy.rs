//! `--accuracy` and `--estimate-error` as their users meet them: grids told, files of the finest one that was solved, refusals.

use crate::output::arrays;
use crate::runs::{read, run, workshop};
use serde_json::Value;
use std::fs;

#[test]
fn the_trunk_is_solved_to_two_thousandths_from_grid_to_grid() {
    let folder = workshop();
    let trunk = "problems/elephant_trunk_effort.json";
    let (status, out, err) = run(
        folder.path(),
        &["solve", trunk, "--accuracy", "2e-3", "-o", "out"],
    );
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.contains("error about"), "{out}");
    let summary = read(folder.path().join("out/summary.json"));
    let accuracy = &summary["accuracy"];
    let levels = accuracy["levels"].as_array().unwrap();
    assert_eq!(accuracy["requested"], 2e-3);
    assert_eq!(accuracy["is_met"], true);
    for (i, level) in levels.iter().enumerate() {
        assert_eq!(level["intervals"], 40 << i);
        assert!(level["seconds"].as_f64().unwrap() > 0.0);
        assert!(err.contains(&level["intervals"].to_string()), "{err}");
    }
    let last = levels.last().unwrap();
    assert!(levels.len() >= 4);
    assert_eq!(summary["objective"], last["objective"]);
    assert_eq!(summary["intervals"], last["intervals"]);
    assert_eq!(accuracy["estimate"], last["estimate"]);
    let objective = |level: &Value| level["objective"].as_f64().unwrap();
    let estimate = |level: &Value, name: &str| level["estimate"][name].as_f64().unwrap();
    for name in ["objective", "path", "end", "response"] {
        assert!(estimate(last, name) < 2e-3, "{name}");
    }
    assert!(estimate(last, "objective") > 1e-6 && estimate(last, "response") > 1e-6);
    let solution = read(folder.path().join("out/solution.json"));
    let intervals = usize::try_from(last["intervals"].as_u64().unwrap()).unwrap();
    assert_eq!(solution["time"].as_array().unwrap().len(), intervals + 1);

    // Each estimate holds against the finest grid, which is itself off by less than its own.
    let best = objective(last);
    for level in &levels[1..levels.len() - 1] {
        let error = (objective(level) - best).abs() / best;
        assert!(
            error > 0.0 && error < estimate(level, "objective"),
            "{level}"
        );
    }

    // What the grid before knows saves iterations.
    let finer = &levels[1..3];
    let iterations = |level: &Value| level["iterations"].as_u64().unwrap();
    let warm: u64 = finer.iter().map(iterations).sum();
    let cold = |level: &Value| {
        let set = format!("control.intervals={}", level["intervals"]);
        let (status, ..) = run(
            folder.path(),
            &["solve", trunk, "--set", &set, "-o", "cold"],
        );
        assert_eq!(status, 0);
        iterations(&read(folder.path().join("cold/summary.json")))
    };
    let cold: u64 = finer.iter().map(cold).sum();
    println!("iterations: {warm} from grid to grid, {cold} from the guess");
    assert!(warm < cold, "{warm} and {cold} iterations");
}

#[test]
fn a_weight_on_the_rate_makes_the_order_one_and_warm_starts_worth_half() {
    let folder = workshop();
    let smooth = "problems/elephant_trunk_smooth.json";
    let (status, out, err) = run(
        folder.path(),
        &["solve", smooth, "--accuracy", "2e-2", "-o", "out"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let summary = read(folder.path().join("out/summary.json"));
    let order = summary["accuracy"]["order"]["objective"].as_f64().unwrap();
    assert!((order - 1.0).abs() < 0.3, "{order}");
    let levels = summary["accuracy"]["levels"].as_array().unwrap();
    for level in &levels[1..] {
        let warm = level["iterations"].as_u64().unwrap();
        let cold = levels[0]["iterations"].as_u64().unwrap();
        assert!(3 * warm < 2 * cold, "{warm} and {cold} iterations");
    }
}

#[test]
fn a_finer_grid_that_fails_leaves_the_files_of_the_one_before() {
    // The first grid begins at its own solution and needs one or two iterations, the finer one more than ten.
    let folder = workshop();
    let trunk = [
        "problems/elephant_trunk_effort.json",
        "--set",
        "control.intervals=30",
    ];
    let guess = [
        "--set",
        "control.guess={\"solution\": \"guess/solution.json\"}",
    ];
    let once = [&["solve"], &trunk[..], &["-o", "guess"]].concat();
    let again = [&["solve"], &trunk[..], &guess, &["-o", "plain"]].concat();
    for solve in [once, again] {
        assert_eq!(run(folder.path(), &solve).0, 0);
    }
    let limits = ["--accuracy", "1e-3", "--max-iterations", "4", "-o", "out"];
    let options = [&guess[..], &limits].concat();
    let (status, out, err) = run(folder.path(), &[&["solve"], &trunk[..], &options].concat());
    assert_eq!(status, 1, "{out}{err}");
    assert!(out.starts_with("solved, but not to 1e-3"), "{out}");
    assert!(err.contains("iteration limit"), "{err}");
    let summary = read(folder.path().join("out/summary.json"));
    assert_eq!(summary["status"], "solved");
    assert_eq!(summary["accuracy"]["is_met"], false);
    assert_eq!(
        summary["accuracy"]["levels"][1]["status"],
        "iteration_limit"
    );
    let [kept, plain] =
        ["out", "plain"].map(|name| read(folder.path().join(name).join("solution.json")));
    assert_eq!(kept["voltages"], plain["voltages"]);
}

#[test]
fn an_estimate_changes_nothing_else() {
    let folder = workshop();
    for (verb, problem, refine) in [
        ("solve", "problems/pair.json", "control.intervals=320"),
        (
            "simulate",
            "problems/pair_constant.json",
            "simulate.step=\"0.0625 ms\"",
        ),
    ] {
        let mut files = Vec::new();
        for options in [&["-o", "plain"][..], &["-o", "told", "--estimate-error"]] {
            let (status, out, err) = run(folder.path(), &[&[verb, problem], options].concat());
            assert_eq!(status, 0, "{out}{err}");
            files.push(
                fs::read_to_string(folder.path().join(options[1]).join("solution.json")).unwrap(),
            );
            assert_eq!(out.contains("error about"), options.len() > 2, "{out}");
        }
        assert_eq!(files[0], files[1]);
        let summary = |name: &str| read(folder.path().join(name).join("summary.json"));
        let (plain, told) = (summary("plain"), summary("told"));
        assert_eq!(plain["accuracy"], Value::Null);
        assert_eq!(plain["iterations"], told["iterations"]);
        assert_eq!(told["accuracy"]["requested"], Value::Null);
        assert_eq!(told["accuracy"]["levels"].as_array().unwrap().len(), 3);

        // The end of the marker, and the objective, against a grid so fine that its error does not count.
        let (status, ..) = run(
            folder.path(),
            &[verb, problem, "--set", refine, "-o", "fine"],
        );
        assert_eq!(status, 0);
        let fine = summary("fine");
        let estimate = |name: &str| told["accuracy"]["estimate"][name].as_f64().unwrap();
        if let (Some(a), Some(b)) = (told["objective"].as_f64(), fine["objective"].as_f64()) {
            let ratio = estimate("objective") / ((a - b) / a);
            println!("objective: estimate {ratio} times the error");
            assert!(ratio > 0.5 && ratio < 3.0, "{ratio}");
        }
        let centres = |name: &str| -> Vec<f64> {
            let folder = folder.path().join(name);
            let solution = read(folder.join("solution.json"));
            // Of a long motion they are in arrays.
            match &solution["configuration"]["bodies"] {
                Value::Object(bodies) => {
                    let places = bodies.values().next().unwrap()["centre"].as_array();
                    let places = places.unwrap().iter().flat_map(|x| x.as_array().unwrap());
                    places.map(|x| x.as_f64().unwrap()).collect()
                }
                _ => {
                    let mut all = arrays(&folder.join("solution.npz")).into_iter();
                    all.find(|(name, _)| name.ends_with("/centre")).unwrap().1
                }
            }
        };
        let (a, b) = (centres("told"), centres("fine"));
        let (a, b) = (a.chunks_exact(3), b.chunks_exact(3));
        let times = (b.len() - 1) / (a.len() - 1);
        let apart = a.zip(b.step_by(times)).map(|(a, b)| {
            let square = |i: usize| (a[i] - b[i]).powi(2);
            (0..3).map(square).sum::<f64>().sqrt()
        });
        let apart = apart.fold(0.0, f64::max);
        // The marker is at the tip of the one body, twice as far from the joint as its centre, which is at 25 mm.
        let truth = 2.0 * apart / 25e-3;
        let ratio = estimate("path") / truth;
        println!("{problem}: estimate of the path {ratio} times its error");
        assert!(truth > 1e-4);
        assert!(ratio > 0.5 && ratio < 3.0, "{ratio}");
    }
}

#[test]
fn wrong_requests_are_refused() {
    let folder = workshop();
    let pair = "problems/pair.json";
    for value in ["0", "-1e-3", "nan", "inf", "1", "small"] {
        let option = format!("--accuracy={value}");
        let (status, out, err) = run(folder.path(), &["solve", pair, &option]);
        assert_eq!((status, out.as_str()), (2, ""), "{err}");
        assert!(err.contains("expected a number between 0 and 1"), "{err}");
    }
    let (status, ..) = run(
        folder.path(),
        &["solve", pair, "--accuracy=1e-3", "--estimate-error"],
    );
    assert_eq!(status, 2);
    for (option, name) in [
        ("--accuracy=1e-3", "--accuracy"),
        ("--estimate-error", "--estimate-error"),
    ] {
        let (status, out, err) = run(folder.path(), &["solve", "problems/pull_in.json", option]);
        assert_eq!((status, out.as_str()), (2, ""), "{err}");
        assert!(err.contains(name) && err.contains("equilibrium"), "{err}");
    }
    assert!(!folder.path().join("results").exists());
}
