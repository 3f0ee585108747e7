//! Steps by a tolerance end where contacts begin and end: a bounce without losses against its closed form.

use crate::common::problem;
use proboscis::control::problem::Task;
use proboscis::dynamics::DiscreteTrajectory;
use proboscis::model::Model;
use proboscis::tasks::simulate::{SimulationRequest, simulate};
use serde_json::json;
use std::ops::ControlFlow;

/// Mass in g, stiffness in N/mm, acceleration in mm/ms², radius, fall and end in mm and ms.
const MASS: f64 = 20.0;
const STIFFNESS: f64 = 10.0;
const GRAVITY: f64 = 9.81e-3;
const RADIUS: f64 = 10.0;
const FALL: f64 = 70.0;
const END: f64 = 200.0;

/// Height of the centre at the end: a fall, a part of an oscillation about the overlap at rest, a rise.
fn height() -> f64 {
    let (speed, omega) = ((2.0 * GRAVITY * FALL).sqrt(), (STIFFNESS / MASS).sqrt());
    let touch = 2.0 / omega * (std::f64::consts::PI - (speed * omega / GRAVITY).atan());
    let rise = END - speed / GRAVITY - touch;
    RADIUS + speed * rise - 0.5 * GRAVITY * rise * rise
}

#[test]
fn steps_by_a_tolerance_end_at_touches() {
    let centre = json!([0, format!("{} mm", RADIUS + FALL), 0]);
    for tolerance in [1e-2, 1e-3, 1e-4] {
        let file = json!({
            "scene": {
                "name": "ball", "gravity": [0, -1e3 * GRAVITY, 0],
                "bodies": [ { "name": "ball", "mass": format!("{MASS} g"), "sphere": { "radius": "10 mm" }, "position": centre, "free": true } ],
                "contacts": [ {
                    "name": "floor", "stiffness": format!("{STIFFNESS} N/mm"),
                    "sphere": { "body": "ball", "at": centre, "radius": "10 mm" }, "plane": { "at": [0, 0, 0], "normal": [0, 1, 0] }
                } ]
            },
            "simulate": { "duration": format!("{END} ms"), "tolerance": tolerance }
        });
        let (system, task) = problem(&file);
        let Task::Simulate(task) = task else {
            panic!("a simulation")
        };
        let go = &mut |_: usize, _: &Model, _: &DiscreteTrajectory| ControlFlow::Continue(());
        let result = simulate(&system, &task, SimulationRequest::default(), go).unwrap();
        let motion = &result.simulated.discrete;
        let (model, steps) = (&result.simulated.model, motion.intervals());
        let last = model.action.map.placed(&motion.z[steps]);
        let error = (model.poses(&last)[0].centre.y - height()).abs() / (RADIUS + FALL);
        println!("tolerance {tolerance}: {steps} steps, error {error:.1e}");
        assert!(error < tolerance, "{error}");
        assert!((steps as f64) < 30.0 / tolerance.sqrt(), "{steps}");
    }
}
