//! Verdicts: whiteness, recordings that are held out, and the next experiment.

use crate::oscillator::{
    DAMPING, STIFFNESS, joint, parameter, pulled_cart, recording, slide, system, task,
};
use proboscis::Signal;
use proboscis::control::problem::{
    Identification, Reading, Recording, Regime, SoughtStart, Voltages,
};
use proboscis::identify::{Grid, Problem, Unknowns, identify, ljung_box};
use proboscis::math::Random;
use proboscis::model::{MaterialConstant, MaxwellBranch, MaxwellBranches, System};
use proboscis::prelude::{Material, kpa};

#[test]
fn white_noise_passes_and_a_slow_wave_does_not() {
    let random = &mut Random::new(3);
    let noise: Vec<f64> = (0..200).map(|_| random.normal()).collect();
    let white = ljung_box(&noise).unwrap();
    assert!(white.p > 0.01 && white.neighbours.abs() < 0.3, "{white:?}");
    let wave = noise
        .iter()
        .enumerate()
        .map(|(k, n)| n + (0.1 * k as f64).sin());
    let wave = ljung_box(&wave.collect::<Vec<_>>()).unwrap();
    assert!(wave.p < 1e-6 && wave.neighbours > 0.2, "{wave:?}");
}

/// A cart that a muscle pulls, of a material with some Maxwell branches.
fn creeping(branches: &[(f64, f64)]) -> System {
    let branch = |&(shear_modulus, relaxation_time)| MaxwellBranch {
        shear_modulus,
        relaxation_time,
    };
    let branches: Vec<_> = branches.iter().map(branch).collect();
    let mut material = Material::elastomer(kpa(100.0)).relative_permittivity(3.0);
    material.viscosity = Some(0.5);
    material.maxwell = MaxwellBranches::new(&branches).unwrap();
    pulled_cart("creep", &material)
}

fn under(name: &str, voltage: Signal, count: usize) -> Recording {
    let reading = |k: usize| Reading {
        time: 10.0 * k as f64,
        value: 0.0,
        deviation: 0.0005,
    };
    Recording {
        name: name.into(),
        scene: None,
        regime: Regime::Motion,
        voltages: Voltages::from(vec![voltage]),
        start: joint(0.0, 0.0),
        sought_start: SoughtStart::Nothing,
        is_held_out: false,
        channels: vec![slide((0..count).map(reading).collect(), true)],
    }
}

/// Fills a task with readings of another system, with errors.
fn measure(task: &mut Identification, system: &System, seed: u64) {
    let values: Vec<f64> = task.parameters.iter().map(|p| p.guess).collect();
    let unknowns = Unknowns::of_values(&values, &vec![&[][..]; task.recordings.len()]);
    let random = &mut Random::new(seed);
    let grid = Grid {
        intervals: task.recordings.iter().map(|_| 390).collect(),
        meets_corners: vec![true; 8],
    };
    for r in 0..task.recordings.len() {
        let truth = Problem { system, task }
            .predict(&[r], &unknowns, &grid)
            .unwrap()
            .values;
        let readings = &mut task.recordings[r].channels[0].readings;
        for (reading, value) in readings.iter_mut().zip(truth.iter()) {
            reading.value = value + reading.deviation * random.normal();
        }
    }
}

/// Fits modulus and viscosity of a muscle with one branch to a motion of another one, and predicts a second motion.
fn held_out(truth: &[(f64, f64)]) -> proboscis::identify::Identified {
    let mut task = Identification {
        parameters: vec![
            parameter("modulus", MaterialConstant::ShearModulus.of_muscle(0), 0.1),
            parameter("viscosity", MaterialConstant::Viscosity.of_muscle(0), 0.5),
        ],
        recordings: vec![
            under("ramp", Signal::ramp(0.0, 2500.0, 60.0), 40),
            under(
                "pulse",
                Signal::Sine {
                    mean: 1200.0,
                    amplitude: 1200.0,
                    frequency: 0.004,
                    phase: 0.0,
                },
                40,
            ),
        ],
        priors: Vec::new(),
        candidates: Vec::new(),
        step: Some(10.0),
        coordinates: None,
    };
    task.recordings[1].is_held_out = true;
    measure(&mut task, &creeping(truth), 5);
    identify(&creeping(&[(0.05, 40.0)]), &task, &mut |_, _| {}).unwrap()
}

#[test]
fn one_branch_explains_its_own_motion_and_not_that_of_three() {
    let own = held_out(&[(0.05, 40.0)]);
    let [one] = &own.held_out[..] else {
        panic!("one recording");
    };
    assert!(
        one.is_explained() && one.reduced < one.quantile,
        "{} {}",
        one.reduced,
        one.p
    );
    assert!(own.is_white() && own.p.unwrap() > 0.01);
    let other = held_out(&[(0.03, 8.0), (0.05, 60.0), (0.06, 300.0)]);
    let [one] = &other.held_out[..] else {
        panic!("one recording");
    };
    assert!(!one.is_explained(), "{} {}", one.reduced, one.p);
    println!("{} {} {:?}", one.reduced, one.quantile, one.whiteness);
}

#[test]
fn the_best_experiment_lowers_the_variance_as_predicted() {
    let noise = &mut Random::new(21);
    let mut task = task(vec![recording(
        "first",
        [5.0, 0.0],
        (15, 60.0),
        Some((0.05, noise)),
    )]);
    let candidate = |name: &str, start: [f64; 2], last: f64| {
        recording(name, start, (15, last), Some((0.05, &mut Random::new(1))))
    };
    task.candidates = vec![
        candidate("the same", [5.0, 0.0], 60.0),
        candidate("long", [5.0, 0.0], 160.0),
        candidate("weak", [0.5, 0.0], 160.0),
    ];
    let before = identify(&system(), &task, &mut |_, _| {}).unwrap();
    let best = &before.experiments[0];
    assert_eq!(task.candidates[best.candidate].name, "long");
    assert_eq!(before.experiments.len(), 3);
    // Done.
    let again = recording("long", [5.0, 0.0], (15, 160.0), Some((0.05, noise)));
    task.recordings.push(again);
    task.candidates.clear();
    let after = identify(&system(), &task, &mut |_, _| {}).unwrap();
    for j in 0..2 {
        let [b, predicted, a] = [&before.information, &best.information, &after.information]
            .map(|information| information.covariance[(j, j)].sqrt());
        println!("{b} {predicted} {a}");
        assert!(predicted < 0.7 * b && (a / predicted - 1.0).abs() < 0.1);
        let truth = [STIFFNESS, DAMPING][j];
        assert!((after.fit.of_constants()[j] - truth).abs() < 3.5 * a);
    }
}
