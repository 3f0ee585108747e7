//! Ends that are held, and those that cannot be.

use crate::verdicts::{control, kept, output_of, read, request, trust};
use proboscis::app::{CommandInput, run};
use proboscis::control::BoundaryConditions;
use proboscis::files::solution;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

#[test]
fn a_solution_holds_its_goal_after_its_end() {
    let folder = tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    assert!(output_of(&kept("pair"), &[], &place("p")).is_solved);
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
        let answer = output_of(&kept("pair_constant"), &set, &place(name));
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
    let (model, _) = BoundaryConditions::resolve(&system, &asked, 10.0).unwrap();
    assert_eq!(solution::read(&old, &model).unwrap().hold, None);
    let held = solution::read(&path, &model).unwrap().hold.unwrap();
    assert_eq!(held.iter().copied().fold(0.0, f64::max), 1700.0);
}

#[test]
fn an_end_that_cannot_be_kept_is_told_or_refused() {
    let folder = tempdir().unwrap();
    let refused = |name: &str| {
        let request = CommandInput {
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
    let answer = output_of(&trust("07_hold_beyond_bounds"), &[], folder.path());
    assert!(answer.is_solved, "{answer:?}");
    let lines = answer
        .notes
        .iter()
        .filter(|note| note.starts_with("warning: the goal cannot be kept: "));
    let lines: Vec<_> = lines.collect();
    assert!(
        lines.len() == 1
            && lines[0].contains("beyond the bounds")
            && lines[0].contains("ends early")
    );
    // Of an unstable and a stable equilibrium under the same voltages the goal is the one that stays.
    let answer = output_of(
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
    let stays = output_of(&pair, &[required], folder.path());
    assert!(
        stays.is_solved && stays.notes.iter().all(|note| !note.contains("kept")),
        "{stays:?}"
    );
    let nothing = CommandInput {
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
    let leaves = output_of(
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
    // The reason is given once, and not as a warning too.
    let reasons = leaves.notes.iter().filter(|note| note.contains("kept"));
    assert_eq!(reasons.count(), 1, "{leaves:?}");
    // Nothing that is written goes by in silence.
    let ignored = CommandInput {
        input: pair,
        set: vec![
            "control.goal={\"joint_angles\":{\"joint1\":0.1},\"hold\":{\"muscle1\":1}}".to_owned(),
        ],
        ..request()
    };
    let error = run(&ignored).unwrap_err().to_string();
    assert!(
        error.contains("control.goal.hold: ")
            && error.contains("\"markers\" or \"orientations\" only"),
        "{error}"
    );
}
