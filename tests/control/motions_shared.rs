//! Motions that share inputs, constants that an independent program finds from three motions, and copies that share an input.

use crate::common::cases::{control, hold, rest_to_rest};
use crate::common::trunk;
use crate::motions::{copies, costs, motion, together};
use proboscis::control::Motions;
use proboscis::control::problem::{
    BoundaryState, Control, CostFunction, Duration, During, Objective, QuantityCost, Task,
};
use proboscis::files::read_problem;
use proboscis::math::Signal;
use proboscis::model::system::Muscle;
use proboscis::model::{Quantity, System};
use proboscis::nlp::joined::SharedVariable;
use proboscis::workflow::{
    Iterate, Optimum, SolveLimits, SolveRequest, optimise, optimise_together,
};
use proboscis::{Handle, State, Together};
use std::ops::ControlFlow;
use std::path::Path;

pub(crate) const INPUTS: [&str; 2] = ["muscle1", "muscle2"];

pub(crate) fn alone(system: &System, control: &Control) -> Optimum {
    let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
    optimise(system, control, None, SolveLimits::default(), go_on).expect("a right problem")
}

/// A robot that ends near an angle, with little effort.
pub(crate) fn steered(system: &System) -> Control {
    Control {
        duration: Duration::Given(200.0),
        goal: BoundaryState::Free,
        objective: Objective {
            effort: 1.0,
            quantities: vec![QuantityCost {
                quantity: Quantity::joint(0, 0.0),
                weight: 1e3,
                function: CostFunction::Square {
                    reference: Signal::Constant(0.1),
                },
                during: During::End,
            }],
            ..Objective::default()
        },
        ..control(system, 40)
    }
}

/// A segment whose muscles are stiffer by a factor.
pub(crate) fn stiffer(factor: f64) -> System {
    let mut system = trunk(1);
    for muscle in &mut system.muscles {
        muscle.material.shear_modulus *= factor;
    }
    system
}

/// Distance of the last joint angle from what is asked for.
fn missed(optimum: &Optimum) -> f64 {
    (optimum.motion.joints.last().unwrap()[0] - 0.1).abs()
}

#[test]
fn one_history_of_inputs_steers_two_robots() {
    let (soft, stiff) = (stiffer(0.8), stiffer(1.2));
    let each = [&soft, &stiff].map(|system| alone(system, &steered(system)));
    let list = vec![
        motion("soft", &soft, steered(&soft)),
        motion("stiff", &stiff, steered(&stiff)),
    ];
    let all = together(list, &INPUTS);
    assert!(all.optima.iter().all(Optimum::is_solved));
    let [a, b] = [&all.optima[0].motion, &all.optima[1].motion];
    assert!(a.voltages.iter().flatten().any(|&v| v > 500.0));
    for (a, b) in a.voltages.iter().flatten().zip(b.voltages.iter().flatten()) {
        assert!((a - b).abs() <= 1e-12 * a.abs(), "{a} {b}");
    }
    // Each of them moves in its own way, and what steers both costs more than what steers each.
    let apart = a
        .joints
        .iter()
        .zip(&b.joints)
        .map(|(a, b)| (a[0] - b[0]).abs());
    assert!(apart.fold(0.0, f64::max) > 1e-3);
    let least: f64 = each.iter().map(|optimum| optimum.solution.objective).sum();
    assert!(
        all.whole.objective > 1.001 * least,
        "{} {least}",
        all.whole.objective
    );
    let worst = all.optima.iter().map(missed).fold(0.0, f64::max);
    assert!(worst < 0.02, "{worst}");
    let numbers = all.whole.variables;
    let own: usize = each.iter().map(|optimum| optimum.solution.x.len()).sum();
    assert_eq!(numbers, own - 2 * 40);
}

#[test]
fn copies_that_share_inputs_are_one_motion() {
    let system = trunk(1);
    let problem = rest_to_rest(1, 20, 200.0);
    assert!(hold(1)[1] > 0.0);
    let one = alone(&system, &problem);
    assert!(one.is_solved());
    let all = together(copies(&system, &problem, 3), &INPUTS);
    let objective = one.solution.objective;
    assert!(objective > 0.0);
    let three = all.whole.objective;
    assert!(
        (three - 3.0 * objective).abs() < 1e-8 * three,
        "{three} {objective}"
    );
    for optimum in &all.optima {
        assert!(optimum.is_solved());
        let both = optimum.motion.voltages.iter().flatten();
        for (a, b) in both.zip(one.motion.voltages.iter().flatten()) {
            assert!((a - b).abs() < 1e-4 * 1700.0, "{a} {b}");
        }
    }
}

#[test]
fn work_with_shared_inputs_grows_in_proportion_to_the_intervals() {
    let system = trunk(1);
    let of = |intervals: usize, count: usize| {
        let problem = Control {
            intervals,
            ..steered(&system)
        };
        costs(&copies(&system, &problem, count), |programs| {
            let (_, first) = &programs[0];
            let inputs = (0..intervals).flat_map(|k| {
                let scalars = first.model().variables.sources_range();
                scalars.map(move |s| (k, s))
            });
            let shared = inputs.map(|(k, s)| {
                let place = first
                    .unknowns()
                    .scalar(k, s)
                    .expect("an input that is sought");
                SharedVariable::of_all(programs.iter().map(|_| (place, 1.0)))
            });
            shared.collect()
        })
    };
    let (short, long) = (of(20, 4), of(160, 4));
    for (short, long) in short.into_iter().zip(long) {
        let growth = long / short;
        assert!(growth > 7.0 && growth < 9.0, "{short} {long}");
    }
    let (few, many) = (of(20, 4), of(20, 16));
    assert!(many[2] < 64.5 * few[2], "{few:?} {many:?}");
}

fn kept() -> Motions {
    let path = Path::new("problems/pair_motions.json");
    match read_problem(path, &[]).expect("a kept problem").task {
        Task::Motions(motions) => *motions,
        other => panic!("{other:?}"),
    }
}

#[test]
fn constants_are_those_of_an_independent_program() {
    let text = include_str!("../reference/motions.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let expected = |case: &str| {
        ["objective", "shear_modulus", "viscosity"]
            .map(|key| reference[case][key].as_f64().unwrap())
    };
    let motions = kept();
    let sine = Motions {
        list: vec![motions.list[0].clone()],
        ..motions.clone()
    };
    // One motion by itself says something else.
    let [a, b] = ["together", "sine"].map(expected);
    assert!((a[2] - b[2]).abs() > 1e-4 * b[2]);
    for (case, motions) in [("together", motions), ("sine", sine)] {
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        let request = SolveRequest::default();
        let found = optimise_together(&motions.task(), request, go_on).unwrap();
        assert!(found.optima.iter().all(Optimum::is_solved));
        let constants = found.optima.iter().map(|one| {
            let parameters = one.motion.parameters.iter();
            parameters
                .map(|one| one.value * one.unit.factor)
                .collect::<Vec<_>>()
        });
        let constants: Vec<Vec<f64>> = constants.collect();
        assert!(constants.iter().all(|own| *own == constants[0]));
        let numbers = [found.whole.objective, constants[0][0], constants[0][1]];
        for (number, expected) in numbers.into_iter().zip(expected(case)) {
            let error = (number - expected).abs();
            assert!(error < 1e-8 * expected, "{case}: {number} {expected}");
        }
    }
}

#[test]
fn a_program_steers_two_robots_as_a_file_does() {
    let made = |factor: f64| {
        let whole = stiffer(factor);
        let mut system = System::new("segment");
        system.add(whole.bodies[0].clone());
        let joint = system.add(whole.joints[0].clone());
        let muscles = whole
            .muscles
            .iter()
            .map(|muscle| system.add(muscle.clone()));
        let muscles: Vec<Handle<Muscle>> = muscles.collect();
        (system, joint, muscles)
    };
    let ((soft, joint, muscles), (stiff, ..)) = (made(0.8), made(1.2));
    let over = |intervals: usize| {
        proboscis::Control::over(200.0, intervals)
            .goal(State::Free)
            .voltage_bounds(0.0, 3000.0)
            .effort(1.0)
            .end_joint_near(joint, 0.1, 1e3)
    };
    let control = over(40);
    let motions = |other| {
        let both = Together::new()
            .motion(&soft, &control)
            .motion(&stiff, other);
        both.shared_input(muscles[0]).shared_input(muscles[1])
    };
    let found = motions(&control).solve().unwrap();
    assert!(found.len() == 2 && found.iter().all(proboscis::Optimum::is_solved));
    // One unknown, which each motion counts in a unit of its own.
    let rows = found[0]
        .solution
        .voltages
        .iter()
        .zip(&found[1].solution.voltages);
    for (a, b) in rows.flat_map(|(one, other)| one.iter().zip(other)) {
        assert!((a - b).abs() <= 1e-14 * a.abs(), "{a} {b}");
    }
    let list = [&soft, &stiff].map(|system| {
        motion(
            &system.muscles[0].material.shear_modulus.to_string(),
            system,
            steered(system),
        )
    });
    let all = together(list.into(), &INPUTS);
    let sum: f64 = found.iter().map(|one| one.objective).sum();
    assert!(
        sum > 0.0 && (sum - all.whole.objective).abs() < 1e-8 * sum,
        "{sum} {}",
        all.whole.objective
    );
    let other = over(20);
    let error = motions(&other).solve().unwrap_err().to_string();
    assert!(error.contains("the instants of the motion"), "{error}");
    let error = Together::new().solve().unwrap_err().to_string();
    assert!(error.contains("one or more"), "{error}");
}
