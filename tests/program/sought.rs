//! Free parameters of a scene, from files to the words of the terminal.

use crate::commands::summary;
use crate::runs::{read, run, workshop};
use std::fs;

#[test]
fn the_arm_of_two_muscles_is_found() {
    let folder = workshop();
    let here = folder.path();
    let problem = "problems/codesign_pair.json";
    let (status, out, err) = run(here, &["solve", problem, "-o", "free"]);
    assert_eq!(status, 0, "{out}{err}");
    let found = summary(here, "free");
    let parameter = &found["parameters"][0];
    assert_eq!(parameter["name"], "chain.muscles.arm");
    assert_eq!(parameter["unit"], "m");
    assert_eq!(parameter["at_bound"], false);
    let arm = parameter["value"].as_f64().unwrap();
    assert!(arm > 0.0051 && arm < 0.0399, "{arm}");
    let told = format!("{out}{err}");
    assert!(told.contains("chain.muscles.arm: 0.0"), "{told}");
    let solution = read(here.join("free/solution.json"));
    assert_eq!(
        solution["parameters"]["chain.muscles.arm"].as_f64(),
        Some(arm)
    );
    // With the arm of the scene given the effort is greater, with the one found it is the same.
    let objective = |summary: &serde_json::Value| summary["objective"].as_f64().unwrap();
    let least = objective(&found);
    let with = |arm: &str, name: &str| {
        let set = format!("scene.chain.muscles.arm={arm}");
        let arguments = [
            "solve",
            problem,
            "-o",
            name,
            "--set",
            "control.free={}",
            "--set",
            &set,
        ];
        let (status, out, err) = run(here, &arguments);
        assert_eq!(status, 0, "{out}{err}");
        let summary = summary(here, name);
        assert!(summary.get("parameters").is_none());
        objective(&summary)
    };
    assert!(with("0.015", "given") > 1.001 * least);
    assert!((with(&arm.to_string(), "same") - least).abs() < 1e-8 * least);
    // A solve that starts from the solution starts with the arm that was found.
    let guess = "control.guess={\"solution\":\"free/solution.json\"}";
    let (status, out, err) = run(here, &["solve", problem, "-o", "again", "--set", guess]);
    assert_eq!(status, 0, "{out}{err}");
    let again = summary(here, "again");
    assert!(again["iterations"].as_u64().unwrap() <= 4, "{again}");
    assert!((objective(&again) - least).abs() < 1e-8 * least);
    // Its voltages belong to that arm.
    let scene = read(here.join(problem))["scene"].to_string();
    let simulate = r#""simulate": { "duration": "0.1 s", "step": "5 ms", "voltages": { "solution": "free/solution.json" } }"#;
    fs::write(
        here.join("problems/under.json"),
        format!("{{ \"scene\": {scene}, {simulate} }}"),
    )
    .unwrap();
    let (status, _, err) = run(here, &["simulate", "problems/under.json"]);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("chain.muscles.arm") && err.contains("0.015"),
        "{err}"
    );
    let set = format!("scene.chain.muscles.arm={arm}");
    let (status, out, err) = run(
        here,
        &[
            "simulate",
            "problems/under.json",
            "--set",
            &set,
            "-o",
            "under",
        ],
    );
    assert_eq!(status, 0, "{out}{err}");
    let end = |path: &str| {
        let angles = &read(here.join(path))["configuration"]["joints"]["joint1"];
        angles.as_array().unwrap().last().unwrap().as_f64().unwrap()
    };
    assert!((end("under/solution.json") - end("free/solution.json")).abs() < 1e-7);
}

#[test]
fn constants_of_a_material_are_recovered_from_a_measured_motion() {
    let folder = workshop();
    let here = folder.path();
    let (status, out, err) = run(
        here,
        &["solve", "problems/identify_pair.json", "-o", "found"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let found = summary(here, "found");
    let [modulus, viscosity] = [0, 1].map(|i| found["parameters"][i]["value"].as_f64().unwrap());
    assert_eq!(found["parameters"][0]["unit"], "Pa");
    assert!((modulus - 130e3).abs() < 1e-8 * 130e3, "{modulus}");
    assert!((viscosity - 700.0).abs() < 1e-8 * 700.0, "{viscosity}");
}
