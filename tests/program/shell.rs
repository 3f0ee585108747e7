//! The program among others: standard input, a summary on standard output, completions, manual pages, robots to begin with.

use crate::commands::summary;
use crate::runs::{read, run, run_with_input, workshop};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The kept pair as one text, with its scene inside.
fn whole_pair(folder: &Path) -> String {
    let mut problem = read(folder.join("problems/pair.json"));
    problem["scene"] = read(folder.join("problems/scenes/pair.json"));
    problem.to_string()
}

#[test]
fn a_problem_comes_through_standard_input() {
    let folder = workshop();
    let (status, ..) = run_with_input(
        folder.path(),
        &["solve", "-", "--quiet"],
        &whole_pair(folder.path()),
    );
    assert_eq!(status, 0);
    let (status, ..) = run(folder.path(), &["solve", "problems/pair.json", "--quiet"]);
    assert_eq!(status, 0);
    let [piped, of_file] = ["stdin", "pair"].map(|name| {
        let path = folder.path().join("results").join(name);
        fs::read(path.join("solution.json")).unwrap()
    });
    assert!(piped.len() > 1000 && piped == of_file);
    // Every start has the same problem.
    let starts = ["solve", "-", "--starts", "3", "--quiet", "-o", "several"];
    let (status, ..) = run_with_input(folder.path(), &starts, &whole_pair(folder.path()));
    assert_eq!(status, 0);
    let starts = read(folder.path().join("several/summary.json"));
    let each = starts["starts"]["each"].as_array().map_or(0, Vec::len);
    assert_eq!(each, 3, "{starts}");
}

#[test]
fn mistakes_of_standard_input_have_their_places() {
    let folder = workshop();
    let cases = [
        (vec!["solve", "-"], "{", "-: "),
        (vec!["inspect", "-"], r#"{ "scene": 3 }"#, "-: scene"),
        (
            vec!["solve", "-", "--starts", "2", "--processes"],
            "pair",
            "standard input",
        ),
    ];
    for (arguments, text, words) in cases {
        let text = match text {
            "pair" => whole_pair(folder.path()),
            text => text.to_owned(),
        };
        let (status, _, err) = run_with_input(folder.path(), &arguments, &text);
        assert!(status == 2 && err.contains(words), "{err}");
        assert!(!folder.path().join("results").exists());
    }
}

#[test]
fn a_summary_may_be_all_that_is_printed() {
    let folder = workshop();
    let commands: [&[&str]; 3] = [
        &["solve", "problems/pair.json", "--json"],
        &["simulate", "problems/pair_constant.json", "--json"],
        &["equilibrium", "problems/clamped_stack.json", "--json"],
    ];
    for (arguments, status) in commands.iter().zip(["solved", "simulated", "at_rest"]) {
        let (code, out, err) = run(folder.path(), arguments);
        let summary: Value =
            serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}{err}"));
        assert_eq!(
            (code, summary["status"].as_str()),
            (0, Some(status)),
            "{err}"
        );
    }
    // A solve that ends early has a summary too.
    let early = [
        "solve",
        "problems/pair.json",
        "--json",
        "--max-iterations",
        "2",
    ];
    let (code, out, _) = run(folder.path(), &early);
    let summary: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (code, summary["status"].as_str()),
        (1, Some("iteration_limit"))
    );
}

#[test]
fn shells_and_manuals_know_every_command() {
    let folder = workshop();
    for shell in ["bash", "zsh", "fish"] {
        let (status, out, _) = run(folder.path(), &["completions", shell]);
        for word in [
            "equilibrium",
            "max-iterations",
            "estimate-error",
            "satellite",
        ] {
            assert!(status == 0 && out.contains(word), "{shell}: {word}");
        }
    }
    let (status, out, err) = run(folder.path(), &["man", "pages/man1"]);
    assert!(status == 0 && out.lines().count() >= 16, "{out}{err}");
    let pages: Vec<&str> = out.lines().collect();
    for page in [
        "proboscis.1",
        "proboscis-solve.1",
        "proboscis-new-gripper.1",
    ] {
        let path = format!("pages/man1/{page}");
        assert!(pages.contains(&path.as_str()), "{out}");
        let text = fs::read_to_string(folder.path().join(path)).unwrap();
        assert!(text.contains(".TH") && text.contains("SYNOPSIS"));
    }
}

#[test]
fn robots_to_begin_with_are_solved() {
    let folder = workshop();
    let others = [
        ("arm", "solved"),
        ("finger", "solved"),
        ("gripper", "solved"),
        ("satellite", "simulated"),
    ];
    let trunks = ["1", "2", "3", "4", "6", "8"].map(|segments| (segments, "solved"));
    for (robot, status) in others.into_iter().chain(trunks) {
        let words = match robot.parse::<usize>() {
            Ok(_) => &["new", "trunk", robot, "--segments", robot][..],
            Err(_) => &["new", robot, robot],
        };
        let (code, out, err) = run(folder.path(), words);
        assert!(code == 0 && out.lines().count() == 5, "{err}");
        let problem = format!("{robot}/problem.json");
        let (code, out, err) = run(folder.path(), &["solve", &problem, "--json", "-o", robot]);
        let summary: Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {err}"));
        assert_eq!(
            (code, summary["status"].as_str()),
            (0, Some(status)),
            "{robot}: {err}"
        );
        // Those to begin with are solved without a warning.
        assert_eq!(err, "", "{robot}");
    }
}

#[test]
fn limits_of_the_command_line_stop_a_solve_with_its_files() {
    let folder = workshop();
    let many = [
        "solve",
        "problems/elephant_trunk_effort.json",
        "--set",
        "control.intervals=400",
    ];
    for (limit, value, word) in [
        ("--max-seconds", "0.05", "time_limit"),
        ("--max-iterations", "2", "iteration_limit"),
    ] {
        let arguments = [&many[..], &[limit, value, "-o", word]].concat();
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 1, "{out}{err}");
        if out.is_empty() {
            // On a busy machine the time may be over before the first iterate, which leaves nothing to write.
            assert!(
                word == "time_limit" && err.contains("before the first result (time limit)"),
                "{err}"
            );
            continue;
        }
        assert!(out.starts_with("not solved ("), "{out}");
        assert_eq!(summary(folder.path(), word)["status"], word);
        assert!(folder.path().join(word).join("solution.json").is_file());
    }
}
