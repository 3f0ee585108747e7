//! Ipopt with the linear solver along the horizon takes the way that it takes with MUMPS.

use crate::common::cases::rest_to_rest;
use crate::common::programs::{HS071_OPTIMUM, HS071_START, hs071};
use crate::common::random_goals::{self, Goals, Kind, Solved};
use crate::common::trunk;
use crate::ipopt::run;
use proboscis::control::problem::{Control, Duration, Limit, Objective, Task};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::files::read_problem;
use proboscis::ipopt::{LinearReport, LinearSolver, NoStages, OptionValue, Options, SolverResult};
use proboscis::model::Coordinates;
use proboscis::model::What;
use proboscis::model::system::System;
use proboscis::nlp::Status;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

fn options(linear_solver: LinearSolver) -> Options {
    Options {
        tolerance: 1e-10,
        linear_solver,
        ..Options::default()
    }
}

fn solve(system: &System, control: &Control, linear_solver: LinearSolver) -> SolverResult {
    let (Duration::Given(t) | Duration::Free { guess: t, .. }) = control.duration;
    let h = t / control.intervals as f64;
    let (model, boundary) = BoundaryConditions::resolve(system, control, h).unwrap();
    let initial = guess(&model, &boundary, control, h, None);
    let mut program = Transcription::new(&model, &boundary, control, &initial).unwrap();
    let point = program.start(&initial);
    run(&mut program, &point.x, &options(linear_solver))
}

/// Motions of trunks: given and free duration, limits, both kinds of coordinates.
fn cases() -> Vec<(&'static str, System, Control)> {
    let plain = rest_to_rest(3, 16, 300.0);
    let timed = Control {
        duration: Duration::Free {
            min: 100.0,
            max: 1e3,
            guess: 300.0,
        },
        objective: Objective {
            effort: 1.0,
            rate: 0.1,
            duration: 1.0,
            ..Objective::default()
        },
        ..plain.clone()
    };
    let redundant = Control {
        coordinates: Some(Coordinates::Redundant),
        intervals: 6,
        ..plain.clone()
    };
    let limited = Control {
        limits: vec![Limit::new(
            What::Joint {
                joint: 0,
                near: 0.0,
            },
            [-0.6, 0.7],
        )],
        ..plain.clone()
    };
    vec![
        ("trunk", trunk(3), plain),
        ("free duration", trunk(3), timed),
        ("redundant", trunk(3), redundant),
        ("limits", trunk(3), limited),
    ]
}

#[test]
fn iterations_and_optima_are_those_of_mumps() {
    assert!(Options::default().run_at_once(), "this Ipopt takes it");
    let mut solved = 0;
    for (name, system, control) in cases() {
        let [mumps, stages] =
            [LinearSolver::Mumps, LinearSolver::Stages].map(|one| solve(&system, &control, one));
        assert_eq!(mumps.linear.solver, "mumps");
        assert_eq!(mumps.linear.stages, None);
        assert_eq!(stages.linear.solver, "stages");
        let report = stages.linear.stages.unwrap();
        assert!(report.statistics.factorisations >= stages.iterations.len() - 1);
        assert!(report.statistics.solutions > 0 && report.factorisation > 0.0);
        assert!(
            report.statistics.backward_error < 1e-3,
            "{name}: {report:?}"
        );
        let is_condensed = report.statistics.condensed == report.statistics.factorisations;
        assert_eq!(is_condensed, name == "redundant", "{name}: {report:?}");
        assert_eq!(stages.status, mumps.status, "{name}");
        if stages.status.is_solved() {
            solved += 1;
            assert_eq!(stages.iterations.len(), mumps.iterations.len(), "{name}");
            let error = (stages.objective - mumps.objective).abs() / mumps.objective.abs();
            assert!(error < 1e-12, "{name}: {error:e}");
        }
    }
    assert!(solved >= 3, "{solved} of the cases are solved");
}

/// MUMPS takes the place of the solver along the horizon where this Ipopt does not take it, and where a user says so; only the first is told.
#[test]
fn a_note_says_why_mumps_was_used() {
    let asked = |linear_solver| run(&mut hs071(), &HS071_START, &options(linear_solver)).linear;
    for solver in [LinearSolver::Auto, LinearSolver::Mumps] {
        let linear = asked(solver);
        let is_refused = solver == LinearSolver::Auto && !Options::default().run_at_once();
        assert_eq!(linear.why_not.is_some(), is_refused);
        assert_eq!(linear.note().is_some(), is_refused);
    }
    for why in [NoStages::WithoutMa57, NoStages::WithoutSetter] {
        let linear = LinearReport {
            solver: "mumps".to_owned(),
            why_not: Some(why),
            stages: None,
        };
        let told = "linear systems were solved by MUMPS, which takes longer: this Ipopt (3.";
        let note = linear.note().expect("a reason");
        assert!(
            note.starts_with(told) && note.ends_with(&why.to_string()),
            "{note}"
        );
    }
}

/// A goal that cannot be reached, so that Ipopt enters its restoration phase, where every equation has a diagonal.
#[test]
fn systems_of_restoration_are_factored_as_a_whole_and_a_note_says_when_that_was_felt() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/problems/fe_bending_control.json"
    );
    let changes = [
        "scene.solids[0].box.elements=[3,1,2]",
        "control.intervals=3",
        r#"control.goal.markers.tip=["29.98 mm",0,"24.2 mm"]"#,
    ];
    let loaded = read_problem(path.as_ref(), &changes.map(str::to_owned)).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let found = solve(&loaded.system, &control, LinearSolver::Stages);
    assert!(found.iterations.iter().any(|i| i.restoration));
    let mut linear = found.linear;
    let report = linear.stages.as_mut().unwrap();
    let (condensed, all) = (
        report.statistics.condensed,
        report.statistics.factorisations,
    );
    assert!(0 < condensed && condensed < all, "{condensed} of {all}");
    // Some were condensed, but not well enough.
    assert!(report.wholes >= all - condensed && report.wholes < all);
    assert!(0.0 < report.whole && report.whole < report.factorisation);
    (report.whole, report.factorisation) = (100.0, 104.0);
    let told = format!(
        "100 of 104 s in factorisations went into {} of {all}",
        report.wholes
    );
    let note = linear.note().expect("that was felt");
    assert!(note.starts_with(&told), "{note}");
    // Not where it was short, or the smaller part.
    for (whole, factorisation) in [(1.0, 1.5), (100.0, 300.0)] {
        let report = linear.stages.as_mut().unwrap();
        (report.whole, report.factorisation) = (whole, factorisation);
        assert_eq!(linear.note(), None);
    }
}

/// Goals that can be reached, some of them in haste.
#[test]
fn random_goals_have_the_same_ends_as_with_mumps() {
    let mut goals = Goals::new(5);
    let (mut solved, mut apart) = (0, 0);
    for round in 0..12 {
        let kind = [Kind::Rest, Kind::Tip][round % 2];
        let duration = [0.6, 0.6, 0.3][round % 3];
        let goal = goals.draw(kind).json;
        let [stages, mumps]: [Solved; 2] = ["stages", "mumps"].map(|name| {
            let changes = [
                format!("control.goal={goal}"),
                "control.intervals=12".to_owned(),
                format!("control.duration={duration} s"),
                format!("control.solver.linear_solver={name}"),
            ];
            random_goals::solved(&random_goals::trunk(), &changes)
        });
        let told = format!("{goal} in {duration} s");
        assert_eq!(stages.word, mumps.word, "{told}");
        // On a coarse grid a simulation does not reproduce all of them.
        if ["solved", "not_reproduced"].contains(&stages.word) {
            solved += 1;
            apart += usize::from(stages.iterations.abs_diff(mumps.iterations) > 1);
            let [one, other] = [&stages, &mumps].map(|one| f64::from_bits(one.objective));
            assert!(
                one > 0.0 && (one / other - 1.0).abs() < 1e-9,
                "{told}: {one} {other}"
            );
        }
    }
    // A solve that goes back and forth for long may part at the last digits of a step.
    assert!(solved >= 10 && apart <= 1, "{solved}, {apart}");
}

/// The pattern is analysed once in a thread, and a solve with a kept one is the same to the last bit.
#[test]
fn a_solve_leaves_no_trace_but_its_plan() {
    let (_, system, control) = cases().swap_remove(0);
    thread::spawn(move || {
        let solves = [0; 3].map(|_| solve(&system, &control, LinearSolver::Auto));
        let analyses = solves.each_ref().map(|s| s.linear.stages.unwrap().analyses);
        assert_eq!(analyses, [1, 0, 0]);
        assert!(solves[0].x.iter().any(|x| x.abs() > 0.1));
        for other in &solves[1..] {
            assert_eq!(other.x, solves[0].x);
            assert_eq!(other.iterations, solves[0].iterations);
        }
    })
    .join()
    .unwrap();
}

#[test]
fn solves_in_four_threads_are_the_same() {
    let (_, system, control) = cases().swap_remove(0);
    let first = solve(&system, &control, LinearSolver::Stages);
    assert!(first.status.is_solved());
    thread::scope(|scope| {
        let work = || (0..8).map(|_| solve(&system, &control, LinearSolver::Stages).x);
        let others: Vec<_> = (0..4)
            .map(|_| scope.spawn(move || work().collect::<Vec<_>>()))
            .collect();
        for x in others.into_iter().flat_map(|other| other.join().unwrap()) {
            assert_eq!(x, first.x);
        }
    });
}

/// A callback may solve another program, and go on or fail afterwards.
#[test]
fn solves_may_be_nested() {
    let mut program = hs071();
    let mut objective = std::mem::replace(&mut program.f, Box::new(|_| 0.0));
    let options = options(LinearSolver::Stages);
    let inner = options.clone();
    program.f = Box::new(move |x| {
        let solution = run(&mut hs071(), &HS071_START, &inner);
        assert!(solution.status.is_solved());
        objective(x)
    });
    let solution = run(&mut program, &HS071_START, &options);
    assert_eq!(solution.status, Status::Solved);
    assert!((solution.objective - HS071_OPTIMUM).abs() < 1e-7);
    let mut failing = hs071();
    failing.f = Box::new(|_| {
        let mut inner = hs071();
        inner.f = Box::new(|_| panic!("within"));
        run(&mut inner, &HS071_START, &Options::default());
        0.0
    });
    assert!(
        catch_unwind(AssertUnwindSafe(|| run(
            &mut failing,
            &HS071_START,
            &options
        )))
        .is_err()
    );
    assert!(run(&mut hs071(), &HS071_START, &options).status.is_solved());
}

/// A linear solver that is named as an option of Ipopt is taken.
#[test]
fn options_of_ipopt_come_first() {
    let mut options = options(LinearSolver::Stages);
    let name = OptionValue::Text("mumps".to_owned());
    options.extra.insert("linear_solver".to_owned(), name);
    let solution = run(&mut hs071(), &HS071_START, &options);
    assert!(solution.status.is_solved());
    assert_eq!(solution.linear.solver, "mumps");
}

/// If MA57 itself is asked for, the linear solver that stands in its place has no program: the solve fails in good order.
#[test]
fn no_other_solve_is_answered() {
    assert!(Options::default().run_at_once());
    let mut options = options(LinearSolver::Auto);
    let name = OptionValue::Text("ma57".to_owned());
    options.extra.insert("linear_solver".to_owned(), name);
    let solution = run(&mut hs071(), &HS071_START, &options);
    assert!(!solution.status.is_solved());
}
