//! Problems and schemas that are kept beside the program.

use crate::runs::{read, run, workshop};
use proboscis::files::read_problem;
use proboscis::model::system::Fidelity;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Returns true if a kept problem has finite elements, whose derivatives are too many for differences.
fn has_elements(name: &str) -> bool {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems");
    let system = read_problem(&path.join(name), &[]).unwrap().system;
    let muscles = system.muscles.iter();
    let mut fidelities = muscles.map(|muscle| muscle.fidelity);
    !system.solids.is_empty() || fidelities.any(|fidelity| fidelity != Fidelity::Lumped)
}

#[test]
fn every_kept_problem_has_right_derivatives() {
    let folder = workshop();
    for entry in fs::read_dir(folder.path().join("problems")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if path.is_dir() || name.contains("schema") || has_elements(&name) {
            continue;
        }
        let mut arguments = vec!["check", path.to_str().unwrap()];
        if fs::read_to_string(&path).unwrap().contains("\"control\":") {
            // All intervals are alike, and differences take as many evaluations as there are variables.
            arguments.extend(["--set", "control.intervals=3"]);
        }
        let (status, out, err) = run(folder.path(), &arguments);
        assert_eq!(status, 0, "{name}: {out}{err}");
        let (status, out, err) = run(folder.path(), &["inspect", path.to_str().unwrap()]);
        assert!(
            status == 0 && out.contains("muscle electroelasticity"),
            "{name}: {out}{err}"
        );
    }
}

#[test]
fn a_new_trunk_can_be_solved_and_is_not_overwritten() {
    let folder = workshop();
    let arguments = ["new", "trunk", "--segments", "2", "mine"];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{err}");
    assert_eq!(out.lines().count(), 5);
    let (status, _, err) = run(folder.path(), &arguments);
    assert!(status == 2 && err.contains("exists already"), "{err}");
    let (status, ..) = run(folder.path(), &["solve", "mine/problem.json"]);
    assert_eq!(status, 0);
    let (status, out, _) = run(folder.path(), &["expand", "mine/scene.json"]);
    assert!(status == 0 && out.contains("\"segment2\"") && !out.contains("\"chain\""));
}

#[test]
fn new_trunks_of_many_segments_can_be_solved() {
    let folder = workshop();
    for segments in ["12", "20"] {
        let place = format!("trunk{segments}");
        let (status, _, err) = run(
            folder.path(),
            &["new", "trunk", "--segments", segments, &place],
        );
        assert_eq!(status, 0, "{err}");
        let (status, out, err) = run(
            folder.path(),
            &["solve", &format!("{place}/problem.json"), "--no-report"],
        );
        assert_eq!(status, 0, "{out}{err}");
    }
}

#[test]
fn kept_schemas_are_those_of_the_program() {
    let folder = workshop();
    for file in ["scene", "problem"] {
        let (_, out, _) = run(folder.path(), &["schema", file]);
        let kept = read(folder.path().join(format!("problems/{file}.schema.json")));
        assert_eq!(serde_json::from_str::<Value>(&out).unwrap(), kept);
    }
}
