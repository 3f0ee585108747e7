//! Constants that are known beside the recordings: the posterior of Gaussian distributions.

use crate::oscillator::{place, recording, system, task};
use crate::rest;
use nalgebra::{Matrix2, Vector2};
use proboscis::control::problem::{Prior, Recording};
use proboscis::identify::{Identified, identify};
use proboscis::math::Random;

/// Known stiffness of the oscillator, a standard error of the recording and more away from what it says.
const KNOWN: Prior = Prior {
    constant: 0,
    value: 0.2009,
    deviation: 3e-4,
};

fn fitted(own: Recording, priors: Vec<Prior>) -> Identified {
    let mut task = task(vec![own]);
    task.step = Some(2.5);
    task.priors = priors;
    identify(&system(), &task, &mut |_, _| {}).unwrap()
}

/// Constants, and the inverse of their covariance, that fit the closed form to a recording from rest at 5 mm and a prior, by Newton's
/// method on the sum of squares with differences.
fn closed_form(recording: &Recording, prior: &Prior) -> (Vector2<f64>, Matrix2<f64>) {
    let mut at = Vector2::new(0.2, 0.6);
    let mut precision = Matrix2::zeros();
    for _ in 0..20 {
        let weight = prior.deviation.powi(-2);
        precision = Matrix2::new(weight, 0.0, 0.0, 0.0);
        let mut right = Vector2::new(weight * (prior.value - at[0]), 0.0);
        for reading in recording.readings() {
            let of = |v: Vector2<f64>| place(reading.time, [v[0], v[1]], [5.0, 0.0]);
            let slope = Vector2::from_fn(|j, _| {
                let step = Vector2::ith(j, 1e-5 * at[j]);
                (of(at + step) - of(at - step)) / (2e-5 * at[j])
            });
            let weight = reading.deviation.powi(-2);
            precision += weight * slope * slope.transpose();
            right += weight * slope * (reading.value - of(at));
        }
        at += precision.try_inverse().unwrap() * right;
    }
    (at, precision)
}

#[test]
fn a_prior_counts_as_a_reading_of_its_constant() {
    let noise = &mut Random::new(7);
    let own = recording("free", [5.0, 0.0], (41, 200.0), Some((0.05, noise)));
    let (values, precision) = closed_form(&own, &KNOWN);
    let without = fitted(own.clone(), Vec::new());
    let alone = without.fit.of_constants().to_vec();
    assert!((values[0] - alone[0]).abs() > 0.3 * without.information.covariance[(0, 0)].sqrt());
    let found = fitted(own, vec![KNOWN]);
    for (j, expected) in values.iter().enumerate() {
        let error = (found.fit.of_constants()[j] / expected - 1.0).abs();
        assert!(error < 1e-5, "{j}: {error:e}");
    }
    let expected = precision.try_inverse().unwrap();
    let error = (&found.information.covariance - expected).amax() / expected.amax();
    assert!(error < 1e-4, "{error:e}");
    assert_eq!(found.fit.freedom(), without.fit.freedom() + 1);
    assert_eq!(found.series[0].times.len(), 41);
    let task = proboscis::control::problem::Identification {
        priors: vec![KNOWN],
        ..task(Vec::new())
    };
    let [difference] = found.fit.of_priors(&task)[..] else {
        panic!("one prior");
    };
    let expected = (KNOWN.value - values[0]) / KNOWN.deviation;
    assert!((difference - expected).abs() < 1e-2 * expected.abs());
}

#[test]
fn a_prior_settles_what_states_of_rest_leave_open() {
    let free = rest::recording("free", [300.0, 1200.0], 0.0);
    let mut task = rest::task(vec![free]);
    let open = identify(&rest::system(), &task, &mut |_, _| {}).unwrap();
    let ratio = open.information.undetermined[0].determined.clone().unwrap();
    let part = 0.01;
    task.priors.push(Prior {
        constant: 0,
        value: rest::TRUE[0],
        deviation: part * rest::TRUE[0],
    });
    let found = identify(&rest::system(), &task, &mut |_, _| {}).unwrap();
    assert!(found.information.undetermined.is_empty());
    let [permittivity, modulus] = found.fit.of_constants()[..] else {
        panic!("two constants");
    };
    assert!((permittivity / rest::TRUE[0] - 1.0).abs() < 1e-6);
    let of_ratio = match ratio.powers[0].0 {
        0 => ratio.value,
        _ => ratio.value.recip(),
    };
    assert!((permittivity / modulus / of_ratio - 1.0).abs() < 1e-5);
    // Relative variances of the prior and of the ratio add up.
    let error = found.information.covariance[(1, 1)].sqrt() / modulus;
    let expected = part.hypot(ratio.deviation);
    assert!(ratio.deviation > 1e-4 && (error / expected - 1.0).abs() < 1e-3);
}
