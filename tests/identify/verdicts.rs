//! Verdicts that an adversary once broke: bounds in place of data, invented deviations, and true models that are not explained.

use crate::oscillator::{DAMPING, MASS, STIFFNESS, parameter, recording, system, task};
use proboscis::identify::identify;
use proboscis::math::Random;
use proboscis::model::Constant;

/// A free motion determines ratios of mass, damping and stiffness alone, also where one of them lies at its bound.
#[test]
fn a_bound_does_not_stand_for_data() {
    let noise = &mut Random::new(4);
    let mut task = task(vec![recording(
        "free",
        [5.0, 0.0],
        (31, 150.0),
        Some((0.01, noise)),
    )]);
    let mut damping = parameter("damping", Constant::JointDamping(0), 1.5 * DAMPING);
    [damping.lower, damping.upper] = [1.45 * DAMPING, 1.8 * DAMPING];
    task.parameters = vec![
        parameter("mass", Constant::Mass(0), MASS),
        parameter("stiffness", Constant::SpringStiffness(0), STIFFNESS),
        damping,
    ];
    let found = identify(&system(), &task, &mut |_, _| {}).unwrap();
    let information = &found.information;
    assert!(!information.undetermined.is_empty(), "{information:?}");
    assert!(
        information.is_determined.iter().all(|is| !is),
        "{information:?}"
    );
}

#[test]
fn a_held_out_recording_without_deviations_is_refused() {
    let noise = &mut Random::new(5);
    let fitted = recording("fitted", [5.0, 0.0], (31, 150.0), Some((0.01, noise)));
    let mut held_out = recording("held out", [-3.0, 0.0], (31, 150.0), None);
    held_out.is_held_out = true;
    let task = task(vec![fitted, held_out]);
    let error = identify(&system(), &task, &mut |_, _| {}).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("nothing tells the standard deviation"),
        "{error}"
    );
}

/// The errors of the fitted constants are smooth in time: they alone are no reason to call a true model wrong.
#[test]
fn true_models_are_explained() {
    let mut explained = 0;
    for seed in 0..12 {
        let noise = &mut Random::new(100 + seed);
        let fitted = recording("fitted", [0.6, 0.0], (31, 150.0), Some((0.05, noise)));
        let mut held_out = recording("held out", [20.0, 0.0], (41, 200.0), Some((0.05, noise)));
        held_out.is_held_out = true;
        let found = identify(&system(), &task(vec![fitted, held_out]), &mut |_, _| {}).unwrap();
        explained += usize::from(found.held_out[0].is_explained());
    }
    assert!(explained >= 10, "{explained} of 12");
}
