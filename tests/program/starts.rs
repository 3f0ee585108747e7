//! Several starting points, in threads and in processes.

use crate::common::signals::Listening as _;
use crate::rank::Rank;
use crate::runs::{problem, read, run};
use proboscis::ipopt::Options;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

#[test]
fn the_best_of_several_starts_is_kept_and_can_be_solved_again_alone() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let pair = problem("pair");
    let arguments = ["solve", &pair, "--starts", "4", "--seed", "7", "-o", "out"];
    let (status, out, err) = run(path, &arguments);
    // What is said of the best start is said once.
    let lines: Vec<_> = err.lines().collect();
    assert!(
        lines.len() == 1 && lines[0].starts_with("warning: the intervals are long"),
        "{err}"
    );
    assert_eq!(status, 0, "{out}");
    let first = out.lines().next().unwrap();
    assert!(
        first
            .starts_with("solved: objective 0.046446126, 4 of 4 starts solved, 1 distinct optimum"),
        "{out}"
    );
    assert_eq!(out.lines().count(), 2 + 4);

    let summary = read(path.join("out/summary.json"));
    let starts = &summary["starts"];
    assert_eq!(
        (&starts["count"], &starts["solved"], &starts["best"]),
        (&4.into(), &4.into(), &1.into())
    );
    assert_eq!(starts["distinct_optima"], 1);
    let each = starts["each"].as_array().unwrap();
    assert!(
        each[0]["seed"].is_null() && each[3]["seed"] == 7004,
        "{starts}"
    );
    let objective = |one: &Value| one["objective"].as_f64().unwrap();
    let iterations: Vec<_> = each
        .iter()
        .map(|one| one["iterations"].as_u64().unwrap())
        .collect();
    assert!(
        iterations.iter().any(|count| *count != iterations[0]),
        "{iterations:?}"
    );
    assert!(
        each.iter()
            .all(|one| (objective(one) / objective(&summary) - 1.0).abs() < 1e-7)
    );

    // The files are those of the best start.
    for file in [
        "solution.json",
        "trajectory.csv",
        "controls.csv",
        "report.html",
    ] {
        let [here, there] =
            ["out", "out/starts/01"].map(|at| fs::read(path.join(at).join(file)).unwrap());
        assert!(here == there && here.len() > 100, "{file}");
    }
    let table = fs::read_to_string(path.join("out/starts.csv")).unwrap();
    assert_eq!(table.lines().count(), 2 + 4);
    let page = fs::read_to_string(path.join("out/starts.html")).unwrap();
    assert!(
        page.contains("4 of 4 starts have an answer.") && page.contains("starts/04/report.html")
    );
    assert!(
        table
            .lines()
            .nth(5)
            .unwrap()
            .starts_with("4,7004,solved,0.0464461"),
        "{table}"
    );

    // A start is an ordinary problem.
    let guess = "control.guess={\"random\":{\"seed\":7003}}";
    let (status, ..) = run(path, &["solve", &pair, "--set", guess, "-o", "alone"]);
    assert_eq!(status, 0);
    let alone = read(path.join("alone/summary.json"));
    assert_eq!(alone["iterations"], each[2]["iterations"]);
    assert_eq!(alone["objective"], each[2]["objective"]);

    // A shorter command leaves no starts of a longer one.
    let (status, ..) = run(path, &["solve", &pair, "--starts", "2", "-o", "out"]);
    assert_eq!(status, 0);
    assert!(path.join("out/starts/02").exists() && !path.join("out/starts/03").exists());
}

/// Files of a folder and of those in it, by their paths.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match path.is_dir() {
            true => {
                let within = files(&path).into_iter();
                all.extend(within.map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
            }
            false => drop(all.insert(name, fs::read(&path).unwrap())),
        }
    }
    all
}

/// A summary without what differs from run to run: times, and the threads that find a plan.
fn lasting(bytes: &[u8]) -> Value {
    let mut summary: Value = serde_json::from_slice(bytes).unwrap();
    fn strip(value: &mut Value) {
        const PASSING: [&str; 6] = [
            "seconds",
            "microseconds",
            "command",
            "analyses",
            "run_in",
            "share",
        ];
        match value {
            Value::Object(map) => {
                map.retain(|key, _| !PASSING.iter().any(|word| key.contains(word)));
                map.values_mut().for_each(strip);
            }
            Value::Array(list) => list.iter_mut().for_each(strip),
            _ => {}
        }
    }
    strip(&mut summary);
    summary
}

#[test]
fn threads_and_processes_leave_the_same_files() {
    assert!(Options::default().run_at_once(), "this Ipopt takes it");
    let pair = problem("pair");
    let both = ["threads", "processes"].map(|run_in| {
        let folder = tempdir().unwrap();
        let mut arguments = vec!["solve", &pair, "--starts", "5", "-o", "out"];
        if run_in == "processes" {
            arguments.push("--processes");
        }
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 0, "{err}");
        let summary = read(folder.path().join("out/summary.json"));
        assert_eq!(summary["starts"]["run_in"], run_in);
        let objective = summary["objective"].as_f64().unwrap();
        assert!(objective > 0.04, "{objective}");
        // Words before the first time.
        let words = out.split(" optimum, ").next().unwrap().to_owned();
        (files(&folder.path().join("out")), words, err)
    });
    let [(threads, words, notes), (processes, others, told)] = both;
    assert_eq!((words, notes), (others, told));
    assert!(threads.len() > 50, "{} files", threads.len());
    assert!(threads.keys().eq(processes.keys()));
    let mut equal = 0;
    for (name, bytes) in &threads {
        let other = &processes[name];
        match name.rsplit('/').next().unwrap() {
            "summary.json" => assert_eq!(lasting(bytes), lasting(other), "{name}"),
            // They tell how long it took.
            "starts.csv" | "starts.html" | "report.html" => {}
            _ if name.contains("starts/") => {
                assert!(bytes == other, "{name}");
                equal += 1;
            }
            "solution.json" => assert!(bytes == other, "{name}"),
            _ => {}
        }
    }
    assert!(equal > 30, "{equal} files");
}

#[test]
fn a_start_that_cannot_keep_its_files_is_told_and_the_others_are_kept() {
    let pair = problem("pair");
    for apart in [&[][..], &["--processes"]] {
        let folder = tempdir().unwrap();
        let starts = folder.path().join("out/starts");
        fs::create_dir_all(&starts).unwrap();
        // A file stands where its folder is to be.
        fs::write(starts.join("02"), "in the way").unwrap();
        let arguments = ["solve", &pair, "--starts", "3", "-o", "out"];
        let (status, out, err) = run(folder.path(), &[&arguments[..], apart].concat());
        assert_eq!(status, 0, "{err}");
        assert!(out.contains("2 of 3 starts solved"), "{out}");
        assert!(
            err.contains("start 2 failed: ") && err.contains("starts/02"),
            "{err}"
        );
        let summary = read(folder.path().join("out/summary.json"));
        let each = &summary["starts"]["each"];
        assert_eq!(each[1]["status"], "failed");
        assert!(each[1]["message"].as_str().unwrap().contains("starts/02"));
        assert!(each[0]["message"].is_null() && each[2]["status"] == "solved");
    }
}

#[test]
fn starts_with_mumps_have_processes_and_the_time_is_that_of_all() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let pair = problem("pair");
    let arguments = ["solve", &pair, "--starts", "2", "-o", "out", "--set"];
    let mumps = r#"control.solver.linear_solver="mumps""#;
    let (status, _, err) = run(path, &[&arguments[..], &[mumps]].concat());
    assert_eq!(status, 0, "{err}");
    let summary = read(path.join("out/summary.json"));
    assert_eq!(summary["starts"]["run_in"], "processes");
    let trunk = problem("elephant_trunk");
    let arguments = [
        "solve",
        &trunk,
        "--starts",
        "900",
        "--max-seconds",
        "2",
        "-o",
        "long",
    ];
    let (_, out, err) = run(path, &arguments);
    let summary = read(path.join("long/summary.json"));
    let each = summary["starts"]["each"].as_array().unwrap();
    let ended = |word: &str| each.iter().filter(|one| one["status"] == word).count();
    assert_eq!(each.len(), 900, "{out} {err}");
    assert!(
        ended("not_started") > 0 && ended("not_started") < 900,
        "{out}"
    );
}

#[test]
fn starts_that_all_fail_say_so_and_keep_the_closest() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let pair = problem("pair");
    let arguments = ["solve", &pair, "--starts", "3", "-o", "out"];
    let (status, out, _) = run(path, &[&arguments[..], &["--max-iterations", "3"]].concat());
    assert_eq!(status, 1, "{out}");
    assert!(
        out.starts_with("not solved: 0 of 3 starts solved, 0 distinct optima"),
        "{out}"
    );
    let summary = read(path.join("out/summary.json"));
    assert_eq!(summary["status"], "iteration_limit");
    let starts = &summary["starts"];
    let infeasibility = |one: &Value| one["infeasibility"].as_f64().unwrap();
    let best = starts["best"].as_u64().unwrap();
    for one in starts["each"].as_array().unwrap() {
        assert_eq!(one["status"], "iteration_limit");
        assert!(one["optimum"].is_null());
        let is_closer = infeasibility(one) < infeasibility(&summary);
        assert!(!is_closer, "start {best} against {one}");
    }
}

#[test]
fn starts_that_make_no_sense_are_refused() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let [pair, constant] = ["pair", "pair_constant"].map(problem);
    let unknown = "control.solver.ipopt={\"mu_strategi\":\"adaptive\"}";
    let cases: [(&[&str], &[&str]); 4] = [
        (
            &["solve", &pair, "--starts", "0"],
            &["--starts", "from 1 to 999"],
        ),
        (
            &["solve", &constant, "--starts", "2"],
            &["--starts", "asks to simulate"],
        ),
        (
            &[
                "solve",
                &pair,
                "--starts",
                "2",
                "--set",
                "control.intervals=0",
            ],
            &["control.intervals", "1 interval or more"],
        ),
        (
            &["solve", &pair, "--starts", "2", "--set", unknown],
            &[
                "start ",
                "control.solver.ipopt",
                "did you mean mu_strategy?",
            ],
        ),
    ];
    for (arguments, words) in cases {
        let (status, out, err) = run(path, arguments);
        // Ipopt tells of an option that it does not know by itself.
        let told = out
            .lines()
            .filter(|line| !line.starts_with("Tried to set Option"));
        assert_eq!((status, told.count()), (2, 0), "{arguments:?}: {err}");
        for word in words {
            assert!(err.contains(word), "{arguments:?}: no {word:?} in {err}");
        }
    }
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_all_starts_and_keeps_the_best() {
    use std::os::unix::process::CommandExt;
    use std::process::{Command, Stdio};
    use std::time::Duration;
    let folder = tempdir().unwrap();
    let path = folder.path();
    let trunk = problem("elephant_trunk");
    let cores = std::thread::available_parallelism().unwrap().get();
    let starts = (cores + 3).to_string();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("proboscis"))
        .current_dir(path)
        .args([
            "solve",
            &trunk,
            "--starts",
            &starts,
            "-o",
            "out",
            "--set",
            "control.intervals=1000",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .process_group(0)
        .spawn_listening()
        .unwrap();
    // The folder of a start is made when its first iterate is told.
    while !path.join("out/starts/01").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        std::thread::sleep(Duration::from_millis(5));
    }
    // As a terminal does: to the whole group.
    crate::common::signals::interrupt_group(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let summary = read(path.join("out/summary.json"));
    assert_eq!(summary["status"], "interrupted");
    let each = summary["starts"]["each"].as_array().unwrap();
    let ended = |word: &str| each.iter().filter(|one| one["status"] == word).count();
    assert_eq!(each.len(), cores + 3);
    assert!(
        ended("interrupted") >= 1 && ended("not_started") >= 1,
        "{each:?}"
    );
    // None of them is left.
    assert!(!crate::common::signals::group_runs(&child));
}

#[test]
fn optima_that_are_held_come_before_those_of_less_objective() {
    let [held, better_held] = [2.0, 1.0].map(|objective| Rank::of_optimum(objective, true));
    let left = Rank::of_optimum(0.1, false);
    let [near, far] = [1e-3, 1.0].map(|violation| Rank::of_end(Some(violation)));
    let none = Rank::of_end(None);
    let mut all = [none, far, left, held, near, better_held];
    all.sort_by(Rank::compare);
    assert_eq!(all, [better_held, held, left, near, far, none]);
    assert!(far.has_point() && !none.has_point());
}
