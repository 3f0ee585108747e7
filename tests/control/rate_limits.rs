//! Limits of rates of joints: kept in every interval, active, the same in both coordinates, and refused where they make no sense.

use crate::limits::{Ran, run};
use serde_json::{Value, json};
use std::path::Path;

/// The pair in 0.2 s with the rate of its joint below a number of rad/s.
fn problem(limit: Value, coordinates: &str) -> Value {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("problems/pair.json")).unwrap();
    let mut problem: Value = serde_json::from_str(&text).unwrap();
    problem["scene"] = json!(root.join("problems/scenes/pair.json"));
    problem["control"]["coordinates"] = json!(coordinates);
    problem["control"]["limits"] = json!([{ "joint_rate": limit }]);
    problem
}

/// Largest mean rate in an interval in rad/s, from the table.
fn largest(ran: &Ran) -> f64 {
    let table = std::fs::read_to_string(ran.folder.path().join("p/trajectory.csv")).unwrap();
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| head.iter().position(|h| h.starts_with(name)).unwrap();
    let [time, joint] = [place("time"), place("joint1 ")];
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|cell| cell.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    let rate = |pair: &[Vec<f64>]| {
        1e3 * (pair[1][joint] - pair[0][joint]) / (pair[1][time] - pair[0][time])
    };
    rows.windows(2).map(rate).fold(0.0, f64::max)
}

#[test]
fn a_joint_turns_no_faster_than_its_limit() {
    let solved = |max: f64, coordinates: &str| {
        let limit = json!({ "joint": "joint1", "max": format!("{max} rad/s") });
        let ran = run("solve", &problem(limit, coordinates), &[]);
        assert!(ran.out.contains("objective"), "{}{}", ran.out, ran.err);
        let objective = ran.read("summary.json")["objective"].as_f64().unwrap();
        (largest(&ran), objective)
    };
    let (free, cheap) = solved(1e3, "reduced");
    assert!(free > 6.0, "{free}");
    let both = ["reduced", "redundant"].map(|coordinates| solved(4.0, coordinates));
    for (rate, objective) in both {
        assert!((rate - 4.0).abs() < 1e-6, "{rate}");
        assert!(objective > 1.01 * cheap, "{objective} {cheap}");
    }
    assert!((both[0].1 / both[1].1 - 1.0).abs() < 1e-6, "{both:?}");
}

#[test]
fn limits_of_rates_that_make_no_sense_are_refused() {
    let refused = |limit: Value, words: &[&str]| {
        run("solve", &problem(limit, "reduced"), &[]).is_refused(words);
    };
    let place = "limits[0].joint_rate";
    refused(json!({ "joint": "joint1" }), &[place, "no bound"]);
    refused(
        json!({ "joint": "joint1", "max": "3 m/s" }),
        &[place, "3 m/s"],
    );
    refused(
        json!({ "joint": "joint1", "min": 2, "max": 1 }),
        &[place, "crossed"],
    );
    refused(json!({ "joint": "joint7", "max": 1 }), &[place, "joint7"]);
}

#[test]
fn a_joint_turns_no_faster_than_its_limit_in_the_least_time() {
    let solved = |limit: Value, coordinates: &str| {
        let mut problem = problem(limit, coordinates);
        problem["control"]["duration"] = json!({ "min": 0.02, "max": 0.4, "guess": 0.1 });
        problem["control"]["objective"] = json!({ "effort": 0.01, "duration": 1.0 });
        let ran = run("solve", &problem, &[]);
        ran.is_solved();
        let summary = ran.read("summary.json");
        (largest(&ran), summary["objective"].as_f64().unwrap())
    };
    let limit =
        |max: f64| json!({ "joint": "joint1", "min": "-9 rad/s", "max": format!("{max} rad/s") });
    let (free, cheap) = solved(limit(1e3), "reduced");
    assert!(free > 6.0, "{free}");
    let both = ["reduced", "redundant"].map(|coordinates| solved(limit(3.0), coordinates));
    for (rate, objective) in &both {
        assert!(*rate < 3.0 + 1e-6 && *rate > 3.0 - 1e-3, "{rate}");
        assert!(*objective > 1.01 * cheap, "{objective} {cheap}");
    }
    assert!((both[0].1 / both[1].1 - 1.0).abs() < 1e-6);
}

/// The ramp of 50 kV/s from 50 ms on is read in the middles of intervals of 10 ms; the rest before and after is half an interval away.
#[test]
fn a_given_voltage_keeps_the_limit_of_its_rate_or_is_refused() {
    let ran = |bounds: Value, end: &str| {
        let mut problem = problem(json!({ "joint": "joint1", "max": "1e6 rad/s" }), "reduced");
        let control = &mut problem["control"];
        let ramp = json!({ "ramp": { "to": "1 kV", "start": "50 ms", "duration": "20 ms" } });
        control["voltages"] = json!({ "muscle1": ramp });
        control["goal"] = json!({ "rest_at_voltages": { "muscle1": end, "muscle2": "1.7 kV" } });
        let mut limit = bounds;
        limit["source"] = json!("muscle1");
        control["limits"] = json!([{ "voltage_rate": limit }]);
        run("solve", &problem, &[])
    };
    let below = |max: &str| json!({ "max": max });
    let words = [
        "limits",
        "given voltage of muscle1 is 50000 V/s at 60 ms",
        "at most 40000 V/s",
    ];
    ran(below("40 kV/s"), "1 kV").is_refused(&words);
    ran(below("51 kV/s"), "1 kV").is_solved();
    let words = ["is -200000 V/s at 200 ms", "at least -60000 V/s"];
    ran(json!({ "min": "-60 kV/s" }), "0 V").is_refused(&words);
    ran(json!({ "min": "-201 kV/s" }), "0 V").is_solved();
}
