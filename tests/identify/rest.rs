//! States of rest of a free muscle, which determine a ratio of its constants.

use crate::oscillator::{joint, parameter, permittivity, pulled_cart, slide, times};
use proboscis::Signal;
use proboscis::control::problem::{
    Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::{Grid, Problem, Product, Unknowns, identify};
use proboscis::math::Random;
use proboscis::model::components::{Load, LoadPlace};
use proboscis::model::system::ElectricConstants;
use proboscis::model::{MaterialConstant, System};
use proboscis::prelude::{Material, kpa};

pub(crate) const TRUE: [f64; 2] = [3.0, 0.1];

/// A cart between a muscle and a force along the slide.
pub(crate) fn system() -> System {
    let material = Material::elastomer(kpa(1e3 * TRUE[1])).ideal_dielectric(TRUE[0]);
    let mut system = pulled_cart("free", &material);
    system.components.loads.push(Load {
        name: "force".into(),
        on: LoadPlace::Joint(0),
    });
    system
}

pub(crate) fn recording(name: &str, [from, to]: [f64; 2], force: f64) -> Recording {
    let reading = |time: f64| Reading {
        time,
        value: 0.0,
        deviation: 0.001,
    };
    Recording {
        name: name.into(),
        scene: None,
        regime: Regime::Rest,
        voltages: Voltages::from(vec![
            Signal::ramp(from, to, 1000.0),
            Signal::Constant(force),
        ]),
        start: joint(0.0, 0.0),
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels: vec![slide(
            times(8, 1000.0).into_iter().map(reading).collect(),
            true,
        )],
    }
}

pub(crate) fn task(recordings: Vec<Recording>) -> Identification {
    let mut task = Identification {
        parameters: vec![
            permittivity(1, ElectricConstants::ideal, TRUE[0]),
            parameter(
                "modulus",
                MaterialConstant::ShearModulus.of_muscle(0),
                TRUE[1],
            ),
        ],
        recordings,
        priors: Vec::new(),
        candidates: Vec::new(),
        step: None,
        coordinates: None,
    };
    let unknowns = Unknowns::of_values(&TRUE, &vec![&[][..]; task.recordings.len()]);
    let grid = Grid::first(&task, &task.recordings);
    let random = &mut Random::new(2);
    for r in 0..task.recordings.len() {
        let truth = Problem {
            system: &system(),
            task: &task,
        }
        .predict(&[r], &unknowns, &grid)
        .unwrap()
        .values;
        for (reading, value) in task.recordings[r].channels[0]
            .readings
            .iter_mut()
            .zip(truth.iter())
        {
            reading.value = value + reading.deviation * random.normal();
        }
    }
    for parameter in &mut task.parameters {
        parameter.guess *= 1.3;
    }
    task.parameters[1].guess *= 0.5;
    task
}

#[test]
fn a_free_muscle_at_rest_determines_a_ratio_and_a_force_both() {
    let free = recording("free", [300.0, 1200.0], 0.0);
    let found = identify(&system(), &task(vec![free.clone()]), &mut |_, _| {}).unwrap();
    let [only] = &found.information.undetermined[..] else {
        panic!("{:?}", found.information.undetermined);
    };
    println!("{only:?}");
    // Both in proportion change nothing.
    assert_eq!(only.powers.len(), 2);
    assert!(
        only.powers
            .iter()
            .all(|(_, power)| (power - 1.0).abs() < 1e-4)
    );
    assert!(only.deviation.is_infinite());
    assert_eq!(found.information.is_determined, [false, false]);
    let Product {
        powers,
        value: ratio,
        deviation,
    } = only.determined.clone().unwrap();
    assert!((powers[1].1 / powers[0].1 + 1.0).abs() < 1e-4);
    let truth = TRUE[0] / TRUE[1];
    let ratio = if powers[0].0 == 0 {
        ratio
    } else {
        ratio.recip()
    };
    assert!(
        deviation < 0.01 && (ratio / truth - 1.0).abs() < 4.0 * deviation,
        "{ratio} {truth} {deviation}"
    );
    let loaded = recording("loaded", [0.0, 800.0], 0.5);
    let found = identify(&system(), &task(vec![free, loaded]), &mut |_, _| {}).unwrap();
    assert!(found.information.undetermined.is_empty());
    for (j, truth) in TRUE.into_iter().enumerate() {
        let error = found.information.covariance[(j, j)].sqrt();
        assert!(error < 0.02 * truth);
        assert!((found.fit.of_constants()[j] - truth).abs() < 3.5 * error);
    }
}
