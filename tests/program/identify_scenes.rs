//! Recordings whose scenes are other ones, whose columns stand in the problem, and that measure forces and circuits.

use crate::runs::{read, run, workshop};
use serde_json::{Value, json};
use std::fs;

/// Mass in kg and damping in N s/m of a cart that coasts: the ratio of both is 1.5/s, with a payload of 1 kg it is 1/s.
const MASS: f64 = 2.0;
const DAMPING: f64 = 3.0;

fn scene() -> Value {
    let body = |name: &str, mass: &str| {
        json!({ "name": name, "mass": mass, "position": [0, 0, 0],
                "box": { "size": ["0.1 m", "0.1 m", "0.1 m"] } })
    };
    json!({
        "name": "cart",
        "bodies": [body("cart", "1.5 kg"), body("payload", "1 ug")],
        "joints": [
            { "name": "slide", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart",
              "at": [0, 0, 0], "damping": "2 N s/m" },
            { "name": "tray", "fixed": {}, "parent": "cart", "child": "payload", "at": [0, 0, 0] }
        ]
    })
}

/// A motion from 1 m/s, in closed form, of the cart with a payload in kg.
fn coasting(name: &str, payload: f64) -> Value {
    let rate = DAMPING / (MASS + payload);
    let times: Vec<f64> = (0..=40).map(|k| 0.05 * f64::from(k)).collect();
    let places = times.iter().map(|t| (1.0 - (-rate * t).exp()) / rate);
    let mut recording = json!({
        "name": name,
        "columns": { "time [s]": times, "x [m]": places.collect::<Vec<_>>() },
        "measured": [ { "joint": "slide", "column": "x", "standard_deviation": "0.1 mm" } ],
        "experiment": { "sought_start": "state" }
    });
    if payload > 0.0 {
        recording["set"] = json!({ "scene.bodies.payload.mass": format!("{payload} kg") });
    }
    recording
}

fn problem(recordings: Vec<Value>) -> Value {
    json!({ "scene": scene(), "identify": {
        "free": { "bodies.cart.mass": { "min": "0.2 kg", "max": "20 kg" },
                  "joints.slide.damping": { "min": "0.2 N s/m", "max": "30 N s/m" } },
        "recordings": recordings, "step": "50 ms" } })
}

/// Exit status, both outputs and the folder.
fn solved(problem: &Value) -> (i32, String, String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("problem.json"), problem.to_string()).unwrap();
    let (status, out, err) = run(folder.path(), &["solve", "problem.json", "-o", "found"]);
    (status, out, err, folder)
}

#[test]
fn a_payload_tells_mass_and_damping_and_a_motion_alone_their_ratio() {
    let (status, out, err, folder) = solved(&problem(vec![coasting("alone", 0.0)]));
    assert_eq!(status, 1, "{out}{err}");
    let summary = read(folder.path().join("found/summary.json"));
    assert_eq!(summary["status"], "not_determined");
    let known = &summary["undetermined"][0]["determined"];
    let ratio = known["value"].as_f64().unwrap();
    let ratio = if ratio < 1.0 { 1.0 / ratio } else { ratio };
    assert!((ratio - 1.5).abs() < 1e-3, "{known}");
    let both = problem(vec![coasting("loaded", 1.0), coasting("alone", 0.0)]);
    let (status, out, err, folder) = solved(&both);
    assert_eq!(status, 0, "{out}{err}");
    let summary = read(folder.path().join("found/summary.json"));
    // In the order of the problem.
    assert_eq!(summary["fitted"][0]["recording"], "loaded");
    for start in summary["starts"].as_array().unwrap() {
        let slide = &start["joints"][0];
        assert_eq!(slide["unit"], "m");
        let [place, rate] = ["value", "rate"].map(|key| slide[key].as_f64().unwrap());
        assert!(place.abs() < 1e-5 && (rate - 1.0).abs() < 1e-4, "{slide}");
    }
    assert_eq!(summary["starts"].as_array().unwrap().len(), 2);
    for (constant, truth) in summary["constants"]
        .as_array()
        .unwrap()
        .iter()
        .zip([MASS, DAMPING])
    {
        let value = constant["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 1e-4, "{constant}");
    }
}

#[test]
fn the_kept_recordings_of_forces_and_a_payload_tell_five_constants() {
    let folder = workshop();
    let arguments = ["solve", "problems/recorded_payload.json", "-o", "found"];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{out}{err}");
    let summary = read(folder.path().join("found/summary.json"));
    // In alphabetical order.
    let truth = [0.062, 2.9, 118e3, 610.0, 420e3];
    for (constant, truth) in summary["constants"].as_array().unwrap().iter().zip(truth) {
        let [value, error] = ["value", "standard_error"].map(|key| constant[key].as_f64().unwrap());
        assert!(
            error < 0.03 * truth && (value - truth).abs() < 3.5 * error,
            "{constant}"
        );
    }
    let table = fs::read_to_string(folder.path().join("found/residuals.csv")).unwrap();
    assert!(table.contains("alone,force,N,") && table.contains("alone,current,A,"));
}

#[test]
fn a_table_that_ends_early_is_told_and_options_without_use_are_refused() {
    let mut pushed = coasting("pushed", 0.0);
    let table = json!({ "csv": { "file": "push.csv", "values": "push" } });
    pushed["experiment"]["loads"] = json!({ "push": table });
    let mut asked = problem(vec![pushed, coasting("loaded", 1.0)]);
    asked["scene"]["loads"] = json!([{ "name": "push", "joint": "slide" }]);
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| fs::write(folder.path().join(name), text).unwrap();
    write("problem.json", asked.to_string());
    write("push.csv", "time [s],push [N]\n0,0\n0.5,0\n".to_owned());
    let solve = |options: &[&str]| {
        let arguments = [&["solve", "problem.json", "-o", "found"], options].concat();
        run(folder.path(), &arguments)
    };
    let (status, out, err) = solve(&[]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(
        err.contains("ends at 0.5000 s, before the last reading at 2.000 s"),
        "{err}"
    );
    for (options, expected) in [
        (["--starts", "3"], "asks to identify"),
        (
            ["--export", "gltf"],
            "whose motions are those of its recordings",
        ),
    ] {
        let (status, out, err) = solve(&options);
        assert!(status == 2 && err.contains(expected), "{out}{err}");
    }
}

/// Message of a problem that is refused.
fn refusal(problem: &Value) -> String {
    let (status, out, err, _folder) = solved(problem);
    assert_eq!(status, 2, "{out}{err}");
    assert_eq!(err.matches("error:").count(), 1, "{err}");
    err
}

#[test]
fn mistakes_of_scenes_columns_and_forces_are_told() {
    let changed = |key: &str, value: Value| {
        let mut recording = coasting("alone", 0.0);
        recording[key] = value;
        problem(vec![recording])
    };
    let measured = |what: Value| changed("measured", json!([what]));
    let cases = [
        (
            changed("set", json!({ "identify.step": "1 ms" })),
            "a place in the scene",
        ),
        (
            changed("set", json!({ "scene.bodies.cart.mass": "3 kg" })),
            "which is sought",
        ),
        (
            changed("set", json!({ "scene.bodies.load.mass": "3 kg" })),
            "load",
        ),
        (
            changed("set", json!({ "scene.bodies.payload.mass": "3 N" })),
            "a mass",
        ),
        (changed("file", json!("one.csv")), "exactly one of"),
        (
            changed("columns", json!({ "time [s]": [0, 1], "x [m]": [1] })),
            "as long as each other",
        ),
        (
            changed("columns", json!({ "time [s]": [0, 1], "y [m]": [1, 2] })),
            "a column of",
        ),
        (
            changed("columns", json!({ "time [s]": [0, 1], "x [N]": [1, 2] })),
            "a length",
        ),
        (
            measured(json!({ "tension": "rope", "column": "x" })),
            "a spring or a tendon",
        ),
        (
            measured(json!({ "charge": "slide", "column": "x" })),
            "slide",
        ),
        (
            measured(json!({ "power": "slide", "column": "x" })),
            "slide",
        ),
        (
            measured(json!({ "reaction_force": "slide", "column": "x" })),
            "no direction",
        ),
        (
            measured(json!({ "joint": "slide", "about": [1, 0, 0], "column": "x" })),
            "reaction_torque",
        ),
        (
            measured(json!({ "joint": "slide", "tension": "slide", "column": "x" })),
            "exactly one of",
        ),
    ];
    for (problem, expected) in cases {
        let message = refusal(&problem);
        assert!(message.contains(expected), "{expected}: {message}");
    }
    // As many unknowns as readings are met by any readings.
    let recording = coasting("alone", 0.0);
    let mut held_out = recording.clone();
    held_out["name"] = json!("short");
    held_out["held_out"] = json!(true);
    held_out["experiment"]["sought_start"] = json!("state");
    held_out["columns"] = json!({ "time [s]": [0, 1], "x [m]": [1, 2] });
    held_out.as_object_mut().unwrap().remove("file");
    let message = refusal(&problem(vec![recording, held_out]));
    assert!(message.contains("leaves nothing to check"), "{message}");
    let fixed = json!({ "reaction_force": "tray", "along": [1, 0, 0], "column": "x", "standard_deviation": "1 N" });
    let mut recording = coasting("alone", 0.0);
    recording["columns"] = json!({ "time [s]": [0, 1, 2, 3, 4, 5], "x [N]": [1, 2, 3, 4, 5, 6] });
    recording["measured"] = json!([fixed]);
    let message = refusal(&problem(vec![recording]));
    assert!(message.contains("a joint that is fixed"), "{message}");
}

#[test]
fn a_candidate_that_tells_nothing_is_refused_at_its_own_place() {
    let candidate = |measured: Value| {
        let mut problem = problem(vec![coasting("alone", 0.0), coasting("loaded", 1.0)]);
        problem["identify"]["candidates"] = json!([{
            "name": "again", "duration": "1 s", "readings": 20, "measured": [measured],
            "experiment": { "start": { "joint_rates": { "slide": "1 m/s" } } }
        }]);
        problem
    };
    let force =
        json!({ "reaction_force": "tray", "along": [1, 0, 0], "standard_deviation": "1 N" });
    let cases = [
        (
            json!({ "joint": "slide" }),
            "nothing tells the standard deviation of slide, which no recording measures whose deviation is estimated",
        ),
        (force, "a joint that is fixed"),
    ];
    for (measured, expected) in cases {
        let message = refusal(&candidate(measured));
        let place = "identify.candidates: candidate \"again\": ";
        assert!(message.contains(place), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}
