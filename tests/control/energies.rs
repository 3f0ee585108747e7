//! Least electrical energy: less is drawn than by least effort, and the conditions of an optimum hold.

use crate::common::cases::rest_to_rest;
use crate::common::tracked::energies;
use crate::common::{placed, trunk};
use crate::optimality::{Optimum, cold};
use proboscis::control::problem::{Control, Objective};
use proboscis::model::Coordinates;
use proboscis::model::system::VACUUM_PERMITTIVITY;

/// Electrical energy in J from the sources of a trunk that starts without charge, the switch to the voltages `after` included, and Σ h |V|²
/// in kV² s.
fn paid(optimum: &Optimum, after: &[f64]) -> [f64; 2] {
    let model = &optimum.model;
    let mut paid = [0.0; 2];
    for (m, &span) in model.spans.iter().enumerate() {
        let scalar = model.variables.input(m).unwrap();
        let charge = |k: usize, v: f64| {
            let i = (placed(model, &optimum.discrete.z[k]).x[span].norm() / 40.0).powi(2);
            2.0 * 4000.0 * VACUUM_PERMITTIVITY * (2.0 - i + 0.5 / i) / (0.05 * 0.05) * v
        };
        let rows = optimum.discrete.scalars.iter();
        let mut voltages: Vec<f64> = rows.map(|row| row[scalar]).collect();
        paid[1] += voltages
            .iter()
            .map(|v| v * v / 1e6 * optimum.h / 1e3)
            .sum::<f64>();
        voltages.push(after[m]);
        let mut last = 0.0;
        for (k, &v) in voltages.iter().enumerate() {
            // What flows at the switch, and what flows until the next.
            paid[0] += v * (charge(k, v) - charge(k, last)) / 1e3;
            if k + 1 < voltages.len() {
                paid[0] += v * (charge(k + 1, v) - charge(k, v)) / 1e3;
            }
            last = v;
        }
    }
    paid
}

/// The optima of least effort and of least electrical energy of one problem.
fn both(segments: usize, effort: &Control) -> [[f64; 2]; 2] {
    let system = trunk(segments);
    let all: Vec<(usize, f64)> = (0..2 * segments).map(|m| (m, 1.0)).collect();
    let energy = Control {
        objective: Objective {
            energies: energies(&all, &[]),
            ..Objective::default()
        },
        ..effort.clone()
    };
    let held = crate::common::cases::hold(segments);
    [effort, &energy].map(|control| {
        let optimum = cold(&system, control);
        let worst = optimum.conditions.into_iter().fold(0.0, f64::max);
        assert!(worst < 1e-8, "{:?}", optimum.conditions);
        let paid = paid(&optimum, &held);
        let own = paid[usize::from(control.objective.effort > 0.0)];
        let objective = optimum.solution.objective;
        assert!((objective - own).abs() < 1e-10 * own, "{objective} {own}");
        paid
    })
}

#[test]
fn least_electrical_energy_draws_less_than_least_effort() {
    let mut found = Vec::new();
    for coordinates in [Coordinates::Reduced, Coordinates::Redundant] {
        let effort = Control {
            coordinates: Some(coordinates),
            ..rest_to_rest(1, 20, 200.0)
        };
        let [of_effort, of_energy] = both(1, &effort);
        println!("{of_effort:?} {of_energy:?}");
        assert!(
            of_energy[0] < 0.9 * of_effort[0],
            "{of_energy:?} {of_effort:?}"
        );
        assert!(
            of_effort[1] < 0.99 * of_energy[1],
            "{of_energy:?} {of_effort:?}"
        );
        found.push(of_energy[0]);
    }
    assert!((found[0] - found[1]).abs() < 1e-7 * found[0], "{found:?}");
}

#[test]
fn a_trunk_of_least_electrical_energy_is_found() {
    let [of_effort, of_energy] = both(3, &rest_to_rest(3, 30, 400.0));
    println!("{of_effort:?} {of_energy:?}");
    assert!(
        of_energy[0] < 0.95 * of_effort[0],
        "{of_energy:?} {of_effort:?}"
    );
}
