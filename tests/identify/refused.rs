//! Data that do not allow an identification, and verdicts that say so.

use crate::oscillator::{DAMPING, parameter, recording, system, task};
use proboscis::control::problem::Recording;
use proboscis::identify::{IdentifyError, identify};
use proboscis::math::Random;
use proboscis::model::Constant;
use proboscis::prelude::{GROUND, Spring, X, mm, n_per_m};

fn refusal(task: &proboscis::control::problem::Identification) -> IdentifyError {
    identify(&system(), task, &mut |_, _| {}).unwrap_err()
}

#[test]
fn data_that_tell_nothing_are_refused() {
    let still = |count| recording("still", [0.0, 0.0], (count, 100.0), None);
    assert_eq!(refusal(&task(vec![still(9)])), IdentifyError::NothingMoves);
    let few = task(vec![recording("few", [5.0, 0.0], (2, 100.0), None)]);
    let expected = IdentifyError::TooFew {
        readings: 2,
        unknowns: 2,
    };
    assert_eq!(refusal(&few), expected);
}

#[test]
fn a_constant_that_no_recording_depends_on_is_refused() {
    let mut system = system();
    let spring = Spring::between((GROUND, -X * mm(50.0)), (GROUND, X * mm(20.0)));
    system.add(spring.stiffness(n_per_m(10.0)));
    let mut task = task(vec![recording("free", [5.0, 0.0], (9, 100.0), None)]);
    task.parameters
        .push(parameter("idle", Constant::SpringStiffness(1), 0.01));
    let error = identify(&system, &task, &mut |_, _| {}).unwrap_err();
    assert!(
        matches!(&error, IdentifyError::Unread { name } if name == "idle"),
        "{error}"
    );
}

#[test]
fn a_candidate_needs_a_deviation_that_is_known_or_estimated() {
    let first = |deviation: Option<f64>| {
        let noise = &mut Random::new(4);
        let mut recording = recording("free", [5.0, 0.0], (31, 150.0), Some((0.05, noise)));
        recording.channels[0].is_deviation_known = deviation.is_some();
        let readings = &mut recording.channels[0].readings;
        readings
            .iter_mut()
            .for_each(|one| one.deviation = deviation.unwrap_or(1.0));
        recording
    };
    let with_candidate = |recorded: Recording| {
        let mut task = task(vec![recorded]);
        let mut candidate = recording("free", [8.0, 0.0], (31, 150.0), None);
        candidate.name = "again".into();
        task.candidates = vec![candidate];
        identify(&system(), &task, &mut |_, _| {})
    };
    let estimated = with_candidate(first(None)).unwrap();
    assert_eq!(estimated.experiments[0].candidate, 0);
    let [before, after] = [
        &estimated.information,
        &estimated.experiments[0].information,
    ];
    assert!(0.0 < after.covariance[(0, 0)] && after.covariance[(0, 0)] < before.covariance[(0, 0)]);
    // A deviation that is known of the recording is not one of the candidate.
    let error = with_candidate(first(Some(0.05))).unwrap_err();
    let IdentifyError::Candidate { candidate, reason } = &error else {
        panic!("{error}");
    };
    assert_eq!(candidate, "again");
    assert!(reason.contains("the standard deviation of x"), "{reason}");
}

#[test]
fn a_constant_at_its_bound_is_said() {
    let noise = &mut Random::new(4);
    let mut task = task(vec![recording(
        "free",
        [5.0, 0.0],
        (31, 150.0),
        Some((0.05, noise)),
    )]);
    task.parameters[1].upper = 0.8 * DAMPING;
    let found = identify(&system(), &task, &mut |_, _| {}).unwrap();
    assert_eq!(found.fit.is_at_bound, [false, true]);
    assert!((found.fit.of_constants()[1] - 0.8 * DAMPING).abs() < 1e-12);
    assert!(found.p.unwrap() < 0.01 || !found.is_white());
}
