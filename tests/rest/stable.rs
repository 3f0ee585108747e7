//! Equilibria: a stable one is found where there is one, what is called stable is, and what leaves the domain of its
//! dielectric is told.

use crate::common::random::Random;
use nalgebra::Vector3;
use proboscis::dynamics::{
    Equilibrium, EquilibriumError, Route, Softening, equilibrium, stable_equilibrium,
};
use proboscis::files::{driven_voltages, read_system};
use proboscis::model::system::{ElectricConstants, System};
use proboscis::model::{Coordinates, Model};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A file of `tests/trust`.
pub(crate) fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/trust/{name}.json"))
}

/// A scene as it is written.
pub(crate) fn scene(written: &Value) -> System {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    std::fs::write(&path, written.to_string()).unwrap();
    read_system(&path, &[]).unwrap()
}

pub(crate) fn model(system: System) -> Model {
    Model::new(system, None, 1.0, &[]).unwrap()
}

pub(crate) fn reference(model: &Model) -> Vec<f64> {
    model.coordinates_at(&vec![0.0; model.joint_readings.len()])
}

fn found(model: &Model, voltages: &[f64]) -> Equilibrium {
    stable_equilibrium(model, &reference(model), voltages).unwrap()
}

/// The trunk upright under gravity in m/s², with voltages that bend it.
fn upright(gravity: f64) -> (Model, Vec<f64>) {
    let set = format!("scene.gravity=[0,-{gravity},0]");
    let system = read_system(&file("06_solve_refused_earth_gravity"), &[set]).unwrap();
    let words = ["2=1.7", "6=1.7", "10=1.7", "3=1.6", "7=1.6", "11=1.6"];
    let words: Vec<String> = words.iter().map(|w| format!("muscle{w}kV")).collect();
    let voltages = driven_voltages(&words, &system).unwrap();
    let model = model(system);
    let voltages = model.scalars(&voltages);
    (model, voltages)
}

/// Every strength of gravity between 9.7 and 10 m/s² has the stable equilibrium that an independent continuation finds, and
/// it changes continuously: it is one family.
#[test]
fn the_upright_trunk_rests_bent_under_any_gravity_near_the_earths() {
    let mut before: Option<Vec<f64>> = None;
    for step in 0..=30 {
        let gravity = 9.7 + 0.01 * f64::from(step);
        let (model, voltages) = upright(gravity);
        let rest = found(&model, &voltages);
        assert_eq!(rest.is_stable(), Some(true), "{gravity}");
        // 0.18 N m/rad.
        let softest = rest.stiffness[0];
        assert!((softest - 183.5).abs() < 1.0, "{softest}");
        if let Some(before) = &before {
            let change = rest.z.iter().zip(before).map(|(a, b)| (a - b).abs());
            let change = change.fold(0.0, f64::max);
            assert!(change > 1e-6 && change < 5e-3, "{gravity}: {change}");
        }
        before = Some(rest.z);
    }
}

/// Directors with multipliers lead to the same rest as joint coordinates, and its stability is read off a state alike.
#[test]
fn redundant_coordinates_rest_where_joint_coordinates_do() {
    let (reduced, voltages) = upright(9.81);
    let rest = found(&reduced, &voltages);
    let redundant = Model::new(
        reduced.system.clone(),
        Some(Coordinates::Redundant),
        1.0,
        &[],
    )
    .unwrap();
    let other = found(&redundant, &voltages);
    assert_eq!(other.is_stable(), Some(true));
    let tip = |model: &Model, rest: &Equilibrium| {
        let instant = model.action.map.placed(&rest.z);
        instant.x[model.markers[0]]
    };
    let (a, b) = (tip(&reduced, &rest), tip(&redundant, &other));
    assert!((a - b).norm() < 1e-6 && a.x.abs() > 100.0, "{a} {b}");
    for (model, rest) in [(&reduced, &rest), (&redundant, &other)] {
        let again = Equilibrium::of_state(model, &rest.z, &rest.scalars);
        assert_eq!(again.is_stable(), Some(true));
        assert_eq!(again.stiffness.len(), rest.stiffness.len());
    }
    // Upright it is in balance too, and falls over.
    let none = vec![0.0; voltages.len()];
    let upright = Equilibrium::of_state(&reduced, &reference(&reduced), &none);
    assert_eq!(upright.is_stable(), Some(false));
    assert_eq!(upright.softest.unwrap().softening, Some(Softening::Loads));
}

/// Potential energy in N mm, written out: W(Λ, V) of the lumped muscles by docs/theory.md, 3.1, weights of bodies and of halves of
/// muscles at their ends.
fn energy(system: &System, model: &Model, z: &[f64], voltages: &[f64]) -> f64 {
    let instant = model.action.map.placed(z);
    let poses = model.poses(&instant);
    let place = |body: Option<usize>, at: &Vector3<f64>| match body {
        None => *at,
        Some(b) => {
            let turn = poses[b].directors * system.bodies[b].directors.transpose();
            poses[b].centre + turn * (at - system.bodies[b].centre)
        }
    };
    let g = system.gravity.unwrap_or_default();
    let mut sum = 0.0;
    for (b, body) in system.bodies.iter().enumerate() {
        sum -= body.mass * g.dot(&poses[b].centre);
    }
    for (muscle, voltage) in system.muscles.iter().zip(voltages) {
        let ends = [&muscle.from, &muscle.to].map(|end| place(end.body, &end.at));
        let length = (muscle.to.at - muscle.from.at).norm();
        let stretch = (ends[1] - ends[0]).norm() / length;
        let volume = length * muscle.cross_section[0] * muscle.cross_section[1];
        let field = voltage / muscle.layer_thickness;
        let ElectricConstants {
            c1,
            c2,
            permittivity,
        } = muscle.material.electric.unwrap();
        let square = stretch * stretch;
        let elastic = 0.5 * muscle.material.shear_modulus * (2.0 / stretch + square - 3.0);
        let electric = (c1 + c2 * square - 0.5 * permittivity / square) * field * field;
        sum += volume * (elastic + electric);
        let mass = muscle.material.density.unwrap_or(0.0) * volume;
        sum -= 0.5 * mass * g.dot(&(ends[0] + ends[1]));
    }
    sum
}

/// A chain of links upright or hanging, aslant or not, with two muscles about each joint.
fn chain(random: &mut Random) -> (System, Vec<f64>) {
    let links = 1 + (random.between(0.0, 4.0) as usize);
    // Half of them are pulled down alone: upright they buckle, where the others bend.
    let aside = if random.unit() > 0.0 { 2.0 } else { 0.0 };
    let up = if random.unit() > 0.0 { 1 } else { -1 };
    let written = json!({
        "name": "chain",
        "materials": { "m": {
            "density": 1000, "shear_modulus": random.between(5e4, 3e5), "relative_permittivity": 3.0, "viscosity": 500,
        } },
        "chain": {
            "segments": links, "length": random.between(0.03, 0.06), "radius": 0.02, "mass": random.between(0.05, 0.6),
            "axis": [0, up, 0], "first_joint_axis": [0, 0, 1],
            "muscles": {
                "material": "m", "arm": random.between(0.01, 0.018), "rest_length": 0.025, "cross_section": [0.01, 0.01],
                "layer_thickness": 5e-5,
            },
            "tip_marker": "tip",
        },
        "gravity": [aside * random.unit(), -9.81, aside * random.unit()],
    });
    let system = scene(&written);
    let voltages = (0..system.muscles.len())
        .map(|_| f64::max(random.between(-1500.0, 2500.0), 0.0))
        .collect();
    (system, voltages)
}

/// At what is called stable the energy written out has a minimum: no slope and positive curvature by central differences.
#[test]
fn what_is_called_stable_is_a_minimum_of_the_energy() {
    let mut random = Random(11);
    let (mut stable, mut beyond, mut none) = (0, 0, 0);
    for case in 0..60 {
        let (system, voltages) = chain(&mut random);
        let model = model(system.clone());
        let rest = match stable_equilibrium(&model, &reference(&model), &model.scalars(&voltages)) {
            Ok(rest) => rest,
            Err(EquilibriumError::LimitPoint { .. }) => {
                none += 1;
                continue;
            }
            Err(error) => panic!("{case}: {error}"),
        };
        if rest.is_stable() != Some(true) {
            none += 1;
            continue;
        }
        stable += 1;
        beyond += usize::from(rest.route != Route::Loads);
        let at = |z: &[f64]| energy(&system, &model, z, &voltages);
        let stiffest = *rest.stiffness.last().unwrap();
        for _ in 0..4 {
            let direction: Vec<f64> = rest.z.iter().map(|_| random.unit()).collect();
            let norm = direction.iter().map(|d| d * d).sum::<f64>().sqrt();
            let moved = |by: f64| {
                let z = rest.z.iter().zip(&direction);
                z.map(|(z, d)| z + by * d / norm).collect::<Vec<_>>()
            };
            let step = 1e-3;
            let [less, here, more] = [-step, 0.0, step].map(|by| at(&moved(by)));
            let slope = (more - less) / (2.0 * step);
            let curvature = (more - 2.0 * here + less) / (step * step);
            // The third derivative leaves step²/6 of its size; the difference of energies leaves round-off over the step.
            assert!(slope.abs() < 1e-4 * stiffest, "{case}: slope {slope}");
            assert!(
                curvature > 0.9 * rest.stiffness[0],
                "{case}: {curvature} of {:?}",
                rest.stiffness
            );
            assert!(
                curvature < 1.1 * stiffest,
                "{case}: {curvature} of {:?}",
                rest.stiffness
            );
        }
    }
    println!("{stable} stable, {beyond} of them off the path of growing loads, {none} none");
    assert!(stable > 30 && beyond > 0, "{stable} {beyond}");
}

/// One link of length ℓ upright, held by a muscle on either side at `arm`.
fn link(mass: f64) -> System {
    scene(&json!({
        "name": "link",
        "materials": { "m": { "shear_modulus": 1e5, "relative_permittivity": 3.0 } },
        "chain": {
            "segments": 1, "length": 0.05, "radius": 0.02, "mass": mass, "axis": [0, 1, 0], "first_joint_axis": [0, 0, 1],
            "muscles": { "material": "m", "arm": 0.015, "rest_length": 0.04, "cross_section": [0.01, 0.01],
                "layer_thickness": 5e-5 },
            "tip_marker": "tip",
        },
        "gravity": [0, -9.81, 0],
    }))
}

/// A link that is too heavy to stand leans aside, where the energy written out is least; just below that it stands.
#[test]
fn a_link_too_heavy_to_stand_leans_aside() {
    let light = model(link(0.01));
    let upright = found(&light, &[0.0; 2]);
    assert_eq!(upright.route, Route::Loads);
    assert!(upright.z[0].abs() < 1e-12);
    let softening = |rest: &Equilibrium| rest.softest.as_ref().unwrap().softening;
    assert_eq!(softening(&upright), Some(Softening::Loads));
    // Hanging, its weight makes it stiffer, and there are no voltages.
    let mut hanging = link(0.01);
    hanging.gravity = hanging.gravity.map(|g| -g);
    let hanging = found(&model(hanging), &[0.0; 2]);
    assert!(hanging.stiffness[0] > 1.01 * upright.stiffness[0]);
    assert_eq!(softening(&hanging), None);
    // Stiffness k − m g ℓ/2 of the upright link: linear in the mass.
    let at = |mass: f64| found(&model(link(mass)), &[0.0; 2]).stiffness[0];
    let (a, b) = (at(0.01), at(0.02));
    let critical = 0.01 + 0.01 * a / (a - b);
    assert!(critical > 0.1, "{critical}");
    for (ratio, leans) in [(0.999, false), (1.001, true), (1.2, true), (2.0, true)] {
        let system = link(ratio * critical);
        let model = model(system.clone());
        let rest = found(&model, &[0.0; 2]);
        assert_eq!(rest.is_stable(), Some(true), "{ratio}");
        assert_eq!(rest.z[0].abs() > 1e-3, leans, "{ratio}: {}", rest.z[0]);
        if !leans {
            continue;
        }
        assert!(
            matches!(rest.route, Route::DampedMotion(_)),
            "{:?}",
            rest.route
        );
        // The path of growing loads stays upright, where it is unstable under the weight.
        let on_path = equilibrium(&model, &reference(&model), &[0.0; 2]).unwrap();
        assert_eq!(
            (on_path.is_stable(), on_path.z[0].abs() < 1e-9),
            (Some(false), true)
        );
        let mode = on_path.softest.unwrap();
        assert_eq!(mode.softening, Some(Softening::Loads));
        assert!(
            mode.moves.starts_with("joint1, stretch of muscle"),
            "{}",
            mode.moves
        );
        // The least energy on a grid of angles.
        let at = |k: i32| energy(&system, &model, &[1e-4 * f64::from(k)], &[0.0; 2]);
        let sign = rest.z[0].signum() as i32;
        let least = (1..12_000)
            .min_by(|&i, &j| at(sign * i).total_cmp(&at(sign * j)))
            .unwrap();
        let expected = 1e-4 * f64::from(sign * least);
        assert!(
            (rest.z[0] - expected).abs() < 2e-4,
            "{ratio}: {} {expected}",
            rest.z[0]
        );
    }
}

/// Parts that nothing holds are named; parts that only their weight holds hang.
#[test]
fn joints_without_stiffness_are_named() {
    let mut written = json!({
        "name": "loose",
        "bodies": [{ "name": "bob", "mass": 0.1, "position": [0.05, 0, 0], "sphere": { "radius": 0.005 } }],
        "joints": [{
            "name": "pivot", "revolute": { "axis": [0, 0, 1] }, "parent": "ground", "child": "bob", "at": [0, 0, 0],
        }],
        "gravity": [0, -9.81, 0],
    });
    let pendulum = model(scene(&written));
    let rest = found(&pendulum, &[]);
    assert!(
        (rest.z[0] + std::f64::consts::FRAC_PI_2).abs() < 1e-9,
        "{:?}",
        rest.z
    );
    assert!((rest.stiffness[0] / (100.0 * 9.81e-3 * 50.0) - 1.0).abs() < 1e-9);
    written["joints"][0]["revolute"]["axis"] = json!([0, 1, 0]);
    let turntable = model(scene(&written));
    written["joints"][0] = json!({
        "name": "rail", "prismatic": { "axis": [0, 1, 0] }, "parent": "ground", "child": "bob", "at": [0, 0, 0],
    });
    let falling = model(scene(&written));
    for (model, name) in [(turntable, "pivot"), (falling, "rail")] {
        let refused = stable_equilibrium(&model, &reference(&model), &[]).unwrap_err();
        assert_eq!(refused, EquilibriumError::NoStiffness(vec![name.into()]));
        let words = refused.to_string();
        assert!(
            words.contains(&format!("no stiffness acts on {name}")),
            "{words}"
        );
    }
}

pub(crate) fn run(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_proboscis"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

pub(crate) fn summary(folder: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

/// The trunk under the earth's gravity through the program: its control has a start and a goal, and its rest says how it was
/// found.
#[test]
fn the_upright_trunk_answers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let problem = file("06_solve_refused_earth_gravity");
    let problem = problem.to_str().unwrap();
    let voltages =
        "muscle2=1.7kV,muscle6=1.7kV,muscle10=1.7kV,muscle3=1.6kV,muscle7=1.6kV,muscle11=1.6kV";
    let arguments = ["equilibrium", problem, "--voltages", voltages, "-o", "rest"];
    let (status, out, err) = run(path, &arguments);
    assert_eq!((status, err.as_str()), (0, ""), "{out}");
    let told = summary(&path.join("rest"));
    assert_eq!(told["is_stable"], true);
    let softest = told["stiffness"][0].as_f64().unwrap();
    assert!((softest - 0.1835).abs() < 1e-3, "{softest}");
    assert!(
        out.contains(&format!(
            "softest mode  {:.6} N mm/rad: joint",
            1e3 * softest
        )),
        "{out}"
    );
    let route = told["route"].as_str().unwrap();
    assert_eq!(
        out.contains("growing voltages lose theirs") || out.contains("growing loads lose theirs"),
        route != "growing_loads",
        "{out}"
    );
    let stretches = told["stretches"].as_object().unwrap().values();
    let stretches: Vec<f64> = stretches.map(|v| v.as_f64().unwrap()).collect();
    let least = stretches.iter().copied().fold(1.0, f64::min);
    let most = stretches.iter().copied().fold(1.0, f64::max);
    assert!(
        (least - 0.69).abs() < 0.01 && (most - 1.19).abs() < 0.01,
        "{least} {most}"
    );
}
