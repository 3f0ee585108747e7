//! Verdicts that an adversary once broke: bounds in place of data, invented deviations, and true models that are not explained.

use crate::oscillator::{DAMPING, MASS, STIFFNESS, parameter, place, recording, system, task};
use nalgebra::{DMatrix, DVector};
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

/// A poor fit predicts poorly: the statistic that decides takes the errors of the constants in, as the covariance by the closed form has them.
#[test]
fn the_statistic_of_a_prediction_is_the_one_that_decides() {
    let deviation = 0.05;
    let mut raw_beyond = 0;
    for seed in 0..6 {
        let noise = &mut Random::new(200 + seed);
        let fitted = recording("fitted", [0.6, 0.0], (31, 150.0), Some((deviation, noise)));
        let start = [20.0, 0.0];
        let mut held_out = recording("held out", start, (41, 200.0), Some((deviation, noise)));
        held_out.is_held_out = true;
        let found = identify(&system(), &task(vec![fitted, held_out]), &mut |_, _| {}).unwrap();
        let (one, series) = (&found.held_out[0], &found.held_out[0].series[0]);
        let values: [f64; 2] = found.fit.of_constants().try_into().unwrap();
        let by = |k: usize, j: usize| {
            let step = 1e-5 * values[j];
            let at = |sign: f64| {
                let mut constants = values;
                constants[j] += sign * step;
                place(series.times[k], constants, start)
            };
            (at(1.0) - at(-1.0)) / (2.0 * step * deviation)
        };
        let n = series.times.len();
        let s = DMatrix::from_fn(n, 2, by);
        let covariance =
            DMatrix::identity(n, n) + &s * &found.information.covariance * s.transpose();
        let r = DVector::from_fn(n, |k, _| {
            (series.measured[k] - place(series.times[k], values, start)) / deviation
        });
        let expected = r.dot(&(covariance.try_inverse().unwrap() * &r)) / n as f64;
        assert!(
            (one.statistic - expected).abs() < 0.02 * expected,
            "{one:?} {expected}"
        );
        assert!((one.reduced - r.norm_squared() / n as f64).abs() < 0.02 * one.reduced);
        assert_eq!(one.statistic > one.quantile, one.p < 0.01);
        raw_beyond += usize::from(one.is_explained() && one.reduced > one.quantile);
    }
    assert!(
        raw_beyond > 0,
        "no prediction whose raw residuals are large"
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
