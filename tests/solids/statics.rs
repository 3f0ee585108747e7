//! Blocks at rest: reference solutions of the same discretisation, homogeneous states, pull-in.

use crate::common::solid::{homogeneous, numbers, reference, stack};
use proboscis::dynamics::{EquilibriumError, Instability, equilibrium};
use proboscis::model::Model;
use proboscis::model::system::System;

/// Displacements of all nodes of the first block in mm, and its potentials in V.
fn solve(system: System, voltage: f64) -> (Model, Vec<[f64; 3]>, Vec<f64>) {
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let found = equilibrium(&model, &model.coordinates_at(&[]), &[voltage]).unwrap();
    assert_eq!(found.is_stable(), Some(true));
    let mut instant = model.action.map.instant();
    instant.z.copy_from_slice(&found.z);
    model.action.map.place(&mut instant);
    let block = &model.solids[0];
    let places = block.places(&instant.x);
    let moved = places.iter().zip(&block.solid.mesh.nodes);
    let moved = moved.map(|(x, at)| (x - at).into()).collect();
    let potentials = block.potentials(&found.scalars);
    (model, moved, potentials)
}

#[test]
fn homogeneous_blocks_are_the_reference() {
    for entry in reference("caseA")["fe"].as_array().unwrap() {
        let voltage = entry["V"].as_f64().unwrap();
        let (_, moved, _) = solve(homogeneous(entry), voltage);
        let probe = &entry["probes"][0];
        let node = probe["node"].as_u64().unwrap() as usize;
        for (found, expected) in moved[node].iter().zip(numbers(&probe["u"])) {
            let expected = expected * 1e3;
            assert!(expected.abs() > 0.1);
            assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
        }
    }
}

#[test]
fn the_stack_is_the_reference() {
    for entry in reference("caseB")["static"].as_array().unwrap() {
        if entry["mesh"]["order"].as_u64() != Some(1)
            || numbers(&entry["mesh"]["elements"])[0] > 4.0
        {
            continue;
        }
        let (_, moved, potentials) = solve(stack(entry), 3e5);
        let scale = 3.0;
        for probe in entry["probes"].as_array().unwrap() {
            let node = probe["node"].as_u64().unwrap() as usize;
            for (found, expected) in moved[node].iter().zip(numbers(&probe["u"])) {
                assert!(
                    (found - 1e3 * expected).abs() < 1e-8 * scale,
                    "{found} {expected}"
                );
            }
        }
        if let Some(all) = entry["full_nodal_u"].as_array() {
            for (found, expected) in moved.iter().zip(all) {
                for (found, expected) in found.iter().zip(numbers(expected)) {
                    assert!((found - 1e3 * expected).abs() < 1e-8 * scale);
                }
            }
            let all = numbers(&entry["full_nodal_phi"]);
            assert!(all.iter().any(|&phi| phi > 1e5 && phi < 2e5));
            for (found, expected) in potentials.iter().zip(all) {
                assert!((found - expected).abs() < 1e-8 * 3e5, "{found} {expected}");
            }
        }
    }
}

#[test]
fn pull_in_is_found_to_six_digits() {
    let case = reference("caseA");
    for entry in case["fe"].as_array().unwrap() {
        if entry["mesh"]["nodes"] != 8 || entry["V"] != 200_000.0 {
            continue;
        }
        let lambda = entry["material"]["lam"].as_f64().unwrap();
        let limits = case["pullin"].as_object().unwrap();
        let of = |name: &&String| name.trim_start_matches("lambda=").parse::<f64>() == Ok(lambda);
        let name = limits.keys().find(of).unwrap();
        let expected = limits[name]["V_over_10mm"].as_f64().unwrap();
        let model = Model::new(homogeneous(entry), None, 1.0, &[]).unwrap();
        let refused = equilibrium(&model, &model.coordinates_at(&[]), &[1e6]).unwrap_err();
        let EquilibriumError::LimitPoint { loss, last } = refused else {
            panic!("{refused}");
        };
        let fraction = loss.fraction;
        assert_eq!(loss.kind, Some(Instability::PullIn));
        assert!(
            (fraction * 1e6 / expected - 1.0).abs() < 1e-7,
            "{} {expected}",
            fraction * 1e6
        );
        let height = last.z.iter().fold(0.0_f64, |m, z| m.max(*z));
        assert!(height > 12.0, "{height}");
    }
}
