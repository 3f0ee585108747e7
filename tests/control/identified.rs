//! Constants of a material are recovered from a motion: all joints are tracked, all voltages are given.

use crate::common::cases::control;
use crate::common::sought::of_all_muscles;
use crate::common::trunk;
use crate::optimality::solve;
use proboscis::Signal;
use proboscis::control::problem::{
    BoundaryState, Control, CostFunction, Duration, During, Guess, Objective, QuantityCost,
    Voltages,
};
use proboscis::dynamics::{Start as Initial, simulate};
use proboscis::ipopt::Start;
use proboscis::model::{
    MaterialConstant, Model, Parameter, Quantity, Role, System, with_parameters,
};
use std::ops::ControlFlow;

const INTERVALS: usize = 40;
const H: f64 = 5.0;
/// Constants of the material.
const TRUE: [f64; 2] = [0.137, 0.71];

/// Shear modulus and viscosity of all muscles.
fn material(system: &System) -> Vec<Parameter> {
    let modulus = ("shear modulus", MaterialConstant::ShearModulus);
    let viscosity = ("viscosity", MaterialConstant::Viscosity);
    vec![
        of_all_muscles(system, modulus, [0.05, 0.1, 0.5]),
        of_all_muscles(system, viscosity, [0.1, 1.0, 5.0]),
    ]
}

/// Voltages that excite both joints.
fn voltages() -> Voltages {
    let sine = |mean: f64, period: f64| Signal::Sine {
        mean,
        amplitude: mean,
        frequency: period.recip(),
        phase: 0.4,
    };
    Voltages::from(vec![
        sine(700.0, 120.0),
        Signal::ramp(0.0, 900.0, 150.0),
        sine(600.0, 80.0),
        Signal::Constant(500.0),
    ])
}

/// Joint coordinates of the motion of the true material.
fn measured(system: &System) -> Vec<Signal> {
    let system = with_parameters(system, &material(system), &TRUE);
    let model = Model::new(system, None, H, &[]).unwrap();
    let zero = vec![0.0; model.joint_readings.len()];
    let start = Initial::at_rest(&model, model.coordinates_at(&zero));
    let scalars = |from: f64, to: f64| model.scalars(&voltages().at(0.5 * (from + to)));
    let (discrete, failure) = simulate(&model, &start, H, INTERVALS, scalars, |_| {
        ControlFlow::Continue(())
    });
    assert!(failure.is_none());
    let joints: Vec<Vec<f64>> = discrete
        .z
        .iter()
        .map(|z| model.joints(&model.action.map.placed(z), &zero))
        .collect();
    let signal = |joint: usize| Signal::Table {
        times: discrete.times.clone(),
        values: joints.iter().map(|row| row[joint]).collect(),
    };
    (0..zero.len()).map(signal).collect()
}

fn identification(system: &System) -> Control {
    let cost = |(joint, reference): (usize, Signal)| QuantityCost {
        quantity: Quantity::joint(joint, 0.0),
        weight: 1.0,
        function: CostFunction::Square { reference },
        during: During::Motion,
    };
    Control {
        duration: Duration::Given(H * INTERVALS as f64),
        goal: BoundaryState::Free,
        course: Some(voltages()),
        parameters: material(system),
        objective: Objective {
            quantities: measured(system).into_iter().enumerate().map(cost).collect(),
            ..Objective::default()
        },
        guess: Guess::Simulate(voltages()),
        ..control(system, INTERVALS)
    }
}

#[test]
fn shear_modulus_and_viscosity_are_recovered_from_a_motion() {
    let system = trunk(2);
    let problem = identification(&system);
    // The motion moves, and its guess is far from it.
    for cost in &problem.objective.quantities {
        let CostFunction::Square { reference } = &cost.function else {
            unreachable!("squares of deviations");
        };
        let largest = (0..=INTERVALS).map(|k| reference.at(k as f64 * H).abs());
        assert!(largest.fold(0.0, f64::max) > 0.02);
    }
    let found = solve(&system, &problem, None, Start::Cold);
    assert!(found.solution.status.is_solved());
    let first = found.solution.iterations[0].objective;
    assert!(first > 1e6 * found.solution.objective.abs(), "{first}");
    let range = found.model.variables.range(Role::Parameter);
    let values = &found.discrete.scalars[0][range];
    for (value, truth) in values.iter().zip(TRUE) {
        println!("{value} {truth}");
        assert!((value - truth).abs() < 1e-8 * truth, "{value} {truth}");
    }
    assert_eq!(found.columns.len() - values.len(), 2 * INTERVALS);
}
