//! Constants of an oscillator, recovered from motions in closed form.

use crate::oscillator::{DAMPING, STIFFNESS, parameter, recording, system, task};
use proboscis::identify::{Ended, identify};
use proboscis::math::Random;
use proboscis::model::Constant;

const TRUE: [f64; 2] = [STIFFNESS, DAMPING];

#[test]
fn stiffness_and_damping_are_recovered_from_twice_and_half_their_values() {
    let task = task(vec![recording("free", [5.0, 0.0], (21, 150.0), None)]);
    let found = identify(&system(), &task, &mut |_, _| {}).unwrap();
    assert_eq!(found.fit.ended, Ended::Converged);
    let pairs = found.fit.unknowns.values.iter().zip(TRUE);
    for ((value, truth), parameter) in pairs.zip(&task.parameters) {
        assert!((parameter.guess / truth - 1.0).abs() > 0.4);
        assert!((value / truth - 1.0).abs() < 1e-6, "{value} {truth}");
    }
    assert!(found.information.undetermined.is_empty());
}

/// The test of another program: a mass on a spring that starts from twice its value.
#[test]
fn a_mass_is_recovered_from_twice_its_value() {
    let mut task = task(vec![recording("free", [5.0, 0.0], (21, 150.0), None)]);
    let system = system();
    let mass = system.bodies[0].mass;
    task.parameters = vec![parameter("mass", Constant::Mass(0), 2.0 * mass)];
    let found = identify(&system, &task, &mut |_, _| {}).unwrap();
    assert_eq!(found.fit.ended, Ended::Converged);
    let value = found.fit.of_constants()[0];
    assert!((value / mass - 1.0).abs() < 1e-6, "{value} {mass}");
}

#[test]
fn long_steps_are_halved_until_their_bias_is_below_a_tenth_of_the_standard_errors() {
    let noise = &mut Random::new(11);
    let mut task = task(vec![recording(
        "free",
        [5.0, 0.0],
        (41, 200.0),
        Some((0.005, noise)),
    )]);
    task.step = Some(20.0);
    let mut first = None;
    let found = identify(&system(), &task, &mut |fit, _| {
        first.get_or_insert_with(|| fit.unknowns.values.clone());
    })
    .unwrap();
    let first = first.unwrap();
    assert!(found.bias.is_confirmed && found.bias.halvings >= 2);
    // Least squares of the closed form, to a thousandth of a standard error.
    let exact = crate::statistics::closed_form(&task.recordings[0], found.fit.of_constants());
    for j in 0..2 {
        let error = found.information.covariance[(j, j)].sqrt();
        let bias = |value: f64| (value - exact[j]).abs() / error;
        println!(
            "{} to {}",
            bias(first[j]),
            bias(found.fit.of_constants()[j])
        );
        assert!(bias(found.fit.of_constants()[j]) < 0.1);
    }
    let error = found.information.covariance[(1, 1)].sqrt();
    assert!((first[1] - exact[1]).abs() > error);
}
