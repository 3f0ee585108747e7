//! Runs that are stopped and go on from what they have kept.

use crate::commands::summary;
use crate::runs::{problem, read, run, run_with_input, workshop};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use std::{fs, thread};

/// The state of a motion, and all rows of its table.
fn kept(folder: &Path) -> (Value, String) {
    let solution = read(folder.join("solution.json"));
    let table = fs::read_to_string(folder.join("trajectory.csv")).unwrap();
    let (_, rows) = table.split_once('\n').unwrap();
    (solution["state"].clone(), rows.to_owned())
}

fn go(folder: &Path, words: &[&str]) -> (i32, String, String) {
    run(folder, words)
}

#[test]
fn a_shorter_simulation_goes_on_to_the_same_files() {
    let folder = workshop();
    let folder = folder.path();
    for (name, short, long, more) in [
        ("elephant_trunk_constant", "0.1 s", "0.3 s", &[][..]),
        ("fe_trunk", "30 ms", "60 ms", &[]),
        (
            "elephant_trunk_constant",
            "0.1 s",
            "0.3 s",
            &["--set", "simulate.integrator={\"galerkin\":2}"],
        ),
    ] {
        let path = problem(name);
        let of = |duration: &str| format!("simulate.duration={duration}");
        let (short, long) = (of(short), of(long));
        let shared = [&["simulate", &path][..], more].concat();
        let with = |rest: &[&str]| {
            let (status, said, notes) = go(folder, &[&shared[..], rest].concat());
            assert_eq!(status, 0, "{said}{notes}");
        };
        with(&["--set", &long, "-o", "whole"]);
        with(&["--set", &short, "-o", "part"]);
        with(&["--set", &long, "-o", "on", "--from", "part"]);
        let [whole, on] = ["whole", "on"].map(|name| kept(&folder.join(name)));
        let [part, _] = ["part", "on"].map(|name| kept(&folder.join(name)));
        assert_ne!(part.1, whole.1);
        assert!(whole == on, "{name}");
        // Once more, in place.
        with(&["--set", &long, "-o", "part", "--from", "part"]);
        assert!(whole == kept(&folder.join("part")), "{name}");
        let steps = |name: &str| summary(folder, name)["newton_iterations"].clone();
        assert_eq!(steps("whole"), steps("on"));
    }
}

/// A motion that no machine ends before it is stopped.
const FAR: &str = "simulate.duration=400 s";

#[test]
fn a_stopped_simulation_says_how_it_goes_on() {
    let folder = workshop();
    let folder = folder.path();
    let set = r#"simulate.voltages={"muscle1":{"sine":{"amplitude":"1 kV","period":"1 s"}}}"#;
    let words = [
        "simulate",
        "problems/elephant_trunk_constant.json",
        "--set",
        set,
        "--set",
        FAR,
        "-o",
        "out dir",
    ];
    let (status, _, notes) = go(folder, &[&words[..], &["--max-seconds", "0.4"]].concat());
    assert_eq!(status, 1, "{notes}");
    let before = read(folder.join("out dir/summary.json"));
    assert_eq!(before["status"], "time_limit");
    let command = notes
        .lines()
        .find_map(|line| line.strip_prefix("to go on: proboscis "));
    let command = command.unwrap_or_else(|| panic!("{notes}"));
    assert!(
        command.ends_with("-o 'out dir' --from 'out dir'"),
        "{command}"
    );
    // The shell takes it as it stands; a shorter motion is enough here.
    let reached = before["duration"].as_f64().unwrap();
    // A whole number of ms, so that both motions have the same step to the last bit.
    let until = format!(
        "simulate.duration={} ms",
        5.0 * ((reached / 0.005).round() + 20.0)
    );
    let line = format!(
        "'{}' {command} --set '{until}'",
        env!("CARGO_BIN_EXE_proboscis")
    );
    let mut shell = Command::new("sh");
    shell.args(["-c", &line]).current_dir(folder);
    assert!(shell.status().unwrap().success(), "{line}");
    let after = read(folder.join("out dir/summary.json"));
    assert_eq!(after["status"], "simulated");
    let steps = |summary: &Value| summary["steps"].as_u64().unwrap();
    assert_eq!(steps(&after), steps(&before) + 20);
    let whole = [&words[..7], &["whole", "--set", &until]].concat();
    assert_eq!(go(folder, &whole).0, 0);
    assert!(kept(&folder.join("whole")) == kept(&folder.join("out dir")));
}

#[test]
fn a_killed_simulation_goes_on_from_its_last_steps() {
    let folder = workshop();
    let folder = folder.path();
    let words = [
        "simulate",
        "problems/elephant_trunk_constant.json",
        "--set",
        "simulate.step=0.1 ms",
        "--set",
        FAR,
    ];
    let mut child = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .args(words)
        .args(["-o", "out"])
        .current_dir(folder)
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !folder.join("out/unfinished.npz").exists() {
        assert!(child.try_wait().unwrap().is_none(), "too short a run");
        thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!folder.join("out/solution.json").exists());
    let (status, _, notes) = go(
        folder,
        &[
            &words[..],
            &["-o", "out", "--from", "out", "--max-seconds", "2"],
        ]
        .concat(),
    );
    assert_eq!(status, 1, "{notes}");
    assert!(!folder.join("out/unfinished.npz").exists());
    let reached = read(folder.join("out/summary.json"))["steps"]
        .as_u64()
        .unwrap();
    assert!(reached > 100, "{reached}");
    // A beginning of it, without a stop.
    let whole = ["--set", "simulate.duration=10 ms", "-o", "whole"];
    assert_eq!(go(folder, &[&words[..], &whole].concat()).0, 0);
    let whole = kept(&folder.join("whole")).0["z"].clone();
    assert_eq!(whole.as_array().unwrap().len(), 101);
    let continuation = folder.join("out/continuation.npz");
    let continued = proboscis::files::continuation::read(&continuation)
        .unwrap()
        .discrete;
    for (row, expected) in continued.z.iter().zip(whole.as_array().unwrap()).take(100) {
        let expected: Vec<f64> = serde_json::from_value(expected.clone()).unwrap();
        assert_eq!(*row, expected);
    }
}

#[test]
fn a_stopped_solve_goes_on_from_its_point_multipliers_and_barrier() {
    let folder = workshop();
    let folder = folder.path();
    let solve = ["solve", "problems/elephant_trunk_effort.json"];
    assert_eq!(go(folder, &[&solve[..], &["-o", "whole"]].concat()).0, 0);
    let whole = summary(folder, "whole");
    let iterations = |summary: &Value| summary["iterations"].as_u64().unwrap();
    let half = iterations(&whole) * 2 / 3;
    assert!(half > 5, "{half}");
    let limit = half.to_string();
    let (status, _, notes) = go(
        folder,
        &[&solve[..], &["-o", "part", "--max-iterations", &limit]].concat(),
    );
    assert_eq!(status, 1);
    assert!(
        notes.contains(
            "to go on: proboscis solve problems/elephant_trunk_effort.json -o part --from part"
        ),
        "{notes}"
    );
    let kept = read(folder.join("part/solution.json"));
    let barrier = kept["barrier"].as_f64().unwrap();
    assert!(barrier > 0.0 && barrier < 0.1, "{barrier}");
    assert!(kept["costates"]["rows"].is_array());
    let (status, said, notes) = go(
        folder,
        &[&solve[..], &["-o", "on", "--from", "part"]].concat(),
    );
    assert_eq!(status, 0, "{said}{notes}");
    let on = summary(folder, "on");
    let left = iterations(&whole) - half;
    assert!(iterations(&on) <= left + 3, "{left}: {}", on["iterations"]);
    // What a run that was killed has kept is newer than the solution of the run before it.
    let at = |name: &str| folder.join("part").join(name);
    fs::rename(at("solution.json"), at("unfinished.json")).unwrap();
    fs::copy(folder.join("whole/solution.json"), at("solution.json")).unwrap();
    let again = [&solve[..], &["-o", "again", "--from", "part"]].concat();
    assert_eq!(go(folder, &again).0, 0);
    let begun = [&on, &summary(folder, "again")].map(iterations);
    assert!(begun[0] > 2 && begun[0] == begun[1], "{begun:?}");
    let [a, b] = [&whole, &on].map(|s| s["objective"].as_f64().unwrap());
    assert!((a - b).abs() < 1e-7 * a.abs(), "{a} against {b}");
    assert!(
        read(folder.join("on/solution.json"))
            .get("barrier")
            .is_none()
    );
}

#[test]
fn what_nothing_goes_on_from_is_refused_with_one_line() {
    let folder = workshop();
    let folder = folder.path();
    let constant = problem("elephant_trunk_constant");
    let short = ["simulate", &constant, "--set", "simulate.duration=0.1 s"];
    assert_eq!(go(folder, &[&short[..], &["-o", "part"]].concat()).0, 0);
    let gravity = "scene.gravity=[0,-9.81,0]";
    let pair = problem("pair_constant");
    let solve = problem("pair");
    let rest = problem("bending_actuator");
    for (words, expected) in [
        (
            &["simulate", &constant, "--from", "nowhere"][..],
            "nowhere holds no simulation",
        ),
        (
            &["simulate", &constant, "--from", "part", "--set", gravity],
            "scene.gravity is not the same",
        ),
        (
            &[
                "simulate",
                &constant,
                "--from",
                "part",
                "--set",
                "simulate.step=1 ms",
            ],
            "simulate.step is not the same",
        ),
        (
            &["simulate", &pair, "--from", "part"],
            "another problem: scene.",
        ),
        (
            &[
                "simulate",
                &constant,
                "--from",
                "part",
                "--set",
                "simulate.duration=50 ms",
            ],
            "part/continuation.npz has 0.1 s of motion",
        ),
        (
            &[
                "simulate",
                &constant,
                "--from",
                "part",
                "--set",
                "simulate.duration=0.303 s",
            ],
            "choose a simulate.duration of whole steps",
        ),
        (
            &["simulate", &constant, "--from", "part", "--estimate-error"],
            "--from: ",
        ),
        (
            &["solve", &solve, "--from", "nowhere"],
            "nowhere holds no solution.json",
        ),
        (
            &["solve", &solve, "--from", "part"],
            "belongs to another scene",
        ),
        (
            &["solve", &rest, "--from", "part"],
            "an equilibrium, which goes on from nothing",
        ),
    ] {
        let (status, said, error) = go(folder, words);
        assert_eq!(status, 2, "{words:?}: {said}{error}");
        assert!(error.contains(expected), "{words:?}: {error}");
        assert_eq!(error.trim_end().lines().count(), 1, "{error}");
    }
    assert!(!folder.join("results").exists());
    // The problem is the same, a file that it names is not.
    let voltages =
        r#"simulate.voltages={"muscle1":{"csv":{"file":"v.csv","time":"time","values":"v"}}}"#;
    let driven = [
        "simulate",
        "-",
        "--set",
        voltages,
        "--set",
        "simulate.duration=50 ms",
    ];
    let scene = problem("scenes/elephant_trunk");
    let asked =
        format!("{{\"scene\":{scene:?},\"simulate\":{{\"duration\":1,\"step\":\"5 ms\"}}}}");
    let csv = folder.join("v.csv");
    fs::write(&csv, "time [s],v [kV]\n0,1\n1,2\n").unwrap();
    let (status, _, error) =
        run_with_input(folder, &[&driven[..], &["-o", "csv"]].concat(), &asked);
    assert_eq!(status, 0, "{error}");
    fs::write(&csv, "time [s],v [kV]\n0,1\n1,1.5\n").unwrap();
    let on = ["-o", "on", "--from", "csv"];
    let (status, _, error) = run_with_input(folder, &[&driven[..], &on].concat(), &asked);
    assert_eq!(status, 2, "{error}");
    assert!(
        error.contains("a file that it names has changed"),
        "{error}"
    );
    let path = folder.join("part/continuation.npz");
    let bytes = fs::read(&path).unwrap();
    for end in [0, 10, bytes.len() / 2, bytes.len() - 1] {
        fs::write(&path, &bytes[..end]).unwrap();
        let (status, _, error) = go(folder, &["simulate", &constant, "--from", "part"]);
        assert!(
            status == 2 && error.contains("part/continuation.npz: "),
            "{error}"
        );
    }
}
