//! Verdicts on optima: guesses that change no condition of the problem, violations that are numbers, voltages that hold.

use proboscis::app::{CommandInput, CommandOutput, PageWanted, ProgressDisplay, run};
use proboscis::control::problem::{Control, Task};
use proboscis::files::read_problem;
use proboscis::math::Random;
use proboscis::model::System;
use proboscis::nlp::Bounds;
use proboscis::report::Figures;
use proboscis::workflow::{Cause, SolveLimits, integrate, optimise, solved};
use serde_json::Value;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

/// A kept problem.
pub(crate) fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"))
}

/// Runs a problem with changes into a folder.
pub(crate) fn output_of(input: &Path, set: &[&str], output: &Path) -> CommandOutput {
    let request = CommandInput {
        input: input.to_owned(),
        set: set.iter().map(|&change| change.to_owned()).collect(),
        output: Some(output.to_owned()),
        ..request()
    };
    run(&request).unwrap()
}

/// A command without a problem.
pub(crate) fn request() -> CommandInput {
    CommandInput {
        command: "proboscis solve".to_owned(),
        input: PathBuf::new(),
        set: Vec::new(),
        output: None,
        max_seconds: None,
        max_iterations: None,
        wanted: None,
        from: None,
        figures: Figures::default(),
        progress: ProgressDisplay::Never,
        page: PageWanted::Written,
        once: false,
    }
}

pub(crate) fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// System and control problem of a kept file.
pub(crate) fn control(name: &str, set: &[String]) -> (System, Control) {
    let loaded = read_problem(&kept(name), set).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a control problem")
    };
    (loaded.system, *control)
}

#[test]
fn what_has_no_value_violates_its_bounds_without_limit() {
    let bounds = Bounds {
        lower: vec![0.0, f64::NEG_INFINITY],
        upper: vec![0.0, 1.0],
    };
    assert_eq!(bounds.violation(&[0.0, -5.0]), 0.0);
    assert_eq!(bounds.violation(&[-0.25, 1.5]), 0.5);
    for nothing in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(bounds.violation(&[0.0, nothing]), f64::INFINITY);
        assert_eq!(bounds.violation(&[nothing, 0.0]), f64::INFINITY);
    }
}

/// A problem of trust: one that misled its user.
pub(crate) fn trust(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/trust/{name}.json"))
}

/// Greatest way of a joint in a solution or in the simulation, whichever is shorter, and how far a simulation of its file under its voltages is beside it at its
/// instants, with so many steps for an interval; infinite where that ends early. In rad.
fn beside(folder: &Path, problem: &Value, steps: usize) -> (f64, f64) {
    let solution = read(&folder.join("solution.json"));
    let rows = |value: &Value| -> Vec<f64> {
        let list = value.as_array().unwrap().iter();
        list.map(|v| v.as_f64().unwrap()).collect()
    };
    let time = rows(&solution["time"]);
    let n = time.len() - 1;
    let mut asked = problem.clone();
    let start = asked["control"]["start"].clone();
    asked.as_object_mut().unwrap().remove("control");
    asked["simulate"] = serde_json::json!({
        "duration": time[n],
        "step": time[n] / (n * steps) as f64 * (1.0 + 1e-12),
        "start": start,
        "voltages": { "solution": folder.join("solution.json").display().to_string() },
    });
    let again = folder.join("again.json");
    fs::write(&again, asked.to_string()).unwrap();
    let loaded = read_problem(&again, &[]).unwrap();
    let Task::Simulate(task) = loaded.task else {
        panic!("a simulation")
    };
    let found = integrate(&loaded.system, &task, |_, _| ControlFlow::Continue(())).unwrap();
    let motion = solved(&found.model, &found.discrete, None);
    let (mut way, mut apart) = (0.0_f64, 0.0_f64);
    for (j, joint) in loaded.system.joints.iter().enumerate() {
        let optimal = rows(&solution["configuration"]["joints"][&joint.name]);
        let of = |angles: &[f64]| -> f64 { angles.windows(2).map(|w| (w[1] - w[0]).abs()).sum() };
        let simulated = motion.joints.iter().step_by(steps).map(|row| row[j]);
        let simulated: Vec<f64> = simulated.collect();
        way = way.max(of(&optimal).min(of(&simulated)));
        for (k, angle) in optimal.iter().enumerate() {
            let at = motion.joints.get(steps * k);
            apart = apart.max(at.map_or(f64::INFINITY, |row| (row[j] - angle).abs()));
        }
    }
    (way, apart)
}

#[test]
fn a_grid_that_resolves_no_motion_is_refined() {
    let folder = tempdir().unwrap();
    let trunk = kept("elephant_trunk_effort");
    let answer = output_of(&trunk, &["control.intervals=3"], folder.path());
    assert!(answer.is_solved, "{answer:?}");
    let summary = read(&folder.path().join("summary.json"));
    let intervals = summary["intervals"].as_u64().unwrap();
    assert!(intervals > 3 && intervals.is_multiple_of(3), "{summary}");
    let note = format!("solved again on {intervals} intervals");
    assert!(
        answer.notes.iter().any(|line| line.contains(&note)),
        "{answer:?}"
    );
    let kept_notes = summary["notes"].as_array().unwrap();
    assert!(
        kept_notes
            .iter()
            .any(|line| line["text"].as_str().unwrap().contains(&note))
    );
    let deviation = &summary["resimulation"]["deviation"]["angle"];
    assert!(deviation.as_f64().unwrap() < 1e-6, "{summary}");
}

#[test]
fn an_optimum_on_another_root_of_a_step_is_no_solution() {
    // The optimum of the problem's own grid alone, without a finer one.
    let (system, control) = control("elephant_trunk_effort", &["control.intervals=3".to_owned()]);
    let found = optimise(&system, &control, None, SolveLimits::default(), &mut |_| {
        ControlFlow::Continue(())
    });
    let found = found.unwrap();
    assert!(found.solution.status.is_solved() && !found.is_solved());
    assert_eq!(found.word(), "not_reproduced");
    let Some(Cause::Root {
        interval, distance, ..
    }) = found.cause()
    else {
        panic!("{:?}", found.cause())
    };
    assert!(*interval < control.intervals && distance.length > 1e-3);
}

#[test]
fn what_is_called_solved_is_reproduced_with_finer_steps() {
    let mut random = Random::new(9);
    let folder = tempdir().unwrap();
    let (mut solved, mut refined, mut refused) = (0, 0, 0);
    for case in 0..14 {
        let mut draw = |lower: f64, upper: f64| random.between(lower, upper);
        let segments = 1 + case % 3;
        let intervals = [3, 4, 6, 10, 16][case % 5];
        let gravity = if case % 2 == 0 { 0.0 } else { draw(-3.0, 3.0) };
        let goal: serde_json::Map<String, Value> = (0..2 * segments)
            .filter(|m| m % 2 == 1)
            .map(|m| (format!("muscle{}", m + 1), draw(800.0, 2200.0).into()))
            .collect();
        let problem = serde_json::json!({
            "scene": {
                "name": "random trunk",
                "gravity": [0, gravity, 0],
                "materials": { "elastomer": {
                    "density": draw(900.0, 1200.0),
                    "shear_modulus": draw(6e4, 2e5),
                    "lame_lambda": draw(2e5, 8e5),
                    "relative_permittivity": draw(2.5, 4.0),
                    "viscosity": draw(100.0, 1500.0),
                } },
                "chain": {
                    "segments": segments, "length": draw(0.03, 0.07), "radius": draw(0.01, 0.025),
                    "mass": draw(0.01, 0.05), "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
                    "muscles": {
                        "material": "elastomer", "arm": draw(0.012, 0.018), "rest_length": 0.03 + draw(0.0, 0.01),
                        "cross_section": [0.01, 0.01], "layer_thickness": 5e-5,
                    },
                    "tip_marker": "tip",
                },
            },
            "control": {
                "duration": draw(0.1, 0.8), "intervals": intervals,
                "start": { "rest_at_voltages": {} }, "goal": { "rest_at_voltages": goal },
                "voltage_bounds": [0, 3000], "objective": { "effort": 1.0 },
                "solver": { "max_iterations": 200 },
            },
        });
        let place = folder.path().join(format!("{case}"));
        fs::create_dir(&place).unwrap();
        let file = place.join("problem.json");
        fs::write(&file, problem.to_string()).unwrap();
        let request = CommandInput {
            output: Some(place.clone()),
            input: file,
            ..request()
        };
        // A goal that is no equilibrium is refused before.
        let Ok(answer) = run(&request) else { continue };
        let summary = read(&place.join("summary.json"));
        if !answer.is_solved {
            refused += 1;
            println!("{case}: {}", answer.result);
            continue;
        }
        solved += 1;
        let is_refined = summary["intervals"].as_u64().unwrap() as usize > intervals;
        refined += usize::from(is_refined);
        let error = summary["resimulation"]["error"].as_f64().unwrap();
        let (way, own) = beside(&place, &problem, 1);
        let (_, apart) = beside(&place, &problem, 8);
        println!(
            "{case}: {segments} segments, {intervals} intervals: told {error:.3}, {:.3}, own {own:.1e}",
            apart / way
        );
        assert!(way > 0.02 && own < 1e-4, "{case}: {own}");
        // The estimate, from half and a quarter of the step, is one of this very error.
        assert!(error <= 0.25 && apart / way < 1.6 * error + 1e-3, "{case}");
        let warned = answer
            .notes
            .iter()
            .any(|note| note.starts_with("warning: the intervals are long"));
        assert_eq!(warned, error > 0.05, "{answer:?}");
    }
    println!("{solved} solved, {refined} of them on finer grids, {refused} refused");
    assert!(solved >= 7 && refined >= 1, "{solved} {refined} {refused}");
}

/// On six intervals the optimum zigzags, and its own path is much longer than that of the motion.
#[test]
fn an_optimum_that_zigzags_is_measured_by_the_motion() {
    let (name, folder) = ("11_coarse_zigzag_126", tempdir().unwrap());
    let answer = output_of(&trust(name), &[], folder.path());
    assert!(answer.is_solved, "{answer:?}");
    let again = |note: &String| note.contains("on 6 intervals: the intervals do not resolve");
    assert!(answer.notes.iter().any(again), "{answer:?}");
    let (way, apart) = beside(folder.path(), &read(&trust(name)), 16);
    assert!(way > 1e-3 && apart < 0.26 * way, "{apart} of {way}");
}
