//! An earlier solution on another mesh, or of lumped muscles: the guess is the motion under its voltages, and it is told.

use crate::common::cases::rest_to_rest;
use crate::common::timed::in_steps;
use crate::common::trunk;
use crate::guesses::{optimum, start};
use crate::verdicts::{control, kept, output_of, read};
use proboscis::control::problem::{Afterwards, Control, Guess};
use proboscis::control::{BoundaryConditions, guess};
use proboscis::model::System;
use proboscis::model::system::{Discretisation, ElementKind, Fidelity};
use serde_json::Value;
use tempfile::tempdir;

/// Changes that make the bending block short of time and coarse.
fn changes(elements: [usize; 3]) -> [String; 4] {
    [
        format!("scene.solids[0].box.elements={elements:?}"),
        "control.duration=0.2 s".to_owned(),
        "control.intervals=8".to_owned(),
        "control.goal={\"markers\":{\"tip\":[null,0,\"2 mm\"]},\"rest\":\"markers\",\"hold\":{\"beam.lower\":\"8 kV\"}}".to_owned(),
    ]
}

/// Coordinates of the motion of a system from the start of a problem under given voltages.
fn under(system: &System, control: &Control, ends: &[f64], rows: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let rows: Vec<_> = rows.iter().chain(rows.last()).cloned().collect();
    let control = Control {
        guess: Guess::Simulate(in_steps(ends, &rows, Afterwards::OfLastInterval)),
        ..control.clone()
    };
    let h = control.duration.first() / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    initial.discrete.z
}

#[test]
fn a_solution_on_another_mesh_lends_its_voltages() {
    let (system, problem) = control("fe_bending_control", &changes([5, 1, 2]));
    let before = optimum(&system, &problem);
    assert!(before.voltages.iter().flatten().any(|v| v.abs() > 1e3));
    assert_eq!(before.meshes["beam"].len(), 6 * 2 * 3);
    let (same, _) = start(&system, &problem, &before);
    assert!(!same.carried.simulated);
    assert_eq!(same.discrete.z, before.z);
    // As many coordinates, other nodes; then more coordinates, and as many nodes at other places.
    for (elements, width) in [([3, 1, 4], 0), ([7, 1, 2], 0), ([5, 1, 2], 1)] {
        let size = format!("scene.solids[0].box.size[1]=\"{} mm\"", 4 + width);
        let set = [&changes(elements)[..], &[size]].concat();
        let (system, problem) = control("fe_bending_control", &set);
        let (initial, _) = start(&system, &problem, &before);
        let count = initial.discrete.z[0].len();
        assert_eq!(count == before.z[0].len(), elements != [7, 1, 2]);
        assert!(initial.carried.simulated && initial.costates.is_none());
        let expected = under(&system, &problem, &before.times[1..], &before.voltages);
        let way = (0..count).map(|i| (expected[0][i] - expected[8][i]).abs());
        assert!(way.fold(0.0, f64::max) > 0.1);
        assert_eq!(initial.discrete.z, expected);
    }
}

#[test]
fn a_file_of_a_coarse_mesh_starts_a_finer_one() {
    let folder = tempdir().unwrap();
    let problem = kept("fe_bending_control");
    let solve = |name: &str, elements, guess: &str| -> Value {
        let mut set = changes(elements).to_vec();
        set.push(format!("control.guess={guess}"));
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        let answer = output_of(&problem, &set, &folder.path().join(name));
        assert!(answer.is_solved, "{answer:?}");
        read(&folder.path().join(name).join("summary.json"))
    };
    let is_told = |summary: &Value| {
        let notes = summary["notes"].as_array().unwrap();
        let words = "the guess is the motion under its voltages";
        notes
            .iter()
            .any(|note| note["text"].as_str().unwrap().contains(words))
    };
    let number = |summary: &Value, key: &str| summary[key].as_f64().unwrap();
    let coarse = folder.path().join("coarse/solution.json");
    let coarse = format!("{{\"solution\":{:?}}}", coarse.display().to_string());
    let interpolated = solve("coarse", [3, 1, 2], "\"interpolate\"");
    let again = solve("again", [3, 1, 2], &coarse);
    assert!(!is_told(&interpolated) && !is_told(&again));
    assert!(number(&again, "iterations") <= 2.0, "{again}");
    let warm = solve("warm", [6, 1, 2], &coarse);
    assert!(is_told(&warm), "{warm}");
}

#[test]
fn a_solution_of_lumped_muscles_starts_finite_elements() {
    let mut system = trunk(1);
    let problem = rest_to_rest(1, 10, 100.0);
    let before = optimum(&system, &problem);
    assert!(before.meshes.is_empty());
    for muscle in &mut system.muscles {
        muscle.material.lame_lambda = Some(0.4);
        muscle.fidelity = Fidelity::FiniteElements(Discretisation {
            first_side: None,
            elements: [1, 1, 2],
            layers: 2,
            element: ElementKind::Hex8,
        });
    }
    let (initial, _) = start(&system, &problem, &before);
    assert!(initial.carried.simulated);
    let expected = under(&system, &problem, &before.times[1..], &before.voltages);
    let ends = [0, 10].map(|k: usize| expected[k][0]);
    assert!((ends[1] - ends[0]).abs() > 0.01, "{ends:?}");
    assert_eq!(initial.discrete.z, expected);
}
