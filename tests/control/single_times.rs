//! Limits at a part of the duration, and limits of what is prescribed: none is left out in silence.

use crate::drivers::{Table, pair};
use crate::limits::{Ran, run};
use serde_json::{Value, json};

fn with(limit: &Value, change: impl FnOnce(&mut Value)) -> Ran {
    let mut problem = pair(&Value::Null, json!([limit]), "reduced");
    change(&mut problem["control"]);
    run("solve", &problem, &[])
}

#[test]
fn limits_and_waypoints_near_the_end_are_those_of_the_end() {
    // The goal is at 8.7 degrees; 0.99 of 20 intervals is the last instant.
    for part in [0.98, 0.99, 1.0] {
        let limit = json!({ "part": part, "joint_angle": { "joint": "joint1", "max": "1 deg" } });
        with(&limit, |_| {}).is_refused(&["goal", "joint1", "at most 0.017453"]);
        let limit = json!({ "part": part, "stretch": { "muscle": "muscle1", "max": 0.9 } });
        with(&limit, |_| {}).is_refused(&["goal", "stretch of muscle1", "at most 0.9"]);
    }
    let mut problem = pair(&Value::Null, json!([]), "reduced");
    problem["control"]["waypoints"] =
        json!([{ "part": 0.99, "joint_angles": { "joint1": "-8 deg" } }]);
    let ran = run("solve", &problem, &[]);
    assert_ne!(ran.status, 0, "{}", ran.out);
}

#[test]
fn what_inputs_that_are_given_alone_decide_is_not_left_out() {
    let ramp =
        json!({ "muscle1": { "ramp": { "from": "0 V", "to": "1 kV", "duration": "0.2 s" } } });
    let given = |control: &mut Value| control["voltages"] = ramp.clone();
    for part in [0.5, 1.0] {
        let limit = json!({ "part": part,
            "voltage_rate": { "source": "muscle1", "max": "1 kV/s" } });
        let ran = with(&limit, |control| {
            given(control);
            control["goal"] = json!("free");
        });
        ran.is_refused(&["rate of the given voltage of muscle1", "at most 1000"]);
    }
    let limit = json!({ "part": 1, "electric_field": { "muscle": "muscle1", "max": "5 V/um" } });
    let ran = with(&limit, given);
    assert_ne!(ran.status, 0, "{}", ran.out);
}

#[test]
fn steps_are_limited_at_the_instant_that_is_named() {
    for (part, instant, bound) in [(0.5, 10, 3.0), (0.05, 1, 0.5), (0.02, 1, 0.5)] {
        let limit = json!({ "part": part, "reaction_force":
            { "joint": "joint1", "along": [0, 1, 0], "min": bound } });
        let mut problem = pair(&Value::Null, json!([limit]), "reduced");
        let silicone = &mut problem["scene"]["materials"]["silicone"];
        silicone.as_object_mut().unwrap().remove("dielectric");
        problem["control"]["duration"] = json!("0.06 s");
        problem["control"]["voltage_bounds"] = json!(["0 V", "5 kV"]);
        let ran = run("solve", &problem, &["--no-report"]);
        ran.is_solved();
        let force = Table::read(&ran, "trajectory.csv").column("joint1_force_y");
        assert!(
            (force[instant] - bound).abs() < 1e-5,
            "{force:?} with part {part}"
        );
    }
}

#[test]
fn limits_of_steps_are_said_to_be_empty_in_one_interval() {
    let limit = json!({ "voltage_rate": { "source": "muscle1", "max": "1 kV/s" } });
    let told = "the rate of the voltage of muscle1 is limited from one interval to the next";
    for (intervals, is_told) in [(1, true), (2, false)] {
        let ran = with(&limit, |control| {
            control["intervals"] = json!(intervals);
            control["goal"] = json!("free");
        });
        assert_eq!(ran.err.contains(told), is_told, "{}", ran.err);
    }
}

/// A cart that a prescribed motion moves with up to 0.157 m/s, and a body on it that a muscle moves.
fn cart(limit: &Value) -> Value {
    let size = json!({ "size": ["10 mm", "10 mm", "10 mm"] });
    let rail = json!({ "axis": [0, 1, 0] });
    json!({
        "scene": {
            "name": "cart",
            "materials": { "silicone": { "density": 1000, "shear_modulus": "100 kPa",
                "lame_lambda": "400 kPa", "relative_permittivity": 3, "viscosity": 1000 } },
            "bodies": [
                { "name": "cart", "mass": "30 g", "box": size, "position": [0, 0, 0] },
                { "name": "load", "mass": "30 g", "box": size, "position": [0, "50 mm", 0] } ],
            "joints": [
                { "name": "rail", "prismatic": rail, "parent": "ground", "child": "cart",
                  "at": [0, 0, 0],
                  "motion": { "sine": { "amplitude": "2 mm", "period": "80 ms" } } },
                { "name": "lift", "prismatic": rail, "parent": "cart", "child": "load",
                  "at": [0, "50 mm", 0] } ],
            "markers": [{ "name": "middle", "body": "cart", "at": [0, 0, 0] }],
            "muscles": [{ "name": "muscle", "material": "silicone",
                "from": { "body": "cart", "at": [0, 0, 0] },
                "to": { "body": "load", "at": [0, "40 mm", 0] },
                "cross_section": ["10 mm", "20 mm"], "layer_thickness": "50 um" }]
        },
        "control": {
            "duration": "0.16 s", "intervals": 40, "start": { "joint_angles": { "lift": 0 } },
            "goal": "free", "voltage_bounds": ["0 V", "3 kV"], "objective": { "effort": 1.0 },
            "limits": [limit]
        }
    })
}

#[test]
fn what_prescribed_motions_alone_decide_is_not_left_out() {
    for (speed, way, is_kept) in [("0.05 m/s", "1 mm", false), ("0.2 m/s", "3 mm", true)] {
        let limits = [
            json!({ "marker_speed": { "marker": "middle", "max": speed } }),
            json!({ "joint_rate": { "joint": "rail", "max": speed } }),
            json!({ "joint_angle": { "joint": "rail", "max": way } }),
        ];
        for limit in &limits {
            let ran = run("solve", &cart(limit), &["--no-report"]);
            assert_eq!(ran.status == 0, is_kept, "{limit}: {}{}", ran.out, ran.err);
        }
    }
}
