//! Motions that are stopped and go on: to the bit what they are without a stop.

use std::ops::ControlFlow;
use std::path::Path;

use proboscis::System;
use proboscis::control::problem::{Simulation, Task};
use proboscis::dynamics::{DiscreteTrajectory, StepError};
use proboscis::files::read_problem;
use proboscis::stop::{self, Questions};
use proboscis::workflow::{Simulated, integrate, integrate_on};

/// A kept simulation with overrides.
fn simulation(name: &str, set: &[&str]) -> (System, Simulation) {
    let path = format!("{}/problems/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let set: Vec<String> = set.iter().map(|&change| change.to_owned()).collect();
    let loaded = read_problem(Path::new(&path), &set).unwrap();
    match loaded.task {
        Task::Simulate(task) => (loaded.system, task),
        _ => panic!("a simulation"),
    }
}

fn all(system: &System, task: &Simulation) -> DiscreteTrajectory {
    let run = integrate(system, task, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(run.failure, None);
    run.discrete
}

fn bits(rows: &[Vec<f64>]) -> Vec<Vec<u64>> {
    let bits = |row: &Vec<f64>| row.iter().map(|x| x.to_bits()).collect();
    rows.iter().map(bits).collect()
}

fn assert_same(a: &DiscreteTrajectory, b: &DiscreteTrajectory, told: &str) {
    assert_eq!(a.intervals(), b.intervals(), "{told}");
    for (what, x, y) in [
        ("z", &a.z, &b.z),
        ("momenta", &a.momenta, &b.momenta),
        ("scalars", &a.scalars, &b.scalars),
    ] {
        let (x, y) = (bits(x), bits(y));
        let first = x.iter().zip(&y).position(|(x, y)| x != y);
        assert_eq!(first, None, "{told}: {what}");
    }
    assert_eq!((&a.times, &a.works), (&b.times, &b.works), "{told}");
    assert_eq!(a.end.lists, b.end.lists, "{told}");
    assert_eq!(a.end.tangent, b.end.tangent, "{told}");
    let counts = |h: &DiscreteTrajectory| {
        let report = h.end.report;
        (
            report.steps,
            report.iterations,
            report.factorisations,
            report.made,
        )
    };
    assert_eq!(counts(a), counts(b), "{told}");
}

/// Stops a motion after each of some numbers of steps and lets it go on.
fn stop(name: &str, set: &[&str], after: &[usize]) {
    let told = format!("{name} {set:?}");
    let (system, task) = simulation(name, set);
    let whole = all(&system, &task);
    let moved = |i: usize| {
        whole
            .z
            .iter()
            .map(|z| z[i])
            .fold(0.0_f64, |m, z| m.max(z.abs()))
    };
    assert!(
        (0..whole.momenta[0].len()).any(|i| moved(i) > 1e-3),
        "{told}: nothing moves"
    );
    let mut begun = None;
    for &steps in after {
        let run = integrate_on(&system, &task, begun, |_, discrete| {
            match discrete.intervals() >= steps {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        let Simulated {
            discrete, failure, ..
        } = run.unwrap();
        assert_eq!((failure, discrete.intervals()), (None, steps), "{told}");
        begun = Some(discrete);
    }
    let run = integrate_on(&system, &task, begun, |_, _| ControlFlow::Continue(()));
    assert_same(&run.unwrap().discrete, &whole, &told);
}

const SHORT: &str = "simulate.duration=0.2 s";

#[test]
fn rigid_bodies_go_on_to_the_bit() {
    let ramp = r#"simulate.voltages={"muscle1":{"ramp":{"to":"2 kV","duration":"0.1 s"}}}"#;
    for set in [
        &[SHORT][..],
        &[SHORT, ramp],
        &[SHORT, ramp, "simulate.coordinates=redundant"],
        &[SHORT, ramp, "simulate.newton=modified"],
    ] {
        stop("elephant_trunk_constant", set, &[1, 2, 17]);
    }
}

#[test]
fn every_method_goes_on_to_the_bit() {
    for method in [
        "\"implicit_euler\"",
        "\"generalised_alpha\"",
        "{\"galerkin\":1}",
        "{\"galerkin\":3}",
    ] {
        let method = format!("simulate.integrator={method}");
        for coordinates in ["reduced", "redundant"] {
            let coordinates = format!("simulate.coordinates={coordinates}");
            stop(
                "elephant_trunk_constant",
                &[SHORT, &method, &coordinates],
                &[1, 3, 20],
            );
        }
    }
}

#[test]
fn steps_by_a_tolerance_go_on_to_the_bit() {
    stop(
        "elephant_trunk_constant",
        &[SHORT, "simulate.step=auto"],
        &[1, 2, 12],
    );
}

#[test]
fn turning_bodies_with_charts_go_on_to_the_bit() {
    for method in ["\"midpoint\"", "{\"galerkin\":2}"] {
        let method = format!("simulate.integrator={method}");
        stop(
            "satellite",
            &["simulate.duration=0.3 s", &method],
            &[1, 4, 13],
        );
    }
}

const BLOCK: [&str; 3] = [
    "scene.solids[0].box.elements=[1,1,4]",
    "simulate.duration=15 ms",
    "simulate.step=0.5 ms",
];

#[test]
fn finite_elements_go_on_to_the_bit_with_the_tangent_that_they_keep() {
    for newton in ["modified", "full"] {
        let newton = format!("simulate.newton={newton}");
        let set = [&BLOCK[..], &[&newton]].concat();
        stop("clamped_stack_step", &set, &[1, 2, 13]);
    }
    let (system, task) = simulation("clamped_stack_step", &BLOCK);
    let whole = all(&system, &task);
    let report = whole.end.report;
    assert!(report.factorisations < report.iterations / 3, "{report:?}");
    let tangent = whole.end.tangent.unwrap();
    assert!(tangent.step.is_some() && !tangent.matrix.is_empty());
}

#[test]
fn muscles_of_finite_elements_go_on_to_the_bit() {
    let set = ["simulate.duration=60 ms"];
    stop("fe_trunk", &set, &[2, 5]);
}

/// A watch ends a motion at any of its questions, which are many within a step; what goes on after ever more of them is the whole motion.
#[test]
fn a_stop_within_a_step_changes_nothing() {
    for (solver, duration) in [("auto", "40 ms"), ("multigrid", "8 ms")] {
        stop_within_steps(solver, duration);
    }
}

fn stop_within_steps(solver: &str, duration: &str) {
    let solver = format!("simulate.linear_solver={solver}");
    let duration = format!("simulate.duration={duration}");
    let set = [BLOCK[0], "simulate.step=0.5 ms", &solver, &duration];
    let (system, task) = simulation("clamped_stack_step", &set);
    let watched = |begun: Option<DiscreteTrajectory>, allowed| {
        let questions = Questions::allowed(allowed);
        let watch = stop::watch_questions(&questions);
        let run = integrate_on(&system, &task, begun, |_, _| ControlFlow::Continue(()));
        drop(watch);
        (run, questions.asked())
    };
    let (whole, asked) = watched(None, u64::MAX);
    let whole = whole.unwrap().discrete;
    let steps = whole.intervals() as u64;
    assert!(asked > 3 * steps, "{asked} questions in {steps} steps");
    let (mut begun, mut stops, mut allowed) = (None, 0, asked / 7 + 1);
    loop {
        let (run, _) = watched(begun.clone(), allowed);
        let run = run.expect("time for the first step");
        assert_eq!(run.failure, None);
        if run.discrete.intervals() == whole.intervals() {
            assert_same(&run.discrete, &whole, "stopped anywhere");
            break;
        }
        // No multiple of the questions of a step.
        (begun, stops, allowed) = (Some(run.discrete), stops + 1, allowed + 1);
        assert!(stops < 20, "it does not go on");
    }
    assert!(stops > 2, "stopped {stops} times on its way");
}

#[test]
fn a_motion_of_something_else_does_not_go_on() {
    let (system, task) = simulation("elephant_trunk_constant", &[SHORT]);
    let begun = all(&system, &task);
    let (other, other_task) = simulation("pair_constant", &[]);
    let stepping = |begun: DiscreteTrajectory, system: &System, task: &Simulation| {
        let run = integrate_on(system, task, Some(begun), |_, _| ControlFlow::Continue(()));
        run.unwrap().failure
    };
    let foreign = |failure| matches!(failure, Some(StepError::Foreign { .. }));
    assert!(foreign(stepping(begun.clone(), &other, &other_task)));
    let (_, by_other_method) = simulation(
        "elephant_trunk_constant",
        &[
            "simulate.duration=0.4 s",
            "simulate.integrator=implicit_euler",
        ],
    );
    assert!(foreign(stepping(begun.clone(), &system, &by_other_method)));
    let mut damaged = begun.clone();
    damaged.momenta[3].pop();
    assert!(foreign(stepping(damaged, &system, &task)));
    let mut damaged = begun;
    damaged.end.lists[1].1.pop();
    assert!(foreign(stepping(damaged, &system, &task)));
}
