//! A cart that its damper stops: a free motion determines damping over mass, a pushed one both.

use crate::derivatives::compare;
use crate::oscillator::{joint, parameter, slide, times};
use proboscis::control::problem::{
    Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::{Unknowns, identify};
use proboscis::math::Random;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::{Constant, System};
use proboscis::prelude::{Body, GROUND, Joint, X, g, mm};

/// Mass in g and damping in N ms/mm: their ratio is 1.5/s.
const MASS: f64 = 500.0;
const DAMPING: f64 = 0.75;
const DEVIATION: f64 = 0.01;

fn system() -> System {
    let mut system = System::new("cart");
    let cart = system.add(Body::sphere(mm(10.0)).mass(g(MASS)));
    system.add(Joint::prismatic(X).between(GROUND, cart));
    system.joints[0].damping = Some(1.2 * DAMPING);
    system.components.loads.push(Load {
        name: "push".into(),
        on: LoadPlace::Joint(0),
    });
    system
}

/// A motion from a velocity in mm/ms under a force in N, in closed form with errors.
fn recording(name: &str, velocity: f64, force: f64, random: &mut Random) -> Recording {
    let rate = DAMPING / MASS;
    let reading = |time: f64| {
        let decay = (1.0 - (-rate * time).exp()) / rate;
        let place = velocity * decay + force / DAMPING * (time - decay);
        Reading {
            time,
            value: place + DEVIATION * random.normal(),
            deviation: DEVIATION,
        }
    };
    let readings = times(31, 1500.0).into_iter().map(reading).collect();
    Recording {
        name: name.into(),
        scene: None,
        regime: Regime::Motion,
        voltages: Voltages::constant(&[force]),
        start: joint(0.0, 0.0),
        sought_start: SoughtStart::State,
        is_held_out: false,
        channels: vec![slide(readings, true)],
    }
}

fn task(recordings: Vec<Recording>) -> Identification {
    Identification {
        parameters: vec![
            parameter("damping", Constant::JointDamping(0), 1.2 * DAMPING),
            parameter("mass", Constant::Mass(0), 0.9 * MASS),
        ],
        recordings,
        priors: Vec::new(),
        candidates: Vec::new(),
        step: None,
        coordinates: None,
    }
}

#[test]
fn a_free_motion_determines_damping_over_mass_and_a_pushed_one_both() {
    let random = &mut Random::new(12);
    let free = recording("free", 0.2, 0.0, random);
    let found = identify(&system(), &task(vec![free.clone()]), &mut |_, _| {}).unwrap();
    let [only] = &found.information.undetermined[..] else {
        panic!("{:?}", found.information.undetermined);
    };
    assert_eq!(found.information.is_determined, [false, false]);
    let known = only.determined.clone().unwrap();
    assert_eq!(known.powers[0], (0, 1.0));
    assert!((known.powers[1].1 + 1.0).abs() < 1e-4, "{known:?}");
    let truth = DAMPING / MASS;
    assert!(known.deviation < 0.01);
    assert!((known.value / truth - 1.0).abs() < 4.0 * known.deviation);
    let pushed = recording("pushed", 0.0, 0.1, random);
    let found = identify(&system(), &task(vec![free, pushed]), &mut |_, _| {}).unwrap();
    assert!(found.information.undetermined.is_empty());
    for (j, truth) in [DAMPING, MASS].into_iter().enumerate() {
        let error = found.information.covariance[(j, j)].sqrt();
        assert!(error < 0.02 * truth);
        assert!((found.fit.of_constants()[j] - truth).abs() < 3.5 * error);
    }
}

#[test]
fn a_mass_is_found_from_a_start_with_a_given_velocity() {
    let mut own = recording("pushed", 0.2, 0.1, &mut Random::new(4));
    own.start = joint(0.0, 0.2);
    own.sought_start = SoughtStart::Nothing;
    let task = task(vec![own]);
    let unknowns = Unknowns::of_values(&[0.8, 450.0], &[&[]]);
    let largest = compare(&system(), &task, &unknowns);
    assert!(largest.iter().all(|size| *size > 0.1), "{largest:?}");
    let found = identify(&system(), &task, &mut |_, _| {}).unwrap();
    for (j, truth) in [DAMPING, MASS].into_iter().enumerate() {
        let error = found.information.covariance[(j, j)].sqrt();
        let value = found.fit.of_constants()[j];
        println!("{j}: {value} ± {error} of {truth}");
        assert!(error > 0.0 && error < 0.02 * truth);
        assert!((value - truth).abs() < 3.5 * error);
    }
}
