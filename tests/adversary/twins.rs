//! Twins of a robot: the same system written otherwise, each with the map from its places to those of the first.

use crate::robots::Robot;
use nalgebra::{Matrix3, Rotation3, Vector3};
use serde_json::{Value, json};

/// Calls a function with each place of a scene: what stands under `position` and `at`.
fn each_place(value: &mut Value, change: &dyn Fn(&mut Value)) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map.iter_mut() {
                match key.as_str() {
                    "position" | "at" => change(inner),
                    _ => each_place(inner, change),
                }
            }
        }
        Value::Array(list) => list.iter_mut().for_each(|inner| each_place(inner, change)),
        _ => {}
    }
}

fn read(value: &Value) -> Vector3<f64> {
    let list: [f64; 3] = serde_json::from_value(value.clone()).unwrap();
    Vector3::from(list)
}

fn written(vector: Vector3<f64>) -> Value {
    json!([vector.x, vector.y, vector.z])
}

/// The robot with its lists in reverse order.
pub(crate) fn reversed(robot: &Robot) -> Robot {
    let mut twin = robot.clone();
    for list in ["bodies", "joints", "muscles", "springs", "loads"] {
        if let Some(Value::Array(list)) = twin.scene.get_mut(list) {
            list.reverse();
        }
    }
    twin
}

/// The robot with masses and densities this many times as great.
pub(crate) fn heavier(robot: &Robot, times: f64) -> Robot {
    let mut twin = robot.clone();
    let grown = |value: &Value| json!(value.as_f64().unwrap() * times);
    for body in twin.scene["bodies"].as_array_mut().unwrap() {
        body["mass"] = grown(&body["mass"]);
    }
    let density = &mut twin.scene["materials"]["m"]["density"];
    *density = grown(density);
    twin
}

/// The robot in millimetres, grams and kilovolts.
pub(crate) fn in_other_units(robot: &Robot) -> Robot {
    let mut twin = robot.clone();
    let length = |value: &Value| json!(format!("{:?} mm", value.as_f64().unwrap() * 1e3));
    each_place(&mut twin.scene, &|place| {
        let list = place.as_array().unwrap();
        *place = list.iter().map(length).collect();
    });
    for body in twin.scene["bodies"].as_array_mut().unwrap() {
        body["mass"] = json!(format!("{:?} g", body["mass"].as_f64().unwrap() * 1e3));
    }
    twin
}

/// The robot turned about an axis; boxes lie along the axes, so that bodies become their mass and inertia.
pub(crate) fn turned(robot: &Robot, turn: &Rotation3<f64>) -> Robot {
    mapped(robot, *turn.matrix())
}

/// The robot in a mirror: axes of hinges are those of the mirrored motion.
pub(crate) fn mirrored(robot: &Robot, normal: usize) -> Robot {
    let mut map = Matrix3::identity();
    map[(normal, normal)] = -1.0;
    mapped(robot, map)
}

fn mapped(robot: &Robot, map: Matrix3<f64>) -> Robot {
    let mut twin = robot.clone();
    each_place(&mut twin.scene, &|place| {
        *place = written(map * read(place));
    });
    let axial = map * map.determinant();
    for joint in twin.scene["joints"].as_array_mut().unwrap() {
        if joint.get("revolute").is_some() {
            let axis = axial * read(&joint["revolute"]["axis"]);
            joint["revolute"]["axis"] = written(axis);
        }
    }
    if let Some(loads) = twin.scene.get_mut("loads") {
        let loads = loads.as_array_mut().unwrap().iter_mut();
        for direction in loads.filter_map(|load| load.get_mut("direction")) {
            *direction = written(map * read(direction));
        }
    }
    if let Some(gravity) = twin.scene.get_mut("gravity") {
        *gravity = written(map * read(gravity));
    }
    twin
}

/// Each muscle as two of half the section side by side in one place.
pub(crate) fn with_halves(robot: &Robot) -> Robot {
    let mut twin = robot.clone();
    let mut halves = Vec::new();
    twin.voltages.clear();
    for muscle in robot.scene["muscles"].as_array().unwrap() {
        for side in ["a", "b"] {
            let mut half = muscle.clone();
            let name = muscle["name"].as_str().unwrap();
            let section = &mut half["cross_section"][0];
            *section = json!(section.as_f64().unwrap() / 2.0);
            half["name"] = json!(format!("{name}{side}"));
            let voltage = robot.voltages[name];
            twin.voltages.insert(format!("{name}{side}"), voltage);
            halves.push(half);
        }
    }
    twin.scene["muscles"] = json!(halves);
    twin
}
