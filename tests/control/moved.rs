//! Start and goal of a program that stands are moved: it is the program that is built for them.

use crate::common::cases::{Case, control, direction, hold, joints, partly, rest_to_rest};
use crate::common::systems::branched;
use crate::common::tracked::energies;
use crate::common::trunk;
use proboscis::control::problem::{BoundaryState, Control, Objective, Rest};
use proboscis::control::{BoundaryConditions, BoundaryError, Transcription, guess};
use proboscis::ipopt::{Options, Solver, Start};
use proboscis::model::Coordinates;
use proboscis::model::system::System;
use proboscis::nlp::Nlp;
use std::ops::ControlFlow;

const INTERVALS: usize = 8;

/// A problem, and the same with another start and goal.
fn pairs() -> Vec<(Case, Control)> {
    let rated = Objective {
        effort: 1.0,
        rate: 0.3,
        ..Objective::default()
    };
    let plain = Control {
        objective: rated.clone(),
        ..rest_to_rest(3, INTERVALS, 300.0)
    };
    let scaled = |factor: f64| hold(3).iter().map(|v| factor * v).collect::<Vec<_>>();
    let rest = |voltages| BoundaryState::RestAtVoltages(voltages, Rest::Everything);
    let moved = Control {
        start: rest(scaled(0.3)),
        goal: rest(scaled(0.9)),
        ..plain.clone()
    };
    let case = |name, system, control| Case {
        name,
        system,
        control,
    };
    let swings = |angle: f64, rate: f64| BoundaryState::JointAngles {
        angles: [(0, angle)].into(),
        rates: [(1, rate)].into(),
        velocities: Default::default(),
    };
    let swung = |angle: f64, rate: f64, goal: f64| Control {
        start: swings(angle, rate),
        goal: joints(&[(0, goal), (2, 0.5 * goal)]),
        ..plain.clone()
    };
    let reached = |x: f64, z: f64| Control {
        goal: partly(&[(0, [Some(x), None, Some(z)])], &[]),
        ..plain.clone()
    };
    let redundant = |control: &Control| Control {
        coordinates: Some(Coordinates::Redundant),
        ..control.clone()
    };
    let mut all = vec![
        (case("rest", trunk(3), plain.clone()), moved.clone()),
        (
            case("redundant rest", trunk(3), redundant(&plain)),
            redundant(&moved),
        ),
        (
            case("joints", trunk(3), swung(0.1, 1e-3, 0.2)),
            swung(-0.1, -2e-3, 0.15),
        ),
        (
            case(
                "redundant joints",
                trunk(3),
                redundant(&swung(0.1, 0.0, 0.2)),
            ),
            redundant(&swung(0.1, 0.0, 0.2)),
        ),
        (
            case("marker", trunk(3), reached(10.0, 5.0)),
            reached(7.0, 9.0),
        ),
    ];
    let charged = |control: &Control| Control {
        objective: Objective {
            energies: energies(&[(1, 1.0)], &[(2, 0.5)]),
            ..Objective::default()
        },
        ..control.clone()
    };
    all.push((case("energies", trunk(3), charged(&plain)), charged(&moved)));
    let system = branched();
    let towards = Control {
        goal: partly(&[], &[(1, direction())]),
        ..control(&system, INTERVALS)
    };
    all.push((case("orientation", system, towards.clone()), towards));
    all
}

/// Objective, scaled gradient, rows, bounds of rows and Jacobian of a motion, without the scales that a guess gives.
fn values(program: &mut Transcription<'_>, x: &[f64]) -> [Vec<f64>; 5] {
    let rows = program.constraints().clone();
    let mut gradient = vec![0.0; x.len()];
    let mut g = vec![0.0; rows.lower.len()];
    let entries = program.jacobian_structure();
    let mut jacobian = vec![0.0; entries.rows.len()];
    let objective = program.objective(x);
    program.gradient(x, &mut gradient);
    program.constraint(x, &mut g);
    program.jacobian(x, &mut jacobian);
    let unscaled = |values: &[f64]| {
        let scales = (0..values.len()).map(|i| program.row_scale(i));
        values
            .iter()
            .zip(scales)
            .map(|(v, s)| v / s)
            .collect::<Vec<_>>()
    };
    let by_row = jacobian.iter().zip(&entries.rows);
    let jacobian = by_row
        .map(|(v, &row)| v / program.row_scale(row as usize))
        .collect();
    let bounds: Vec<f64> = [unscaled(&rows.lower), unscaled(&rows.upper)].concat();
    [vec![objective], gradient, unscaled(&g), bounds, jacobian]
}

#[test]
fn a_moved_program_is_the_one_that_is_built_there() {
    let mut changed = 0;
    for (
        Case {
            name,
            system,
            control,
        },
        other,
    ) in pairs()
    {
        let h = 300.0 / INTERVALS as f64;
        let resolve = |control: &Control| BoundaryConditions::resolve(&system, control, h).unwrap();
        let (model, here) = resolve(&control);
        let (other_model, there) = resolve(&other);
        let initial = guess(&model, &here, &control, h, None);
        let mut moved = Transcription::new(&model, &here, &control, &initial).unwrap();
        let mut built = Transcription::new(&other_model, &there, &other, &initial).unwrap();
        // Multipliers have scales of the guess, which only redundant coordinates have.
        let is_reduced = model.coordinates == Coordinates::Reduced;
        let mut x = moved.start(&initial).x;
        x.iter_mut()
            .enumerate()
            .for_each(|(i, x)| *x += 0.02 * (i as f64).sin());
        let before = values(&mut moved, &x);
        moved.move_ends(&there).unwrap();
        assert_eq!(
            moved.jacobian_structure(),
            built.jacobian_structure(),
            "{name}"
        );
        let after = values(&mut moved, &x);
        changed += usize::from(before != after);
        if is_reduced {
            for (one, two) in after.iter().zip(values(&mut built, &x)) {
                let largest = two
                    .iter()
                    .filter(|v| v.is_finite())
                    .fold(0.0, |m: f64, v| m.max(v.abs()));
                assert!(largest > 0.0 || two.iter().all(|v| *v == 0.0 || v.is_infinite()));
                for (a, b) in one.iter().zip(&two) {
                    assert!(a == b || (a - b).abs() < 1e-9 * largest, "{name}: {a} {b}");
                }
            }
        }
        // There and back.
        moved.move_ends(&here).unwrap();
        assert_eq!(values(&mut moved, &x), before, "{name}");
    }
    assert!(changed >= 4, "{changed}");
}

#[test]
fn a_solver_follows_a_goal_in_few_iterations() {
    for (
        Case {
            name,
            system,
            control,
        },
        other,
    ) in pairs()
    {
        if !matches!(name, "rest" | "marker") {
            continue;
        }
        let h = 300.0 / INTERVALS as f64;
        let resolve = |control: &Control| BoundaryConditions::resolve(&system, control, h).unwrap();
        let (model, here) = resolve(&control);
        let (other_model, there) = resolve(&other);
        let initial = guess(&model, &here, &control, h, None);
        let program = Transcription::new(&model, &here, &control, &initial).unwrap();
        let point = program.start(&initial);
        let mut go_on = |_: &_, _: &proboscis::ipopt::Reached<'_>| ControlFlow::Continue(());
        let mut solver = Solver::new(program, Options::default());
        let first = solver.solve(&point, &mut go_on).unwrap().clone();
        assert!(first.status.is_solved(), "{name}");
        solver.set_options(Options {
            start: Start::PrimalDual,
            ..Options::default()
        });
        solver.program_mut().move_ends(&there).unwrap();
        let second = solver.solve_again(&mut go_on).unwrap().clone();
        assert!(second.status.is_solved(), "{name}: {}", second.status);
        assert!(second.iterations.len() < first.iterations.len(), "{name}");
        assert!(
            (second.objective / first.objective - 1.0).abs() > 1e-3,
            "{name}"
        );

        let initial = guess(&other_model, &there, &other, h, None);
        let fresh = Transcription::new(&other_model, &there, &other, &initial).unwrap();
        let point = fresh.start(&initial);
        let mut fresh = Solver::new(fresh, Options::default());
        let alone = fresh.solve(&point, &mut go_on).unwrap();
        let error = (second.objective / alone.objective - 1.0).abs();
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

/// The ends of a problem do not fit a program, for a reason with these words.
fn refused(
    program: &mut Transcription<'_>,
    h: f64,
    system: &System,
    control: &Control,
    words: &str,
) {
    let (_, there) = BoundaryConditions::resolve(system, control, h).unwrap();
    let error = program.move_ends(&there).unwrap_err();
    assert!(matches!(error, BoundaryError::OtherProgram { .. }));
    assert!(error.to_string().contains(words), "{error}");
}

#[test]
fn ends_of_another_program_are_refused() {
    let (system, plain) = (trunk(3), rest_to_rest(3, INTERVALS, 300.0));
    let h = 300.0 / INTERVALS as f64;
    let (model, here) = BoundaryConditions::resolve(&system, &plain, h).unwrap();
    let initial = guess(&model, &here, &plain, h, None);
    let mut program = Transcription::new(&model, &here, &plain, &initial).unwrap();
    let x = program.start(&initial).x;
    let before = values(&mut program, &x);
    let goals = [
        (joints(&[(0, 0.1)]), "other coordinates"),
        (
            BoundaryState::RestAtVoltages(hold(3), Rest::Bodies),
            "something else comes to rest",
        ),
        (BoundaryState::Free, "other coordinates"),
    ];
    for (goal, words) in goals {
        let other = Control {
            goal,
            ..plain.clone()
        };
        refused(&mut program, h, &system, &other, words);
    }
    let longer = rest_to_rest(4, INTERVALS, 300.0);
    refused(&mut program, h, &trunk(4), &longer, "another model");
    assert_eq!(values(&mut program, &x), before);
    let reached = |axes: [Option<f64>; 3]| Control {
        goal: partly(&[(0, axes)], &[]),
        ..plain.clone()
    };
    let one = reached([Some(5.0), None, None]);
    let (model, there) = BoundaryConditions::resolve(&system, &one, h).unwrap();
    let initial = guess(&model, &there, &one, h, None);
    let mut program = Transcription::new(&model, &there, &one, &initial).unwrap();
    refused(
        &mut program,
        h,
        &system,
        &reached([None, Some(5.0), None]),
        "no goal or limit any more",
    );
    refused(
        &mut program,
        h,
        &system,
        &reached([Some(5.0), Some(5.0), None]),
        "more or fewer goals and limits",
    );
}
