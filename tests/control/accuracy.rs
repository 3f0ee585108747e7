//! As fine a grid as an accuracy needs: estimates against true errors, grids that grow as the order says, and what is kept
//! when a grid fails.

use crate::common::force::{Force, with_control};
use crate::common::{bare, body, joint};
use nalgebra::{Matrix3, Vector3};
use proboscis::control::problem::{
    BoundaryState, Control, Duration, Guess, MotionTask, Objective, Simulation, Solver, SoughtHold,
    Task, Voltages,
};
use proboscis::control::{BoundaryConditions, Transcription, guess};
use proboscis::dynamics::{DiscreteTrajectory, Solving};
use proboscis::files::read_problem;
use proboscis::ipopt::{self, LinearSolver, Options};
use proboscis::kinematics::MaterialVector;
use proboscis::model::Model;
use proboscis::model::system::{JointKind, System};
use proboscis::workflow::accuracy::ErrorSample;
use proboscis::workflow::accuracy::{AccuracyTarget, Attempt, Refined, refine};
use proboscis::workflow::{Iterate, SolveRequest, integrate_to, optimise_together};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

const MASS: f64 = 1.3;
const GOAL: f64 = 0.7;
const TIME: f64 = 2.0;

/// A slider that a force brings over 0.7 mm to rest in 2 ms with the least ∫s²dt, on a number of intervals.
fn double_integrator(intervals: usize) -> Attempt<usize> {
    let axis = Vector3::new(1.0, -2.0, 2.0) / 3.0;
    let slider = body(
        "slider",
        MASS,
        [0.4, 0.5, 0.6],
        axis * 2.0,
        Matrix3::identity(),
    );
    let rail = joint(
        "rail",
        JointKind::Prismatic { axis },
        None,
        0,
        Vector3::zeros(),
    );
    let scene = bare(vec![slider], vec![rail], None);
    let rest_at = |angle: f64| BoundaryState::JointAngles {
        angles: BTreeMap::from([(0, angle)]),
        rates: BTreeMap::new(),
        velocities: Default::default(),
    };
    let problem = Control {
        duration: Duration::Given(TIME),
        intervals,
        input_intervals: 1,
        is_refined: false,
        varied: Vec::new(),
        outcomes: Vec::new(),
        start: rest_at(0.0),
        goal: rest_at(GOAL),
        voltage_bounds: [f64::NEG_INFINITY, f64::INFINITY],
        load_bounds: Default::default(),
        given: Default::default(),
        course: None,
        parameters: Vec::new(),
        continues: [false; 2],
        sought_hold: SoughtHold::default(),
        hold: Default::default(),
        // h is in ms and the effort in s.
        objective: Objective {
            effort: 1e3,
            ..Objective::default()
        },
        limits: Vec::new(),
        waypoints: Vec::new(),
        coordinates: None,
        guess: Guess::Interpolate,
        solver: Solver {
            tolerance: 1e-10,
            max_iterations: 200,
            linear_solver: LinearSolver::Auto,
            ipopt: BTreeMap::new(),
        },
    };
    let h = TIME / intervals as f64;
    let (model, mut boundary) = BoundaryConditions::resolve(&scene, &problem, h).unwrap();
    let centre = MaterialVector::point(Some(0), &(axis * 2.0), &model.reference);
    let (plain, _) = BoundaryConditions::resolve(&scene, &problem, h).unwrap();
    let model = with_control(model, Force { direction: axis }, &centre);
    boundary.rest = [Some(vec![0.0]), Some(vec![0.0])];
    let initial = guess(&model, &boundary, &problem, h, None);
    let mut program = Transcription::new(&model, &boundary, &problem, &initial).unwrap();
    // The program does not know the size of a force that is none of its inputs.
    let options = Options {
        tolerance: 1e-10,
        objective_scale: Some(TIME.powi(3) / (12.0 * (MASS * GOAL).powi(2))),
        ..Options::default()
    };
    let start = program.start(&initial);
    let solution = ipopt::solve(&mut program, &start, &options, &mut |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    let discrete = program.decode(&solution.x);
    Attempt {
        run: intervals,
        sample: ErrorSample {
            objective: Some(solution.objective),
            ..ErrorSample::of_motion(&plain, &discrete)
        },
        intervals,
        iterations: solution.iterations.len() - 1,
        variables: solution.x.len(),
        status: solution.status.word(),
        is_complete: solution.status.is_solved(),
    }
}

fn refined(first: usize, error: f64) -> Refined<usize> {
    let nothing_stops = || None;
    let run = |times: usize, _: Option<&usize>| Ok(double_integrator(first * times));
    refine(AccuracyTarget::Below(error), 1.0, nothing_stops, run).unwrap()
}

/// Relative error of the least effort and greatest error of the optimal path (in lengths of the system) on a grid.
fn true_errors(intervals: usize) -> [f64; 2] {
    let sample = double_integrator(intervals).sample;
    let continuous = 12.0 * (MASS * GOAL).powi(2) / TIME.powi(3);
    let objective = sample.objective.unwrap();
    let length = 4.0 / 3.0;
    let path = sample.path.iter().enumerate().map(|(k, places)| {
        let s = k as f64 / intervals as f64;
        let way = 2.0 + GOAL * s * s * (3.0 - 2.0 * s);
        (places[0].norm() - way / length).abs()
    });
    [
        (objective - continuous) / objective,
        path.fold(0.0, f64::max),
    ]
}

#[test]
fn the_least_effort_of_a_double_integrator_is_as_accurate_as_asked_for() {
    let mut chosen = Vec::new();
    for request in [1e-2, 1e-3, 1e-4, 1e-5] {
        let found = refined(4, request);
        let accuracy = &found.accuracy;
        let n = found.run;
        let [objective, path] = true_errors(n);
        println!(
            "{request:e}: {n} intervals, {objective:e} {path:e}, {:?}",
            accuracy.estimate
        );
        assert_eq!(n, 4 * found.times);
        assert_eq!(accuracy.is_met, Some(true));
        assert!(objective > 0.0 && objective < request, "{objective}");
        assert!(path > 0.0 && path < request, "{path}");
        for (estimate, error) in [("objective", objective), ("path", path)] {
            let ratio = accuracy.estimate[estimate] / error;
            assert!(ratio > 0.5 && ratio < 2.0, "{estimate}: {ratio}");
        }
        // The grid before was too coarse.
        let [before, _] = true_errors(n / 2);
        assert!(before > 0.5 * request, "{before} on {} intervals", n / 2);
        chosen.push(n);
    }
    // Order two: a hundred times the accuracy for ten times the intervals, to the next power of two.
    for (coarse, fine) in chosen.iter().zip(&chosen[2..]) {
        assert!([8, 16].contains(&(fine / coarse)), "{chosen:?}");
    }
}

#[test]
fn one_refinement_tells_the_error_of_the_first_grid() {
    let run = |times: usize, _: Option<&usize>| Ok(double_integrator(10 * times));
    let found = refine(AccuracyTarget::Estimate, 1.0, || None, run).unwrap();
    assert_eq!((found.run, found.times), (10, 1));
    assert_eq!(
        (found.accuracy.requested, found.accuracy.is_met),
        (None, None)
    );
    let [objective, path] = true_errors(10);
    // Without a third grid the order is taken for one, which is on the safe side by half.
    for (name, error) in [("objective", objective), ("path", path)] {
        let ratio = found.accuracy.estimate[name] / error;
        assert!(ratio > 1.0 && ratio < 2.0, "{name}: {ratio}");
    }
}

/// A made-up run whose objective is one plus an error.
fn made_up(error: f64, is_complete: bool) -> Attempt<f64> {
    Attempt {
        run: error,
        sample: ErrorSample {
            objective: Some(1.0 + error),
            path: vec![Vec::new(); 2],
            ..ErrorSample::default()
        },
        intervals: 1,
        iterations: 3,
        variables: 10,
        status: if is_complete {
            "solved"
        } else {
            "iteration_limit"
        },
        is_complete,
    }
}

fn series(request: f64, error: impl Fn(usize) -> f64) -> Refined<f64> {
    let run = |times: usize, _: Option<&f64>| Ok(made_up(error(times), true));
    refine(AccuracyTarget::Below(request), 1.0, || None, run).unwrap()
}

#[test]
fn the_order_is_observed_and_chance_is_not_believed() {
    for order in [1.0, 1.5, 2.0] {
        let found = series(1e-3, |times| 0.1 * (times as f64).powf(-order));
        let seen = found.accuracy.order["objective"];
        assert!((seen - order).abs() < 0.05, "{seen} for {order}");
        let ratio = found.accuracy.estimate["objective"] / found.run;
        assert!(
            found.run > 1e-5 && (ratio - 1.0).abs() < 0.1,
            "{ratio} for {order}"
        );
    }
    // What falls faster than the rule can is told as it is, and estimated as if it fell by four.
    let found = series(1e-6, |times| 0.1 * (times as f64).powi(-4));
    let seen = found.accuracy.order["objective"];
    assert!((seen - 4.0).abs() < 0.05, "{seen}");
    assert!(found.accuracy.estimate["objective"] > 10.0 * found.run);
    // So is what grows.
    let found = series(1e-9, |times| 1.0 + 1e-3 * (times as f64).powf(0.5));
    let seen = found.accuracy.order["objective"];
    assert!((seen + 0.5).abs() < 0.05, "{seen}");
    // Two grids that agree by chance are no proof: the difference of 0.03 before it has to fall by four at a time.
    let found = series(1e-4, |times| {
        [0.06, 0.03, 0.0299999, 0.008, 0.002][times.ilog2().min(4) as usize]
    });
    let third = found.accuracy.levels[2].estimate["objective"];
    assert!(third > 2e-3, "{third}");
    assert_eq!(found.run, 0.002);
    // Errors that grow are never small enough.
    let found = series(1e-3, |times| 0.01 * (times as f64).powf(0.5));
    assert_eq!(found.accuracy.is_met, Some(false));
    assert_eq!(found.accuracy.stopped.as_deref(), Some("too_large"));
    // What is no number is no agreement.
    let found = series(1e-2, |_| f64::NAN);
    assert_eq!(found.accuracy.is_met, Some(false));
}

#[test]
fn a_grid_that_fails_leaves_the_one_before() {
    let run = |times: usize, before: Option<&f64>| {
        assert_eq!(before.is_some(), times > 1);
        Ok(made_up(0.1 / (times * times) as f64, times < 8))
    };
    let found = refine(AccuracyTarget::Below(1e-6), 1.0, || None, run).unwrap();
    assert_eq!((found.times, found.run), (4, 0.1 / 16.0));
    assert_eq!(found.iterations, 9);
    assert_eq!(found.accuracy.is_met, Some(false));
    assert_eq!(found.accuracy.stopped.as_deref(), Some("iteration_limit"));
    let ends: Vec<&str> = found.accuracy.levels.iter().map(|l| l.status).collect();
    assert_eq!(ends, ["solved", "solved", "solved", "iteration_limit"]);
    assert!(found.accuracy.estimate["objective"] > 1e-3);

    let run = |_: usize, _: Option<&f64>| Ok(made_up(0.1, false));
    let found = refine(AccuracyTarget::Below(1e-6), 1.0, || None, run).unwrap();
    assert!(found.accuracy.estimate.is_empty() && found.accuracy.levels.len() == 1);
    assert_eq!(found.accuracy.is_met, Some(false));

    let run = |times: usize, _: Option<&f64>| Ok(made_up(0.1 / times as f64, true));
    let found = refine(AccuracyTarget::Below(1e-6), 1.0, || Some("time_limit"), run).unwrap();
    assert_eq!(found.times, 1);
    assert_eq!(found.accuracy.stopped.as_deref(), Some("time_limit"));
}

/// IFToMM A01: a mass of 1 at a distance of 1 from its pivot, g = 9.81, from (−1, 0) at rest.
fn pendulum() -> System {
    let mass = body("mass", 1.0, [0.0; 3], -Vector3::x(), Matrix3::identity());
    let kind = JointKind::Revolute { axis: Vector3::z() };
    let pivot = joint("pivot", kind, None, 0, Vector3::zeros());
    bare(vec![mass], vec![pivot], Some(Vector3::new(0.0, -9.81, 0.0)))
}

fn swing(step: f64) -> Simulation {
    Simulation {
        duration: 1.0,
        step,
        tolerance: None,
        start: BoundaryState::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: Default::default(),
        },
        voltages: Voltages::default(),
        coordinates: None,
        solving: Solving::default(),
        controller: None,
    }
}

#[test]
fn a_pendulum_is_where_elliptic_functions_say_to_the_accuracy_asked_for() {
    let exact = Vector3::new(0.9862917511, -0.1650108531, 0.0);
    let mut steps = Vec::new();
    for request in [1e-2, 1e-3, 1e-4, 1e-5] {
        let found = integrate_to(
            &pendulum(),
            &swing(0.05),
            AccuracyTarget::Below(request),
            None,
            &mut |_, _, _| ControlFlow::Continue(()),
        )
        .unwrap();
        let accuracy = &found.accuracy;
        let discrete = &found.run.discrete;
        let placed = crate::common::placed(&found.run.model, &discrete.z[discrete.intervals()]);
        let error = (found.run.model.poses(&placed)[0].centre - exact).norm();
        let estimate = accuracy.estimate["end"];
        println!(
            "{request:e}: {} steps, {error:e}, {estimate:e}",
            discrete.intervals()
        );
        assert_eq!(accuracy.is_met, Some(true));
        assert!(!accuracy.estimate.contains_key("objective"));
        assert!(error > 1e-8 && error < request, "{error}");
        assert!(
            estimate / error > 0.5 && estimate / error < 2.0,
            "{}",
            estimate / error
        );
        assert!(accuracy.estimate["path"] >= 0.5 * estimate);
        assert_eq!(discrete.intervals(), 20 * found.times);
        steps.push(discrete.intervals());
    }
    // An estimate needs three grids, so that the first accuracy asks for no fewer than the second.
    for (coarse, fine) in steps[1..].iter().zip(&steps[3..]) {
        assert!([8, 16].contains(&(fine / coarse)), "{steps:?}");
    }
}

#[test]
fn a_motion_stopped_on_a_finer_grid_is_kept_as_it_was_on_the_one_before() {
    let stop_at_80 = &mut |steps: usize, _: &Model, discrete: &DiscreteTrajectory| match steps == 80
        && discrete.intervals() == 7
    {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let wanted = AccuracyTarget::Below(1e-7);
    let task = swing(0.05);
    let found = integrate_to(&pendulum(), &task, wanted, None, stop_at_80);
    let found = found.unwrap();
    assert_eq!(found.run.discrete.intervals(), 40);
    assert_eq!(found.accuracy.is_met, Some(false));
    let levels: Vec<usize> = found.accuracy.levels.iter().map(|l| l.intervals).collect();
    assert_eq!(levels, [20, 40, 7]);
    assert!(found.accuracy.stopped.is_some());
}

#[test]
fn an_optimum_stopped_on_a_finer_grid_is_kept_as_it_was_on_the_one_before() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/pair.json");
    let loaded = read_problem(&file, &[]).unwrap();
    let Task::Control(control) = loaded.task else {
        panic!("a control problem");
    };
    let stop_at_80 = &mut |intervals: usize, at: &Iterate<'_>| match intervals == 80
        && at.report.iteration == 3
    {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let request = SolveRequest {
        wanted: Some(AccuracyTarget::Below(1e-4)),
        ..SolveRequest::default()
    };
    let task = MotionTask::alone(&loaded.system, &control).into();
    let found = optimise_together(&task, request, stop_at_80).unwrap();
    assert_eq!(found.optima[0].motion.intervals(), 40);
    assert!(found.optima[0].solution.status.is_solved());
    let accuracy = found.accuracy.expect("three grids");
    assert_eq!(accuracy.stopped.as_deref(), Some("interrupted"));
    assert_eq!(accuracy.levels.len(), 3);
    assert!(accuracy.estimate["objective"] > 1e-4);
}
