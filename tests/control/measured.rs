//! Tensions, fields, currents, powers and rates as costs, and limits at single times: they are what the tables say, written out.

use crate::drivers::{Table, capacitance, pair};
use crate::limits::{Ran, run};
use crate::tension_limits::tension;
use serde_json::{Value, json};

/// The pair in 0.2 s to a state of rest, or with a free end, with an objective.
fn problem(circuit: &Value, objective: Value, is_free: bool) -> Value {
    let mut problem = pair(circuit, json!([]), "reduced");
    problem["control"]["objective"] = objective;
    if is_free {
        problem["control"]["goal"] = json!("free");
    }
    problem
}

/// Columns of a motion of the pair.
struct Seen {
    /// Step in s.
    step: f64,
    angles: Vec<f64>,
    voltages: Vec<f64>,
    motion: Table,
    objective: f64,
}

impl Seen {
    fn new(ran: &Ran) -> Self {
        ran.is_solved();
        let [motion, controls] =
            ["trajectory.csv", "controls.csv"].map(|name| Table::read(ran, name));
        let times = motion.column("time");
        Self {
            step: 1e-3 * (times[1] - times[0]),
            angles: motion.column("joint1"),
            voltages: controls.column("muscle2"),
            objective: ran.read("summary.json")["objective"].as_f64().unwrap(),
            motion,
        }
    }

    /// Rates of the joint in rad/s in the intervals.
    fn rates(&self) -> Vec<f64> {
        let steps = self.angles.windows(2);
        steps.map(|pair| (pair[1] - pair[0]) / self.step).collect()
    }

    /// Tensions of the left muscle in the intervals.
    fn tensions(&self) -> Vec<f64> {
        let steps = self.angles.windows(2).zip(&self.voltages);
        steps
            .map(|(pair, &voltage)| tension([pair[0], pair[1]], self.step, voltage))
            .collect()
    }

    /// Speeds of the tip in m/s in the intervals.
    fn speeds(&self) -> Vec<f64> {
        let places = ["tip_x", "tip_y", "tip_z"].map(|name| self.motion.column(name));
        let far = |k: usize| {
            let squares = places.iter().map(|of| (of[k + 1] - of[k]).powi(2));
            1e-3 * squares.sum::<f64>().sqrt() / self.step
        };
        (0..self.voltages.len()).map(far).collect()
    }
}

fn squares(values: &[f64], from: f64) -> f64 {
    values.iter().map(|value| (value - from).powi(2)).sum()
}

#[test]
fn costs_are_the_sums_of_the_squares_in_the_tables() {
    let objective = json!({ "effort": 0.01,
        "track": [
            { "tension": { "muscle": "muscle2", "at": "1 N", "weight": 2 } },
            { "joint_rate": { "joint": "joint1", "at": "0.5 rad/s", "weight": 0.3 } },
            { "marker_speed": { "marker": "tip", "weight": 40 } } ],
        "final": [ { "tension": { "muscle": "muscle2", "at": "3 N", "weight": 0.1 } } ] });
    let ran = run("solve", &problem(&Value::Null, objective, false), &[]);
    let seen = Seen::new(&ran);
    let volts: f64 = ["muscle1", "muscle2"]
        .map(|name| squares(&Table::read(&ran, "controls.csv").column(name), 0.0))
        .iter()
        .sum();
    let tensions = seen.tensions();
    let parts = [
        0.01 * seen.step * 1e-6 * volts,
        2.0 * seen.step * squares(&tensions, 1.0),
        0.3 * seen.step * squares(&seen.rates(), 0.5),
        40.0 * seen.step * squares(&seen.speeds(), 0.0),
        0.1 * squares(&tensions[tensions.len() - 1..], 3.0),
    ];
    assert!(parts.iter().all(|part| *part > 1e-4), "{parts:?}");
    let sum: f64 = parts.iter().sum();
    assert!(
        (seen.objective / sum - 1.0).abs() < 1e-6,
        "{} {parts:?}",
        seen.objective
    );
    let last = tensions[tensions.len() - 1];
    let told = &ran.read("summary.json")["final_values"][0];
    assert_eq!(told["name"], "muscle2_tension");
    let reached = told["reached"].as_f64().unwrap();
    assert!((reached - last).abs() < 1e-6, "{reached} {last}");
    let told = format!("{}{}", ran.out, ran.err);
    assert!(told.contains("muscle2_tension ends at"), "{told}");
}

#[test]
fn costs_of_sources_are_those_of_currents_that_change_the_charge() {
    let circuit = json!({ "resistance": 200e3 });
    let objective = json!({ "effort": 0.01, "track": [
        { "current": { "source": "muscle2", "at": "1 mA", "weight": 2 } },
        { "power": { "source": "muscle2", "weight": 0.05 } },
        { "electric_field": { "muscle": "muscle2", "weight": 1e-3 } } ] });
    let ran = run("solve", &problem(&circuit, objective, false), &[]);
    let seen = Seen::new(&ran);
    let volts = seen.motion.column("muscle2_voltage");
    let stretches = seen.motion.column("muscle2_stretch");
    let charges: Vec<f64> = volts
        .iter()
        .zip(&stretches)
        .map(|(v, s)| v * capacitance(*s))
        .collect();
    let currents: Vec<f64> = charges
        .windows(2)
        .map(|pair| 1e3 * (pair[1] - pair[0]) / seen.step)
        .collect();
    let powers: Vec<f64> = currents
        .iter()
        .zip(&seen.voltages)
        .map(|(i, v)| 1e-3 * i * v)
        .collect();
    let fields: Vec<f64> = volts
        .iter()
        .zip(&stretches)
        .map(|(v, s)| v / (50.0 * s))
        .collect();
    let ends = 0.5 * (fields[0].powi(2) + fields[fields.len() - 1].powi(2));
    let all = Table::read(&ran, "controls.csv");
    let effort: f64 = ["muscle1", "muscle2"]
        .map(|name| squares(&all.column(name), 0.0))
        .iter()
        .sum();
    let parts = [
        0.01 * seen.step * 1e-6 * effort,
        2.0 * seen.step * squares(&currents, 1.0),
        0.05 * seen.step * squares(&powers, 0.0),
        1e-3 * seen.step * (squares(&fields, 0.0) - ends),
    ];
    assert!(parts.iter().all(|part| *part > 1e-4), "{parts:?}");
    let sum: f64 = parts.iter().sum();
    assert!(
        (seen.objective / sum - 1.0).abs() < 1e-5,
        "{} {parts:?}",
        seen.objective
    );
}

#[test]
fn a_limit_at_a_part_of_the_duration_holds_there_alone() {
    let objective = json!({ "effort": 1.0, "rate": 0.001 });
    let mut free = problem(&Value::Null, objective, true);
    free["control"]["limits"] = json!([
        { "part": 1, "joint_rate": { "joint": "joint1", "min": "0.6 rad/s", "max": "0.6 rad/s" } },
        { "part": 1, "tension": { "muscle": "muscle2", "min": "2.5 N" } },
        { "part": 1, "joint_angle": { "joint": "joint1", "min": "4 deg" } },
        { "part": 0.5, "marker_speed": { "marker": "tip", "max": "0.02 m/s" } } ]);
    for coordinates in ["reduced", "redundant"] {
        free["control"]["coordinates"] = json!(coordinates);
        let seen = Seen::new(&run("solve", &free, &[]));
        let (rates, tensions, speeds) = (seen.rates(), seen.tensions(), seen.speeds());
        let last = rates.len() - 1;
        assert!((rates[last] - 0.6).abs() < 1e-6, "{rates:?}");
        assert!(
            rates.iter().any(|rate| (rate - 0.6).abs() > 0.1),
            "{rates:?}"
        );
        assert!(
            tensions[last] > 2.5 - 1e-6 && tensions[0] < 2.4,
            "{tensions:?}"
        );
        let angle = seen.angles[last + 1].to_degrees();
        assert!((angle - 4.0).abs() < 1e-4, "{angle}");
        let middle = rates.len() / 2 - 1;
        assert!(speeds[middle] < 0.02 + 1e-7, "{speeds:?}");
        assert!(speeds.iter().any(|speed| *speed > 0.03), "{speeds:?}");
    }
}

#[test]
fn a_marker_is_no_faster_than_its_limit() {
    let objective = json!({ "effort": 1.0 });
    let mut problem = problem(&Value::Null, objective, false);
    let fast = Seen::new(&run("solve", &problem, &[])).speeds();
    let most = fast.iter().copied().fold(0.0, f64::max);
    assert!(most > 0.05, "{fast:?}");
    problem["control"]["limits"] =
        json!([{ "marker_speed": { "marker": "tip", "max": 0.8 * most } }]);
    let slow = Seen::new(&run("solve", &problem, &[])).speeds();
    let reached = slow.iter().copied().fold(0.0, f64::max) / (0.8 * most);
    assert!((reached - 1.0).abs() < 1e-6, "{reached}");
}

#[test]
fn limits_at_single_times_that_make_no_sense_are_refused() {
    let refused = |limit: Value, words: &[&str]| {
        let mut problem = problem(&Value::Null, json!({ "effort": 1 }), false);
        problem["control"]["limits"] = json!([limit]);
        run("solve", &problem, &[]).is_refused(words);
    };
    let angle = json!({ "joint": "joint1", "max": "9 deg" });
    for part in [0.0, -0.5, 1.5] {
        let limit = json!({ "part": part, "joint_angle": angle });
        refused(limit, &["limits[0].part", "above 0 and at most 1"]);
    }
    refused(json!({ "part": 0.5 }), &["limits[0]", "none of them"]);
    let at_rest = json!({ "part": 1, "joint_angle": { "joint": "joint1", "max": "1 deg" } });
    refused(at_rest, &["control.goal", "joint joint1", "0.017453"]);
    let speed = json!({ "marker_speed": { "marker": "tip", "max": "0 m/s" } });
    refused(speed, &["limits[0].marker_speed.max", "positive"]);
}
