//! Sought masses of a motion that starts with given rates: its momentum follows them.

use crate::common::sought::parameter;
use crate::optimality::guessed_step;
use crate::sought::{pair, turn};
use crate::sought_rest::solved;
use proboscis::control::problem::{BoundaryState, Control};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::model::{
    Constant, MaterialConstant, MaterialOf, Parameter, System, with_parameters,
};
use proboscis::nlp::{Nlp, differences};

/// Rate of the joint at the start in rad/ms.
const RATE: f64 = -2e-3;

fn swinging(system: &System) -> Control {
    Control {
        start: BoundaryState::JointAngles {
            angles: [].into(),
            rates: [(0, RATE)].into(),
            velocities: [].into(),
        },
        ..turn(system)
    }
}

fn with_mass(system: &System) -> Control {
    let own = system.bodies[0].mass;
    Control {
        parameters: vec![parameter("mass", &[(Constant::Mass(0), 1.0)], own)],
        ..swinging(system)
    }
}

#[test]
fn the_momentum_of_the_start_has_exact_derivatives_by_a_mass() {
    let system = pair();
    let control = with_mass(&system);
    let h = guessed_step(&control);
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, h).unwrap();
    let [line] = &boundary.momentum_slopes[..] else {
        panic!("{:?}", boundary.momentum_slopes);
    };
    // A point mass on an arm: its part of the moment of inertia is in proportion.
    let change = line.slopes[0] * system.bodies[0].mass;
    assert!(change.abs() > 1e-3 * boundary.start.momentum[0].abs());
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let x = program.start(&initial).x;
    let moved: Vec<f64> = x.iter().map(|value| value + 0.05).collect();
    let report = differences::check(&mut program, &moved, 3);
    assert!(report.wrong.is_empty(), "{report}");
    assert!(program.jacobian_structure().rows.len() > 10);
}

#[test]
fn the_momentum_of_a_muscle_follows_its_density() {
    let mut system = pair();
    system.muscles[1].material.density = Some(1e-3);
    let density = (
        Constant::Material(MaterialOf::Muscle(1), MaterialConstant::Density),
        1.0,
    );
    let control = Control {
        parameters: vec![parameter("density", &[density], 1e-3)],
        ..swinging(&system)
    };
    let momentum = |value: f64| {
        let system = with_parameters(&system, &control.parameters, &[value]);
        let (_, boundary) = BoundaryConditions::resolve(&system, &swinging(&system), 10.0).unwrap();
        boundary.start.momentum[0]
    };
    let (_, boundary) = BoundaryConditions::resolve(&system, &control, 10.0).unwrap();
    let [line] = &boundary.momentum_slopes[..] else {
        panic!("{:?}", boundary.momentum_slopes);
    };
    let expected = (momentum(1.5e-3) - momentum(0.5e-3)) / 1e-3;
    assert!(expected.abs() > 1.0, "{expected}");
    assert!((line.slopes[0] / expected - 1.0).abs() < 1e-9);
    assert!((boundary.start.momentum[0] / momentum(1e-3) - 1.0).abs() < 1e-12);
}

#[test]
fn a_momentum_that_is_a_product_of_two_parameters_is_refused() {
    let mut system = pair();
    system.muscles[1].material.density = Some(1e-3);
    let density = (
        Constant::Material(MaterialOf::Muscle(1), MaterialConstant::Density),
        1.0,
    );
    let side = parameter("side", &[(Constant::Side(1, 0), 1.0)], 10.0);
    let resolved = |parameters: Vec<Parameter>| {
        let control = Control {
            parameters,
            ..swinging(&system)
        };
        BoundaryConditions::resolve(&system, &control, 10.0)
            .map(|(_, boundary)| boundary.momentum_slopes.len())
    };
    let density = parameter("density", &[density], 1e-3);
    assert_eq!(resolved(vec![density.clone()]), Ok(1));
    assert_eq!(resolved(vec![side.clone()]), Ok(1));
    let error = resolved(vec![density, side]).unwrap_err().to_string();
    assert!(error.contains("no straight line"), "{error}");
}

#[test]
fn a_mass_is_sought_of_a_motion_that_starts_with_a_rate() {
    let system = pair();
    let control = with_mass(&system);
    // The simulation that verifies it starts with the rate and the mass that was found.
    let best = solved(&system, &control, None);
    let found = best.motion.parameters[0].value;
    let own = system.bodies[0].mass;
    println!(
        "mass {found} from {own}, effort {}",
        best.solution.objective
    );
    assert!((found / own - 1.0).abs() > 0.05);
    let effort = |mass: f64| {
        let system = with_parameters(&system, &control.parameters, &[mass]);
        let optimum = solved(&system, &swinging(&system), Some(&best));
        optimum.solution.objective
    };
    let least = best.solution.objective;
    assert!((effort(found) - least).abs() < 1e-6 * least);
    assert!(effort(own) > least * (1.0 + 1e-4));
}
