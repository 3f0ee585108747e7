//! Gains over a delay at the end of a motion, which in short steps is not quite at the goal that is held behind it.

use crate::common::receding::problem;
use crate::common::robot::Robot;
use proboscis::control::problem::Regulator;
use proboscis::feedback::{Controller, Law};
use proboscis::model::Model;
use proboscis::stop::{self, Questions};
use proboscis::tasks::{SolveRequest, solve};
use proboscis::workflow::Iterate;
use proboscis::workflow::regulator::{Along, NoRegulator, regulator};
use std::ops::ControlFlow;

/// Deviations in rad of the joint from the goal in intervals behind the end of the motion, and the greatest before.
fn behind_the_end(model: &Model, law: &Law) -> (Vec<f64>, f64) {
    let mut robot = Robot::new(model, 5);
    let delay = law.delay as f64 * law.h;
    let mut controller = Controller::new(law, law.h, delay);
    let (mut behind, mut before) = (Vec::new(), 0.0_f64);
    let end = law.points.len();
    for k in 0..end + 12 {
        let time = law.h * k as f64;
        let off = robot.z[0] - law.at(time).state[0];
        match k < end {
            true => before = before.max(off.abs()),
            false => behind.push(off),
        }
        controller.sample(time, &robot.measure());
        let mut inputs = vec![0.0; law.inputs.len()];
        controller.inputs(time, time + 0.5 * law.h, &mut inputs);
        robot.go(law.h, &inputs);
    }
    (behind, before)
}

/// On its motion the pair comes to the goal under gains over a delay as it does under gains without.
#[test]
fn the_end_of_the_motion_is_predicted_over_a_delay() {
    // Coarse intervals in shorter steps end clearly beside the goal.
    let changes = [
        "control.intervals=10",
        "control.goal={\"rest_at_voltages\": {\"muscle1\": \"1.2 kV\", \"muscle2\": \"1.9 kV\"}}",
    ];
    let (system, control) = problem("pair.json", &changes);
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve(&system, &control, SolveRequest::default(), go_on).unwrap();
    assert!(found.verdict.is_solved);
    let law = |delay: f64| {
        let task = Regulator {
            step: 4.0,
            delay,
            ..Regulator::default()
        };
        let along = Along::new(&found.optimum, &found.discrete, &control);
        regulator(along, &task).unwrap().law
    };
    let (at_once, late) = (law(0.0), law(40.0));
    assert_eq!(late.delay, 2);
    let model = Model::new(system, None, at_once.h, &[]).unwrap();
    let (expected, before) = behind_the_end(&model, &at_once);
    let (found, late_before) = behind_the_end(&model, &late);
    println!("{expected:.6?}\n{found:.6?}\n{before:e} {late_before:e}");
    let jump = expected[0].abs();
    assert!(before < 1e-6 && late_before < 1e-6 && jump > 1e-3);
    for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert!(
            (found - expected).abs() < 0.05 * jump,
            "{k}: {found} {expected}"
        );
    }
    // Without the corrections that know of the end it stays there for the delay.
    let mut unaware = late;
    unaware.points.iter_mut().for_each(|p| p.offset.clear());
    let (beside, _) = behind_the_end(&model, &unaware);
    println!("{beside:.6?}");
    assert!((beside[1] - expected[1]).abs() > 0.5 * jump);
}

/// A stop in any step ends the search for gains as a stop: a step that was stopped is not a singular one.
#[test]
fn a_stop_among_the_gains_is_no_singular_step() {
    let (system, control) = problem("pair.json", &["control.intervals=4"]);
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let found = solve(&system, &control, SolveRequest::default(), go_on).unwrap();
    let run = |allowed: u64| {
        let questions = Questions::allowed(allowed);
        let _watch = stop::watch_questions(&questions);
        let task = Regulator::default();
        let found = regulator(Along::new(&found.optimum, &found.discrete, &control), &task);
        (found.map(|found| found.held.is_some()), questions.asked())
    };
    let (whole, asked) = run(u64::MAX >> 1);
    assert!(whole == Ok(true) && asked > 10, "{whole:?} {asked}");
    let mut stopped = 0;
    for allowed in (0..asked).step_by(29) {
        match run(allowed).0 {
            Ok(is_held) => assert!(is_held, "{allowed} of {asked}"),
            Err(reason) => {
                stopped += 1;
                // The motion of the law is simulated first, and its steps say themselves that they were stopped.
                let is_stop = match &reason {
                    NoRegulator::Step(text) => text.contains("was stopped"),
                    other => *other == NoRegulator::Stopped,
                };
                assert!(is_stop, "{allowed} of {asked}: {reason}");
            }
        }
    }
    assert!(stopped > 4, "{stopped}");
}
