//! Wrong input: one message with place, found and expected, and nothing written.

use crate::runs::{run, workshop};
use serde_json::json;
use std::fs;
use std::path::Path;

/// `solve problems/pair.json` with overrides is refused with these words, and nothing is written.
///
/// The scene is written out, so that overrides can reach its bodies, joints and muscles.
fn refused(overrides: &[&str], words: &[&str]) {
    let folder = workshop();
    let scene = "problems/scenes/pair.json";
    let (_, expanded, _) = run(folder.path(), &["expand", scene]);
    fs::write(folder.path().join(scene), expanded).unwrap();
    let mut arguments = vec!["solve", "problems/pair.json"];
    for change in overrides {
        arguments.extend(["--set", change]);
    }
    refused_run(folder.path(), &arguments, words);
}

pub(crate) fn refused_run(folder: &Path, arguments: &[&str], words: &[&str]) {
    let (status, out, err) = run(folder, arguments);
    assert_eq!(status, 2, "{arguments:?}: {out}{err}");
    assert_eq!(out, "", "{arguments:?}");
    let first = err.lines().next().unwrap();
    for word in words {
        assert!(first.contains(word), "{arguments:?}: no {word:?} in {err}");
    }
    assert!(!err.contains("panicked"), "{err}");
    assert!(!folder.join("results").exists(), "{arguments:?}");
}

#[test]
fn wrong_files_are_refused() {
    let folder = workshop();
    let path = folder.path();
    fs::write(path.join("broken.json"), "{ \"scene\": ").unwrap();
    refused_run(path, &["solve", "broken.json"], &["broken.json", "JSON"]);
    refused_run(
        path,
        &["solve", "nowhere.json"],
        &["nowhere.json", "no readable file"],
    );
    fs::write(path.join("infinite.json"), "{ \"scene\": 1e999 }").unwrap();
    refused_run(path, &["solve", "infinite.json"], &["scene", "not finite"]);
    let problem = fs::read_to_string(path.join("problems/pair.json")).unwrap();
    fs::write(
        path.join("problems/nan.json"),
        problem.replace("\"0.2 s\"", "NaN"),
    )
    .unwrap();
    refused_run(path, &["solve", "problems/nan.json"], &["nan.json", "JSON"]);
}

#[test]
fn wrong_words_are_refused_with_a_suggestion() {
    refused(
        &["control.intervls=3"],
        &["intervls", "did you mean \"intervals\""],
    );
    refused(
        &["control.goal={\"rest_at_voltages\":{\"muscl2\":\"1 kV\"}}"],
        &[
            "control.goal.rest_at_voltages.muscl2",
            "did you mean \"muscle2\"",
        ],
    );
    refused(
        &["scene.muscles[0].from.body=segmnt1"],
        &["muscles[0].from.body", "did you mean \"segment1\""],
    );
    refused(&["nonsense"], &["command line", "path=value"]);
}

#[test]
fn an_option_that_ipopt_does_not_know_is_refused() {
    let folder = workshop();
    let option = "control.solver.ipopt={\"mu_strategi\":\"adaptive\"}";
    let arguments = ["solve", "problems/pair.json", "--set", option];
    // Ipopt says a line of its own on standard output.
    let (status, _, err) = run(folder.path(), &arguments);
    assert_eq!(status, 2);
    assert!(
        err.contains("problems/pair.json: control.solver.ipopt"),
        "{err}"
    );
    assert!(err.contains("did you mean mu_strategy?"), "{err}");
    assert!(!folder.path().join("results").exists());
}

#[test]
fn wrong_quantities_are_refused() {
    refused(
        &["control.duration=0.2 mm"],
        &["control.duration", "a length", "a time"],
    );
    refused(
        &["scene.bodies[0].mass=-30 g"],
        &["bodies[0].mass", "positive"],
    );
    refused(
        &["control.intervals=0"],
        &["control.intervals", "1 interval or more"],
    );
    refused(&["control.duration=0 s"], &["control.duration", "positive"]);
    refused(
        &["control.voltage_bounds=[\"3 kV\",\"0 V\"]"],
        &["control.voltage_bounds[1]", "lower bound"],
    );
}

#[test]
fn scenes_that_do_not_hold_together_are_refused() {
    refused(&["scene.joints=[]"], &["segment1", "joint"]);
    refused(
        &["scene.muscles[0].to={\"body\":\"segment1\",\"at\":[\"15 mm\",\"-20 mm\",\"0 mm\"]}"],
        &["muscles[0]"],
    );
    refused(
        &["scene.muscles[1].name=muscle1"],
        &["muscles[1].name", "a second time"],
    );
    refused(
        &["control.goal={\"markers\":{\"tip\":[0,0.05,0]}}"],
        &["control.goal", "3 final conditions", "1 degrees of freedom"],
    );
}

#[test]
fn wrong_solutions_are_refused() {
    let folder = workshop();
    let path = folder.path();
    let guess = "control.guess={\"solution\":\"earlier.json\"}";
    let refused_solution = |text: String, words: &[&str]| {
        fs::write(path.join("earlier.json"), text).unwrap();
        refused_run(
            path,
            &["solve", "problems/pair.json", "--set", guess],
            words,
        );
    };
    let voltages = json!({ "muscle1": [0.0], "muscle2": [0.0] });
    refused_solution("{".into(), &["earlier.json", "a mistake in the JSON text"]);
    refused_solution(
        "{\"scene\": \"x\"}".into(),
        &["earlier.json", "no key \"time\""],
    );
    refused_solution(
        json!({ "time": [0, 1], "joints": { "hip": [0, 0] }, "voltages": voltages }).to_string(),
        &["another scene", "no joint \"hip\""],
    );
    refused_solution(
        json!({ "time": [0, 1], "joints": { "joint1": [0, 0] }, "voltages": { "muscle1": [0] } })
            .to_string(),
        &["another scene", "muscle2"],
    );
    refused_solution(
        json!({ "time": [0, 1], "joints": { "joint1": [0, null] }, "voltages": voltages })
            .to_string(),
        &["joints.joint1[1]", "null"],
    );
    refused_solution(
        json!({ "time": [0, 1], "joints": { "joint1": [0] }, "voltages": voltages }).to_string(),
        &["joints.joint1: found 1 values, expected 2, one for each instant"],
    );
}
