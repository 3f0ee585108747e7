//! What a program that is killed leaves.

use crate::output::arrays;
use crate::runs::{problem, read, run};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Runs the program until it has written an iterate with its multipliers, which are unknown at first and zero at the start, and kills it; the
/// folder of its results.
fn killed(folder: &Path, arguments: &[&str]) -> PathBuf {
    let results = folder.join("results");
    let mut child = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .args(arguments)
        .arg("-o")
        .arg(&results)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    let has_multipliers = || {
        let arrays = results.join("unfinished.npz");
        let is_there = |rows: &Vec<f64>| rows.iter().any(|y| y.abs() > 1e-9);
        arrays.exists()
            && self::arrays(&arrays)
                .get("costates/rows")
                .is_some_and(is_there)
    };
    while !results.join("unfinished.json").exists() || !has_multipliers() {
        let ended = child.try_wait().unwrap();
        assert!(ended.is_none(), "too short a run: {ended:?}");
        assert!(began.elapsed() < Duration::from_secs(120), "nothing kept");
        thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!results.join("solution.json").exists());
    results
}

#[test]
fn a_solve_that_is_killed_leaves_an_iterate_to_go_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let problem = problem("elephant_trunk_effort");
    let fine = ["--set", "control.intervals=4000"];
    let results = killed(folder.path(), &[&["solve", &problem][..], &fine].concat());
    let kept = read(results.join("unfinished.json"));
    // So many numbers stand in arrays beside it.
    let beside = results.join(kept["arrays"]["file"].as_str().unwrap());
    let all = arrays(&beside);
    assert_eq!(all["time"].len(), 4001);
    // With multipliers and the barrier parameter, so that a solve goes on where this one was.
    for name in ["costates/rows", "costates/lower", "costates/upper"] {
        assert!(all[name].iter().any(|v| v.abs() > 1e-9), "{name}");
    }
    assert!(kept["barrier"].as_f64().unwrap() > 0.0);
    // It is a guess like any solution, and goes when a run has written its results.
    let guess = format!(
        "control.guess={{\"solution\":{:?}}}",
        results.join("unfinished.json")
    );
    let out = results.to_str().unwrap();
    let (status, said, errors) = run(
        folder.path(),
        &["solve", &problem, "--set", &guess, "-o", out],
    );
    assert_eq!(status, 0, "{said}{errors}");
    assert!(results.join("solution.json").exists());
    assert!(!results.join("unfinished.json").exists() && !beside.exists());
}

/// Warnings are shown without being asked for, as lines without time and colours where nobody watches.
#[test]
fn an_iterate_that_cannot_be_kept_is_told_during_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    std::fs::create_dir_all(out.join("unfinished.json")).unwrap();
    let fine = ["--set", "control.intervals=4000"];
    let limit = ["--max-seconds", "5", "--no-report"];
    let problem = problem("elephant_trunk_effort");
    let words = [
        &["solve", &problem, "-o", out.to_str().unwrap()][..],
        &fine,
        &limit,
    ]
    .concat();
    let (_, _, errors) = run(folder.path(), &words);
    let told = errors.lines().find(|line| line.contains("unfinished.json"));
    let told = told.unwrap_or_else(|| panic!("{errors}"));
    assert!(told.trim_start().starts_with("WARN"), "{told:?}");
    assert!(!errors.contains('\u{1b}'), "{errors:?}");
}
