//! Limits hold at all instants, start and end included, and select something; what cannot be met is explained.

use crate::field_limits::lift;
use assert_cmd::Command;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A kept problem.
pub(crate) fn kept(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trust");
    serde_json::from_str(&fs::read_to_string(path.join(name)).unwrap()).unwrap()
}

/// A run of a problem in a folder of its own, with its results in `p`.
pub(crate) struct Ran {
    pub(crate) status: i32,
    pub(crate) out: String,
    pub(crate) err: String,
    pub(crate) folder: TempDir,
}

pub(crate) fn run(task: &str, problem: &Value, more: &[&str]) -> Ran {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.json"), problem.to_string()).unwrap();
    let output = Command::cargo_bin("proboscis")
        .unwrap()
        .current_dir(folder.path())
        .args([task, "p.json", "-o", "p"])
        .args(more)
        .output()
        .unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ran {
        status: output.status.code().unwrap(),
        out: text(output.stdout),
        err: text(output.stderr),
        folder,
    }
}

impl Ran {
    pub(crate) fn read(&self, file: &str) -> Value {
        let text = fs::read_to_string(self.folder.path().join("p").join(file)).unwrap();
        serde_json::from_str(&text).unwrap()
    }

    /// It was refused in one line with these words, and wrote nothing.
    pub(crate) fn is_refused(&self, words: &[&str]) {
        assert_eq!(self.status, 2, "{}{}", self.out, self.err);
        let first = self.err.lines().next().unwrap();
        for word in words {
            assert!(first.contains(word), "no {word:?} in {first}");
        }
        assert!(!self.folder.path().join("p").exists());
    }

    pub(crate) fn is_solved(&self) {
        assert_eq!(self.status, 0, "{}{}", self.out, self.err);
    }
}

/// A trunk with a goal and limits.
pub(crate) fn trunk(segments: usize, goal: Value, limits: Value) -> Value {
    json!({
        "scene": {
            "name": "pair",
            "materials": { "silicone": {
                "density": "1000 kg/m^3", "shear_modulus": "100 kPa", "lame_lambda": "400 kPa",
                "relative_permittivity": 3.0, "viscosity": "1000 Pa s"
            } },
            "chain": {
                "segments": segments, "length": "50 mm", "radius": "20 mm", "mass": "30 g",
                "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
                "muscles": {
                    "material": "silicone", "arm": "15 mm", "rest_length": "40 mm",
                    "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um"
                },
                "tip_marker": "tip"
            }
        },
        "control": {
            "duration": "0.2 s", "intervals": 10,
            "start": { "rest_at_voltages": {} },
            "goal": goal,
            "voltage_bounds": ["0 V", "3 kV"],
            "objective": { "effort": 1.0 },
            "limits": limits
        }
    })
}

#[test]
fn a_goal_beyond_a_limit_is_refused_by_name() {
    for coordinates in ["reduced", "redundant"] {
        let mut problem = kept("05_limit_violated_by_goal.json");
        problem["control"]["coordinates"] = json!(coordinates);
        let words = ["control.goal", "joint1", "0.151", "at most 0.0500", "rad"];
        run("solve", &problem, &[]).is_refused(&words);
    }
    // A named angle, whatever is known of the rest.
    let joint = json!([{ "joint_angle": { "joint": "joint1", "min": -0.3, "max": 0.05 } }]);
    let named = trunk(1, json!({ "joint_angles": { "joint1": 0.1 } }), joint);
    run("solve", &named, &[]).is_refused(&["control.goal", "joint1", "0.1000", "0.0500"]);
}

#[test]
fn limits_that_contradict_each_other_are_refused_by_name() {
    let goal = json!({ "joint_angles": { "joint1": 0.0 } });
    let joint =
        |side: &str, value: f64| json!({ "joint_angle": { "joint": "joint1", side: value } });
    let limits = json!([joint("max", -0.1), joint("min", 0.1)]);
    let words = [
        "control.limits",
        "joint1",
        "at least 0.10000 rad",
        "at most -0.10000 rad",
    ];
    run("solve", &trunk(1, goal.clone(), limits), &[]).is_refused(&words);
    let stretch =
        |side: &str, value: f64| json!({ "stretch": { "muscle": "muscle1", side: value } });
    let limits = json!([stretch("min", 1.1), stretch("max", 0.9)]);
    let words = [
        "control.limits",
        "muscle1",
        "at least 1.1000",
        "at most 0.90000",
    ];
    run("solve", &trunk(1, goal, limits), &[]).is_refused(&words);
}

#[test]
fn a_start_beyond_a_limit_is_refused_by_name() {
    let goal = json!({ "rest_at_voltages": { "muscle1": "1.2 kV" } });
    let start = |mut problem: Value, start: Value| {
        problem["control"]["start"] = start;
        problem
    };
    // The marker is at (0, 50, 0) mm at the start.
    let inside = json!([{ "marker": { "marker": "tip", "inside": { "sphere": {
        "centre": ["0 mm", "36 mm", "0 mm"], "radius": "10 mm" } } } }]);
    let words = ["control.start", "tip", "14.000 mm", "at most 10.000 mm"];
    run("solve", &trunk(1, goal.clone(), inside), &[]).is_refused(&words);
    let stretched = json!([{ "stretch": { "muscle": "muscle2", "min": 0.5, "max": 1.02 } }]);
    let bent = json!({ "joint_angles": { "joint1": -0.3 } });
    let problem = start(trunk(1, goal.clone(), stretched), bent);
    run("solve", &problem, &[]).is_refused(&["control.start", "muscle", "at most 1.0200"]);
    // A field before the motion begins: 2 kV over 50 um are 40 V/um at rest length.
    let field = json!([{ "electric_field": { "muscles": "all", "max": "30 V/um" } }]);
    let held = json!({ "rest_at_voltages": { "muscle1": "2 kV", "muscle2": "2 kV" } });
    let problem = start(trunk(1, goal, field), held);
    run("solve", &problem, &[]).is_refused(&[
        "control.start",
        "field of muscle1",
        "at most 30.000",
    ]);
}

#[test]
fn a_goal_of_a_marker_beyond_its_region_is_refused() {
    let goal = json!({ "markers": { "tip": ["-5 mm", "149 mm", "0 mm"] } });
    let low = json!(["-4 mm", "0 mm", "-1 mm"]);
    let high = json!(["4 mm", "160 mm", "1 mm"]);
    let limits = json!([{ "marker": { "marker": "tip", "inside": { "box": {
        "min": low, "max": high } } } }]);
    let words = [
        "control.goal",
        "x of marker tip",
        "-5.0000 mm",
        "at least -4.0000 mm",
    ];
    run("solve", &trunk(3, goal, limits), &[]).is_refused(&words);
}

#[test]
fn a_limit_holds_at_an_open_end() {
    // Joint 3 is open at the end; what it does by itself there is cut in half.
    for coordinates in ["reduced", "redundant"] {
        let goal = json!({ "joint_angles": { "joint1": 0.15 }, "hold": "none" });
        let mut problem = trunk(3, goal, json!([]));
        problem["control"]["coordinates"] = json!(coordinates);
        let end = |ran: &Ran| {
            ran.is_solved();
            let joint = &ran.read("solution.json")["configuration"]["joints"]["joint3"];
            joint.as_array().unwrap().last().unwrap().as_f64().unwrap()
        };
        let free = end(&run("solve", &problem, &[]));
        assert!(free.abs() > 1e-3, "{free}");
        let (side, half) = (if free > 0.0 { "max" } else { "min" }, 0.5 * free);
        problem["control"]["limits"] =
            json!([{ "joint_angle": { "joint": "joint3", side: half } }]);
        let held = end(&run("solve", &problem, &[]));
        assert!((held - half).abs() < 1e-6, "{held} {half}");
    }
}

#[test]
fn a_limit_that_selects_nothing_is_refused() {
    let with = |limit: Value| {
        let mut problem = lift(0.05);
        problem["control"]["limits"] = json!([{ "electric_field": limit }]);
        run("solve", &problem, &[])
    };
    let place = "control.limits[0].electric_field";
    let words = |rest: &'static str| [place, rest];
    with(json!({ "muscles": "all", "max": 1e7 })).is_refused(&words("\"solid\""));
    with(json!({ "solid": "s", "region": "r", "max": 1e7 })).is_refused(&words("region"));
    with(json!({ "solids": "all", "region": "r", "max": 1e7 })).is_refused(&words("region"));
    // A block without electrodes beside the one with them.
    let mut passive = lift(0.05);
    let solids = passive["scene"]["solids"].as_array_mut().unwrap();
    solids.push(json!({
        "name": "q", "material": "m", "glued": { "z_min": "ground" },
        "box": { "corner": [0.1, 0, 0], "size": [0.01, 0.01, 0.01], "elements": [1, 1, 1] }
    }));
    passive["control"]["limits"] = json!([{ "electric_field": { "solid": "q", "max": 1e7 } }]);
    run("solve", &passive, &[]).is_refused(&[place, "nothing that a field reaches"]);
}

#[test]
fn bodies_glued_to_elements_rest_in_both_coordinates() {
    let mut ends = Vec::new();
    for coordinates in ["reduced", "redundant"] {
        let mut problem = lift(0.05);
        problem["control"]["coordinates"] = json!(coordinates);
        let ran = run("solve", &problem, &[]);
        ran.is_solved();
        let summary = ran.read("summary.json");
        println!("{}", summary["resimulation"]);
        ends.push(summary);
    }
    let number = |summary: &Value, path: &str| summary.pointer(path).unwrap().as_f64().unwrap();
    let [reduced, redundant] = [0, 1].map(|i| number(&ends[i], "/objective"));
    assert!(
        (reduced - redundant).abs() < 1e-6 * reduced,
        "{reduced} {redundant}"
    );
    let [reduced, redundant] = [0, 1].map(|i| number(&ends[i], "/resimulation/drift/length"));
    assert!(
        reduced > 0.0 && (reduced - redundant).abs() < 1e-3 * reduced,
        "{reduced} {redundant}"
    );
}

#[test]
fn an_infeasible_problem_is_explained() {
    // A short horizon: the voltages are at their bound most of the time, and the tip falls short.
    let goal = json!({ "rest_at_voltages": { "muscle1": 1500 } });
    let mut problem = trunk(1, goal, json!([]));
    problem["control"]["duration"] = json!("0.016 s");
    problem["control"]["voltage_bounds"] = json!([0, 1600]);
    let ran = run("solve", &problem, &[]);
    assert_eq!(ran.status, 1, "{}{}", ran.out, ran.err);
    assert!(
        ran.out.starts_with("not solved (infeasible)"),
        "{}",
        ran.out
    );
    println!("{}", ran.err);
    let line = |word: &str| {
        let found = ran.err.lines().find(|line| line.contains(word));
        found
            .unwrap_or_else(|| panic!("no {word:?} in {}", ran.err))
            .to_owned()
    };
    let number = |text: &str, after: &str, before: &str| -> f64 {
        let (_, rest) = text.split_once(after).unwrap();
        rest.split_once(before).unwrap().0.parse().unwrap()
    };
    let missed = number(&line("comes within"), "comes within ", " mm");
    assert!(missed > 0.1 && missed < 10.0, "{missed}");
    let often = number(
        &line("at its bound of 1600 V"),
        " V in ",
        " of 10 intervals",
    );
    assert!(often >= 3.0, "{often}");
    // The duration that is named does.
    let longer = number(&line("duration free"), "motion found takes ", " s");
    assert!(longer > 0.016);
    problem["control"]["duration"] = json!(longer);
    run("solve", &problem, &[]).is_solved();
    // What is told stands in the summary.
    let notes = ran.read("summary.json")["notes"].to_string();
    assert!(
        notes.contains("comes within") && notes.contains("duration free"),
        "{notes}"
    );
}

#[test]
fn a_robot_that_floats_is_told_how_to_start() {
    let goal = json!({ "joint_angles": { "hinge": 0.1 } });
    let mut problem = trunk(1, goal, json!([]));
    let scene = problem["scene"].as_object_mut().unwrap();
    scene.remove("chain");
    scene.insert(
        "bodies".into(),
        json!(["a", "b"].map(|name| json!({
            "name": name, "mass": "30 g", "free": name == "a", "position": [0, if name == "a" { 0.0 } else { 0.05 }, 0],
            "box": { "size": [0.02, 0.04, 0.02] }
        }))),
    );
    scene.insert(
        "joints".into(),
        json!([{ "name": "hinge", "revolute": { "axis": [0, 0, 1] },
        "parent": "a", "child": "b", "at": [0, 0.025, 0] }]),
    );
    let end = |body: &str, y: f64| json!({ "body": body, "at": [0.01, y, 0] });
    scene.insert(
        "muscles".into(),
        json!([{ "name": "muscle", "material": "silicone",
        "cross_section": [0.01, 0.01], "layer_thickness": 5e-5,
        "from": end("a", 0.005), "to": end("b", 0.045) }]),
    );
    let refused = run("solve", &problem, &[]);
    refused.is_refused(&["control.start", "\"start\": { \"joint_angles\": {} }"]);
}
