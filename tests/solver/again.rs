//! One program solved again and again: the answers are those of solvers that are new.

use crate::common::cases::rest_to_rest;
use crate::common::programs::{HS071_OPTIMUM, HS071_START, Program, hs071};
use crate::common::trunk;
use crate::ipopt::run;
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::ipopt::{
    IpoptError, Iteration, LinearSolver, Options, Reached, Solver, SolverResult, Start,
    StartingPoint,
};
use proboscis::nlp::Status;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

fn go_on(_: &Iteration, _: &Reached<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn start(x: &[f64]) -> StartingPoint {
    StartingPoint {
        x: x.to_vec(),
        costates: None,
    }
}

/// All that does not depend on the clock.
fn same(one: &SolverResult, other: &SolverResult) {
    assert_eq!(one.status, other.status);
    assert_eq!(one.x, other.x);
    assert_eq!(one.objective.to_bits(), other.objective.to_bits());
    assert_eq!(one.constraints, other.constraints);
    assert_eq!(one.costates, other.costates);
    assert_eq!(one.iterations, other.iterations);
    assert_eq!(one.evaluations, other.evaluations);
    assert_eq!(one.failed_evaluations, other.failed_evaluations);
    assert_eq!(one.linear.solver, other.linear.solver);
    let statistics = |result: &SolverResult| result.linear.stages.map(|stages| stages.statistics);
    assert_eq!(statistics(one), statistics(other));
}

#[test]
fn a_trunk_is_solved_again_to_the_same_bits_with_one_analysis() {
    let (system, control) = (trunk(3), rest_to_rest(3, 12, 300.0));
    let h = 300.0 / 12.0;
    let (model, boundary) = BoundaryConditions::resolve(&system, &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let program = || Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let point = program().start(&initial);
    let options = Options::default();
    let alone = run(&mut program(), &point.x, &options);
    assert!(alone.status.is_solved() && alone.iterations.len() > 5);
    let mut solver = Solver::new(program(), options.clone());
    for _ in 0..3 {
        same(solver.solve(&point, &mut go_on).unwrap(), &alone);
    }
    // Another pattern in between is another solver's.
    assert!(run(&mut hs071(), &HS071_START, &options).status.is_solved());
    let again = solver.solve(&point, &mut go_on).unwrap();
    same(again, &alone);
    assert_eq!(again.linear.stages.map(|stages| stages.analyses), Some(0));
    // From where it has ended there is little left to do.
    solver.set_options(Options {
        start: Start::PrimalDual,
        ..options
    });
    let again = solver.solve_again(&mut go_on).unwrap();
    assert!(again.status.is_solved() && again.iterations.len() <= 3);
    assert!((again.objective / alone.objective - 1.0).abs() < 1e-8);
}

/// Solves with other right-hand sides and bounds, by one solver and by new ones.
fn follows_bounds(linear_solver: LinearSolver) {
    let options = Options {
        linear_solver,
        ..Options::default()
    };
    let changes: [&dyn Fn(&mut Program); 4] = [
        &|_| (),
        &|p| (p.constraints.lower[1], p.constraints.upper[1]) = (38.0, 38.0),
        &|p| p.constraints.lower[0] = 21.0,
        &|p| p.variables.upper[2] = 3.0,
    ];
    let mut solver = Solver::new(hs071(), options.clone());
    let mut objectives = Vec::new();
    for (i, change) in changes.iter().enumerate() {
        change(solver.program_mut());
        let mut fresh = hs071();
        changes[..=i].iter().for_each(|change| change(&mut fresh));
        let fresh = run(&mut fresh, &HS071_START, &options);
        assert!(fresh.status.is_solved());
        same(
            solver.solve(&start(&HS071_START), &mut go_on).unwrap(),
            &fresh,
        );
        objectives.push(fresh.objective);
    }
    assert!((objectives[0] - HS071_OPTIMUM).abs() < 1e-7);
    let differ = |pair: &[f64]| (pair[0] - pair[1]).abs() > 1e-3;
    assert!(objectives.windows(2).all(differ), "{objectives:?}");
    // The point is put onto bounds that Ipopt relaxes by 1e-8 of their size.
    let result = solver.into_result();
    assert!((result.constraints[1] - 38.0).abs() < 1e-5, "{result:?}");
}

#[test]
fn right_hand_sides_and_bounds_may_move() {
    follows_bounds(LinearSolver::Auto);
}

#[test]
fn with_mumps_too_and_others_may_solve_in_between() {
    follows_bounds(LinearSolver::Mumps);
    let options = Options {
        linear_solver: LinearSolver::Mumps,
        ..Options::default()
    };
    let mut solver = Solver::new(hs071(), options.clone());
    let first = solver
        .solve(&start(&HS071_START), &mut go_on)
        .unwrap()
        .clone();
    let other = run(&mut hs071(), &HS071_START, &options);
    same(&first, &other);
    same(
        solver.solve(&start(&HS071_START), &mut go_on).unwrap(),
        &first,
    );
}

#[test]
fn options_may_change_and_a_wrong_one_is_told() {
    let mut solver = Solver::new(hs071(), Options::default());
    let point = start(&HS071_START);
    let free = solver.solve(&point, &mut go_on).unwrap().clone();
    assert!(free.status.is_solved());
    solver.set_options(Options {
        max_iterations: 2,
        ..Options::default()
    });
    let short = solver.solve(&point, &mut go_on).unwrap();
    assert_eq!(
        (short.status, short.iterations.len()),
        (Status::IterationLimit, 3)
    );
    let mut wrong = Options::default();
    wrong.extra.insert(
        "tol".to_owned(),
        proboscis::ipopt::OptionValue::Text("much".to_owned()),
    );
    solver.set_options(wrong);
    let refused = solver.solve(&point, &mut go_on).map(|_| ());
    assert!(
        matches!(refused, Err(IpoptError::OptionRejected { .. })),
        "{refused:?}"
    );
    solver.set_options(Options::default());
    same(solver.solve(&point, &mut go_on).unwrap(), &free);
}

#[test]
fn a_panic_leaves_a_solver_that_solves() {
    let mut solver = Solver::new(hs071(), Options::default());
    let point = start(&HS071_START);
    let first = solver.solve(&point, &mut go_on).unwrap().clone();
    let mut fail = |iteration: &Iteration, _: &Reached<'_>| match iteration.iteration {
        2 => panic!("in an observer"),
        _ => ControlFlow::Continue(()),
    };
    let broken = catch_unwind(AssertUnwindSafe(|| {
        solver.solve(&point, &mut fail).map(|_| ())
    }));
    assert!(broken.is_err());
    same(solver.solve(&point, &mut go_on).unwrap(), &first);
}
