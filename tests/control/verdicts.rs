//! What an optimum is worth: guesses that change nothing that is asked, violations that are numbers, voltages that hold.

use proboscis::control::problem::{Control, Duration, Guess, Task};
use proboscis::control::{Boundary, Initial, Solved, guess};
use proboscis::math::random::Random;
use proboscis::model::{Coordinates, System};
use proboscis::nlp::Bounds;
use proboscis::run::{
    Allowed, Cause, Request, Shown, Told, integrate, optimise, run, solution_file, solved,
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
        input: input.to_owned(),
        set: set.iter().map(|&change| change.to_owned()).collect(),
        output: Some(output.to_owned()),
        ..request()
    };
    run(&request).unwrap()
}

/// A command without a problem.
fn request() -> Request {
    Request {
        command: "proboscis solve".to_owned(),
        input: PathBuf::new(),
        set: Vec::new(),
        output: None,
        max_seconds: None,
        max_iterations: None,
        wanted: None,
        progress: Shown::Never,
    }
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
    let simulated = integrate(Path::new("problem"), &loaded.system, &task, |_, _| {
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

/// A problem of trust: one that misled its user.
fn trust(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/trust/{name}.json"))
}

/// Greatest way of a joint in a solution, and how far a simulation of its file under its voltages is beside it at its
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
    let found = integrate(&again, &loaded.system, &task, |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let motion = solved(&found.model, &found.history, None);
    let (mut way, mut apart) = (0.0_f64, 0.0_f64);
    for (j, joint) in loaded.system.joints.iter().enumerate() {
        let optimal = rows(&solution["configuration"]["joints"][&joint.name]);
        way = way.max(optimal.windows(2).map(|w| (w[1] - w[0]).abs()).sum());
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
    let answer = told(&trunk, &["control.intervals=3"], folder.path());
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
            .any(|line| line.as_str().unwrap().contains(&note))
    );
    let deviation = &summary["resimulation"]["deviation"]["angle"];
    assert!(deviation.as_f64().unwrap() < 1e-6, "{summary}");
}

#[test]
fn an_optimum_on_another_root_of_a_step_is_no_solution() {
    // The optimum of the problem's own grid alone, without a finer one.
    let (system, control) = control("elephant_trunk_effort", &["control.intervals=3".to_owned()]);
    let found = optimise(
        Path::new("trunk"),
        &system,
        &control,
        None,
        Allowed::default(),
        &mut |_| ControlFlow::Continue(()),
    );
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
        let request = Request {
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
            .any(|note| note.starts_with("the intervals are long"));
        assert_eq!(warned, error > 0.05, "{answer:?}");
    }
    println!("{solved} solved, {refined} of them on finer grids, {refused} refused");
    assert!(solved >= 7 && refined >= 1, "{solved} {refined} {refused}");
}

#[test]
fn an_end_that_cannot_be_kept_is_told_or_refused() {
    let folder = tempdir().unwrap();
    let refused = |name: &str| {
        let request = Request {
            input: trust(name),
            set: vec!["control.hold=\"required\"".to_owned()],
            output: Some(folder.path().join("none")),
            ..request()
        };
        let error = run(&request).unwrap_err();
        assert_eq!(error.exit_status(), 2);
        assert!(!folder.path().join("none").exists());
        error.to_string()
    };
    let beyond = refused("07_hold_beyond_bounds");
    let line = "control.goal.hold.muscle1: a hold of 4000 V is beyond the bounds 0 V to 3000 V";
    assert!(beyond.ends_with(line), "{beyond}");
    // Without the word it is solved, with one line; a hold that leads into pull-in ends early.
    let answer = told(&trust("07_hold_beyond_bounds"), &[], folder.path());
    assert!(answer.is_solved, "{answer:?}");
    let lines = answer
        .notes
        .iter()
        .filter(|note| note.starts_with("the goal cannot be kept: "));
    let lines: Vec<_> = lines.collect();
    assert!(
        lines.len() == 1
            && lines[0].contains("beyond the bounds")
            && lines[0].contains("ends early")
    );
    // Of an unstable and a stable equilibrium under the same voltages the goal is the one that stays.
    let answer = told(
        &trust("08_unstable_ends_solved"),
        &["control.hold=\"required\""],
        folder.path(),
    );
    assert!(answer.is_solved, "{answer:?}");
    let drift = &read(&folder.path().join("summary.json"))["resimulation"]["drift"]["angle"];
    assert!(drift.as_f64().unwrap() < 1e-3, "{drift}");

    // Voltages that hold a stable goal are no matter; a goal without any cannot be promised.
    let pair = kept("pair");
    let required = "control.hold=\"required\"";
    let stays = told(&pair, &[required], folder.path());
    assert!(
        stays.is_solved && stays.notes.iter().all(|note| !note.contains("kept")),
        "{stays:?}"
    );
    let nothing = Request {
        input: pair.clone(),
        set: vec![
            required.to_owned(),
            "control.goal={\"joint_angles\":{\"joint1\":0.1}}".to_owned(),
        ],
        ..request()
    };
    let error = run(&nothing).unwrap_err();
    assert!(
        error.to_string().contains("names no voltages that hold it"),
        "{error}"
    );
    assert_eq!(error.exit_status(), 2);

    // A hold that is within its bounds and leads elsewhere is seen after the solve.
    let zero = "control.goal.hold={\"muscle1\":0}";
    let leaves = told(
        &trust("07_hold_beyond_bounds"),
        &[zero, required],
        folder.path(),
    );
    assert!(
        !leaves.is_solved && leaves.result.contains("not held"),
        "{leaves:?}"
    );
    assert_eq!(
        read(&folder.path().join("summary.json"))["status"],
        "not_held"
    );
    // Nothing that is written goes by in silence.
    let ignored = Request {
        input: pair,
        set: vec![
            "control.goal={\"joint_angles\":{\"joint1\":0.1},\"hold\":{\"muscle1\":1}}".to_owned(),
        ],
        ..request()
    };
    let error = run(&ignored).unwrap_err().to_string();
    assert!(
        error.contains("control.goal.hold: ") && error.contains("\"markers\" only"),
        "{error}"
    );
}
