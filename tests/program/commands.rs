//! The program as its users meet it: files in, one line and files out, an exit status.

use crate::common::signals::Listening as _;
use crate::refusals::refused_run;
use crate::runs::{read, run, workshop};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

pub(crate) fn summary(folder: &Path, results: &str) -> Value {
    read(folder.join(results).join("summary.json"))
}

#[test]
fn a_goal_beyond_pull_in_has_no_answer() {
    for state in ["start", "goal"] {
        let folder = workshop();
        let change = format!("control.{state}={{\"rest_at_voltages\":{{\"muscle2\":\"9 kV\"}}}}");
        let bounds = "control.voltage_bounds=[\"0 V\",\"20 kV\"]";
        let problem = "problems/pair.json";
        let arguments = ["solve", problem, "--set", &change, "--set", bounds];
        let (status, _, err) = run(folder.path(), &arguments);
        // The input is right.
        assert_eq!(status, 1, "{err}");
        for word in [
            problem,
            &format!("control.{state}"),
            "no equilibrium",
            "pull-in",
            "stretch of muscle2",
        ] {
            assert!(err.contains(word), "{word}: {err}");
        }
        let summary = summary(folder.path(), "results/pair");
        assert_eq!(summary["status"], "no_equilibrium");
    }
}

#[test]
fn an_unreachable_goal_is_named_and_the_files_are_kept() {
    let folder = workshop();
    let goal = "control.goal={\"markers\":{\"tip\":[\"0 mm\",\"400 mm\",\"0 mm\"]}}";
    let arguments = [
        "solve",
        "problems/elephant_trunk_effort.json",
        "--set",
        goal,
        "-o",
        "far",
    ];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 1, "{out}{err}");
    assert!(out.starts_with("not solved (infeasible)") && out.lines().count() == 1);
    // The trunk is 300 mm long: 100 mm are missing.
    assert!(
        err.contains("goal y of marker tip: violated by 100.0 mm"),
        "{err}"
    );
    assert!(err.contains("tip comes within 100 mm of its goal"), "{err}");
    let summary = summary(folder.path(), "far");
    assert_eq!(summary["status"], "infeasible");
    assert_eq!(summary["violations"][0]["row"], "goal y of marker tip");
    for file in [
        "solution.json",
        "controls.csv",
        "trajectory.csv",
        "report.html",
    ] {
        assert!(folder.path().join("far").join(file).is_file(), "{file}");
    }
}

#[test]
fn a_solved_problem_leaves_what_is_promised() {
    let folder = workshop();
    let (status, out, err) = run(folder.path(), &["solve", "problems/pair.json"]);
    let lines: Vec<_> = err.lines().collect();
    assert!(
        lines.len() == 1 && lines[0].starts_with("warning: the intervals are long"),
        "{err}"
    );
    assert_eq!(status, 0);
    assert!(
        out.starts_with("solved: objective 0.046446126, ") && out.lines().count() == 1,
        "{out}"
    );
    assert!(out.ends_with("results/pair\n"), "{out}");
    let summary = summary(folder.path(), "results/pair");
    let keys = [
        "command",
        "input",
        "status",
        "objective",
        "iterations",
        "variables",
        "constraints",
        "jacobian_nonzeros",
        "hessian_nonzeros",
        "coordinates",
        "seconds",
        "effects",
        "versions",
        "interval_microseconds",
        "resimulation",
    ];
    for key in keys {
        assert!(!summary[key].is_null(), "{key} of {summary}");
    }
    let seconds = [
        "total",
        "setup",
        "solver",
        "objective",
        "gradient",
        "constraints",
        "jacobian",
        "hessian",
    ];
    for key in seconds {
        assert!(summary["seconds"][key].is_f64(), "{key} of {summary}");
    }
    assert_eq!(summary["status"], "solved");
    assert_eq!(summary["input"], "problems/pair.json");
    assert_eq!(summary["command"], "proboscis solve problems/pair.json");
    // Source: tests/reference/pair.json.
    assert!((summary["objective"].as_f64().unwrap() - 0.046_446_126_6).abs() < 1e-8);
    // The steps of a simulation are converged to 1e-9.
    let deviation = &summary["resimulation"]["deviation"];
    assert!(deviation["angle"].as_f64().unwrap() < 1e-8, "{summary}");
    assert!(summary["resimulation"]["drift"]["angle"].as_f64().unwrap() < 1e-7);
    for file in [
        "solution.json",
        "trajectory.csv",
        "controls.csv",
        "configuration.svg",
        "voltages.svg",
        "tip_path.svg",
        "joint_angles.svg",
        "report.html",
    ] {
        let path = folder.path().join("results/pair").join(file);
        assert!(path.metadata().is_ok_and(|m| m.len() > 100), "{file}");
    }
    energies_are_those_of_the_table(folder.path(), "results/pair");
    let controls = fs::read_to_string(folder.path().join("results/pair/controls.csv")).unwrap();
    assert_eq!(controls.lines().count(), 2 + 20);
}

/// Sums in `summary.json`, in J, are the last row of `trajectory.csv`, in N mm, and that of both muscles.
fn energies_are_those_of_the_table(folder: &Path, results: &str) {
    let summary = summary(folder, results);
    let csv = fs::read_to_string(folder.join(results).join("trajectory.csv")).unwrap();
    let names: Vec<_> = csv.lines().nth(1).unwrap().split(',').collect();
    let values: Vec<_> = csv.lines().next_back().unwrap().split(',').collect();
    let last = |name: &str| {
        let column = names.iter().position(|other| other == &name);
        column.map(|c| values[c].parse::<f64>().unwrap())
    };
    for quantity in ["electrical_energy", "mechanical_work"] {
        let total = last(&format!("{quantity} [N mm]")).unwrap();
        let of = |muscle: &str| last(&format!("{muscle}_{quantity} [N mm]")).unwrap_or(0.0);
        let told = summary["energies"][quantity].as_f64().unwrap();
        assert!(told > 1e-6 && (told - total / 1e3).abs() < 1e-12 * told);
        let sum = of("muscle1") + of("muscle2");
        assert!((total - sum).abs() < 1e-12 * total, "{total} {sum}");
    }
}

#[test]
fn simulations_and_equilibria_answer() {
    let folder = workshop();
    let path = folder.path();
    let (status, out, err) = run(path, &["simulate", "problems/pair_constant.json"]);
    assert_eq!(status, 0, "{err}");
    assert!(
        out.starts_with("simulated: 200 steps, 1 s of motion"),
        "{out}"
    );
    assert_eq!(summary(path, "results/pair_constant")["steps"], 200);
    energies_are_those_of_the_table(path, "results/pair_constant");
    let scene = "problems/scenes/pair.json";
    for file in ["problems/pair.json", scene] {
        let voltages = ["--voltages", "muscle2=1.7kV", "-o", "equilibrium"];
        let arguments = [&["equilibrium", file][..], &voltages].concat();
        let (status, out, _) = run(path, &arguments);
        assert_eq!(status, 0);
        let reference =
            read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/pair.json"));
        let angle = reference["equilibrium"]["theta_rad"][0].as_f64().unwrap();
        assert!(out.contains(&format!("{angle:.9}")), "{out}");
        assert!(out.contains("\nstable equilibrium"), "{out}");
    }
    let beyond = [
        "equilibrium",
        scene,
        "--voltages",
        "muscle2=17kV",
        "-o",
        "beyond",
    ];
    let (status, out, err) = run(path, &beyond);
    assert_eq!((status, out.trim()), (1, "no equilibrium"));
    assert!(err.contains("no equilibrium was found"), "{err}");
    let (status, _, err) = run(path, &["equilibrium", "problems/pair.json"]);
    assert!(status == 2 && err.contains("--voltages"), "{err}");
    let wrong = ["equilibrium", scene, "--voltages", "muscl2=1kV"];
    let (status, _, err) = run(path, &wrong);
    assert!(
        status == 2 && err.contains("did you mean \"muscle2\""),
        "{err}"
    );
}

/// A small version of the clamped stack.
const COARSE: &str = "scene.solids[0].box.elements=[1,1,8]";

#[test]
fn blocks_leave_what_is_promised() {
    let folder = workshop();
    let path = folder.path();
    let problem = "problems/clamped_stack_step.json";
    let short = "simulate.duration=2 ms";
    let arguments = ["simulate", problem, "--set", COARSE, "--set", short];
    let (status, out, err) = run(path, &arguments);
    assert_eq!(status, 0, "{out}");
    assert!(
        err.contains("the steps of 0.5 ms leave an estimated error"),
        "{err}"
    );
    // Two markers moved to their nearest nodes.
    assert_eq!(err.lines().count(), 3, "{err}");
    let results = path.join("results/clamped_stack_step");
    for file in [
        "trajectory.pvd",
        "fields/0000.vtu",
        "fields/0004.vtu",
        "configuration.svg",
        "charge.svg",
        "energy.svg",
        "tip_path.svg",
        "report.html",
    ] {
        assert!(results.join(file).is_file(), "{file}");
    }
    let told = summary(path, "results/clamped_stack_step");
    let block = json!({ "nodes": 36, "elements": 8, "unknowns": 88, "potentials": 16 });
    assert_eq!(told["blocks"]["block"], block);
    assert_eq!(told["instants_written"], 5);
    assert!(told["charges"]["block.stack"].as_f64().unwrap() > 1e-7);
    let effects = told["effects"].as_array().unwrap();
    let electric = effects
        .iter()
        .find(|e| e["name"] == "block electroelasticity");
    assert_eq!(electric.unwrap()["equations"], 16);

    let problem = "problems/clamped_stack.json";
    let arguments = ["equilibrium", problem, "--set", COARSE, "-o", "rest"];
    let (status, out, err) = run(path, &arguments);
    // Two markers moved to their nearest nodes.
    assert_eq!((status, err.lines().count()), (0, 2), "{err}");
    assert!(out.contains("stable equilibrium"), "{out}");
    let (status, inspected, _) = run(path, &["inspect", problem, "--set", COARSE]);
    assert!(status == 0 && inspected.contains("potentials of an interval"));
    for file in ["trajectory.pvd", "fields/0000.vtu", "configuration.svg"] {
        assert!(path.join("rest").join(file).is_file(), "{file}");
    }
    assert!(!path.join("rest/fields/0001.vtu").exists());
}

#[test]
fn an_equilibrium_that_is_lost_keeps_its_last_state() {
    let folder = workshop();
    let path = folder.path();
    let high = "block.stack=900kV";
    let file = "problems/clamped_stack.json";
    let arguments = ["equilibrium", file, "--set", COARSE, "--voltages", high];
    let arguments = [&arguments[..], &["-o", "lost"]].concat();
    let (status, out, err) = run(path, &arguments);
    assert_eq!((status, out.trim()), (1, "no equilibrium"), "{err}");
    // Two markers moved to their nearest nodes, and why there is none.
    assert_eq!(err.lines().count(), 3);
    assert!(err.contains("pull-in at ") && err.contains("lost"), "{err}");
    let told = summary(path, "lost");
    assert_eq!(told["status"], "pull_in");
    let reached = told["voltages"]["block.stack"].as_f64().unwrap();
    let fraction = told["fraction"].as_f64().unwrap();
    assert!(fraction > 0.1 && fraction < 0.99, "{fraction}");
    assert!((reached - 9e5 * fraction).abs() < 1e-3);
    // Layers are 10 mm thick.
    assert!(told["largest_nominal_field"].as_f64().unwrap() > 0.99 * reached / 0.01);
    for file in ["trajectory.pvd", "fields/0000.vtu", "configuration.svg"] {
        assert!(path.join("lost").join(file).is_file(), "{file}");
    }

    // A motion that ends early is kept as far as it went.
    let file = "problems/clamped_stack_step.json";
    let high = "simulate.voltages={\"block.stack\":\"1200 kV\"}";
    let arguments = ["simulate", file, "--set", COARSE, "--set", high];
    let (status, _, err) = run(path, &[&arguments[..], &["-o", "early"]].concat());
    assert_eq!(status, 1, "{err}");
    assert_eq!(summary(path, "early")["status"], "step_failed");
    assert!(path.join("early/trajectory.pvd").is_file());
    assert!(path.join("early/report.html").is_file());
}

#[test]
fn a_block_that_floats_is_refused() {
    let folder = workshop();
    let loose = "scene.solids[0].fixed=[{\"face\":\"z_min\",\"directions\":[\"z\"]}]";
    let file = "problems/clamped_stack.json";
    let arguments = ["equilibrium", file, "--set", COARSE, "--set", loose];
    refused_run(
        folder.path(),
        &[&arguments[..], &["-o", "results"]].concat(),
        &[file, "block is not held", "zero-energy mode"],
    );
}

#[cfg(unix)]
#[test]
fn a_folder_that_cannot_be_made_is_told() {
    let folder = workshop();
    fs::write(folder.path().join("file"), "").unwrap();
    let arguments = ["solve", "problems/pair.json", "-o", "file/results"];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!((status, out.as_str()), (1, ""));
    assert!(err.starts_with("error: cannot write file/results"), "{err}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_files() {
    let folder = workshop();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("proboscis"))
        .current_dir(folder.path())
        .args([
            "solve",
            "problems/elephant_trunk_effort.json",
            "-o",
            "stopped",
        ])
        .args(["--set", "control.intervals=1500"])
        .stdout(std::process::Stdio::piped())
        .spawn_listening()
        .unwrap();
    // The folder is made when the first iterate is told.
    while !folder.path().join("stopped").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        std::thread::sleep(Duration::from_millis(2));
    }
    crate::common::signals::interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(summary(folder.path(), "stopped")["status"], "interrupted");
    assert!(folder.path().join("stopped/solution.json").is_file());
}

/// The command in a summary, typed into a shell, makes the same result again.
#[test]
fn the_command_that_is_told_repeats_the_run() {
    let folder = workshop();
    let goal = "control.goal={\"rest_at_voltages\": {\"muscle2\": \"1.1 kV\"}}";
    let out = "results of 'today'";
    let arguments = ["solve", "problems/pair.json", "--set", goal, "-o", out];
    let (status, _, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{err}");
    let first = summary(folder.path(), out);
    let solution = || fs::read(folder.path().join(out).join("solution.json")).unwrap();
    let kept = solution();
    assert!(first["objective"].as_f64().unwrap() > 1e-3);
    fs::remove_dir_all(folder.path().join(out)).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_proboscis"));
    let command = format!(
        "PATH={}:$PATH; {}",
        program.parent().unwrap().display(),
        first["command"].as_str().unwrap()
    );
    let again = Command::new("sh")
        .args(["-c", &command])
        .current_dir(folder.path())
        .output();
    assert!(again.unwrap().status.success(), "{command}");
    assert_eq!(summary(folder.path(), out)["command"], first["command"]);
    assert!(solution() == kept);
}
