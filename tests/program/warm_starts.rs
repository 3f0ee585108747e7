//! Solves that start from an earlier solution.

use crate::commands::summary;
use crate::runs::{read, run, workshop};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Solves a problem, starts again from its solution, and returns both summaries.
fn warm(problem: &str, second: &[&str]) -> (Value, Value) {
    let folder = workshop();
    let path = format!("problems/{problem}.json");
    let (status, ..) = run(folder.path(), &["solve", &path, "-o", "first"]);
    assert_eq!(status, 0);
    let guess = "control.guess={\"solution\":\"first/solution.json\"}";
    let mut arguments = vec!["solve", &path, "-o", "second", "--set", guess];
    arguments.extend(second);
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let of = |name| summary(folder.path(), name);
    (of("first"), of("second"))
}

pub(crate) fn iterations(summary: &Value) -> u64 {
    summary["iterations"].as_u64().unwrap()
}

fn assert_same_objective(a: &Value, b: &Value) {
    let [a, b] = [a, b].map(|s| s["objective"].as_f64().unwrap());
    assert!((a - b).abs() < 1e-7 * a.abs(), "{a} against {b}");
}

#[test]
fn a_solution_starts_the_same_problem_at_its_end() {
    for problem in ["pair", "pair_time", "elephant_trunk_effort"] {
        let (cold, warm) = warm(problem, &[]);
        assert!(iterations(&cold) > 8, "{cold}");
        assert!(iterations(&warm) <= 8, "{warm}");
        assert_same_objective(&cold, &warm);
    }
}

#[test]
fn a_solution_starts_a_finer_grid() {
    let (coarse, fine) = warm("pair", &["--set", "control.intervals=40"]);
    assert_eq!(fine["intervals"], 40);
    let ratio = fine["objective"].as_f64().unwrap() / coarse["objective"].as_f64().unwrap();
    // The optimum of a grid is that of the continuous problem up to terms that fall with the interval length.
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
}

#[test]
fn a_reduced_solution_starts_redundant_coordinates() {
    let (reduced, redundant) = warm("pair", &["--set", "control.coordinates=redundant"]);
    assert_eq!(redundant["coordinates"], "redundant");
    assert_same_objective(&reduced, &redundant);
}

/// A solution by hand: nodes and voltages of a reference solution without costates.
fn by_hand(reference: &str) -> Value {
    let name = format!("tests/reference/{reference}.json");
    let file = read(Path::new(env!("CARGO_MANIFEST_DIR")).join(name));
    let control = &file["control"];
    let h = control["h"].as_f64().unwrap();
    let rows = |key: &str| -> Vec<Vec<f64>> {
        serde_json::from_value(control[key].clone()).expect("rows of numbers")
    };
    let columns = |name: &str, rows: Vec<Vec<f64>>, factor: f64| -> Value {
        let column = |i: usize| rows.iter().map(|row| factor * row[i]).collect::<Vec<_>>();
        (0..rows[0].len())
            .map(|i| (format!("{name}{}", i + 1), json!(column(i))))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    let angles = rows("theta_rad");
    json!({
        "time": (0..angles.len()).map(|k| k as f64 * h).collect::<Vec<_>>(),
        "joints": columns("joint", angles, 1.0),
        "voltages": columns("muscle", rows("voltage_kV"), 1e3),
    })
}

#[test]
fn reference_solutions_written_by_hand_start_a_solve() {
    for (problem, reference) in [
        ("pair", "pair"),
        ("pair_time", "pair_time"),
        ("elephant_trunk_effort", "trunk6"),
    ] {
        let folder = workshop();
        fs::write(
            folder.path().join("hand.json"),
            by_hand(reference).to_string(),
        )
        .unwrap();
        let path = format!("problems/{problem}.json");
        let guess = "control.guess={\"solution\":\"hand.json\"}";
        let arguments = ["solve", &path, "-o", "warm", "--set", guess];
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 0, "{out}{err}");
        let warm = summary(folder.path(), "warm");
        assert!(iterations(&warm) <= 15, "{problem}: {warm}");
    }
}
