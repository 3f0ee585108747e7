//! Drivers and data sheets: gains, a delay and priors of an identification.

use crate::runs::{read, run};
use serde_json::{Value, json};
use std::fs;

const MASS: f64 = 0.05;
const STIFFNESS: f64 = 200.0;
const DAMPING: f64 = 0.6;
/// The force that the recording says, from 10 ms on, what acts of it, and the time by which it acts later.
const FORCE: f64 = 1.5;
const GAIN: f64 = 1.2;
const DELAY: f64 = 7.3e-3;

fn scene() -> Value {
    json!({
        "name": "oscillator",
        "bodies": [ { "name": "cart", "mass": MASS, "position": [0, 0, 0],
                      "box": { "size": ["20 mm", "20 mm", "20 mm"] } } ],
        "joints": [ { "name": "slide", "prismatic": { "axis": [1, 0, 0] }, "parent": "ground", "child": "cart",
                      "at": [0, 0, 0], "damping": "0.5 N s/m" } ],
        "springs": [ { "name": "stay", "from": { "body": "ground", "at": ["-50 mm", 0, 0] },
                       "to": { "body": "cart", "at": [0, 0, 0] }, "stiffness": "180 N/m" } ],
        "loads": [ { "name": "pull", "joint": "slide" } ]
    })
}

/// A stiffness and a damping from a recording under a step of the force, in closed form.
fn problem() -> Value {
    let times: Vec<f64> = (0..=80).map(|k| 2.5e-3 * f64::from(k)).collect();
    let decay = 0.5 * DAMPING / MASS;
    let omega = (STIFFNESS / MASS - decay * decay).sqrt();
    let still = GAIN * FORCE / STIFFNESS;
    let place = |t: &f64| match t - 0.01 - DELAY {
        since if since > 0.0 => {
            let turn = omega * since;
            still * (1.0 - (-decay * since).exp() * (turn.cos() + decay / omega * turn.sin()))
        }
        _ => 0.0,
    };
    let places: Vec<f64> = times.iter().map(place).collect();
    json!({ "scene": scene(), "identify": {
        "free": { "springs.stay.stiffness": { "min": 50, "max": 900 },
                  "joints.slide.damping": { "min": 0.1, "max": 5 } },
        "inputs": { "gains": { "pull": { "min": 0.5, "max": 2 } }, "delay": { "min": "0 s", "max": "20 ms" } },
        "priors": { "springs.stay.stiffness": { "value": "200 N/m", "standard_deviation": "0.1 N/m" } },
        "recordings": [ {
            "name": "step", "columns": { "time [s]": times, "x [m]": places },
            "measured": [ { "joint": "slide", "column": "x", "standard_deviation": "0.02 mm" } ],
            "experiment": {
                "start": { "rest_at_voltages": {} },
                "loads": { "pull": { "ramp": { "to": FORCE, "start": "10 ms", "duration": "1 us" } } }
            } } ] } })
}

fn solved(problem: &Value) -> (i32, String, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("problem.json"), problem.to_string()).unwrap();
    let (status, out, err) = run(folder.path(), &["solve", "problem.json", "-o", "found"]);
    (status, format!("{out}{err}"), folder)
}

#[test]
fn gain_and_delay_of_a_driver_are_told_with_their_units() {
    let (status, text, folder) = solved(&problem());
    assert_eq!(status, 0, "{text}");
    let summary = read(folder.path().join("found/summary.json"));
    let expected = [
        ("joints.slide.damping", "N s/m", DAMPING),
        ("springs.stay.stiffness", "N/m", STIFFNESS),
        ("gain of pull", "", GAIN),
        ("delay", "s", DELAY),
    ];
    let constants = summary["constants"].as_array().unwrap();
    assert_eq!(constants.len(), expected.len());
    for (constant, (name, unit, truth)) in constants.iter().zip(expected) {
        assert_eq!(
            (&constant["name"], &constant["unit"]),
            (&json!(name), &json!(unit))
        );
        let value = constant["value"].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 5e-3, "{constant}");
    }
    assert_eq!(constants[1]["prior"]["value"], 200.0);
    assert!(constants[0]["prior"].is_null());
    assert!(!text.contains("away from its prior"), "{text}");
    let mut wrong = problem();
    wrong["identify"]["priors"]["springs.stay.stiffness"]["value"] = json!("150 N/m");
    let (_, text, _) = solved(&wrong);
    assert!(
        text.contains("standard deviations away from its prior"),
        "{text}"
    );
}

/// A prior counts as one reading more of its constant.
#[test]
fn gains_and_delays_have_priors_in_their_units() {
    let mut known = problem();
    let inputs = &mut known["identify"]["inputs"];
    inputs["gains"]["pull"]["prior"] = json!({ "value": GAIN, "standard_deviation": 1e-3 });
    inputs["delay"]["prior"] = json!({ "value": "7.3 ms", "standard_deviation": "20 us" });
    let (status, text, folder) = solved(&known);
    assert_eq!(status, 0, "{text}");
    assert!(!text.contains("away from its prior"), "{text}");
    let summary = read(folder.path().join("found/summary.json"));
    let (gain, delay) = (&summary["constants"][2], &summary["constants"][3]);
    assert_eq!(gain["prior"]["value"], GAIN);
    assert_eq!(delay["prior"]["standard_deviation"], 2e-5);
    let without = solved(&problem());
    let without = read(without.2.path().join("found/summary.json"));
    for (number, least) in [(2, 1e-3), (3, 2e-5)] {
        let error = |summary: &Value| summary["constants"][number]["standard_error"].as_f64();
        let (with, without) = (error(&summary).unwrap(), error(&without).unwrap());
        // Information adds up; of both constants at once at least as much.
        let sum = (without.powi(-2) + f64::powi(least, -2)).powf(-0.5);
        assert!(
            with < 0.9999 * without && with < sum * 1.001,
            "{with} {without} {sum}"
        );
    }
    known["identify"]["inputs"]["delay"]["prior"]["value"] = json!("8 ms");
    let (_, text, _) = solved(&known);
    assert!(
        text.contains("delay") && text.contains("standard deviations away from its prior"),
        "{text}"
    );
}

/// However narrow it is: the estimate then stays at the prior, and the readings are what it is far from.
#[test]
fn a_narrow_prior_beside_the_recording_is_told() {
    for deviation in ["1 N/m", "1e-3 N/m", "1e-4 N/m"] {
        let mut wrong = problem();
        wrong["identify"]["priors"]["springs.stay.stiffness"] =
            json!({ "value": "230 N/m", "standard_deviation": deviation });
        wrong["identify"]["inputs"] = json!({ "delay": { "min": "0 s", "max": "20 ms" } });
        let (_, text, _) = solved(&wrong);
        assert!(
            text.contains("standard deviations away from its prior"),
            "{deviation}: {text}"
        );
    }
}

#[test]
fn mistakes_of_inputs_and_priors_are_told() {
    let cases: &[(&str, Value, &str)] = &[
        (
            "/inputs/gains",
            json!({ "push": { "min": 0.5, "max": 2 } }),
            "the name of a muscle",
        ),
        (
            "/inputs/gains/pull",
            json!({ "min": -0.5, "max": 2 }),
            "positive",
        ),
        (
            "/inputs/gains/pull",
            json!({ "min": 1.5, "max": 2 }),
            "without 1",
        ),
        (
            "/inputs/gains/pull",
            json!({ "min": 2, "max": 1 }),
            "larger than \"min\"",
        ),
        (
            "/inputs/gains/pull",
            json!({ "min": 0.5, "max": 2, "prior": { "value": 1, "standard_deviation": 0 } }),
            "a positive value",
        ),
        (
            "/inputs/delay",
            json!({ "min": "0 s", "max": "2 ms", "prior": { "value": "1 V", "standard_deviation": "1 ms" } }),
            "a time",
        ),
        (
            "/inputs/delay",
            json!({ "min": "-1 ms", "max": "2 ms" }),
            "no negative time",
        ),
        (
            "/inputs/delay",
            json!({ "min": "0 V", "max": "2 ms" }),
            "a time",
        ),
        (
            "/priors",
            json!({ "bodies.cart.mass": { "value": 1, "standard_deviation": 1 } }),
            "a constant of \"free\"",
        ),
        (
            "/priors/springs.stay.stiffness/value",
            json!("200 N"),
            "a stiffness",
        ),
        (
            "/priors/springs.stay.stiffness/standard_deviation",
            json!("2 mm"),
            "in a unit of the value",
        ),
        (
            "/priors/springs.stay.stiffness/standard_deviation",
            json!(0),
            "a positive size",
        ),
        (
            "/inputs",
            json!({ "delays": { "push": { "min": "0 s", "max": "2 ms" } } }),
            "the name of a muscle",
        ),
        (
            "/inputs",
            json!({ "delays": { "pull": { "min": "-1 ms", "max": "2 ms" } } }),
            "no negative time",
        ),
    ];
    for (place, value, expected) in cases {
        let mut problem = problem();
        *problem["identify"].pointer_mut(place).unwrap() = value.clone();
        let (status, text, folder) = solved(&problem);
        assert!(
            status == 2 && text.contains(expected),
            "{place}, {status}: {text}"
        );
        assert_eq!(text.matches("error:").count(), 1, "{text}");
        assert!(!folder.path().join("found").exists());
    }
}
