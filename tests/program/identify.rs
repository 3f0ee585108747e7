//! Identification by the program: the kept problem, and mistakes in problems and recordings.

use crate::page::page_data;
use crate::runs::{read, run, workshop};
use std::fs;
use std::path::Path;

#[test]
fn the_kept_recordings_tell_modulus_and_viscosity() {
    let folder = workshop();
    let arguments = ["solve", "problems/recorded_pair.json", "-o", "found"];
    let (status, out, err) = run(folder.path(), &arguments);
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.starts_with("explained\n"), "{out}");
    let summary = read(folder.path().join("found/summary.json"));
    assert_eq!(summary["status"], "explained");
    let held_out = &summary["held_out"][0];
    assert_eq!(held_out["verdict"], "explained");
    assert_eq!(held_out["not_white"], serde_json::json!([]));
    let [statistic, quantile] =
        ["statistic", "quantile"].map(|key| held_out[key].as_f64().unwrap());
    assert!(0.0 < statistic && statistic < quantile, "{held_out}");
    let line = format!(
        "sine: explained (reduced χ² of the prediction {statistic:.2}, 1 % beyond {quantile:.2})"
    );
    assert!(out.contains(&line), "{line}: {out}");
    assert_eq!(summary["grid"]["confirmed"], true);
    // The twin that made the recordings, from a scene with 100 kPa and 1000 Pa s.
    for (constant, truth) in summary["constants"]
        .as_array()
        .unwrap()
        .iter()
        .zip([123e3, 640.0])
    {
        let [value, error] = ["value", "standard_error"].map(|key| constant[key].as_f64().unwrap());
        assert!(error < 0.01 * truth, "{constant}");
        assert!((value - truth).abs() < 3.5 * error, "{constant}");
    }
    let best = &summary["next_experiments"][0];
    assert!(best["standard_errors"][0].as_f64().unwrap() > 0.0);
    let page = fs::read_to_string(folder.path().join("found/report.html")).unwrap();
    let residuals = page.matches("\"label\":\"residual [σ]\"").count();
    assert!(residuals == 4 && page.contains("\"name\":\"Correlation\""));
    let data = page_data(&page);
    let scenes = data["scenes"].as_array().unwrap().iter();
    let names: Vec<_> = scenes.clone().map(|scene| &scene["name"]).collect();
    assert_eq!(names, ["step", "sine"]);
    assert!(
        scenes
            .clone()
            .all(|scene| scene["span"][1].as_f64() > Some(0.1))
    );
    let charts = data["charts"].as_array().unwrap().iter();
    let followed = charts.filter(|chart| chart["of"] == "sine" && chart["time"] == true);
    let titles: Vec<_> = followed
        .map(|chart| chart["title"].as_str().unwrap())
        .collect();
    assert!(
        titles[0].ends_with(", held out") && titles.contains(&"Voltages"),
        "{titles:?}"
    );
    let modulus = data["rows"][0][1].as_str().unwrap();
    assert!(
        modulus.contains(" kPa ± 0.") && modulus.contains("(95 %: "),
        "{modulus}"
    );
    assert!(
        out.contains(&format!("materials.silicone.shear_modulus: {modulus}\n")),
        "{out}"
    );
    let table = fs::read_to_string(folder.path().join("found/residuals.csv")).unwrap();
    assert!(table.lines().count() > 300 && table.contains("sine"));
}

/// A cart on a slide between a spring and a muscle.
const SCENE: &str = r#"{
  "name": "cart",
  "materials": {
    "soft": { "shear_modulus": "100 kPa", "relative_permittivity": 3 },
    "spare": { "shear_modulus": "100 kPa" }
  },
  "bodies": [ { "name": "cart", "mass": "50 g", "box": { "size": ["20 mm", "20 mm", "20 mm"] }, "position": [0, 0, 0] } ],
  "joints": [ { "name": "slide", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart", "at": [0, 0, 0], "damping": "0.5 N s/m" } ],
  "springs": [ { "name": "stay", "from": { "body": "ground", "at": ["-50 mm", 0, 0] }, "to": { "body": "cart", "at": [0, 0, 0] }, "stiffness": "200 N/m" } ],
  "markers": [ { "name": "tip", "body": "cart", "at": ["10 mm", 0, 0] } ]
}"#;

const FREE: &str = r#""springs.stay.stiffness": { "min": "50 N/m", "max": "900 N/m" }"#;

/// Exit status and message of a problem with constants, entries of a recording and its file.
fn refusal(free: &str, entries: &str, file: &str) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let problem = format!(
        r#"{{ "scene": "scene.json", "identify": {{ "free": {{ {free} }}, "recordings": [ {{ "name": "one", "file": "one.csv", {entries} }} ] }} }}"#
    );
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("scene.json", SCENE);
    write("problem.json", &problem);
    write("one.csv", file);
    let (status, out, err) = run(folder.path(), &["solve", "problem.json", "-o", "out"]);
    assert!(
        !Path::new(&folder.path().join("out")).exists(),
        "{out}{err}"
    );
    assert_eq!(err.matches("error:").count(), 1, "{err}");
    (status, err)
}

const MEASURED: &str = r#""measured": [ { "joint": "slide", "column": "x" } ]"#;
const STARTED: &str = r#""measured": [ { "joint": "slide", "column": "x" } ], "experiment": { "start": { "joint_angles": { "slide": "5 mm" } } }"#;
const RIGHT: &str = "time [ms],x [mm]\n0,5\n10,4\n20,2\n30,-1\n";

#[test]
fn mistakes_of_problems_and_recordings_are_told() {
    let crossed = r#""springs.stay.stiffness": { "min": "900 N/m", "max": "50 N/m" }"#;
    let negative = r#""springs.stay.stiffness": { "min": "-5 N/m", "max": "900 N/m" }"#;
    let spare = r#""materials.spare.shear_modulus": { "min": "50 kPa", "max": "900 kPa" }"#;
    let marker = r#""measured": [ { "marker": "top", "along": [1, 0, 0], "column": "x" } ]"#;
    let direction = r#""measured": [ { "marker": "tip", "column": "x" } ]"#;
    let twice = r#""measured": [ { "joint": "slide", "column": "x" }, { "joint": "slide", "column": "x" } ]"#;
    let two =
        format!(r#"{FREE}, "joints.slide.damping": {{ "min": "0.1 N s/m", "max": "2 N s/m" }}"#);
    let cases: &[(&str, &str, &str, &str)] = &[
        (crossed, STARTED, RIGHT, "larger than \"min\""),
        (negative, STARTED, RIGHT, "positive"),
        (spare, STARTED, RIGHT, "on which nothing depends"),
        (FREE, marker, RIGHT, "the name of a marker"),
        (FREE, direction, RIGHT, "a direction"),
        (FREE, twice, RIGHT, "measured already"),
        (FREE, STARTED, "time [ms],x [V]\n0,5\n10,4\n", "a voltage"),
        (FREE, STARTED, "time [mm],x [mm]\n0,5\n10,4\n", "a time"),
        (
            FREE,
            STARTED,
            "time [ms],y [mm]\n0,5\n10,4\n",
            "a column of",
        ),
        (FREE, STARTED, "time [ms],x [mm]\n", "no readings"),
        (FREE, STARTED, "time [ms],x [mm]\n0,5\n", "too short"),
        (FREE, STARTED, "time [ms],x\n0,5\n10,NaN\n", "not finite"),
        (
            FREE,
            STARTED,
            "time [ms],x [mm]\n0,5\n10,NaN\n",
            "in line 3",
        ),
        (
            FREE,
            STARTED,
            "time [ms],x [mm]\n0,5\n20,4\n10,2\n",
            "increasing",
        ),
        (
            FREE,
            STARTED,
            "time [ms],x [mm]\n0,5\n20,\n30,\n",
            "too short",
        ),
        (
            &two,
            STARTED,
            "time [ms],x [mm]\n0,5\n20,3\n",
            "2 readings for 2 unknowns",
        ),
        (
            FREE,
            MEASURED,
            "time [ms],x [mm]\n0,0\n10,0\n20,0\n",
            "not identifiable: nothing moves",
        ),
    ];
    for (free, entries, file, expected) in cases {
        let (status, message) = refusal(free, entries, file);
        assert!(
            status == 2 && message.contains(expected),
            "{expected}: {message}"
        );
    }
}
