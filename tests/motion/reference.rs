//! Statics and forward motion of the trunk against the reference solutions.

use crate::common::{numbers, reference, trunk};
use proboscis::dynamics::{Start, equilibrium, simulate};
use proboscis::model::{Coordinates, Model};
use std::ops::ControlFlow;

fn case(name: &str, segments: usize, coordinates: Coordinates) {
    let file = reference(name);
    let model = Model::new(trunk(segments), Some(coordinates), 5.0, &[]).unwrap();
    let zero = model.coordinates_at(&vec![0.0; segments]);
    let hold = numbers(&file["hold_voltage_V"]);
    let scalars = model.scalars(&hold);

    let rest = equilibrium(&model, &zero, &scalars).unwrap();
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(&rest.z);
    model.action.map.place(&mut instant);
    let angles = model.joints(&instant, &vec![0.0; segments]);
    let expected = numbers(&file["equilibrium"]["theta_rad"]);
    assert!(expected.iter().any(|a| a.abs() > 0.1));
    for (a, b) in angles.iter().zip(&expected) {
        assert!(
            (a - b).abs() < 1e-9,
            "{name} {coordinates:?}: {a} against {b}"
        );
    }
    if coordinates == Coordinates::Reduced {
        for (a, b) in rest
            .stiffness
            .iter()
            .zip(numbers(&file["equilibrium"]["stiffness_eigenvalues_Nm"]))
        {
            assert!((a * 1e-3 - b).abs() < 1e-9 * b);
        }
    }

    let start = Start::at_rest(&model, zero);
    let (discrete, failure) = simulate(
        &model,
        &start,
        5.0,
        200,
        |_, _| scalars.clone(),
        |_| ControlFlow::Continue(()),
    );
    assert_eq!(failure, None);
    let steps = file["simulation_constant_voltage"]["theta_rad"]
        .as_object()
        .unwrap();
    assert!(steps.len() > 3);
    let mut near = vec![0.0; segments];
    for (k, z) in discrete.z.iter().enumerate() {
        instant.z.copy_from_slice(z);
        model.action.map.place(&mut instant);
        near = model.joints(&instant, &near);
        if let Some(expected) = steps.get(&k.to_string()) {
            for (a, b) in near.iter().zip(numbers(expected)) {
                assert!(
                    (a - b).abs() < 1e-8,
                    "{name} {coordinates:?} step {k}: {a} against {b}"
                );
            }
        }
    }
}

#[test]
fn pair_reduced() {
    case("pair", 1, Coordinates::Reduced);
}

#[test]
fn pair_redundant() {
    case("pair", 1, Coordinates::Redundant);
}

#[test]
fn trunk_reduced() {
    case("trunk6", 6, Coordinates::Reduced);
}

#[test]
fn trunk_redundant() {
    case("trunk6", 6, Coordinates::Redundant);
}
