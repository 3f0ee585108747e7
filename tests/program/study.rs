//! Studies of motions with a closed form, refused studies, points that fail, and their files.

use crate::common::signals::Listening as _;
use crate::runs::run;
use proboscis::control::problem::Task;
use proboscis::files::read_problem;
use proboscis::workflow::{integrate, trajectory};
use serde_json::{Value, json};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;
use std::{fs, thread};
use tempfile::TempDir;

/// A wheel of 1 kg and 0.1 m that is slowed down by its hub: θ(t) = ω I/c (1 − exp(−c t/I)) with I = m r²/2.
pub(crate) fn wheel() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scene = json!({
        "name": "wheel",
        "bodies": [{
            "name": "wheel", "mass": "1 kg", "position": [0, 0, 0],
            "cylinder": { "length": "50 mm", "radius": "100 mm", "axis": [0, 0, 1] }
        }],
        "joints": [{
            "name": "hub", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "wheel",
            "at": [0, 0, 0], "damping": "0.02 N m s/rad"
        }],
        "markers": [{ "name": "rim", "body": "wheel", "at": ["100 mm", 0, 0] }]
    });
    let problem = json!({
        "scene": "wheel.json",
        "simulate": {
            "duration": "1 s", "step": "50 ms",
            "start": { "joint_angles": {}, "joint_rates": { "hub": "3 rad/s" } }
        }
    });
    write(folder.path(), "wheel.json", &scene);
    write(folder.path(), "problem.json", &problem);
    folder
}

/// Place of the rim in m at a time in s.
pub(crate) fn rim(time: f64) -> [f64; 3] {
    let rate = 0.02 / (0.5 * 0.1 * 0.1);
    let angle = 3.0 / rate * (1.0 - f64::exp(-rate * time));
    [0.1 * angle.cos(), 0.1 * angle.sin(), 0.0]
}

/// A study of the step of the wheel in both kinds of coordinates.
pub(crate) fn steps() -> Value {
    json!({
        "title": "Steps of a wheel",
        "problem": "problem.json",
        "methods": [
            { "name": "angle", "set": { "simulate.coordinates": "reduced" } },
            { "name": "directors", "set": { "simulate.coordinates": "redundant" } }
        ],
        "refine": {
            "name": "step",
            "set": { "simulate.step": ["50 ms", "25 ms", "12.5 ms", "6.25 ms", "3.125 ms"] }
        }
    })
}

pub(crate) fn write(folder: &Path, name: &str, value: &Value) {
    fs::write(folder.join(name), value.to_string()).unwrap();
}

/// Runs a study in a folder and returns its `study.json`.
pub(crate) fn results(folder: &Path, study: &Value, runs: &str) -> Value {
    write(folder, "study.json", study);
    let (status, out, err) = run(
        folder,
        &["study", "study.json", "-o", "out", "--runs", runs, "-q"],
    );
    assert_eq!(status, 0, "{out}{err}");
    record(folder)
}

pub(crate) fn record(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("out/study.json")).unwrap()).unwrap()
}

/// Returns the record of one measure.
pub(crate) fn of<'a>(record: &'a Value, measure: &str) -> &'a Value {
    let all = record["measures"].as_array().unwrap();
    all.iter()
        .find(|m| m["measure"] == measure)
        .unwrap_or_else(|| panic!("no {measure}"))
}

pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

pub(crate) fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn a_wheel_that_is_slowed_down_converges_to_its_closed_form() {
    let folder = wheel();
    let record = results(folder.path(), &steps(), "1");
    assert_eq!(record["status"], "complete");
    assert_eq!(record["asked"], "motion");
    let exact = rim(1.0);
    assert!(apart(&exact, &[0.1, 0.0, 0.0]) > 0.05, "the wheel turns");
    for (m, reference) in of(&record, "end")["references"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        let order = reference["orders"]
            .as_array()
            .unwrap()
            .last()
            .unwrap()
            .as_f64()
            .unwrap();
        assert!((order - 2.0).abs() < 0.05, "{order}");
        assert_eq!(reference["is_extrapolated"], true);
        let method = &record["methods"][m];
        let shown = method["orders"]["end"].as_f64().unwrap();
        assert!((shown - 2.0).abs() < 0.05, "{shown}");
        let points = method["points"].as_array().unwrap();
        assert_eq!(points.len(), 5);
        let finest = numbers(&points[4]["values"]["end"]);
        let left = apart(&finest, &exact);
        let limit = apart(&numbers(&reference["value"]), &exact);
        assert!(
            left > 1e-9 && limit < 1e-3 * left,
            "{limit:e} against {left:e}"
        );
        for point in points {
            // Against the closed form, by the places that are recorded.
            let truth = apart(&numbers(&point["values"]["end"]), &exact);
            let told = point["errors"]["end"].as_f64().unwrap();
            assert!(
                (told - truth).abs() < 1e-2 * truth,
                "{told:e} against {truth:e}"
            );
        }
    }
    // Along the path: all 21 instants of the coarsest grid, and the greatest error among them.
    let instants = numbers(&record["instants"]);
    assert_eq!(instants.len(), 21);
    let coarsest = &record["methods"][0]["points"][0];
    let places = numbers(&coarsest["values"]["path"]);
    let pairs = places.chunks(3).zip(&instants);
    let truth = pairs
        .map(|(place, t)| apart(place, &rim(*t)))
        .fold(0.0, f64::max);
    let told = coarsest["errors"]["path"].as_f64().unwrap();
    assert!(
        truth > 1e-6 && (told - truth).abs() < 1e-2 * truth,
        "{told:e} against {truth:e}"
    );
    // What the hub dissipates is accounted for, to the order of the rule.
    for method in record["methods"].as_array().unwrap() {
        let order = method["orders"]["energy_balance"].as_f64().unwrap();
        // The greatest error is that of t₁ = h, where energies of two intervals are interpolated: h²/8 E″(h), and E″ falls like
        // exp(−8 h/s). Two steps h and h/2 show 2 − 4 h/(s ln 2), which is 1.71 for the coarsest two and 1.96 for the finest.
        let points = method["points"].as_array().unwrap();
        let error = |k: usize| points[k]["errors"]["energy_balance"].as_f64().unwrap();
        for k in 0..4 {
            let step = 0.05 * 0.5_f64.powi(k as i32);
            let here = (error(k) / error(k + 1)).log2();
            let seen = 2.0 - 4.0 * step / std::f64::consts::LN_2;
            // To the next order in the step.
            assert!((here - seen).abs() < 1.5 * step, "{here} against {seen}");
        }
        assert!((order - 2.0).abs() < 0.15, "{order}");
        assert!(
            method["points"][0]["errors"]["energy_balance"]
                .as_f64()
                .unwrap()
                > 1e-5
        );
    }
    let violation = |m: usize| {
        record["methods"][m]["points"][0]["errors"]["constraint_violation"]
            .as_f64()
            .unwrap()
    };
    assert_eq!(violation(0), 0.0);
    assert!(
        violation(1) > 0.0 && violation(1) < 1e-8,
        "{}",
        violation(1)
    );
}

#[test]
fn a_reference_of_its_own_is_finer_than_the_points_and_is_not_timed() {
    let folder = wheel();
    let mut study = steps();
    study["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms"]);
    study["reference"] = json!({
        "method": "angle",
        "refine": { "name": "step", "set": { "simulate.step": ["4 ms", "2 ms", "1 ms"] } }
    });
    let record = results(folder.path(), &study, "1");
    let end = of(&record, "end");
    assert_eq!(end["references"].as_array().unwrap().len(), 1);
    assert_eq!(end["references"][0]["method"], "angle");
    assert!(apart(&numbers(&end["references"][0]["value"]), &rim(1.0)) < 1e-9);
    let extra = record["reference_points"].as_array().unwrap();
    assert_eq!(extra.len(), 3);
    assert!(extra.iter().all(|point| point.get("seconds").is_none()));
    let timed = record["methods"][1]["points"][1]["seconds"]["runs"]
        .as_array()
        .unwrap();
    assert_eq!(timed.len(), 1);
    // The steps of the reference share their instants with 50 and 25 ms only where 4 ms does: every 100 ms.
    assert_eq!(numbers(&record["instants"]).len(), 11);
}

#[test]
fn each_point_runs_again_from_its_overrides_to_the_last_bit() {
    let folder = wheel();
    let record = results(folder.path(), &steps(), "1");
    let mut count = 0;
    for method in record["methods"].as_array().unwrap() {
        for point in method["points"].as_array().unwrap() {
            let set: Vec<String> = serde_json::from_value(point["set"].clone()).unwrap();
            assert_eq!(set.len(), 2);
            let path = folder.path().join(point["problem"].as_str().unwrap());
            let loaded = read_problem(&path, &set).unwrap();
            let Task::Simulate(task) = &loaded.task else {
                panic!("a simulation");
            };
            let moved = integrate(&loaded.system, task, |_, _| ControlFlow::Continue(())).unwrap();
            let kept = proboscis::workflow::solved(&moved.model, &moved.discrete, None);
            let places = trajectory(&moved.model, &kept).path(0);
            let last = places.last().unwrap();
            let told = numbers(&point["values"]["end"]);
            assert_eq!(told, [last.x / 1e3, last.y / 1e3, last.z / 1e3]);
            let command = point["command"].as_str().unwrap();
            assert!(
                command.starts_with("proboscis simulate problem.json --set "),
                "{command}"
            );
            // Blanks need quotes in a shell.
            assert!(command.contains("--set 'simulate.step="), "{command}");
            count += 1;
        }
    }
    assert_eq!(count, 10);
}

#[test]
fn what_any_mesh_tells_exactly_has_nothing_to_extrapolate() {
    let folder = tempfile::tempdir().unwrap();
    let scene = json!({
        "name": "cube",
        "materials": { "silicone": { "shear_modulus": "100 kPa", "lame_lambda": "400 kPa", "relative_permittivity": 3.0 } },
        "solids": [{
            "name": "cube", "material": "silicone",
            "box": { "size": ["10 mm", "10 mm", "10 mm"], "elements": [1, 1, 1] },
            "electrodes": [
                { "name": "bottom", "face": "z_min", "potential": "grounded" },
                { "name": "top", "face": "z_max", "potential": "driven" }
            ],
            "fixed": [
                { "face": "x_min", "directions": ["x"] },
                { "face": "y_min", "directions": ["y"] },
                { "face": "z_min", "directions": ["z"] }
            ]
        }],
        "markers": [
            { "name": "corner", "solid": "cube", "at": ["10 mm", "10 mm", "10 mm"] },
            { "name": "middle", "solid": "cube", "at": ["5 mm", "5 mm", "5 mm"] }
        ]
    });
    write(folder.path(), "cube.json", &scene);
    let problem =
        json!({ "scene": "cube.json", "equilibrium": { "voltages": { "cube.top": "500 kV" } } });
    write(folder.path(), "problem.json", &problem);
    let mut study = json!({
        "title": "Meshes of a cube",
        "problem": "problem.json",
        "methods": [{ "name": "hex8" }],
        "refine": {
            "name": "elements", "sizes": [2, 4, 6],
            "set": { "scene.solids[0].box.elements": [[2, 2, 2], [4, 4, 4], [6, 6, 6]] }
        }
    });
    let record = results(folder.path(), &study, "1");
    assert_eq!(record["asked"], "rest");
    let place = of(&record, "place");
    assert!(place["scale"].as_f64().unwrap() > 1e-5, "{place}");
    assert_eq!(place["references"][0]["is_extrapolated"], false);
    for point in record["methods"][0]["points"].as_array().unwrap() {
        assert_eq!(point["status"], "at_rest");
        assert!(point["errors"]["place"].as_f64().unwrap() < 1e-12);
    }
    assert!(!folder.path().join("out/place.svg").exists());
    // The middle is no node of three elements.
    study["refine"]["sizes"] = json!([2, 3, 4]);
    study["refine"]["set"]["scene.solids[0].box.elements"] =
        json!([[2, 2, 2], [3, 3, 3], [4, 4, 4]]);
    write(folder.path(), "study.json", &study);
    let (status, _, err) = run(folder.path(), &["study", "study.json", "-o", "other", "-q"]);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("markers") && err.contains("\"middle\"") && err.contains("nearest node"),
        "{err}"
    );
}

#[test]
fn ctrl_c_keeps_the_results_so_far() {
    let folder = wheel();
    let mut study = steps();
    // The last point takes long.
    study["refine"]["set"]["simulate.step"] = json!(["50 ms", "25 ms", "12.5 ms", "0.0005 ms"]);
    write(folder.path(), "study.json", &study);
    let binary = assert_cmd::cargo::cargo_bin("proboscis");
    let mut child = std::process::Command::new(binary)
        .current_dir(folder.path())
        .args(["study", "study.json", "-o", "out", "-q"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn_listening()
        .unwrap();
    // The folder is made once Ctrl-C is listened to.
    while !folder.path().join("out").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        thread::sleep(Duration::from_millis(10));
    }
    thread::sleep(Duration::from_millis(300));
    crate::common::signals::interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(1));
    let record = record(folder.path());
    assert_eq!(record["status"], "interrupted");
    let points = record["methods"][0]["points"].as_array().unwrap();
    assert_eq!(points.len(), 4);
    assert_eq!(points[3]["status"], "interrupted");
    assert!(points[3].get("seconds").is_none());
    let html = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(html.contains("\"title\":\"Study\""));
    let page = fs::read_to_string(folder.path().join("out/study.md")).unwrap();
    assert!(page.contains("(interrupted)"), "{page}");
}
