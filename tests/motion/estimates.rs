//! Estimated errors of motions against the same motion by Galerkin's method of a higher degree in parts of their steps.

use crate::common::problem;
use crate::similar::moving;
use proboscis::control::problem::{Simulation, Task};
use proboscis::control::resolve_start;
use proboscis::dynamics::trajectory::Trajectory;
use proboscis::dynamics::{
    DiscreteTrajectory, Drive, Integrator, Lengths, Solving, distance_between, go_on,
};
use proboscis::model::Model;
use proboscis::tasks::simulate::{SimulationRequest, simulate};
use serde_json::{Value, json};
use std::ops::ControlFlow;

/// Parts of a step of the exact motion.
const PARTS: usize = 4;

struct Inputs<'a>(&'a Model, &'a Simulation);

impl Drive for Inputs<'_> {
    fn at(&self, [from, to]: [f64; 2], part: f64) -> Vec<f64> {
        self.0
            .scalars(&self.1.voltages.at(from + part * (to - from)))
    }
}

/// The motion by Galerkin's method of degree 3 in parts of the steps between some times.
fn exact(model: &Model, task: &Simulation, times: &[f64]) -> DiscreteTrajectory {
    let parts = times.windows(2).flat_map(|ends| {
        let h = (ends[1] - ends[0]) / PARTS as f64;
        (1..=PARTS).map(move |k| ends[0] + k as f64 * h)
    });
    let all: Vec<f64> = times[..1].iter().copied().chain(parts).collect();
    let solving = Solving {
        integrator: Integrator::Galerkin { degree: 3 },
        ..Solving::default()
    };
    let start = resolve_start(model, &task.start).unwrap();
    let (begun, lengths) = (DiscreteTrajectory::at(&start), Lengths::Between(&all));
    let go = |_: &DiscreteTrajectory| ControlFlow::Continue(());
    let (motion, failure) = go_on(solving, model, begun, lengths, &Inputs(model, task), go);
    assert_eq!(failure, None);
    motion
}

/// The error that is told in mm, and the true one.
fn told_and_true(file: &Value) -> [f64; 2] {
    let (system, task) = problem(file);
    let Task::Simulate(task) = task else {
        panic!("a simulation")
    };
    let go = &mut |_: usize, _: &Model, _: &DiscreteTrajectory| ControlFlow::Continue(());
    let result = simulate(&system, &task, SimulationRequest::default(), go).unwrap();
    let (model, motion) = (&result.simulated.model, &result.simulated.discrete);
    let trajectory = Trajectory::from_discrete(model, motion);
    let told = result
        .assess(&system, &task, &trajectory)
        .neglected
        .unwrap();
    let fine = exact(model, &task, &motion.times);
    let of_fine = Trajectory::from_discrete(model, &fine);
    let instants: Vec<usize> = (0..fine.times.len()).step_by(PARTS).collect();
    let error = distance_between(model, (&fine, &of_fine), &instants, (motion, &trajectory));
    [told.error, error]
}

#[test]
fn errors_of_steps_by_a_tolerance_are_never_told_too_small() {
    for (seed, tolerance) in [(1, 1e-3), (2, 1e-3), (3, 1e-4), (6, 1e-3), (9, 1e-4)] {
        let simulate = json!({ "duration": "40 ms", "tolerance": tolerance });
        let [told, error] = told_and_true(&moving(seed, &simulate));
        println!("{seed} {tolerance}: told {told:e} of {error:e} mm");
        assert!(
            error > 1e-7 && told >= 0.5 * error,
            "{seed}: {told} of {error}"
        );
    }
}

#[test]
fn errors_of_galerkin_methods_are_told_within_a_factor() {
    for (seed, step) in [(1, 2.0), (2, 1.0), (3, 4.0), (5, 2.0), (6, 1.0), (9, 2.0)] {
        let integrator = json!({ "galerkin": 2 });
        let simulate = json!({
            "duration": "40 ms", "step": format!("{step} ms"), "integrator": integrator,
        });
        let [told, error] = told_and_true(&moving(seed, &simulate));
        println!("{seed} {step} ms: told {told:e} of {error:e} mm");
        let ratio = told / error;
        assert!((0.5..3.0).contains(&ratio), "{seed}: {told} of {error}");
    }
}
