//! Similar problems of every task: the same verdict, notes and iterations, and the same columns in units of the robot, from robots of milligrams and
//! millimetres to those of kilograms and metres.

use crate::common::similar::{Scales, problem_of};
use crate::seeds;
use assert_cmd::Command;
use proboscis::math::Random;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// Kept problems whose numbers all have units, and the largest difference of a column relative to its size.
const PROBLEMS: [(&str, &str, f64); 20] = [
    ("solve", "pair", 1e-8),
    ("solve", "pair_energy", 1e-7),
    ("solve", "pair_feedback", 1e-7),
    ("solve", "pair_observed", 1e-7),
    ("solve", "pair_peak", 1e-6),
    ("solve", "pair_reaction", 1e-7),
    ("solve", "pair_sensitivity", 1e-8),
    ("solve", "pair_time", 1e-7),
    ("solve", "tendon_finger_control", 1e-6),
    ("solve", "stiffening_muscle", 1e-9),
    ("solve", "pair_swing", 1e-7),
    ("solve", "prestretched_pair", 1e-7),
    ("simulate", "pair_constant", 1e-9),
    ("simulate", "four_bar", 1e-7),
    ("simulate", "slider_crank", 1e-8),
    ("solve", "elbow_torque", 1e-8),
    ("equilibrium", "clamped_stack", 1e-8),
    ("equilibrium", "stiffening_block", 1e-8),
    ("solve", "recorded_pair", 1e-7),
    ("solve", "recorded_payload", 1e-6),
];

/// What a run ended with.
#[derive(Debug)]
struct Outcome {
    status: Value,
    iterations: Value,
    /// Numbers of warnings and notes.
    told: [usize; 2],
    objective: Option<f64>,
    /// Columns with units, and constants with their intervals.
    columns: Vec<(String, String, Vec<f64>)>,
}

/// A run of the program.
pub(crate) struct Ran {
    folder: TempDir,
    said: String,
}

/// Runs a task of a problem.
pub(crate) fn program(task: &str, problem: &Value) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.json"), problem.to_string()).unwrap();
    let output = Command::cargo_bin("proboscis")
        .unwrap()
        .current_dir(folder.path())
        .args([task, "p.json", "-o", "p", "--no-report"])
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran {
        said: text(output.stdout) + &text(output.stderr),
        folder,
    }
}

impl Ran {
    pub(crate) fn folder(&self) -> PathBuf {
        self.folder.path().join("p")
    }

    pub(crate) fn summary(&self) -> Value {
        let summary = fs::read_to_string(self.folder().join("summary.json"));
        let summary = summary.unwrap_or_else(|_| panic!("{}", self.said));
        serde_json::from_str(&summary).unwrap()
    }
}

fn outcome(task: &str, problem: &Value) -> Outcome {
    let ran = program(task, problem);
    let summary = ran.summary();
    let count = |word: &str| {
        ran.said
            .lines()
            .filter(|line| line.starts_with(word))
            .count()
    };
    let tables = ["trajectory.csv", "equilibrium.csv"];
    let tables = tables.map(|name| fs::read_to_string(ran.folder().join(name)));
    let mut columns = columns(tables.iter().flatten().next().map_or("", String::as_str));
    for constant in summary["constants"].as_array().into_iter().flatten() {
        let numbers = ["value", "standard_error"].map(|key| constant[key].as_f64());
        let [name, unit] = ["name", "unit"].map(|key| constant[key].as_str().unwrap().to_owned());
        columns.push((name, unit, numbers.into_iter().flatten().collect()));
    }
    Outcome {
        status: summary["status"].clone(),
        iterations: summary["iterations"].clone(),
        told: [count("warning"), count("note")],
        objective: summary["objective"].as_f64(),
        columns,
    }
}

/// Names, units and numbers of a table.
fn columns(table: &str) -> Vec<(String, String, Vec<f64>)> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let Some(header) = lines.next() else {
        return Vec::new();
    };
    let named = header.split(',').map(|name| {
        let (name, unit) = name.split_once(" [").unwrap_or((name, ""));
        (name.to_owned(), unit.trim_end_matches(']').to_owned())
    });
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let columns = named.enumerate();
    columns
        .map(|(j, (name, unit))| (name, unit, rows.iter().map(|row| row[j]).collect()))
        .collect()
}

/// The largest difference of a column from that of a similar robot, relative to its size or that of columns of its unit.
fn apart(scales: &Scales, one: &Outcome, other: &Outcome) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for ((name, unit, values), (_, _, others)) in one.columns.iter().zip(&other.columns) {
        if values.len() != others.len() {
            return (
                f64::INFINITY,
                format!("{} and {} rows", values.len(), others.len()),
            );
        }
        let factor = scales.of_unit(unit);
        let same = one.columns.iter().filter(|column| column.1 == *unit);
        let of_unit = same.map(|column| size(&column.2)).fold(0.0, f64::max);
        let differences = values
            .iter()
            .zip(others)
            .map(|(a, b)| (a - b / factor).abs());
        let difference = differences.fold(0.0, f64::max) / of_unit;
        if name != "constraint_violation" && (difference.is_nan() || difference > worst.0) {
            worst = (difference, name.clone());
        }
    }
    worst
}

#[test]
fn similar_problems_have_similar_results_at_all_scales() {
    let mut failures = Vec::new();
    seeds(0, PROBLEMS.len() as u64, &[], |seed| {
        let (task, name, tolerance) = PROBLEMS[seed as usize % PROBLEMS.len()];
        let mut random = Random::new(seed);
        let mut power = |low: f64, high: f64| 10_f64.powf(random.between(low, high));
        // Densities that no material has are refused.
        let (length, time) = (power(-1.7, 1.3), power(-2.3, 2.7));
        let scales = Scales::in_vacuum(length.powi(3) * power(-1.5, 1.8), length, time);
        let problem = problem_of(&format!("problems/{name}.json"));
        let one = outcome(task, &problem);
        let other = outcome(task, &scales.problem(&problem));
        let (difference, column) = apart(&scales, &one, &other);
        let same = (&one.status, &one.iterations, one.told)
            == (&other.status, &other.iterations, other.told);
        let objectives = one.objective.zip(other.objective);
        let off = objectives.map_or(0.0, |(a, b)| (b / a - 1.0).abs());
        println!(
            "{seed} {name}: {} {} {:?}, {} {} {:?}; {column} {difference:.1e}, objective {off:.1e}",
            one.status, one.iterations, one.told, other.status, other.iterations, other.told
        );
        let is_similar = same && difference <= tolerance && off <= tolerance;
        if !is_similar {
            failures.push(format!("{seed} {name} {scales:?}"));
        }
    });
    assert!(failures.is_empty(), "{failures:#?}");
}
