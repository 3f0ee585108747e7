//! Files of a program that is killed.

use crate::output::arrays;
use crate::runs::{problem, read, run};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, mem, thread};

/// The arrays of the iterate that is kept in a folder, in the file that it names; also of a run that goes on.
fn kept(results: &Path) -> BTreeMap<String, Vec<f64>> {
    let iterate = read(results.join("unfinished.json"));
    arrays(&results.join(iterate["arrays"]["file"].as_str().unwrap()))
}

/// Multipliers that an iterate keeps.
const MULTIPLIERS: [&str; 3] = ["costates/rows", "costates/lower", "costates/upper"];

fn is_nonzero(numbers: &[f64]) -> bool {
    numbers.iter().any(|v| v.abs() > 1e-9)
}

/// Runs the program until it has written one iterate after another, the last with its multipliers, which are unknown at first and zero at the
/// start, and kills it; the folder of its results and what its `unfinished.json` said of the iterate before. Multipliers of bounds that are not
/// reached shrink with the barrier parameter, so that not every iterate has some of each kind that are not zero.
fn killed(folder: &Path, arguments: &[&str]) -> (PathBuf, Vec<u8>) {
    let results = folder.join("results");
    let mut child = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .args(arguments)
        .arg("-o")
        .arg(&results)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let (mut before, mut latest) = (Vec::new(), Vec::new());
    let mut is_kept = || {
        match fs::read(results.join("unfinished.json")) {
            Ok(now) if now != latest => before = mem::replace(&mut latest, now),
            _ => return false,
        }
        !before.is_empty() && {
            let all = kept(&results);
            let is_there = |name: &&str| all.get(*name).is_some_and(|numbers| is_nonzero(numbers));
            MULTIPLIERS.iter().all(is_there)
        }
    };
    while !is_kept() {
        let ended = child.try_wait().unwrap();
        assert!(ended.is_none(), "too short a run: {ended:?}");
        thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!results.join("solution.json").exists());
    (results, before)
}

#[test]
fn a_solve_that_is_killed_leaves_an_iterate_to_go_on_from() {
    let folder = tempfile::tempdir().unwrap();
    let problem = problem("elephant_trunk_effort");
    let fine = ["--set", "control.intervals=4000"];
    let (results, before) = killed(folder.path(), &[&["solve", &problem][..], &fine].concat());
    let kept = read(results.join("unfinished.json"));
    // So many numbers stand in arrays beside it.
    let beside = results.join(kept["arrays"]["file"].as_str().unwrap());
    let all = arrays(&beside);
    assert_eq!(all["time"].len(), 4001);
    // With multipliers and the barrier parameter, so that a solve goes on where this one was.
    for name in MULTIPLIERS {
        assert!(is_nonzero(&all[name]), "{name}");
    }
    assert!(kept["barrier"].as_f64().unwrap() > 0.0);
    let goes_on_from = |unfinished: &Path, out: &Path| {
        let guess = format!("control.guess={{\"solution\":{unfinished:?}}}");
        let out = out.to_str().unwrap();
        let words = ["solve", &problem, "--set", &guess, "-o", out];
        let (status, said, errors) = run(folder.path(), &words);
        assert_eq!(status, 0, "{said}{errors}");
    };
    // Also where the program is killed when it has written the arrays of the next iterate, but not the file that names them.
    fs::write(results.join("before.json"), before).unwrap();
    goes_on_from(&results.join("before.json"), &folder.path().join("other"));
    // It is a guess like any solution, and goes when a run has written its results.
    goes_on_from(&results.join("unfinished.json"), &results);
    assert!(results.join("solution.json").exists());
    assert!(!results.join("unfinished.json").exists() && !beside.exists());
}

/// Warnings are shown without being asked for, as lines without time and colours where nobody watches.
#[test]
fn an_iterate_that_cannot_be_kept_is_told_during_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("results");
    fs::create_dir_all(out.join("unfinished.json")).unwrap();
    let fine = ["--set", "control.intervals=4000"];
    let problem = problem("elephant_trunk_effort");
    let words = ["solve", &problem, "-o", out.to_str().unwrap()];
    let mut child = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .args([&words[..], &fine].concat())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Until it is told, however long that takes.
    let mut errors = String::new();
    for line in BufReader::new(child.stderr.take().unwrap()).lines() {
        errors += &format!("{}\n", line.unwrap());
        if errors.contains("unfinished.json") {
            break;
        }
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let told = errors.lines().find(|line| line.contains("unfinished.json"));
    let told = told.unwrap_or_else(|| panic!("{errors}"));
    assert!(told.trim_start().starts_with("WARN"), "{told:?}");
    assert!(!errors.contains('\u{1b}'), "{errors:?}");
}
