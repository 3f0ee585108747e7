//! Optimal control against the reference solutions.

use crate::common::{numbers, reference, trunk};
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Guess, Objective, Rest, Solver, SoughtHold,
};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::ipopt::{self, LinearSolver, Options, Start};
use proboscis::model::Coordinates;
use proboscis::nlp::differences;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

fn problem(name: &str, coordinates: Coordinates) -> Control {
    let file = reference(name);
    let control = &file["control"];
    let hold = numbers(&file["hold_voltage_V"]);
    let mut objective = Objective::default();
    match control["objective"].as_str().unwrap() {
        "effort" => objective.effort = 1.0,
        "rate" => objective.rate = 1.0,
        "time" => objective.duration = 1.0,
        other => panic!("objective {other}"),
    }
    let duration = control["duration_s"].as_f64().map_or(
        Duration::Free {
            min: 2.0,
            max: 600.0,
            guess: 200.0,
        },
        |s| Duration::Given(1e3 * s),
    );
    Control {
        duration,
        intervals: control["intervals"].as_u64().unwrap() as usize,
        input_intervals: 1,
        is_refined: false,
        varied: Vec::new(),
        outcomes: Vec::new(),
        start: BoundaryState::RestAtVoltages(vec![0.0; hold.len()], Rest::Everything),
        goal: BoundaryState::RestAtVoltages(hold, Rest::Everything),
        voltage_bounds: [0.0, 3000.0],
        load_bounds: Default::default(),
        given: BTreeMap::new(),
        course: None,
        parameters: Vec::new(),
        continues: [false; 2],
        sought_hold: SoughtHold::default(),
        hold: Default::default(),
        objective,
        limits: Vec::new(),
        waypoints: Vec::new(),
        coordinates: Some(coordinates),
        guess: Guess::Interpolate,
        solver: Solver {
            tolerance: 1e-8,
            max_iterations: 500,
            linear_solver: LinearSolver::Auto,
            ipopt: BTreeMap::new(),
        },
    }
}

fn solve(name: &str, segments: usize, coordinates: Coordinates) {
    let file = reference(name);
    let control = problem(name, coordinates);
    let h = match control.duration {
        Duration::Given(t) | Duration::Free { guess: t, .. } => t / control.intervals as f64,
    };
    let (model, boundary) = BoundaryConditions::resolve(&trunk(segments), &control, h).unwrap();
    let initial = guess(&model, &boundary, &control, h, None);
    let mut program = Transcription::new(&model, &boundary, &control, &initial).unwrap();
    let start = program.start(&initial);
    let report = differences::check(&mut program, &start.x, 7);
    assert!(report.is_consistent(), "{report}");
    println!(
        "{name} {coordinates:?}: {} variables, {} rows",
        start.x.len(),
        program.unknowns().rows.len()
    );
    let options = Options {
        tolerance: 1e-10,
        start: Start::Cold,
        ..Options::default()
    };
    let clock = std::time::Instant::now();
    let solution = ipopt::solve(&mut program, &start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let expected = file["control"]["objective_kV"].as_f64().unwrap();
    println!(
        "{:?} {} iterations, objective {} against {expected}, {:?}, {:?}",
        solution.status,
        solution.iterations.len(),
        solution.objective,
        clock.elapsed(),
        solution.seconds
    );
    assert!(solution.status.is_solved());
    assert!(
        (solution.objective - expected).abs() < 1e-6 * expected,
        "{} against {expected}",
        solution.objective
    );
}

#[test]
fn pair_reduced() {
    solve("pair", 1, Coordinates::Reduced);
}

#[test]
fn pair_redundant() {
    solve("pair", 1, Coordinates::Redundant);
}

#[test]
fn pair_time() {
    solve("pair_time", 1, Coordinates::Reduced);
}

#[test]
fn pair_time_redundant() {
    solve("pair_time", 1, Coordinates::Redundant);
}

#[test]
fn trunk_effort() {
    solve("trunk6", 6, Coordinates::Reduced);
}

#[test]
fn trunk_effort_n80() {
    solve("trunk6_n80", 6, Coordinates::Reduced);
}

#[test]
fn trunk_rate() {
    solve("trunk6_rate", 6, Coordinates::Reduced);
}

#[test]
fn trunk_redundant() {
    solve("trunk6", 6, Coordinates::Redundant);
}
