//! States of rest of random robots: the same in every form of the same robot, for every step, and whatever its masses.

use crate::robots::{Parts, Robot, robot, system};
use crate::{seeds, twins};
use nalgebra::{Matrix3, Rotation3, Vector3};
use proboscis::dynamics::stable_equilibrium;
use proboscis::model::{Coordinates, Model};
use std::collections::BTreeMap;

/// Centres of bodies by name in mm, or why there is no rest.
type Places = Result<BTreeMap<String, Vector3<f64>>, String>;

/// Rest of a robot as the start of a motion with steps of `h` ms.
fn rest(robot: &Robot, h: f64, coordinates: Option<Coordinates>) -> Places {
    let system = system(&robot.scene);
    let voltages = robot.inputs_of(&system);
    let model = Model::new(system, coordinates, h, &[]).unwrap();
    let start = model.coordinates_at(&vec![0.0; model.joint_readings.len()]);
    let found = stable_equilibrium(&model, &start, &model.scalars(&voltages));
    let found = found.map_err(|error| error.to_string())?;
    if found.is_stable() != Some(true) {
        return Err("unstable".to_owned());
    }
    let poses = model.poses(&model.action.map.placed(&found.z));
    let bodies = model.system.bodies.iter().zip(poses);
    Ok(bodies
        .map(|(b, pose)| (b.name.clone(), pose.centre))
        .collect())
}

/// Greatest distance in mm of the bodies of two states of rest.
fn apart(one: &Places, other: &Places, map: &Matrix3<f64>) -> f64 {
    match (one, other) {
        (Ok(one), Ok(other)) => {
            let distance =
                |(name, place): (&String, &Vector3<f64>)| (map * place - other[name]).norm();
            one.iter().map(distance).fold(0.0, f64::max)
        }
        (Err(_), Err(_)) => 0.0,
        _ => f64::INFINITY,
    }
}

/// Places of a state of rest are exact to the square root of rounding where it is soft.
const SAME: f64 = 1e-5;

#[test]
fn a_state_of_rest_is_the_same_in_every_form_of_a_robot() {
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.3);
    let identity = Matrix3::identity();
    let (mut found, mut none, mut moved) = (0, 0, 0);
    let mut wrong: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    seeds(1, 60, &[], |seed| {
        let parts = Parts {
            weight: seed % 3 != 0,
            ball_joints: seed % 2 == 0,
            tendons: seed % 5 < 2,
            viscosity: seed % 4 < 2,
            bodies: 3,
        };
        let robot = robot(seed, parts);
        let first = rest(&robot, 1.0, None);
        match &first {
            Ok(_) => found += 1,
            Err(_) => none += 1,
        }
        let reference = robot.scene["bodies"].as_array().unwrap();
        if let Ok(places) = &first {
            let is_away = reference.iter().any(|body| {
                let at: [f64; 3] = serde_json::from_value(body["position"].clone()).unwrap();
                (Vector3::from(at) * 1e3 - places[body["name"].as_str().unwrap()]).norm() > 1.0
            });
            moved += usize::from(is_away);
        }
        let mut same = |what: &'static str, twin: Places, map: &Matrix3<f64>| {
            let distance = apart(&first, &twin, map);
            if distance > SAME {
                let told = match (&first, &twin) {
                    (Ok(_), Ok(_)) => format!("{distance} mm"),
                    (a, b) => format!("{:?} {:?}", a.as_ref().err(), b.as_ref().err()),
                };
                wrong
                    .entry(what)
                    .or_default()
                    .push(format!("{seed}: {told}"));
            }
        };
        for h in [1e-3, 0.01, 10.0, 1e4] {
            same("step", rest(&robot, h, None), &identity);
        }
        same(
            "order",
            rest(&twins::reversed(&robot), 1.0, None),
            &identity,
        );
        same(
            "units",
            rest(&twins::in_other_units(&robot), 1.0, None),
            &identity,
        );
        same(
            "halves",
            rest(&twins::with_halves(&robot), 1.0, None),
            &identity,
        );
        if !parts.weight {
            same(
                "masses",
                rest(&twins::heavier(&robot, 50.0), 1.0, None),
                &identity,
            );
        }
        let turned = rest(&twins::turned(&robot, &turn), 1.0, None);
        same("turned", turned, turn.matrix());
        let mut mirror = Matrix3::identity();
        mirror[(0, 0)] = -1.0;
        same(
            "mirrored",
            rest(&twins::mirrored(&robot, 0), 1.0, None),
            &mirror,
        );
        let redundant = Some(Coordinates::Redundant);
        same("redundant", rest(&robot, 1.0, redundant), &identity);
        same("redundant, step", rest(&robot, 0.01, redundant), &identity);
    });
    println!("{found} rest, {moved} of them away from their reference, {none} have no rest");
    for (what, list) in &wrong {
        println!("{what}: {}", list.len());
        list.iter().for_each(|line| println!("   {line}"));
    }
    assert!(found > 2 * none && 2 * moved > found);
    // Some robots have several stable states of rest; in other coordinates the path of loads may lead to another one.
    for others in ["redundant", "redundant, step"] {
        let list = wrong.remove(others).unwrap_or_default();
        assert!(30 * list.len() <= found, "{others}: {list:?}");
    }
    assert!(wrong.is_empty());
}
