//! Random robots: trees of bodies with hinges and ball joints, driven by lumped muscles and loads, with springs, tendons and weight.

use crate::common::random::Random;
use proboscis::files::read_system;
use proboscis::model::system::System;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A scene as it is written, with voltages of its muscles and sizes of its loads by name.
#[derive(Clone, Debug)]
pub(crate) struct Robot {
    pub(crate) scene: Value,
    pub(crate) voltages: BTreeMap<String, f64>,
    /// In N or N mm.
    pub(crate) loads: BTreeMap<String, f64>,
}

/// Parts that robots may have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts {
    pub(crate) weight: bool,
    pub(crate) ball_joints: bool,
    pub(crate) tendons: bool,
    pub(crate) viscosity: bool,
    /// Greatest number of bodies.
    pub(crate) bodies: usize,
}

/// A system as the reader makes it of a scene.
pub(crate) fn system(scene: &Value) -> System {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    std::fs::write(&path, scene.to_string()).unwrap();
    read_system(&path, &[]).unwrap_or_else(|error| panic!("{error}\n{scene}"))
}

impl Robot {
    /// Voltages and loads by source of the system that is made of the scene.
    pub(crate) fn inputs_of(&self, system: &System) -> Vec<f64> {
        let sources = system.sources();
        let both = |name: &String| self.voltages.get(name).or_else(|| self.loads.get(name));
        let of = |name: &String| both(name).copied().unwrap_or_default();
        sources.iter().map(|source| of(&source.name)).collect()
    }
}

fn whole(random: &mut Random, low: usize, high: usize) -> usize {
    (random.between(low as f64, high as f64 + 1.0) as usize).min(high)
}

fn happens(random: &mut Random, probability: f64) -> bool {
    random.between(0.0, 1.0) < probability
}

fn vector(random: &mut Random, size: f64) -> [f64; 3] {
    [0; 3].map(|_| random.between(-size, size))
}

/// A robot of a seed.
pub(crate) fn robot(seed: u64, parts: Parts) -> Robot {
    let random = &mut Random(seed.wrapping_mul(0x2545_f491_4f6c_dd1d));
    let count = whole(random, 1, parts.bodies);
    let mut bodies = Vec::new();
    let mut joints = Vec::new();
    let mut muscles = Vec::new();
    // By body: where its joint is, and the middle of the body.
    let mut places: Vec<[[f64; 3]; 2]> = Vec::new();
    for b in 0..count {
        let parent = match b {
            0 => None,
            _ if happens(random, 0.8) => Some(b - 1),
            _ => Some(whole(random, 0, b - 1)),
        };
        let base = parent.map_or(0.0, |p| 2.0 * places[p][1][1] - places[p][0][1]);
        let length = random.between(0.035, 0.06);
        let aside = vector(random, 0.004);
        let at = [aside[0], base + aside[1], aside[2]];
        let shift = vector(random, 0.004);
        let centre = [shift[0], base + 0.5 * length, shift[2]];
        places.push([at, centre]);
        bodies.push(json!({
            "name": format!("b{b}"), "mass": random.between(0.02, 0.06), "position": centre,
            "box": { "size": [random.between(0.02, 0.045), length, random.between(0.02, 0.045)] },
        }));
        let is_ball = parts.ball_joints && happens(random, 0.4);
        let mut joint = json!({
            "name": format!("j{b}"), "child": format!("b{b}"), "at": at,
            "parent": parent.map_or("ground".to_owned(), |p| format!("b{p}")),
        });
        match is_ball {
            true => joint["spherical"] = json!({}),
            false => {
                let tilt = vector(random, 0.5);
                let axis = match happens(random, 0.5) {
                    true => [1.0, tilt[1], tilt[2]],
                    false => [tilt[0], tilt[1], 1.0],
                };
                joint["revolute"] = json!({ "axis": axis });
            }
        }
        joints.push(joint);
        let pulls = if is_ball {
            whole(random, 3, 5)
        } else {
            whole(random, 1, 3)
        };
        for k in 0..pulls {
            let turn = std::f64::consts::TAU * (k as f64 + random.between(0.0, 0.6)) / pulls as f64;
            let arm = random.between(0.012, 0.02);
            let twist = random.between(-0.6, 0.6);
            let end = |angle: f64, y: f64| [arm * angle.cos(), y, arm * angle.sin()];
            let mut from = json!({ "at": end(turn, base - random.between(0.012, 0.02)) });
            from["body"] = joints[b]["parent"].clone();
            muscles.push(json!({
                "name": format!("m{}", muscles.len()), "material": "m",
                "cross_section": [random.between(0.008, 0.011), random.between(0.008, 0.011)],
                "layer_thickness": random.between(45e-6, 55e-6), "from": from,
                "to": { "body": format!("b{b}"), "at": end(turn + twist, base + random.between(0.015, 0.022)) },
            }));
        }
    }
    let mut material = json!({
        "shear_modulus": random.between(9e4, 2e5), "relative_permittivity": random.between(2.5, 4.0),
        "density": random.between(900.0, 1200.0),
    });
    if parts.viscosity {
        material["viscosity"] = json!(random.between(500.0, 2000.0));
    }
    let end = |random: &mut Random, b: usize| {
        let [_, c] = places[b];
        let aside = vector(random, 0.015);
        json!({ "body": format!("b{b}"), "at": [c[0] + aside[0], c[1] + aside[1], c[2] + aside[2]] })
    };
    let mut scene = json!({
        "name": format!("robot {seed}"), "materials": { "m": material }, "bodies": bodies, "joints": joints,
    });
    if happens(random, 0.4) {
        let aside = vector(random, 0.03);
        scene["springs"] = json!([{
            "name": "stay", "from": { "body": "ground", "at": [0.03 + aside[0], aside[1], aside[2]] },
            "to": end(random, count - 1), "stiffness": random.between(20.0, 200.0),
        }]);
    }
    if parts.tendons && happens(random, 0.5) {
        let aside = vector(random, 0.02);
        let mut through =
            vec![json!({ "body": "ground", "at": [aside[0], -0.02, 0.02 + aside[2]] })];
        through.extend((0..count).map(|b| end(random, b)));
        // Taut by a tenth of a millimetre and more, or slack by as much.
        let ends: Vec<Vec<f64>> = through
            .iter()
            .map(|p| serde_json::from_value(p["at"].clone()).unwrap())
            .collect();
        let apart = |p: &[Vec<f64>]| {
            let squares = (0..3).map(|i| (p[1][i] - p[0][i]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let length: f64 = ends.windows(2).map(apart).sum();
        let change = random.between(1e-4, 1e-3) * if happens(random, 0.7) { -1.0 } else { 1.0 };
        scene["tendons"] = json!([{
            "name": "cord", "through": through, "stiffness": random.between(100.0, 1000.0),
            "rest_length": length + change,
        }]);
    }
    if parts.weight {
        let aside = vector(random, 2.0);
        let down = if happens(random, 0.5) { -9.81 } else { 9.81 };
        scene["gravity"] = json!([aside[0], down, aside[2]]);
    }
    let names: Vec<String> = muscles
        .iter()
        .map(|m| m["name"].as_str().unwrap().to_owned())
        .collect();
    let voltage = |random: &mut Random| match happens(random, 0.6) {
        true => random.between(300.0, 1800.0),
        false => 0.0,
    };
    let voltages = names
        .into_iter()
        .map(|name| (name, voltage(random)))
        .collect();
    scene["muscles"] = json!(muscles);
    add_springs_and_branches(&mut scene, seed, parts);
    let loads = add_loads(&mut scene, seed);
    Robot {
        scene,
        voltages,
        loads,
    }
}

/// Springs of hinges and Maxwell branches of the material, by numbers of their own: the rest of a robot is what it is without them.
fn add_springs_and_branches(scene: &mut Value, seed: u64, parts: Parts) {
    let random = &mut Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    for joint in scene["joints"].as_array_mut().unwrap() {
        if joint.get("revolute").is_some() && happens(random, 0.3) {
            joint["stiffness"] = json!(random.between(0.02, 0.2));
            joint["rest_angle"] = json!(random.between(-0.3, 0.3));
        }
    }
    if parts.viscosity && happens(random, 0.4) {
        let mut branch = |least: f64, most: f64| {
            json!({
                "shear_modulus": random.between(1e4, 6e4),
                "relaxation_time": random.between(least, most),
            })
        };
        scene["materials"]["m"]["maxwell"] = json!([branch(0.01, 0.05), branch(0.1, 1.0)]);
    }
}

/// A force on the last body and a motor on a hinge of some robots, by numbers of their own.
fn add_loads(scene: &mut Value, seed: u64) -> BTreeMap<String, f64> {
    let random = &mut Random(seed.wrapping_mul(0xd6e8_feb8_6659_fd93));
    let mut sizes = BTreeMap::new();
    let mut loads = Vec::new();
    if happens(random, 0.3) {
        let body = scene["bodies"].as_array().unwrap().last().unwrap();
        loads.push(json!({
            "name": "push", "point": { "body": body["name"], "at": body["position"] },
            "direction": vector(random, 1.0),
        }));
        sizes.insert("push".to_owned(), random.between(-0.2, 0.2));
    }
    let joints = scene["joints"].as_array().unwrap();
    let hinge = joints.iter().find(|joint| joint.get("revolute").is_some());
    if let Some(hinge) = hinge.filter(|_| happens(random, 0.3)) {
        loads.push(json!({ "name": "motor", "joint": hinge["name"] }));
        sizes.insert("motor".to_owned(), random.between(-5.0, 5.0));
    }
    if !loads.is_empty() {
        scene["loads"] = json!(loads);
    }
    sizes
}
