//! Random optima of robots of all sizes under costs of all weights: no solve that goes on from a "solved" one, to a tolerance of 1e-12 and with the
//! objective divided by what was found, gains more than 1e-5 of it.

use crate::seeds;
use crate::similar::program;
use proboscis::math::Random;
use serde_json::{Value, json};

/// Permittivity of vacuum in F/m.
const VACUUM: f64 = 8.854e-12;
/// The most that a solved problem may leave to gain, as a part of its objective.
const LOSS: f64 = 1e-5;

/// Draws parts of problems.
struct Draw(Random);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.0.between(low, high))
    }

    fn is(&mut self, part: f64) -> bool {
        self.0.between(0.0, 1.0) < part
    }

    fn of(&mut self, count: usize) -> usize {
        (self.0.between(0.0, count as f64) as usize).min(count - 1)
    }
}

/// A robot, with what a problem of it needs to know.
struct Robot {
    scene: Value,
    /// Bounds of its inputs, as keys of the problem.
    bounds: Vec<(&'static str, Value)>,
    joints: Vec<String>,
    /// Duration in s; a goal that is far away, in rad or m; cost of usual inputs.
    duration: f64,
    reach: f64,
    effort: f64,
    has_resistors: bool,
}

/// Links or a cart with motors, in springs and dampers.
fn driven(draw: &mut Draw) -> Robot {
    let is_cart = draw.is(0.3);
    let count = if is_cart { 1 } else { 1 + draw.of(2) };
    let (length, duration) = (draw.power(-2.3, -0.3), draw.power(-1.5, 1.0));
    let mass = draw.power(-3.0, 0.0) * length;
    let size = if is_cart { 1.0 } else { length * length };
    let force = mass * size / duration.powi(2) * if is_cart { length } else { 1.0 };
    let parent = |i: usize| {
        if i == 0 {
            "ground".to_owned()
        } else {
            format!("b{}", i - 1)
        }
    };
    let mut joints = Vec::new();
    let mut bodies = Vec::new();
    for i in 0..count {
        let at = -(i as f64) * length;
        bodies.push(json!({
            "name": format!("b{i}"), "mass": mass, "position": [0, at - 0.5 * length, 0],
            "box": { "size": [0.2 * length, length, 0.2 * length] }
        }));
        let mut joint = json!({ "name": format!("j{i}"), "parent": parent(i), "child": format!("b{i}"), "at": [0, at, 0] });
        let [kind, axis] = if is_cart {
            ["prismatic", "x"]
        } else {
            ["revolute", "z"]
        };
        let axis = if axis == "x" { [1, 0, 0] } else { [0, 0, 1] };
        joint[kind] = json!({ "axis": axis });
        if draw.is(0.5) {
            joint["damping"] = json!(draw.between(0.0, 1.0) * mass * size / duration);
        }
        if draw.is(0.5) {
            joint["stiffness"] = json!(draw.between(0.0, 3.0) * mass * size / duration.powi(2));
        }
        joints.push(joint);
    }
    let names: Vec<String> = (0..count).map(|i| format!("j{i}")).collect();
    let loads: Vec<Value> = (0..count)
        .map(|i| json!({ "name": format!("l{i}"), "joint": names[i] }))
        .collect();
    let bounds: serde_json::Map<String, Value> = (0..count)
        .map(|i| {
            let bound = force * draw.power(0.7, 4.0);
            (format!("l{i}"), json!([-bound, bound]))
        })
        .collect();
    let mut scene = json!({ "name": "driven", "bodies": bodies, "joints": joints, "loads": loads });
    if !is_cart && draw.is(0.6) {
        scene["gravity"] = json!([0, -draw.between(0.1, 10.0) * length / duration.powi(2), 0]);
    }
    Robot {
        scene,
        bounds: vec![("load_bounds", bounds.into())],
        joints: names,
        duration,
        reach: [1.0, 0.1, 0.01][draw.of(3)] * if is_cart { length } else { 1.0 },
        effort: duration * force * force,
        has_resistors: false,
    }
}

/// Links between pairs of muscles, some behind resistors, some that creep.
fn muscular(draw: &mut Draw) -> Robot {
    let count = 1 + draw.of(2);
    let (length, duration) = (draw.power(-2.3, -1.0), draw.power(-1.5, 1.3));
    let (modulus, permittivity, layer) = (
        draw.power(4.5, 6.0),
        draw.between(2.0, 6.0),
        draw.power(-4.7, -3.5),
    );
    let mut material = json!({ "shear_modulus": modulus, "relative_permittivity": permittivity });
    if draw.is(0.8) {
        material["viscosity"] = json!(modulus * duration * draw.power(-2.5, 0.0));
    }
    if draw.is(0.3) {
        let time = duration * draw.power(-1.5, 0.5);
        material["maxwell"] = json!([{ "shear_modulus": 0.5 * modulus, "relaxation_time": time }]);
    }
    if draw.is(0.3) {
        material["law"] = json!({ "mooney_rivlin": { "share": draw.between(0.05, 0.3) } });
    }
    let (edge, arm) = (0.2 * length, 0.3 * length);
    let stiffness = 3.0 * modulus * edge * edge / (0.8 * length) * 2.0 * arm * arm;
    let omega = std::f64::consts::TAU / (duration * draw.between(0.2, 5.0));
    let mass = stiffness / omega.powi(2) / (length * length / 3.0) / count as f64;
    let capacitance = permittivity * VACUUM * edge * edge * 0.8 * length / layer.powi(2);
    let has_resistors = draw.is(0.5);
    let parent = |i: usize| {
        if i == 0 {
            "ground".to_owned()
        } else {
            format!("b{}", i - 1)
        }
    };
    let (mut bodies, mut joints, mut muscles) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..count {
        let at = i as f64 * length;
        bodies.push(json!({
            "name": format!("b{i}"), "mass": mass, "position": [0, at + 0.5 * length, 0],
            "box": { "size": [0.2 * length, length, 0.2 * length] }
        }));
        joints.push(json!({
            "name": format!("j{i}"), "revolute": { "axis": [0, 0, 1] }, "parent": parent(i), "child": format!("b{i}"), "at": [0, at, 0]
        }));
        for (side, x) in [("l", arm), ("r", -arm)] {
            let mut muscle = json!({
                "name": format!("u{i}{side}"), "material": "m", "cross_section": [edge, edge], "layer_thickness": layer,
                "from": { "body": parent(i), "at": [x, at - 0.4 * length, 0] }, "to": { "body": format!("b{i}"), "at": [x, at + 0.4 * length, 0] }
            });
            if has_resistors {
                muscle["circuit"] =
                    json!({ "resistance": duration * draw.power(-3.0, -1.0) / capacitance });
            }
            muscles.push(muscle);
        }
    }
    let natural = layer * (modulus / (permittivity * VACUUM)).sqrt();
    let most = natural * draw.power(-0.3, 1.0);
    Robot {
        scene: json!({ "name": "muscular", "materials": { "m": material }, "bodies": bodies, "joints": joints, "muscles": muscles }),
        bounds: vec![("voltage_bounds", json!([0.0, most]))],
        joints: (0..count).map(|i| format!("j{i}")).collect(),
        duration,
        reach: [0.1, 0.03, 0.003][draw.of(3)],
        effort: duration * (0.3 * most.min(natural) / 1e3).powi(2),
        has_resistors,
    }
}

/// A problem of a robot: a goal, or costs of the end or along the motion, also of measured quantities, with a given or a free duration.
fn problem(draw: &mut Draw) -> Value {
    let robot = if draw.is(0.4) {
        driven(draw)
    } else {
        muscular(draw)
    };
    let Robot {
        duration, reach, ..
    } = robot;
    let is_cart = robot.scene["joints"][0].get("prismatic").is_some();
    let unit = if is_cart { 1e3 } else { 1.0 };
    let effort = if draw.is(0.5) {
        1.0
    } else {
        draw.power(-6.0, 12.0)
    };
    let weight = match draw.is(0.5) {
        true => draw.power(-6.0, 12.0),
        false => effort * robot.effort / (reach * unit).powi(2) * draw.power(-2.0, 4.0),
    };
    let joint = robot.joints[draw.of(robot.joints.len())].clone();
    let target = draw.between(-1.0, 1.0) * reach;
    let angles = |value: f64| -> Value {
        robot
            .joints
            .iter()
            .map(|name| (name.clone(), json!(value)))
            .collect()
    };
    let mut objective = json!({ "effort": effort });
    let intervals = [8, 12, 20, 40][draw.of(4)];
    let mut control = json!({
        "duration": duration, "intervals": intervals,
        "start": { "joint_angles": angles(0.0) }, "goal": "free"
    });
    match draw.of(4) {
        0 => control["goal"] = json!({ "joint_angles": angles(target), "hold": "none" }),
        1 => {
            control["goal"] = json!({ "joint_angles": angles(target), "hold": "none" });
            control["duration"] =
                json!({ "min": 0.2 * duration, "max": 5.0 * duration, "guess": duration });
            objective["duration"] = json!(effort * robot.effort / duration * draw.power(-3.0, 3.0));
        }
        2 => {
            objective["final"] =
                json!([{ "joint": { "joint": joint, "at": target, "weight": weight } }]);
        }
        _ => {
            let along = json!({ "sine": { "amplitude": target, "period": duration } });
            objective["track"] =
                json!([{ "joint": { "joint": joint, "along": along, "weight": weight } }]);
        }
    }
    if robot.scene.get("muscles").is_some() {
        measured(draw, &mut objective, effort, &robot);
    }
    if draw.is(0.25) {
        let most = 8.0 * reach / duration;
        control["limits"] =
            json!([{ "joint_rate": { "joint": joint, "min": -most, "max": most } }]);
    }
    for (key, value) in robot.bounds {
        control[key] = value;
    }
    control["objective"] = objective;
    json!({ "scene": robot.scene, "control": control })
}

/// Adds the cost of a measured quantity of a muscle.
fn measured(draw: &mut Draw, objective: &mut Value, effort: f64, robot: &Robot) {
    let mut track = |quantity: Value| {
        let mut all = objective["track"].as_array().cloned().unwrap_or_default();
        all.push(quantity);
        objective["track"] = all.into();
    };
    match (draw.of(8), robot.has_resistors) {
        (0, true) => {
            track(json!({ "power": { "source": "u0l", "weight": draw.power(-6.0, 12.0) } }));
        }
        (1, true) => {
            track(json!({ "current": { "source": "u0l", "weight": draw.power(-6.0, 8.0) } }));
        }
        (2, _) => track(json!({ "tension": { "muscle": "u0l", "weight": draw.power(-3.0, 6.0) } })),
        (3, _) => {
            track(
                json!({ "electric_field": { "muscle": "u0l", "weight": draw.power(-6.0, 3.0) } }),
            );
        }
        (4, _) => {
            objective["rate"] = json!(effort * robot.duration.powi(2) * draw.power(-3.0, 0.0));
        }
        (5, _) => {
            objective["peak_voltage"] = json!(effort * robot.duration * draw.power(-2.0, 2.0));
        }
        (6, _) => objective["electrical_energy"] = json!(draw.power(-3.0, 6.0)),
        (7, false) => objective["mechanical_work"] = json!(draw.power(-3.0, 6.0)),
        _ => {}
    }
}

/// The problem with all weights times a factor.
fn weighted(problem: &Value, factor: f64) -> Value {
    let mut out = problem.clone();
    for (_, cost) in out["control"]["objective"].as_object_mut().unwrap() {
        if let Some(weight) = cost.as_f64() {
            *cost = json!(weight * factor);
        }
        for one in cost.as_array_mut().into_iter().flatten() {
            for (_, quantity) in one.as_object_mut().unwrap() {
                quantity["weight"] = json!(quantity["weight"].as_f64().unwrap() * factor);
            }
        }
    }
    out
}

#[test]
fn no_solved_problem_leaves_much_to_gain() {
    let (mut all, mut solved, mut failures) = (0, 0, Vec::new());
    seeds(0, 40, &[], |seed| {
        let problem = problem(&mut Draw(Random::new(seed)));
        let first = program("solve", &problem);
        let summary = first.summary();
        let objective = summary["objective"].as_f64().unwrap_or(0.0);
        all += 1;
        println!("{seed}: {} {objective:.6e}", summary["status"]);
        if summary["status"] != "solved" || objective == 0.0 {
            return;
        }
        solved += 1;
        let mut again = weighted(&problem, objective.abs().recip());
        again["control"]["guess"] = json!({ "solution": first.folder() });
        again["control"]["solver"] = json!({ "tolerance": 1e-12 });
        let found = program("solve", &again).summary();
        let gained = objective.signum() - found["objective"].as_f64().unwrap();
        if gained > LOSS {
            failures.push(format!("{seed}: {gained:e}"));
        }
    });
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(10 * solved >= 8 * all, "{solved} of {all} are solved");
}
