//! States of rest at start and goal that depend on free parameters: their coordinates are unknowns with equations of their own.

use crate::common::cases::joints;
use crate::common::sought::of_all_muscles;
use crate::optimality::guessed_step;
use crate::sought::{arm, pair, turn};
use nalgebra::Vector3;
use proboscis::control::problem::{BoundaryState, Control, Limit, Rest};
use proboscis::control::{BoundaryConditions, Transcription, guess, rest_programs};
use proboscis::model::{
    FieldPlace, MaterialConstant, MaxwellBranch, MaxwellBranches, System, What, with_parameters,
};
use proboscis::nlp::{Status, differences};
use proboscis::workflow::{Optimum, SolveLimits, optimise};
use std::ops::ControlFlow;

/// The pair under a weight across its axis, under which it sags.
fn sagging() -> System {
    System {
        gravity: Some(Vector3::new(4e-3, 0.0, 0.0)),
        ..pair()
    }
}

/// From one state of rest to another one, both under voltages and the weight.
fn between_states_of_rest(system: &System) -> Control {
    let mut control = turn(system);
    control.start = BoundaryState::RestAtVoltages(vec![0.0, 0.0], Rest::Everything);
    control.goal = BoundaryState::RestAtVoltages(vec![1500.0, 300.0], Rest::Everything);
    control.solver.tolerance = 1e-10;
    control
}

pub(crate) fn solved(system: &System, control: &Control, from: Option<&Optimum>) -> Optimum {
    let earlier = from.map(|optimum| &optimum.motion);
    let go_on = &mut |_: &proboscis::workflow::Iterate<'_>| ControlFlow::Continue(());
    let optimum = optimise(system, control, earlier, SolveLimits::default(), go_on).unwrap();
    assert_eq!(optimum.solution.status, Status::Solved);
    assert!(optimum.is_solved(), "{:?}", optimum.resimulation);
    optimum
}

/// The arm that was found, and the angles at start and goal.
fn found(optimum: &Optimum) -> (f64, [f64; 2]) {
    let joints = &optimum.motion.joints;
    let ends = [joints.first(), joints.last()].map(|row| row.unwrap()[0]);
    (optimum.motion.parameters[0].value, ends)
}

/// Angles of rest with a given arm.
fn at_rest(system: &System, length: f64) -> [f64; 2] {
    let system = with_parameters(system, &[arm([1.0, 99.0], 15.0)], &[length]);
    let control = between_states_of_rest(&system);
    let (_, boundary) = BoundaryConditions::resolve(&system, &control, 10.0).unwrap();
    [boundary.start.z[0], boundary.goal.rest.unwrap().z[0]]
}

#[test]
fn rest_programs_are_equilibria_with_exact_derivatives() {
    let system = sagging();
    let control = Control {
        parameters: vec![arm([4.0, 60.0], 15.0)],
        ..between_states_of_rest(&system)
    };
    let h = guessed_step(&control);
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, h).unwrap();
    assert_eq!(boundary.sought_rest, [true; 2]);
    let initial = guess(&model, &boundary, &control, h, None);
    let motion = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let states = rest_programs(&motion, &model, &boundary, &control).unwrap();
    assert_eq!(states.len(), 2);
    for mut state in states {
        assert_eq!(state.shared.len(), model.coordinate_count());
        let x = state.point.x.clone();
        assert!(state.program.violation(&x) < 1e-8);
        let moved: Vec<f64> = x.iter().map(|value| value + 0.05).collect();
        assert!(state.program.violation(&moved) > 1e-3);
        let report = differences::check(&mut state.program, &moved, 3);
        assert!(report.wrong.is_empty(), "{report}");
    }
}

/// Seeks an arm, to an angle and to a state of rest that a short arm brings near, within bounds of each.
fn seek_arms(system: &System, bounds: [[f64; 2]; 2]) {
    let to_angle = |system: &System| Control {
        goal: turn(system).goal,
        ..between_states_of_rest(system)
    };
    let problems: [&dyn Fn(&System) -> Control; 2] = [&to_angle, &between_states_of_rest];
    for (number, (problem, bounds)) in problems.into_iter().zip(bounds).enumerate() {
        let control = Control {
            parameters: vec![arm(bounds, 15.0)],
            ..problem(system)
        };
        let best = solved(system, &control, None);
        let (length, ends) = found(&best);
        let guess = at_rest(system, 15.0);
        let expected = at_rest(system, length);
        println!("{length}: {ends:?}, {expected:?}, at the guess {guess:?}");
        for end in 0..=number {
            assert!((expected[end] - guess[end]).abs() > 0.01, "it moves");
            assert!((ends[end] - expected[end]).abs() < 1e-8);
        }
        // The same effort with the arm given, more with any other one within the bounds.
        let effort = |length: f64| {
            let system = with_parameters(system, &[arm([1.0, 99.0], 15.0)], &[length]);
            let optimum = solved(&system, &problem(&system), Some(&best));
            optimum.solution.objective
        };
        let least = best.solution.objective;
        let error = effort(length) - least;
        assert!(error.abs() < 1e-7 * least, "{error:e} of {least}");
        let others = [0.97, 1.03].map(|factor| factor * length);
        let within = others
            .into_iter()
            .filter(|other| (bounds[0]..=bounds[1]).contains(other));
        let within: Vec<f64> = within.collect();
        assert_eq!(within.len(), 2 - number);
        for other in within {
            assert!(effort(other) > least * (1.0 + 1e-6), "{other}");
        }
    }
}

#[test]
fn an_arm_is_sought_between_states_of_rest_that_it_moves() {
    seek_arms(&sagging(), [[4.0, 60.0], [8.0, 22.0]]);
}

/// The same where muscles remember their stretch: relaxed at the start, as it comes at the goal.
#[test]
fn an_arm_of_muscles_that_creep_is_sought_between_states_of_rest() {
    let branch = MaxwellBranch {
        shear_modulus: 0.03,
        relaxation_time: 40.0,
    };
    let mut system = sagging();
    for muscle in &mut system.muscles {
        muscle.material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    }
    seek_arms(&system, [[4.0, 60.0], [8.0, 22.0]]);
    // Coordinates that are given leave open where branches are relaxed.
    let control = Control {
        start: joints(&[]),
        parameters: vec![arm([8.0, 22.0], 15.0)],
        ..between_states_of_rest(&system)
    };
    let refused = BoundaryConditions::resolve(&system, &control, 10.0).unwrap_err();
    assert!(
        refused.to_string().contains("give a start at rest"),
        "{refused}"
    );
}

#[test]
fn what_moves_no_state_of_rest_leaves_it_given() {
    let system = pair();
    let both = ("modulus", MaterialConstant::ShearModulus);
    let modulus = of_all_muscles(&system, both, [0.05, 0.1, 0.2]);
    let control = Control {
        start: BoundaryState::RestAtVoltages(vec![0.0, 0.0], Rest::Everything),
        parameters: vec![modulus],
        ..turn(&system)
    };
    let (_, boundary) = BoundaryConditions::resolve(&system, &control, 10.0).unwrap();
    assert_eq!(boundary.sought_rest, [false; 2]);
}

#[test]
fn a_field_at_rest_that_an_arm_changes_keeps_its_limit() {
    let system = sagging();
    // The muscle that is pulled longer by the weight.
    let problem = || Control {
        goal: BoundaryState::RestAtVoltages(vec![300.0, 1500.0], Rest::Everything),
        ..between_states_of_rest(&system)
    };
    let free = Control {
        parameters: vec![arm([8.0, 22.0], 15.0)],
        ..problem()
    };
    let limited = |max: f64, control: &Control| Control {
        limits: vec![Limit::below(What::Field(FieldPlace::Muscle(1)), max)],
        ..control.clone()
    };
    // A problem with the arm given refuses a goal that breaks the limit.
    let keeps = |length: f64, max: f64| {
        let system = with_parameters(&system, &[arm([1.0, 99.0], 15.0)], &[length]);
        let control = limited(max, &problem());
        BoundaryConditions::resolve(&system, &control, 10.0).is_ok()
    };
    // The largest limit that the goal with an arm breaks, by halving.
    let field = |length: f64| {
        let (mut low, mut high) = (1e3, 1e6);
        assert!(!keeps(length, low) && keeps(length, high));
        while high - low > 1e-9 * high {
            let middle = 0.5 * (low + high);
            match keeps(length, middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        high
    };
    let best = solved(&system, &free, None);
    let (length, _) = found(&best);
    let others = [8.0, 22.0].map(field);
    let (own, least) = (field(length), others[0].min(others[1]));
    println!("arm {length}: {own} V/mm, {others:?}");
    assert!(least < 0.999 * own);
    let max = 0.5 * (own + least);
    let best = solved(&system, &limited(max, &free), None);
    let (length, _) = found(&best);
    let reached = field(length);
    println!("arm {length}: {reached} V/mm of {max}");
    assert!((reached / max - 1.0).abs() < 1e-6);
}
