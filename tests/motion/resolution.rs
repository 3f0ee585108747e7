//! Time steps that do not resolve a motion are refused or told, and what is told is so.

use crate::common::random::Random;
use crate::common::{at_reference, bare, body, column, joint, trunk};
use nalgebra::{Matrix3, Vector3};
use proboscis::control::problem::{Simulation, Task};
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{
    DiscreteTrajectory, Drive, Integrator, LocalError, Solving, Start, local_error, observations,
    simulate_by,
};
use proboscis::files::read_problem;
use proboscis::model::system::JointKind;
use proboscis::model::{Coordinates, Model};
use proboscis::workflow::{Simulated, integrate};
use serde_json::{Value, json};
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

fn trust(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/trust")
        .join(name)
}

/// The motion that a file asks for, with other steps where `step` in ms is given.
fn motion_of(file: &Path, step: Option<f64>) -> Simulated {
    let loaded = read_problem(file, &[]).unwrap_or_else(|error| panic!("{error}"));
    let Task::Simulate(task) = loaded.task else {
        panic!("{}", file.display());
    };
    let task = Simulation {
        step: step.unwrap_or(task.step),
        ..task
    };
    integrate(&loaded.system, &task, |_, _| ControlFlow::Continue(())).unwrap()
}

/// Greatest distance in mm of the markers of two motions, at the instants of the first, which has so many times fewer steps.
fn apart(coarse: &Simulated, fine: &Simulated, times: usize) -> f64 {
    let [a, b] = [coarse, fine].map(|run| Trajectory::from_discrete(&run.model, &run.discrete));
    let pairs = a.marks.iter().enumerate();
    let distance = |(k, marks): (usize, &Vec<Vector3<f64>>)| {
        let others = marks.iter().zip(&b.marks[k * times]);
        others.map(|(x, y)| (x - y).norm()).fold(0.0, f64::max)
    };
    pairs.map(distance).fold(0.0, f64::max)
}

/// The error that is told of a motion.
fn error_of(model: &Model, discrete: &DiscreteTrajectory, order: usize) -> Option<LocalError> {
    let motion = Trajectory::from_discrete(model, discrete);
    local_error(model, discrete, &motion, order)
}

pub(crate) fn estimate(run: &Simulated) -> LocalError {
    error_of(&run.model, &run.discrete, 2).expect("there are steps enough")
}

#[test]
fn a_joint_does_not_turn_by_many_turns_in_a_step() {
    for (name, step) in [
        ("02_alias_79_0.02.json", 20.0),
        ("02_simulate_alias.json", 1.5),
    ] {
        let coarse = motion_of(&trust(name), None);
        assert_eq!(coarse.failure, None, "{name}");
        assert!(coarse.discrete.report.halved > 0, "{name}");
        // No step turns a joint by a turn, and the energy stays where the gravity and the muscles put it.
        let joints = Trajectory::from_discrete(&coarse.model, &coarse.discrete).joints;
        let largest = joints
            .windows(2)
            .flat_map(|w| {
                w[0].iter()
                    .zip(&w[1])
                    .map(|(a, b)| (a - b).abs())
                    .collect::<Vec<_>>()
            })
            .fold(0.0, f64::max);
        assert!(largest > 0.1 && largest < 6.3, "{name}: {largest}");
        let fine = motion_of(&trust(name), Some(step / 64.0));
        let seen = observations(&coarse.model, &coarse.discrete);
        let exact = observations(&fine.model, &fine.discrete);
        let [total, reference] = [&seen, &exact].map(|seen| column(seen, "total_energy"));
        let range = |list: &[f64]| {
            let most = list.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            most - list.iter().copied().fold(f64::INFINITY, f64::min)
        };
        println!(
            "{name}: energy within {} and {}",
            range(total),
            range(reference)
        );
        let kinetic = column(&exact, "kinetic_energy")
            .iter()
            .copied()
            .fold(0.0, f64::max);
        assert!(range(total) < range(reference) + kinetic, "{name}");
        // What is left is told.
        let told = estimate(&coarse);
        println!("{name}: {told:?}, truly {}", apart(&coarse, &fine, 64));
        assert!(told.relative() > 0.01, "{name}: {told:?}");
    }
}

#[test]
fn elements_beyond_pull_in_are_refused_with_long_steps_too() {
    for step in [20.0, 5.0, 1.0] {
        let run = motion_of(&trust("03_fe_beyond_pull_in.json"), Some(step));
        let failure = run.failure.expect("there is no such motion").to_string();
        assert!(failure.contains("from t = 5"), "{step}: {failure}");
        assert!(
            run.discrete
                .times
                .last()
                .is_some_and(|t| *t >= 40.0 && *t < 60.0)
        );
    }
}

/// A chain of bodies on hinges with random axes, a pair of muscles each, under gravity.
fn random_robot(random: &mut Random) -> Value {
    let bodies = 1 + (random.between(0.0, 3.0) as usize).min(2);
    let material = json!({
        "density": random.between(900.0, 1300.0), "shear_modulus": random.between(5e4, 2e5),
        "relative_permittivity": random.between(2.0, 7.0), "viscosity": random.between(100.0, 2000.0)
    });
    let (length, mut at) = (0.04, 0.0);
    let (mut links, mut joints, mut muscles) = (Vec::new(), Vec::new(), Vec::new());
    let mut parent = "ground".to_owned();
    for i in 0..bodies {
        let name = format!("s{i}");
        let axis = random.vector();
        links.push(json!({ "name": name, "mass": random.between(0.01, 0.05), "position": [0, at + 0.5 * length, 0],
            "cylinder": { "length": length, "radius": 0.01, "axis": [0, 1, 0] } }));
        joints.push(json!({ "name": format!("j{i}"), "revolute": { "axis": [axis.x, 0.3 * axis.y, 0.5 + axis.z.abs()] },
            "parent": parent, "child": name, "at": [0, at, 0] }));
        for side in [-1.0, 1.0] {
            let x = side * random.between(0.012, 0.02);
            muscles.push(json!({ "name": format!("m{i}{}", if side < 0.0 { "a" } else { "b" }), "material": "m",
                "cross_section": [0.01, random.between(0.006, 0.012)], "layer_thickness": 6e-5,
                "from": { "body": parent, "at": [x, at - 0.018, random.between(-0.004, 0.004)] },
                "to": { "body": name, "at": [x, at + 0.018, random.between(-0.004, 0.004)] } }));
        }
        at += length;
        parent = name;
    }
    json!({ "name": "random", "materials": { "m": material }, "bodies": links, "joints": joints, "muscles": muscles,
        "markers": [{ "name": "tip", "body": parent, "at": [0, at, 0] }],
        "gravity": [random.between(-5.0, 5.0), random.between(-9.0, 0.0), random.between(-5.0, 5.0)] })
}

#[test]
fn what_is_simulated_without_a_word_is_right() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("problem.json");
    let mut random = Random(7);
    let (mut silent, mut warned, mut refused) = (0, 0, 0);
    for case in 0..30 {
        let scene = random_robot(&mut random);
        let step = 1e-3 * 10_f64.powf(random.between(-0.5, 2.0));
        let steps = (0.3 / step).ceil().max(4.0);
        let mut voltages = serde_json::Map::new();
        for muscle in scene["muscles"].as_array().unwrap() {
            let name = muscle["name"].as_str().unwrap().to_owned();
            voltages.insert(name, json!(random.between(0.0, 2500.0)));
        }
        let problem = json!({ "scene": scene, "simulate": { "duration": steps * step, "step": step, "voltages": voltages } });
        fs::write(&file, problem.to_string()).unwrap();
        let coarse = motion_of(&file, None);
        if let Some(error) = coarse.failure {
            refused += 1;
            assert!(error.to_string().contains("from t = "), "{case}: {error}");
            continue;
        }
        let told = estimate(&coarse);
        let times = (step / 0.1e-3).log2().ceil().max(3.0).exp2();
        let fine = motion_of(&file, Some(1e3 * step / times));
        if fine.failure.is_some() {
            continue;
        }
        let error = apart(&coarse, &fine, times as usize);
        println!(
            "{case}: {step:.5} s, told {:.4} % of {:.1} mm, truly {:.4} %",
            100.0 * told.relative(),
            told.path,
            100.0 * error / told.path
        );
        match told.relative() > 0.01 {
            true => warned += 1,
            false => {
                silent += 1;
                assert!(
                    error < 10.0 * told.error && error < 0.03 * told.path,
                    "{case}: {error} of {told:?}"
                );
            }
        }
    }
    println!("{silent} silent, {warned} warned, {refused} refused");
    assert!(silent > 10 && warned > 5);
}

/// A mass on a slide between two muscles without viscosity, pushed at the start.
fn slider(h: f64, integrator: Integrator, steps: usize) -> (Model, DiscreteTrajectory) {
    driven_slider(h, integrator, steps, |_| 0.0)
}

/// A voltage in V as a function of the time in ms, within steps too.
struct Driven<'a> {
    model: &'a Model,
    voltage: &'a dyn Fn(f64) -> f64,
}

impl Drive for Driven<'_> {
    fn at(&self, [begin, end]: [f64; 2], part: f64) -> Vec<f64> {
        let time = begin + part * (end - begin);
        self.model.scalars(&[(self.voltage)(time)])
    }
}

/// The same under a voltage in V, a function of the time in ms.
fn driven_slider(
    h: f64,
    integrator: Integrator,
    steps: usize,
    voltage: impl Fn(f64) -> f64,
) -> (Model, DiscreteTrajectory) {
    let slide = joint(
        "slide",
        JointKind::Prismatic { axis: Vector3::y() },
        None,
        0,
        Vector3::zeros(),
    );
    let mass = body(
        "mass",
        20.0,
        [50.0; 3],
        Vector3::zeros(),
        Matrix3::identity(),
    );
    let mut scene = bare(vec![mass], vec![slide], None);
    let mut muscle = trunk(1).muscles.remove(0);
    muscle.material.viscosity = None;
    muscle.from.body = None;
    muscle.from.at = Vector3::new(0.0, -40.0, 0.0);
    muscle.to.body = Some(0);
    muscle.to.at = Vector3::zeros();
    scene.muscles = vec![muscle];
    let model = Model::new(scene, Some(Coordinates::Reduced), h, &[]).unwrap();
    let start = Start::with_rates(&model, at_reference(&model), &[0.02]);
    let solving = Solving {
        integrator,
        ..Solving::default()
    };
    let go_on = |_: &_| ControlFlow::Continue(());
    let (discrete, failure) = simulate_by(
        solving,
        &model,
        &start,
        h,
        steps,
        Driven {
            model: &model,
            voltage: &voltage,
        },
        go_on,
    );
    assert_eq!(failure, None);
    (model, discrete)
}

#[test]
fn galerkin_methods_balance_their_energy_under_varying_voltages() {
    let voltage = |time: f64| 1500.0 + 1000.0 * (0.05 * time).sin();
    for degree in [2, 3] {
        let integrator = Integrator::Galerkin { degree };
        let made = |h: f64| {
            let (_, discrete) = driven_slider(h, integrator, (240.0 / h) as usize, voltage);
            let report = discrete.report;
            assert!(report.exchanged > 1e-3);
            (report.made / report.exchanged).abs()
        };
        // What the sources supply within a step is no energy that the step makes.
        let [coarse, fine] = [made(12.0), made(6.0)];
        println!("{degree}: {coarse:.2e} {fine:.2e}");
        assert!(coarse < 0.05 && fine < coarse / 2_f64.powi(2 * degree as i32 - 1));
    }
}

#[test]
fn the_estimate_is_of_the_size_of_the_error_for_every_integrator() {
    for (integrator, h, within) in [
        (Integrator::Midpoint, 2.0, [0.3, 3.0]),
        (Integrator::ImplicitEuler, 0.2, [0.3, 3.0]),
        (
            Integrator::GeneralisedAlpha {
                spectral_radius: 0.8,
            },
            1.0,
            [0.2, 3.0],
        ),
        (Integrator::Galerkin { degree: 1 }, 2.0, [0.2, 5.0]),
        (Integrator::Galerkin { degree: 2 }, 4.0, [0.1, 10.0]),
    ] {
        let steps = (400.0 / h) as usize;
        let places = |h: f64, by: Integrator, steps: usize| -> Vec<f64> {
            slider(h, by, steps).1.z.iter().map(|z| z[0]).collect()
        };
        let exact = places(h / 4.0, Integrator::Galerkin { degree: 4 }, 4 * steps);
        let error = places(h, integrator, steps)
            .iter()
            .zip(exact.iter().step_by(4))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        let (model, discrete) = slider(h, integrator, steps);
        let told = error_of(&model, &discrete, integrator.order()).unwrap();
        println!(
            "{integrator:?}: told {:e}, truly {error:e} of {}",
            told.error, told.path
        );
        assert!(error > 1e-9 && told.is_resolved);
        let ratio = told.error / error;
        assert!(
            ratio > within[0] && ratio < within[1],
            "{integrator:?}: {ratio}"
        );
    }
}

#[test]
fn the_step_that_would_do_does() {
    let (model, discrete) = slider(2.0, Integrator::Midpoint, 200);
    let told = error_of(&model, &discrete, 2).unwrap();
    let better = told.step_for(0.2 * told.relative());
    let steps = (400.0 / better).ceil();
    let (model, discrete) = slider(400.0 / steps, Integrator::Midpoint, steps as usize);
    let after = error_of(&model, &discrete, 2).unwrap();
    println!("{} by {better} ms to {}", told.relative(), after.relative());
    assert!(after.relative() < 0.25 * told.relative() && after.relative() > 0.1 * told.relative());
}

#[test]
fn energies_and_dissipation_belong_to_the_instants_of_their_rows() {
    let columns = |h: f64, steps: usize| {
        let model = Model::new(trunk(2), Some(Coordinates::Reduced), h, &[]).unwrap();
        let start = Start::at_rest(&model, at_reference(&model));
        let scalars = model.scalars(&[2000.0, 0.0, 700.0, 1500.0]);
        let go_on = |_: &_| ControlFlow::Continue(());
        let (discrete, _) = simulate_by(
            Solving::default(),
            &model,
            &start,
            h,
            steps,
            |_, _| scalars.clone(),
            go_on,
        );
        let seen = observations(&model, &discrete);
        let names = [
            "kinetic_energy",
            "muscle_electroelasticity_energy",
            "total_energy",
            "dissipated_energy",
            "muscle1_charge",
        ];
        names.map(|name| column(&seen, name).to_vec())
    };
    let exact = columns(0.05, 1600);
    let [coarse, fine] = [(4.0, 20), (2.0, 40)].map(|(h, steps)| columns(h, steps));
    for (i, exact) in exact.iter().enumerate() {
        let error = |list: &[f64]| {
            let every = 1600 / (list.len() - 1);
            let pairs = list.iter().zip(exact.iter().step_by(every));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let size = exact
            .iter()
            .fold(0.0_f64, |m, e| m.max((e - exact[0]).abs()));
        let errors = [error(&coarse[i]), error(&fine[i])];
        println!("{i}: {errors:?} of {size}");
        assert!(size > 1e-6, "{i}");
        assert!(
            errors[0] / errors[1] > 3.0 && errors[1] < 0.1 * size,
            "{i}: {errors:?} of {size}"
        );
    }
}
