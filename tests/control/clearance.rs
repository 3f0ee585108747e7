//! The distance of a marker from a plane fixed to a moving body, in all its uses, against the places of markers that move with the plane.

use crate::limits::{Ran, run, trunk};
use serde_json::{Value, json};

/// Foot and head of the normal (0, 0.6, 0.8) of a plane of the first segment, in mm in the reference configuration.
const FOOT: [f64; 3] = [-20.0, 30.0, 5.0];
const NORMAL: [f64; 3] = [0.0, 0.6, 0.8];

fn plane() -> Value {
    json!({ "body": "segment1", "point": FOOT.map(|x| format!("{x} mm")), "normal": NORMAL.map(|n| 5.0 * n) })
}

/// A trunk of two segments whose first one carries the plane and markers at both ends of its normal.
fn bent(limits: Value) -> Value {
    let goal = json!({ "joint_angles": { "joint1": 0.12, "joint2": 0.1 } });
    let mut problem = trunk(2, goal, limits);
    let head = [0, 1, 2].map(|i| format!("{} mm", FOOT[i] + 10.0 * NORMAL[i]));
    problem["scene"]["markers"] = json!([
        { "name": "foot", "body": "segment1", "at": FOOT.map(|x| format!("{x} mm")) },
        { "name": "head", "body": "segment1", "at": head }
    ]);
    problem
}

/// Columns of a table by their names without units.
fn columns(ran: &Ran, file: &str) -> impl Fn(&str) -> Vec<f64> + use<> {
    let text = std::fs::read_to_string(ran.folder.path().join("p").join(file)).unwrap();
    let lines: Vec<Vec<String>> = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect();
    move |name| {
        let is_own = |header: &String| header.split([' ', '[']).next() == Some(name);
        let column = lines[0]
            .iter()
            .position(is_own)
            .unwrap_or_else(|| panic!("no {name}: {:?}", lines[0]));
        lines[1..]
            .iter()
            .map(|line| line[column].parse().unwrap())
            .collect()
    }
}

/// Distances in mm at the instants, from the places of the markers.
fn distances(ran: &Ran) -> Vec<f64> {
    let column = columns(ran, "trajectory.csv");
    let places = |name: &str| ["x", "y", "z"].map(|axis| column(&format!("{name}_{axis}")));
    let [foot, head, tip] = ["foot", "head", "tip"].map(places);
    let at = |k: usize| -> f64 {
        let from = |a: &[Vec<f64>; 3], i: usize| a[i][k] - foot[i][k];
        let along = [0, 1, 2].map(|i| from(&head, i));
        let length = along.iter().map(|a| a * a).sum::<f64>().sqrt();
        let dot: f64 = (0..3).map(|i| from(&tip, i) * along[i]).sum();
        dot / length
    };
    (0..foot[0].len()).map(at).collect()
}

#[test]
fn a_clearance_is_kept_followed_and_prescribed() {
    let free = run("solve", &bent(json!([])), &[]);
    free.is_solved();
    let distances_of_free = distances(&free);
    let least = distances_of_free
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let most = distances_of_free.iter().copied().fold(0.0, f64::max);
    assert!(most - least > 1.0, "{least} {most}");
    // Prescribed in the middle of the motion.
    let middle = 0.4 * least + 0.6 * most;
    let at = |value: f64| format!("{value} mm");
    let once = json!([{ "part": 0.5, "clearance": { "marker": "tip", "from": plane(), "min": at(middle), "max": at(middle) } }]);
    let met = run("solve", &bent(once), &[]);
    met.is_solved();
    assert!((distances(&met)[5] - middle).abs() < 1e-6 * middle);
    assert!((distances_of_free[5] - middle).abs() > 1e-3);
    // A start beyond it is refused by name.
    let beyond =
        json!([{ "clearance": { "marker": "tip", "from": plane(), "max": at(least - 1.0) } }]);
    let words = ["control.start", "clearance of marker tip", "at most"];
    run("solve", &bent(beyond), &[]).is_refused(&words);
    let mut followed = bent(json!([]));
    followed["control"]["objective"]["track"] = json!([{ "clearance": { "marker": "tip", "from": plane(), "at": at(middle), "weight": 1e6 } }]);
    let near = run("solve", &followed, &[]);
    near.is_solved();
    let deviation = |ran: &Ran| {
        distances(ran)
            .iter()
            .map(|d| (d - middle).powi(2))
            .sum::<f64>()
    };
    assert!(deviation(&near) < 0.9 * deviation(&free));
    let mut ended = bent(json!([]));
    ended["control"].as_object_mut().unwrap().remove("goal");
    ended["control"]["objective"]["final"] = json!([{ "clearance": { "marker": "tip", "from": plane(), "at": at(middle), "weight": 1e9 } }]);
    let end = run("solve", &ended, &[]);
    end.is_solved();
    assert!((distances(&end).last().unwrap() - middle).abs() < 1e-3);
}

#[test]
fn a_clearance_is_recorded() {
    let simulated =
        json!({ "duration": "0.2 s", "step": "0.2 ms", "voltages": { "muscle3": "1.5 kV" } });
    let mut problem = bent(json!([]));
    problem.as_object_mut().unwrap().remove("control");
    problem["simulate"] = simulated;
    let truth = run("simulate", &problem, &[]);
    truth.is_solved();
    let times = columns(&truth, "trajectory.csv")("time");
    problem.as_object_mut().unwrap().remove("simulate");
    problem["identify"] = json!({
        "free": { "materials.silicone.viscosity": { "min": "100 Pa s", "max": "5000 Pa s" } },
        "recordings": [{
            "name": "swing",
            "columns": { "time [ms]": times, "gap [mm]": distances(&truth) },
            "measured": [{ "clearance": "tip", "from": plane(), "column": "gap", "standard_deviation": "10 um" }],
            "experiment": { "voltages": { "muscle3": "1.5 kV" } }
        }],
        "step": "2 ms"
    });
    let found = run("solve", &problem, &[]);
    found.is_solved();
    let summary = found.read("summary.json");
    let value = summary["constants"][0]["value"].as_f64().unwrap();
    assert!((value / 1e3 - 1.0).abs() < 1e-3, "{value}");
    // A plane belongs to a clearance, and is named where it is wrong.
    let measured = |entry: Value| {
        let mut wrong = problem.clone();
        wrong["identify"]["recordings"][0]["measured"][0] = entry;
        wrong
    };
    let without = measured(json!({ "clearance": "tip", "column": "gap" }));
    run("solve", &without, &[]).is_refused(&["measured[0].from", "no plane"]);
    let beside =
        measured(json!({ "marker": "tip", "along": [1, 0, 0], "from": plane(), "column": "gap" }));
    run("solve", &beside, &[])
        .is_refused(&["measured[0].from", "a plane of a \"clearance\" alone"]);
}
