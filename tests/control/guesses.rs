//! A guess changes nothing that is asked.

use crate::verdicts::{control, kept, output_of, read};
use proboscis::control::problem::{Control, Duration, Guess, Task};
use proboscis::control::{BoundaryConditions, InitialGuess, Solution, guess};
use proboscis::files::read_problem;
use proboscis::model::{Coordinates, System};
use proboscis::workflow::{SolveLimits, integrate, optimise, solved};
use std::ops::ControlFlow;
use tempfile::tempdir;

/// The optimum of a control problem.
pub(crate) fn optimum(system: &System, control: &Control) -> Solution {
    let found = optimise(system, control, None, SolveLimits::default(), &mut |_| {
        ControlFlow::Continue(())
    });
    let found = found.unwrap();
    assert!(found.solution.status.is_solved());
    found.motion
}

/// The guess that an earlier motion gives.
pub(crate) fn start(
    system: &System,
    control: &Control,
    earlier: &Solution,
) -> (InitialGuess, Vec<Vec<f64>>) {
    let h = control.duration.first() / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, Some(earlier));
    let joints = solved(&model, &initial.discrete, None).joints;
    (initial, joints)
}

/// Value at a part s of a motion in time, on the lines between its instants.
pub(crate) fn between(rows: &[Vec<f64>], s: f64, j: usize) -> f64 {
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
            ..Default::default()
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
    let simulated = integrate(&loaded.system, &task, |_, _| ControlFlow::Continue(()));
    let simulated = simulated.unwrap();
    let earlier = [
        optimum(&system, &given),
        optimum(&system, &changed(free, None, 20)),
        optimum(&system, &changed(Duration::Given(90.0), redundant, 15)),
        solved(&simulated.model, &simulated.discrete, None),
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
                    let end = initial.discrete.times[intervals];
                    let place = format!("{length} ms, {duration:?}, {coordinates:?}, {intervals}");
                    assert!(
                        (initial.h * intervals as f64 - expected).abs() < 1e-9,
                        "{place}"
                    );
                    assert!((end - expected).abs() < 1e-9, "{place}");
                    let is_other = (expected - length).abs() > 1e-6 * expected;
                    assert_eq!(initial.carried.stretched.is_some(), is_other, "{place}");
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
    assert!(output_of(&pair, &[], &first).is_solved);
    let solution = first.join("solution.json");
    let from = format!(
        "control.guess={{\"solution\":{:?}}}",
        solution.display().to_string()
    );
    let answer = output_of(&pair, &["control.duration=0.4 s", &from], &second);
    assert!(answer.is_solved, "{answer:?}");
    let line = "the guess lasts 0.2 s; it was stretched in time to 0.4 s";
    assert!(
        answer
            .notes
            .iter()
            .any(|note| *note == format!("note: {line}")),
        "{answer:?}"
    );
    let summary = read(&second.join("summary.json"));
    assert_eq!(summary["duration"], 0.4);
    let note = serde_json::json!({ "severity": "note", "code": "earlier_solution", "text": line });
    assert!(summary["notes"].as_array().unwrap().contains(&note));
    assert!(summary["iterations"].as_u64().unwrap() > 3, "{summary}");
    let time = &read(&second.join("solution.json"))["time"];
    assert_eq!(time.as_array().unwrap().last().unwrap(), 0.4);
    // One of the same length is taken as it is, in silence.
    let again = output_of(&pair, &[&from], &second);
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
