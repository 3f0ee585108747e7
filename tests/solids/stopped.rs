//! Stops within evaluations of elements by the nodes of boxes and meshes, and on the ways to equilibria, at any question.

use crate::common::solid::system;
use crate::common::stacks::{cubes, rubber, scattered};
use crate::multigrid::{MULTIGRID, apart};
use nalgebra::Vector3;
use proboscis::dynamics::{
    EquilibriumError, MultigridUse, PathStop, Route, Softening, Start, StepError, Stepper,
    continuation, stable_equilibrium, stable_equilibrium_by,
};
use proboscis::files::read_system;
use proboscis::model::Model;
use proboscis::model::system::{ElementKind, System};
use proboscis::stop::{self, Questions};
use std::path::Path;

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
    let watch = stop::watch_questions(&questions);
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
    for allowed in (0..asked).step_by(asked as usize / 7).chain([asked - 1]) {
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

/// Questions behind the state, about its mode and what softens it; of a box and of a mesh that is none, of mean dilatation.
#[test]
fn a_stop_behind_an_equilibrium_names_no_other_cause_of_its_softness() {
    let mut nearly_incompressible = cubes(2, rubber(0.4, None));
    nearly_incompressible.element = ElementKind::Hex8Q1P0;
    for material in &mut nearly_incompressible.materials {
        material.lame_lambda = Some(1e3 * material.shear_modulus);
    }
    let mut named = 0;
    for (solid, weight, softening) in [
        // The straight column buckles.
        (cubes(2, rubber(0.4, None)), 0.5, Some(Softening::Elastic)),
        (scattered(nearly_incompressible, 0.2), 0.02, None),
    ] {
        let mut system = system(vec![solid]);
        system.gravity = Some(Vector3::new(0.0, 0.0, -weight));
        let model = Model::new(system, None, STEP, &[]).unwrap();
        let start = model.reference_coordinates();
        let rest = || stable_equilibrium_by(&model, &start, &[5e4], MultigridUse::Alone);
        let (whole, asked) = within(u64::MAX, rest);
        let whole = whole.unwrap();
        assert!(apart(&whole.z, &start) > 1e-3);
        assert_eq!(whole.softest.unwrap().softening, softening);
        let is_stable = Some(softening.is_none());
        assert_eq!(whole.unstable.map(|count| count == 0), is_stable);
        for allowed in (asked - 4)..asked {
            let (stopped, _) = within(allowed, rest);
            let rest = match stopped {
                Ok(rest) => rest,
                Err(EquilibriumError::Stopped(_)) => continue,
                Err(other) => panic!("question {allowed} of {asked}: {other}"),
            };
            assert_eq!(rest.z, whole.z);
            assert!(rest.is_stable().is_none() || rest.is_stable() == is_stable);
            if let Some(mode) = rest.softest {
                named += 1;
                let is_same = mode.softening.is_none() || mode.softening == softening;
                assert!(
                    is_same,
                    "question {allowed} of {asked}: {:?}",
                    mode.softening
                );
            }
        }
    }
    assert!(named > 1, "{named}");
}

/// A path that is stopped while its limit point is sought does not have one elsewhere.
#[test]
fn a_stopped_path_loses_no_stability() {
    let model = Model::new(system(vec![cubes(1, rubber(0.4, None))]), None, STEP, &[]).unwrap();
    let start = model.reference_coordinates();
    let path = |points: usize| continuation(&model, &start, &[1e6], points).unwrap();
    let whole = path(16);
    let is_lost = |stop: &&PathStop| stop.lost.is_some();
    let before = whole.iter().take_while(|stop| !is_lost(stop)).count() - 1;
    let fraction = whole[before + 1].fraction;
    let followed = |path: &[PathStop]| -> Vec<f64> {
        let points = path.iter().filter(|stop| !is_lost(stop));
        points.map(|stop| stop.fraction).collect()
    };
    let (_, first) = within(u64::MAX, || path(before + 1));
    let (_, asked) = within(u64::MAX, || path(before + 2));
    assert!(asked > first + 10);
    let mut stops = 0;
    for allowed in (first..=asked).step_by((asked - first) as usize / 4) {
        let (stopped, _) = within(allowed, || path(before + 2));
        let points = followed(&stopped);
        assert_eq!(points, followed(&whole)[..points.len()]);
        stops += usize::from(points.len() <= before + 1);
        for lost in stopped.iter().filter(is_lost) {
            assert_eq!(lost.fraction, fraction, "question {allowed} of {asked}");
        }
    }
    assert!(stops > 2, "{stops}");
}

/// A trunk that buckles under its weight falls to two sides: no side is the answer before both are known.
#[test]
fn the_lower_of_two_equilibria_is_not_told_before_both_are_known() {
    let file = "tests/trust/06_solve_refused_earth_gravity.json";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let system = read_system(&path, &["scene.gravity=[0,-9.81,0]".to_owned()]).unwrap();
    let model = Model::new(system, None, 1.0, &[]).unwrap();
    let (start, none) = (
        model.reference_coordinates(),
        vec![0.0; model.sources.len()],
    );
    let rest = || stable_equilibrium(&model, &start, &model.scalars(&none));
    let (whole, asked) = within(u64::MAX, rest);
    let whole = whole.unwrap();
    assert!(matches!(whole.route, Route::DampedMotion(_)));
    for allowed in asked - 12..asked {
        let (stopped, _) = within(allowed, rest);
        let is_stopped = matches!(stopped, Err(EquilibriumError::Stopped(_)));
        assert!(is_stopped, "question {allowed} of {asked}: {stopped:?}");
    }
    assert_eq!(within(asked, rest).0.unwrap().z, whole.z);
}
