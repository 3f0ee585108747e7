//! What an optimum is worth: guesses that change nothing that is asked, violations that are numbers, voltages that hold.

use proboscis::control::problem::{Control, Duration, Guess, Task};
use proboscis::control::{Boundary, Initial, Solved, guess};
use proboscis::model::{Coordinates, System};
use proboscis::nlp::Bounds;
use proboscis::run::{
    Allowed, Request, Shown, Told, integrate, optimise, run, solution_file, solved,
};
use proboscis::scene::read_problem;
use serde_json::Value;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

/// A kept problem.
fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"))
}

/// Runs a problem with changes into a folder.
fn told(input: &Path, set: &[&str], output: &Path) -> Told {
    let request = Request {
        command: "proboscis solve".to_owned(),
        input: input.to_owned(),
        set: set.iter().map(|&change| change.to_owned()).collect(),
        output: Some(output.to_owned()),
        max_seconds: None,
        max_iterations: None,
        wanted: None,
        progress: Shown::Never,
    };
    run(&request).unwrap()
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// System and control problem of a kept file.
fn control(name: &str, set: &[String]) -> (System, Control) {
    let loaded = read_problem(&kept(name), set).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a control problem")
    };
    (loaded.system, *control)
}

/// The optimum of a control problem.
fn optimum(system: &System, control: &Control) -> Solved {
    let found = optimise(
        Path::new("problem"),
        system,
        control,
        None,
        Allowed::default(),
        &mut |_| ControlFlow::Continue(()),
    );
    let found = found.unwrap();
    assert!(found.solution.status.is_solved());
    found.motion
}

/// The guess that an earlier motion gives.
fn start(system: &System, control: &Control, earlier: &Solved) -> (Initial, Vec<Vec<f64>>) {
    let h = control.duration.first() / control.intervals as f64;
    let (model, boundary) = Boundary::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, Some(earlier));
    let joints = solved(&model, &initial.history, None).joints;
    (initial, joints)
}

/// Value at a part s of a motion in time, on the lines between its instants.
fn between(rows: &[Vec<f64>], s: f64, j: usize) -> f64 {
    let place = s * (rows.len() - 1) as f64;
    let k = (place as usize).min(rows.len() - 2);
    rows[k][j] + (place - k as f64) * (rows[k + 1][j] - rows[k][j])
}

#[test]
fn a_guess_changes_nothing_that_is_asked() {
    // Optima of 200 ms, of a free time and of 90 ms in other coordinates, and a simulation of 500 ms.
    let (system, given) = control("pair", &[]);
    let free = Duration::Free {
        min: 60.0,
        max: 300.0,
        guess: 70.0,
    };
    let redundant = Some(Coordinates::Redundant);
    let changed = |duration, coordinates, intervals| Control {
        duration,
        coordinates,
        intervals,
        objective: proboscis::control::problem::Objective {
            effort: 1.0,
            rate: 0.0,
            duration: 0.0,
        },
        guess: Guess::Interpolate,
        ..given.clone()
    };
    let loaded = read_problem(
        &kept("pair_constant"),
        &["simulate.duration=0.5".to_owned()],
    );
    let loaded = loaded.unwrap();
    let Task::Simulate(task) = loaded.task else {
        panic!("a simulation")
    };
    let simulated = integrate(Path::new("problem"), &loaded.system, &task, |_| {
        ControlFlow::Continue(())
    });
    let simulated = simulated.unwrap();
    let earlier = [
        optimum(&system, &given),
        optimum(&system, &changed(free, None, 20)),
        optimum(&system, &changed(Duration::Given(90.0), redundant, 15)),
        solved(&simulated.model, &simulated.history, None),
    ];
    let lengths = earlier.each_ref().map(|e| e.times[e.intervals()]);
    assert!(
        lengths[1] > 60.5 && (lengths[1] - 70.0).abs() > 1.0 && (lengths[3] - 500.0).abs() < 1e-9,
        "{lengths:?}"
    );
    for (before, length) in earlier.iter().zip(lengths) {
        for (duration, expected) in [
            (Duration::Given(400.0), 400.0),
            (Duration::Given(200.0), 200.0),
            (free, length.clamp(60.0, 300.0)),
        ] {
            for coordinates in [None, redundant] {
                for intervals in [20, 13] {
                    let asked = changed(duration, coordinates, intervals);
                    let (initial, joints) = start(&system, &asked, before);
                    let end = initial.history.times[intervals];
                    let place = format!("{length} ms, {duration:?}, {coordinates:?}, {intervals}");
                    assert!(
                        (initial.h * intervals as f64 - expected).abs() < 1e-9,
                        "{place}"
                    );
                    assert!((end - expected).abs() < 1e-9, "{place}");
                    let is_other = (expected - length).abs() > 1e-6 * expected;
                    assert_eq!(initial.stretched.is_some(), is_other, "{place}");
                    // The same way, faster or slower.
                    let at = |k: usize| between(&before.joints, k as f64 / intervals as f64, 0);
                    let apart = (0..=intervals).map(|k| (joints[k][0] - at(k)).abs());
                    let way = before.joints.iter().map(|row| row[0].abs());
                    let [apart, way] = [apart.fold(0.0, f64::max), way.fold(0.0, f64::max)];
                    assert!(way > 0.05 && apart < 0.1 * way, "{place}: {apart} of {way}");
                }
            }
        }
    }
}

#[test]
fn a_duration_that_is_given_stays_and_the_stretched_guess_is_told() {
    let folder = tempdir().unwrap();
    let [first, second] = ["p", "q"].map(|name| folder.path().join(name));
    let pair = kept("pair");
    assert!(told(&pair, &[], &first).is_solved);
    let solution = first.join("solution.json");
    let from = format!(
        "control.guess={{\"solution\":{:?}}}",
        solution.display().to_string()
    );
    let answer = told(&pair, &["control.duration=0.4 s", &from], &second);
    assert!(answer.is_solved, "{answer:?}");
    let line = "the guess lasts 0.2 s; it was stretched in time to 0.4 s";
    assert!(answer.notes.iter().any(|note| note == line), "{answer:?}");
    let summary = read(&second.join("summary.json"));
    assert_eq!(summary["duration"], 0.4);
    assert!(summary["notes"].as_array().unwrap().contains(&line.into()));
    assert!(summary["iterations"].as_u64().unwrap() > 3, "{summary}");
    let time = &read(&second.join("solution.json"))["time"];
    assert_eq!(time.as_array().unwrap().last().unwrap(), 0.4);
    // One of the same length is taken as it is, in silence.
    let again = told(&pair, &[&from], &second);
    assert!(
        again.notes.iter().all(|note| !note.contains("stretched")),
        "{again:?}"
    );
    assert!(
        read(&second.join("summary.json"))["iterations"]
            .as_u64()
            .unwrap()
            <= 2
    );
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

#[test]
fn a_solution_holds_its_goal_after_its_end() {
    let folder = tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    assert!(told(&kept("pair"), &[], &place("p")).is_solved);
    let path = place("p").join("solution.json");
    let mut solution = read(&path);
    assert_eq!(solution["hold"]["muscle2"], 1700.0);
    assert_eq!(solution["hold"]["muscle1"], 0.0);
    let last = solution["voltages"]["muscle2"]
        .as_array()
        .unwrap()
        .last()
        .unwrap();
    let last = last.as_f64().unwrap();
    assert!((last - 1700.0).abs() > 50.0, "{last}");

    let after = |name: &str, solution: &Path| {
        let voltages = format!(
            "simulate.voltages={{\"solution\":{:?}}}",
            solution.display().to_string()
        );
        let set = ["simulate.duration=1 s", "simulate.step=10 ms", &voltages];
        let answer = told(&kept("pair_constant"), &set, &place(name));
        assert!(answer.is_solved, "{answer:?}");
        let motion = read(&place(name).join("solution.json"));
        let joint = motion["configuration"]["joints"]["joint1"]
            .as_array()
            .unwrap();
        let joint: Vec<f64> = joint.iter().map(|v| v.as_f64().unwrap()).collect();
        let goal = joint[20];
        let drift = joint[20..].iter().map(|v| (v - goal).abs());
        (goal, drift.fold(0.0, f64::max), answer.notes.join("\n"))
    };
    let (goal, drift, notes) = after("held", &path);
    assert!(goal.abs() > 0.05 && drift < 1e-6, "{goal} {drift}");
    assert!(
        notes.contains("after 0.2 s the voltages that hold the goal of"),
        "{notes}"
    );

    // Files of before have no such entry.
    solution.as_object_mut().unwrap().remove("hold");
    let old = place("old.json");
    fs::write(&old, solution.to_string()).unwrap();
    let (_, drift, notes) = after("left", &old);
    assert!(drift > 1e-3, "{drift}");
    assert!(
        notes.contains("after 0.2 s the voltages of the last interval are held"),
        "{notes}"
    );
    let set = [format!(
        "control.guess={{\"solution\":{:?}}}",
        old.display().to_string()
    )];
    let (system, asked) = control("pair", &set);
    let (model, _) = Boundary::resolve(&system, &asked, 10.0).unwrap();
    assert_eq!(solution_file::read(&old, &model).unwrap().hold, None);
    let held = solution_file::read(&path, &model).unwrap().hold.unwrap();
    assert_eq!(held.iter().copied().fold(0.0, f64::max), 1700.0);
}
