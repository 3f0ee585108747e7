//! Stops within an evaluation of elements by the nodes of a box, at any question.

use crate::common::solid::system;
use crate::common::stacks::{cubes, rubber};
use crate::multigrid::{MULTIGRID, apart};
use proboscis::dynamics::{
    EquilibriumError, MultigridUse, Start, StepError, Stepper, stable_equilibrium_by,
};
use proboscis::ipopt::interrupt::{self, Questions};
use proboscis::model::Model;
use proboscis::model::system::System;

const STEP: f64 = 0.5;
const VOLTAGE: f64 = 2e5;
/// Elements between two questions.
const STRETCH: usize = 128;

/// 4 × 4 × 16 elements.
fn block(viscosity: Option<f64>) -> (System, u64) {
    let solid = cubes(4, rubber(0.4, viscosity));
    let stretches = solid.mesh.hexahedra.len().div_ceil(STRETCH) as u64;
    assert!(stretches > 1);
    (system(vec![solid]), stretches)
}

/// What a function returns within a time of so many questions, and the questions that it asked.
fn within<T>(allowed: u64, work: impl FnOnce() -> T) -> (T, u64) {
    let questions = Questions::allowed(allowed);
    let watch = interrupt::watch_questions(&questions);
    let found = work();
    drop(watch);
    (found, questions.asked())
}

#[test]
fn a_step_stops_within_an_evaluation_and_can_be_repeated() {
    let (system, stretches) = block(Some(1.0));
    let model = Model::new(system, None, STEP, &[]).unwrap();
    let start = Start::at_rest(&model, model.coordinates_at(&[]));
    let stepper = || Stepper::new(&model, &start.z, &start.momentum, MULTIGRID);
    let mut whole = stepper();
    let (done, asked) = within(u64::MAX, || whole.step(STEP, &[VOLTAGE]));
    done.unwrap();
    let moved = whole.coordinates().to_vec();
    assert!(
        moved
            .iter()
            .zip(&start.z)
            .any(|(a, b)| (a - b).abs() > 1e-3)
    );
    // Elements and their viscosity are two terms.
    let evaluations = 2 * 2 * stretches;
    assert!(asked > evaluations, "{asked} of {evaluations}");
    for allowed in (0..asked).step_by(4).chain([asked - 1]) {
        let mut stepper = stepper();
        let (stopped, questions) = within(allowed, || stepper.step(STEP, &[VOLTAGE]));
        let is_stopped = matches!(stopped, Err(StepError::Stopped { .. }));
        assert!(is_stopped, "question {allowed} of {asked}: {stopped:?}");
        assert!(questions <= allowed + 8, "{} more", questions - allowed);
        assert_eq!(stepper.coordinates(), start.z);
        stepper.step(STEP, &[VOLTAGE]).unwrap();
        // The tangent of the attempt that was stopped is kept.
        let apart = apart(stepper.coordinates(), &moved);
        assert!(apart < 1e-9, "{apart:e} mm after question {allowed}");
    }
}

#[test]
fn an_equilibrium_stops_within_an_evaluation() {
    let (system, stretches) = block(None);
    let model = Model::new(system, None, STEP, &[]).unwrap();
    let start = model.reference_coordinates();
    let rest = || stable_equilibrium_by(&model, &start, &[VOLTAGE], MultigridUse::Alone);
    let (whole, asked) = within(u64::MAX, rest);
    let whole = whole.unwrap();
    assert_eq!(whole.is_stable(), Some(true));
    assert!(apart(&whole.z, &start) > 1e-2);
    assert!(asked > 5 * stretches, "{asked}");
    let mut stops = 0;
    for allowed in (0..asked).step_by(asked as usize / 11).chain([asked - 1]) {
        let (stopped, _) = within(allowed, rest);
        match stopped {
            Err(EquilibriumError::Stopped(_)) => stops += 1,
            // The state was found before.
            Ok(rest) => {
                assert_eq!(rest.z, whole.z);
                assert_ne!(
                    rest.is_stable(),
                    Some(false),
                    "question {allowed} of {asked}"
                );
            }
            Err(other) => panic!("question {allowed} of {asked}: {other}"),
        }
    }
    assert!(stops > 4, "{stops} stops");
}
