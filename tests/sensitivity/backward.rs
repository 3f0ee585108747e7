//! Derivatives of few outcomes by many numbers, with one solution for each outcome, against those with one for each number.

use crate::resolved::{optimum, problem};
use proboscis::OutcomeOf;
use proboscis::control::Solution;
use proboscis::sensitivity::{NoSensitivity, Sensitivity, gradients, sensitivities};

/// Numbers of all kinds that the optimum of the pair has.
const NUMBERS: [&str; 9] = [
    "chain.mass",
    "duration",
    "goal.joint_angles.joint1",
    "materials.silicone.relative_permittivity",
    "materials.silicone.shear_modulus",
    "objective.effort",
    "objective.rate",
    "start.joint_rates.joint1",
    "voltage_bounds[1]",
];

/// The pair between angles; its upper bound of voltages is reached.
const CHANGES: [&str; 5] = [
    r#"control.goal={"joint_angles": {"joint1": 0.2}, "hold": "none"}"#,
    r#"control.start={"joint_angles": {"joint1": 0.05}, "joint_rates": {"joint1": 0.5}}"#,
    "control.voltage_bounds=[0, 1650]",
    "control.objective={\"effort\": 1.0, \"rate\": 0.0005}",
    "control.solver.tolerance=1e-12",
];

fn changes(numbers: &[&str]) -> Vec<String> {
    let list = numbers.iter().map(|one| format!("{one:?}: {{}}"));
    let asked = format!(
        "control.sensitivity={{{}}}",
        list.collect::<Vec<_>>().join(", ")
    );
    let all = CHANGES.iter().map(|one| (*one).to_owned());
    all.chain([asked]).collect()
}

/// Length of an interval in ms.
const H: f64 = 10.0;

/// An outcome of derivatives of all that an optimum has.
fn of(outcome: OutcomeOf, by: &Sensitivity) -> f64 {
    let at = |time: f64| (time / H).round() as usize;
    match outcome {
        OutcomeOf::Duration => by.duration,
        OutcomeOf::Parameter(place) => by.parameters[place],
        OutcomeOf::Input { source, time } => by.voltages[at(time)][source],
        OutcomeOf::Joint { joint, time } => by.joints[at(time)][joint],
        OutcomeOf::Marker { marker, axis, time } => by.markers[at(time)][marker][axis],
        OutcomeOf::Multiplier(row) => by.multipliers[row],
    }
}

/// An interval in which the voltage of a source is between its bounds.
fn between(motion: &Solution, source: usize) -> usize {
    let is_between = |row: &Vec<f64>| row[source] > 300.0 && row[source] < 1600.0;
    motion.voltages.iter().position(is_between).unwrap()
}

#[test]
fn few_outcomes_by_many_numbers() {
    let base = problem("pair", &changes(&NUMBERS));
    let motion = optimum(&base, None).motion;
    let forward = sensitivities(&base.0, &base.1, &motion).unwrap().0;
    let last = motion.voltages.len();
    assert!((motion.times[1] - H).abs() < 1e-9);
    let interval = between(&motion, 1);
    let outcomes = [
        OutcomeOf::Input {
            source: 1,
            time: H * interval as f64,
        },
        OutcomeOf::Joint {
            joint: 0,
            time: H * (last / 2) as f64,
        },
        OutcomeOf::Marker {
            marker: 0,
            axis: 0,
            time: H * last as f64,
        },
        OutcomeOf::Multiplier(3),
        OutcomeOf::Marker {
            marker: 0,
            axis: 1,
            time: 3.0 * H,
        },
    ];
    let backward = gradients(&base.0, &base.1, &motion, &outcomes).unwrap();
    assert_eq!(backward.solutions, 1 + outcomes.len());
    assert!(backward.one_sided.is_empty(), "{:?}", backward.one_sided);
    assert!(forward.iter().all(|by| by.weak.is_empty()));
    let mut zeros = 0;
    for (outcome, found) in outcomes.iter().zip(&backward.outcomes) {
        let expected: Vec<f64> = forward.iter().map(|by| of(*outcome, by)).collect();
        let pairs = found.iter().zip(&expected).zip(&forward);
        for ((found, expected), by) in pairs {
            println!("{outcome:?} by {}: {found} {expected}", by.varied.name);
            zeros += usize::from(*expected == 0.0);
            assert!((found - expected).abs() <= 1e-10 * expected.abs());
        }
        assert!(expected.iter().any(|one| one.abs() > 0.0), "{outcome:?}");
    }
    // The place at the end is given: it depends on the goal alone.
    assert_eq!(zeros, NUMBERS.len() - 1);
    for (found, by) in backward.objective.iter().zip(&forward) {
        assert!(by.objective.abs() > 0.0, "{}", by.varied.name);
        assert!((found - by.objective).abs() <= 1e-10 * by.objective.abs());
    }
    // The objective alone takes the solution that checks it.
    let alone = gradients(&base.0, &base.1, &motion, &[]).unwrap();
    assert_eq!((alone.solutions, alone.objective), (1, backward.objective));
}

#[test]
fn many_outcomes_by_few_numbers() {
    let base = problem("pair", &changes(&NUMBERS[3..5]));
    let motion = optimum(&base, None).motion;
    let forward = sensitivities(&base.0, &base.1, &motion).unwrap().0;
    let instants = 0..motion.voltages.len();
    let joint = |k: usize| OutcomeOf::Joint {
        joint: 0,
        time: H * k as f64,
    };
    let outcomes = instants.map(joint);
    let outcomes: Vec<OutcomeOf> = outcomes.collect();
    let found = gradients(&base.0, &base.1, &motion, &outcomes).unwrap();
    assert_eq!(found.solutions, 2);
    for (outcome, found) in outcomes.iter().zip(&found.outcomes) {
        let expected: Vec<f64> = forward.iter().map(|by| of(*outcome, by)).collect();
        assert_eq!(*found, expected);
    }
    assert!(found.outcomes[5].iter().all(|one| *one != 0.0));
}

#[test]
fn outcomes_that_are_not_offered() {
    let place = "chain.length";
    let asked = format!("control.sensitivity={{{place:?}: {{}}}}");
    let base = problem("pair", &[asked]);
    let motion = optimum(&base, None).motion;
    let outcome = OutcomeOf::Marker {
        marker: 0,
        axis: 0,
        time: 3.0 * H,
    };
    let error = gradients(&base.0, &base.1, &motion, &[outcome]).unwrap_err();
    let NoSensitivity::Refused(reason) = error else {
        panic!("{error}");
    };
    println!("{reason}");
    assert!(reason.contains(place), "{reason}");
    let joint = OutcomeOf::Joint {
        joint: 0,
        time: 3.0 * H,
    };
    assert!(gradients(&base.0, &base.1, &motion, &[joint]).is_ok());
}
