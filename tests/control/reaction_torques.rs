//! Limits and goals of the torque that a joint transmits: kept at all instants between intervals or at one, active, the same in both coordinates and
//! where the duration is free, those of the table, and refused where they make no sense.

use crate::drivers::Table;
use crate::limits::run;
use crate::tension_limits::greatest;
use serde_json::{Value, json};

/// An arm that turns about z at the ground and about x at its elbow, under gravity along z, each joint moved by a muscle beside it.
fn arm(limits: Value, coordinates: &str, is_free: bool) -> Value {
    let size = json!({ "size": ["20 mm", "60 mm", "20 mm"] });
    let muscle = |name: &str, [from, to]: [(&str, [f64; 3]); 2]| {
        let end = |(body, at): (&str, [f64; 3])| json!({ "body": body, "at": at });
        json!({ "name": name, "material": "silicone", "from": end(from), "to": end(to),
            "cross_section": ["10 mm", "10 mm"], "layer_thickness": "50 um" })
    };
    let joint = |name: &str, axis: [f64; 3], parent: &str, child: &str, at: [f64; 3]| {
        json!({ "name": name, "revolute": { "axis": axis }, "parent": parent, "child": child,
            "at": at, "damping": "1e-4 N m s/rad" })
    };
    let duration = match is_free {
        true => json!({ "min": 0.02, "max": 0.4, "guess": 0.06 }),
        false => json!("0.06 s"),
    };
    let objective = match is_free {
        true => json!({ "effort": 0.01, "duration": 1.0 }),
        false => json!({ "effort": 1.0 }),
    };
    let base = "ground";
    json!({
        "scene": {
            "name": "arm", "gravity": [0, 0, -9.81],
            "materials": { "silicone": { "density": 1000, "shear_modulus": "100 kPa",
                "lame_lambda": "400 kPa", "dielectric": "ideal", "relative_permittivity": 3,
                "viscosity": 1000 } },
            "bodies": [
                { "name": "upper", "mass": "20 g", "box": size, "position": [0, 0.03, 0] },
                { "name": "lower", "mass": "20 g", "box": size, "position": [0, 0.09, 0] } ],
            "joints": [
                joint("shoulder", [0.0, 0.0, 1.0], base, "upper", [0.0; 3]),
                joint("elbow", [1.0, 0.0, 0.0], "upper", "lower", [0.0, 0.06, 0.0]) ],
            "muscles": [
                muscle("left", [(base, [-0.02, -0.01, 0.005]), ("upper", [-0.02, 0.03, 0.005])]),
                muscle("right", [(base, [0.02, -0.01, 0.005]), ("upper", [0.02, 0.03, 0.005])]),
                muscle("upwards", [("upper", [0.0, 0.03, 0.02]), ("lower", [0.0, 0.07, 0.02])]),
                muscle("downwards", [("upper", [0.0, 0.03, -0.02]), ("lower", [0.0, 0.07, -0.02])]) ]
        },
        "control": {
            "duration": duration, "intervals": 12, "coordinates": coordinates,
            "start": { "joint_angles": { "shoulder": 0, "elbow": 0 } },
            "goal": { "joint_angles": { "shoulder": "4 deg", "elbow": "-3 deg" } },
            "voltage_bounds": ["0 V", "6 kV"], "objective": objective, "limits": limits
        }
    })
}

/// A direction of length one.
const ABOUT: [f64; 3] = [0.6, 0.64, 0.48];

/// Torques in N m of the shoulder about the direction at the instants, and the objective.
fn solved(problem: &Value) -> (Vec<f64>, f64) {
    let ran = run("solve", problem, &["--no-report"]);
    ran.is_solved();
    let table = Table::read(&ran, "trajectory.csv");
    let columns = ["x", "y", "z"].map(|axis| table.column(&format!("shoulder_torque_{axis}")));
    let instants = 0..columns[0].len();
    let torque = |k: usize| 1e-3 * (0..3).map(|i| columns[i][k] * ABOUT[i]).sum::<f64>();
    let objective = ran.read("summary.json")["objective"].as_f64().unwrap();
    (instants.map(torque).collect(), objective)
}

fn limit(bounds: Value) -> Value {
    let mut limit = json!({ "joint": "shoulder", "about": ABOUT.map(|part| 5.0 * part) });
    let own = limit.as_object_mut().unwrap();
    own.extend(bounds.as_object().unwrap().clone());
    json!({ "reaction_torque": limit })
}

#[test]
fn a_joint_transmits_no_more_torque_than_its_limit() {
    for is_free in [false, true] {
        let (torques, cheap) = solved(&arm(json!([]), "reduced", is_free));
        let inner = 1..torques.len() - 1;
        let [least, most] = [-1.0, 1.0].map(|sign| {
            let signed: Vec<f64> = torques[inner.clone()].iter().map(|t| sign * t).collect();
            sign * greatest(&signed)
        });
        assert!(most - least > 0.01, "{torques:?}");
        let bound = least + 0.8 * (most - least);
        let limits = json!([limit(json!({ "max": bound }))]);
        let both = ["reduced", "redundant"]
            .map(|coordinates| solved(&arm(limits.clone(), coordinates, is_free)));
        for (torques, objective) in &both {
            let over = (greatest(&torques[inner.clone()]) - bound) / (most - least);
            assert!(over < 1e-6 && over > -1e-3, "{over}");
            assert!(*objective > cheap * (1.0 + 1e-7), "{objective} {cheap}");
        }
        let [one, other] = both.map(|(_, objective)| objective);
        assert!((one / other - 1.0).abs() < 1e-6, "{one} {other}");
    }
}

#[test]
fn a_torque_that_is_prescribed_at_a_time_is_that_of_the_table() {
    // Without inputs that hold the goal, the last instant between intervals is that before the end.
    let arm = |limits: Value, coordinates: &str| {
        let mut arm = arm(limits, coordinates, false);
        let goal = json!({ "upwards": "1 kV", "left": "1.5 kV" });
        arm["control"]["goal"] = json!({ "rest_at_voltages": goal });
        arm
    };
    let (free, _) = solved(&arm(json!([]), "reduced"));
    for (part, instant) in [(0.5, 6), (1.0, 11)] {
        let torque = free[instant] + 0.004;
        let mut limit = limit(json!({ "min": torque, "max": torque }));
        limit["part"] = json!(part);
        for coordinates in ["reduced", "redundant"] {
            let (torques, _) = solved(&arm(json!([limit]), coordinates));
            let error = torques[instant] - torque;
            assert!(error.abs() < 1e-8, "{error:e} with part {part}");
        }
    }
}

#[test]
fn limits_of_torques_that_make_no_sense_are_refused() {
    let place = "limits[0].reaction_torque";
    let mut ball = arm(json!([limit(json!({ "max": 1 }))]), "reduced", false);
    let joint = ball["scene"]["joints"][0].as_object_mut().unwrap();
    joint.remove("revolute");
    joint.remove("damping");
    joint.insert("spherical".to_owned(), json!({}));
    ball["control"]["goal"] = json!("free");
    ball["control"]["start"] = json!({ "joint_angles": { "elbow": 0 } });
    let refused = |problem: &Value, words: &[&str]| {
        run("solve", problem, &[]).is_refused(&[&[place], words].concat());
    };
    refused(&ball, &["shoulder", "spherical", "transmits a torque"]);
    let cases = [
        (json!({}), "no bound"),
        (json!({ "max": "1 N" }), "a torque"),
        (json!({ "joint": "wrist", "max": 1 }), "wrist"),
        (json!({ "about": [0, 0, 0], "max": 1 }), "about"),
    ];
    for (change, words) in cases {
        refused(&arm(json!([limit(change)]), "reduced", false), &[words]);
    }
}
