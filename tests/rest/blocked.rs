//! Blocked muscles: both ends on the ground.

use crate::stable::{file, model, reference};
use proboscis::control::problem::Task;
use proboscis::dynamics::{DiscreteTrajectory, observations, stable_equilibrium};
use proboscis::files::read_problem;

/// A muscle between two places of the ground has no coordinate, and the force that a data sheet states.
#[test]
fn a_blocked_muscle_pulls_with_its_blocking_force() {
    let loaded = read_problem(&file("12_blocking_force"), &[]).unwrap();
    let Task::Equilibrium(task) = loaded.task else {
        panic!("it asks for no equilibrium");
    };
    let model = model(loaded.system);
    let found = stable_equilibrium(&model, &reference(&model), &model.scalars(&task.voltages));
    let found = found.unwrap();
    assert_eq!(model.coordinate_count(), 0);
    let still = DiscreteTrajectory {
        times: vec![0.0],
        z: vec![found.z.clone()],
        momenta: vec![Vec::new()],
        scalars: vec![found.scalars.clone()],
        ..DiscreteTrajectory::default()
    };
    let seen = observations(&model, &still);
    let tension = seen.columns.iter().find(|c| c.name == "stack_tension");
    let tension = tension.unwrap().values[0];
    // ε A (V/t)² of an ideal dielectric; a stretch of 1 has no elastic force.
    let permittivity = 9.821341249875774 * 8.8541878128e-12;
    let expected = permittivity * 15e-3 * 15e-3 * (1000.0_f64 / 30e-6).powi(2);
    assert!(
        (tension - expected).abs() < 1e-6 * expected,
        "{tension} {expected}"
    );
}
