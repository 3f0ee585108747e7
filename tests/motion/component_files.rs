//! Springs and tendons in files.

use crate::components::column;
use proboscis::control::problem::Task;
use proboscis::files::{read_problem, read_system};
use proboscis::model::system::System;
use proboscis::workflow::integrate;
use std::ops::ControlFlow;
use std::path::Path;

const SCENE: &str = r#"{
  "name": "tied", "bodies": [ { "name": "b", "mass": "10 g", "sphere": { "radius": "5 mm" }, "position": [0.03, 0, 0] } ],
  "joints": [ { "name": "j", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "b", "at": [0.03, 0, 0] } ],
  "springs": [ { "name": "s", "from": { "body": "ground", "at": [0, 0, 0] }, "to": { "body": "b", "at": ["30 mm", 0, 0] }, "stiffness": "400 N/m", "damping": "0.5 N s/m", "rest_length": "25 mm" } ],
  "tendons": [ { "name": "t", "through": [ { "body": "ground", "at": [0, 0, 0] }, { "body": "b", "at": ["30 mm", 0, 0] } ], "stiffness": "2 N/mm" } ]
}"#;

pub(crate) fn read(text: &str) -> Result<System, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    std::fs::write(&path, text).unwrap();
    read_system(&path, &[]).map_err(|error| error.to_string())
}

#[test]
fn files_say_springs_and_tendons() {
    let components = read(SCENE).unwrap().components;
    let (spring, tendon) = (&components.springs[0], &components.tendons[0]);
    assert_eq!(spring.stiffness, Some(0.4));
    assert_eq!(spring.damping, Some(0.5));
    assert!((spring.rest_length - 25.0).abs() < 1e-12);
    assert!((tendon.stiffness - 2.0).abs() < 1e-12);
    // The length of the path where none is written.
    assert!((tendon.rest_length - 30.0).abs() < 1e-12);
    for (from, to, told) in [
        (
            r#""stiffness": "400 N/m", "damping": "0.5 N s/m","#,
            "",
            "\"stiffness\" or \"damping\"",
        ),
        (r#""stiffness": "400 N/m","#, "", "springs[0].rest_length"),
        ("\"400 N/m\"", "\"-400 N/m\"", "zero or a positive"),
        ("\"400 N/m\"", "\"400 N\"", "a stiffness"),
        ("\"25 mm\"", "\"-25 mm\"", "zero or a positive length"),
        (r#""name": "t""#, r#""name": "s""#, "tendons[0].name"),
        (
            r#"[ { "body": "ground", "at": [0, 0, 0] }, {"#,
            "[ {",
            "2 points or more",
        ),
        ("\"2 N/mm\"", "0", "tendons[0].stiffness"),
        (
            r#""at": [0, 0, 0] }, { "body": "b", "at": ["30 mm""#,
            r#""at": [0, 0, 0] }, { "body": "b", "at": ["0 mm""#,
            "through[1].at",
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let message = read(&SCENE.replace(from, to)).unwrap_err();
        assert!(message.contains(told), "{from}: {message}");
    }
}

#[test]
fn the_finger_with_a_tendon_bends() {
    let problem = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/tendon_finger.json");
    let loaded = read_problem(&problem, &["simulate.duration=100 ms".to_owned()]).unwrap();
    let Task::Simulate(task) = &loaded.task else {
        panic!("a simulation")
    };
    let run = integrate(&loaded.system, task, |_, _| ControlFlow::Continue(()));
    let run = run.unwrap();
    assert_eq!(run.failure, None);
    let of = |name: &str| column(&run.model, &run.discrete, name);
    let (tension, bend) = (of("flexor_tension"), of("knuckle3"));
    assert!(tension.iter().all(|&t| t >= 0.0) && tension[5] > 0.1);
    assert!(bend[bend.len() - 1] > 0.3, "{bend:?}");
}
