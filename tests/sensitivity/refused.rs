//! Numbers by which an optimum is not differentiated, because what follows from them is not known.

use crate::resolved::{optimum, problem};
use proboscis::sensitivity::{check, sensitivities};

/// The reason why a number of a changed pair of muscles is refused, if it is.
fn refusal(changes: &[&str], number: &str) -> Option<String> {
    let number = format!("control.sensitivity={{{number:?}: {{}}}}");
    let changes: Vec<String> = changes
        .iter()
        .map(|one| (*one).to_owned())
        .chain([number])
        .collect();
    let (system, control) = problem("pair", &changes);
    check(&system, &control).err().map(|(_, reason)| reason)
}

const REDUNDANT: &str = "control.coordinates=\"redundant\"";
const ANGLES: &str = "control.start={\"joint_angles\": {\"joint1\": 0.1}}";

#[test]
fn a_start_of_joint_coordinates_is_offered_in_these_alone() {
    let start = "start.joint_angles.joint1";
    assert_eq!(refusal(&[ANGLES], start), None);
    let reason = refusal(&[ANGLES, REDUNDANT], start).unwrap();
    assert!(reason.contains("joint coordinates"), "{reason}");
}

#[test]
fn a_given_duration_stretches_no_function_of_time_and_no_rate() {
    assert_eq!(refusal(&[], "duration"), None);
    let constant = "control.voltages={\"muscle1\": \"300 V\"}";
    assert_eq!(refusal(&[constant], "duration"), None);
    let sine = "control.voltages={\"muscle1\": {\"sine\": {\"mean\": \"300 V\", \"amplitude\": \"100 V\", \"period\": \"0.2 s\"}}}";
    let reason = refusal(&[sine], "duration").unwrap();
    assert!(reason.contains("functions of time"), "{reason}");
    for limit in [
        "{\"voltage_rate\": {\"sources\": \"all\", \"max\": \"100 kV/s\"}}",
        "{\"joint_rate\": {\"joint\": \"joint1\", \"max\": \"50 rad/s\"}}",
    ] {
        let limits = format!("control.limits=[{limit}]");
        let reason = refusal(&[&limits], "duration").unwrap();
        assert!(reason.contains("count time"), "{reason}");
    }
}

#[test]
fn a_start_that_branches_remember_is_refused() {
    let branch = "scene.materials.silicone.maxwell=[{\"shear_modulus\": \"20 kPa\", \"relaxation_time\": \"50 ms\"}]";
    let reason = refusal(&[ANGLES, branch], "start.joint_angles.joint1").unwrap();
    assert!(reason.contains("memory"), "{reason}");
}

#[test]
fn a_number_that_is_refused_leaves_the_others() {
    let changes = [
        REDUNDANT,
        "control.goal={\"joint_angles\": {\"joint1\": 0.1}, \"hold\": \"none\"}",
        "control.sensitivity={\"goal.joint_angles.joint1\": {}, \"materials.silicone.shear_modulus\": {}}",
    ];
    let changes = changes.map(str::to_owned);
    let base = problem("pair", &changes);
    let motion = optimum(&base, None).motion;
    let (found, refused) = sensitivities(&base.0, &base.1, &motion).unwrap();
    let [(name, _)] = &refused[..] else {
        panic!("{refused:?}");
    };
    assert_eq!(name, "goal.joint_angles.joint1");
    let [of_modulus] = &found[..] else {
        panic!("{} numbers", found.len());
    };
    // The same in joint coordinates, where both exist.
    let changes = changes.map(|one| one.replace("redundant", "reduced"));
    let base = problem("pair", &changes);
    let motion = optimum(&base, None).motion;
    let (both, refused) = sensitivities(&base.0, &base.1, &motion).unwrap();
    assert!(refused.is_empty(), "{refused:?}");
    let same = both
        .iter()
        .find(|one| one.varied == of_modulus.varied)
        .unwrap();
    assert!(of_modulus.objective != 0.0);
    let difference = (of_modulus.objective - same.objective).abs();
    // Both optima are found up to the tolerance of the solver.
    assert!(difference < 1e-5 * same.objective.abs(), "{difference}");
}
