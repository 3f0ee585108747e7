//! Random goals: each ends solved or with a word, and voltages that solve it lead there.

use crate::common::random_goals::{Goal, Goals, Kind, trunk};
use proboscis::control::problem::Task;
use proboscis::dynamics::simulate;
use proboscis::files::read_problem;
use proboscis::nlp::Status;
use proboscis::workflow::{Iterate, SolveLimits, optimise};
use std::ops::ControlFlow;

/// Statuses with which a solve of a well-posed problem may end.
const CLASSIFIED: [Status; 7] = [
    Status::Solved,
    Status::Acceptable,
    Status::Infeasible,
    Status::IterationLimit,
    Status::RestorationFailed,
    Status::SearchDirectionTooSmall,
    Status::InvalidNumber,
];

/// Solves a goal; whether it was solved.
fn solve(goal: &Goal, kind: Kind) -> bool {
    let goal_is = format!("control.goal={}", goal.json);
    let loaded = read_problem(&trunk(), &[goal_is]).expect("a goal");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let allowed = SolveLimits {
        iterations: Some(200),
        seconds: None,
    };
    let optimum = optimise(&loaded.system, &control, None, allowed, &mut go_on);
    let optimum = optimum.expect("a reachable goal");
    let status = optimum.solution.status;
    assert!(CLASSIFIED.contains(&status), "{status} for {}", goal.json);
    if !status.is_solved() {
        assert!(!optimum.violated.is_empty() || optimum.infeasibility < 1e-6);
        return false;
    }
    let (model, motion) = (&optimum.model, &optimum.motion);
    let steps = motion.intervals();
    let h = motion.times[steps] / steps as f64;
    let voltages = |from: f64, _: f64| model.scalars(&motion.voltages[(from / h).round() as usize]);
    let start = &optimum.boundary.start;
    let (discrete, failure) = simulate(model, start, h, steps, voltages, |_| {
        ControlFlow::Continue(())
    });
    assert_eq!(failure, None);
    let mut end = model.action.map.instant();
    end.z.copy_from_slice(&discrete.z[steps]);
    model.action.map.place(&mut end);
    let far = (end.x[model.markers[0]] - goal.tip).norm();
    assert!(far < 1e-4, "{far} mm from {}", goal.json);
    let momentum = discrete.momenta[steps]
        .iter()
        .fold(0.0, |m: f64, p| m.max(p.abs()));
    let largest = discrete
        .momenta
        .iter()
        .flatten()
        .fold(0.0, |m: f64, p| m.max(p.abs()));
    assert!(momentum < 1e-5 * largest, "{momentum} of {largest} is left");
    if kind == Kind::Rest {
        for (angle, expected) in model.joints(&end, &goal.angles).iter().zip(&goal.angles) {
            assert!((angle - expected).abs() < 1e-6, "{angle}, not {expected}");
        }
    }
    assert!(
        motion
            .voltages
            .iter()
            .flatten()
            .all(|v| (-1e-3..3000.001).contains(v))
    );
    true
}

#[test]
fn random_goals_are_reached_or_refused_with_a_word() {
    let mut goals = Goals::new(1);
    let mut solved = 0;
    for kind in [Kind::Rest, Kind::Tip] {
        for _ in 0..3 {
            let goal = goals.draw(kind);
            // The trunk is 300 mm long.
            assert!(goal.tip.norm() < 300.1, "{}", goal.tip);
            assert!(goal.angles.iter().any(|angle| angle.abs() > 0.02));
            solved += usize::from(solve(&goal, kind));
        }
    }
    assert!(solved >= 3, "{solved} of 6 are solved");
}

#[test]
fn a_goal_that_is_just_reached_in_time_is_found_from_the_shortest_motion() {
    // The guess of the problem ends in the limit of iterations; the shortest motion takes 0.184 s.
    let changes = [
        r#"control.goal={"markers":{"tip":[0.13047225366716458,0.23968469529064168,0.09329478813017689]}}"#,
        "control.duration=0.19 s",
        "control.solver.max_iterations=80",
    ]
    .map(str::to_owned);
    let loaded = read_problem(&trunk(), &changes).expect("a goal");
    let Task::Control(control) = loaded.task else {
        panic!("a problem of control");
    };
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let limits = SolveLimits::default();
    let optimum = optimise(&loaded.system, &control, None, limits, &mut go_on);
    let optimum = optimum.expect("a reachable goal");
    assert!(optimum.is_solved(), "{}", optimum.word());
    let duration = optimum.motion.times[optimum.motion.intervals()];
    assert!((duration - 190.0).abs() < 1e-9, "{duration} ms");
    let from = optimum.restarted.expect("another start").from;
    assert_eq!(from, "the shortest motion");
}

#[test]
fn a_simulation_as_a_guess_saves_iterations() {
    let mut goals = Goals::new(1);
    let mut all = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let goal = goals.draw(Kind::Rest).json;
        let voltages = &goal["rest_at_voltages"];
        let guesses = [
            r#""interpolate""#.to_owned(),
            format!(r#"{{"simulate":{{"voltages":{voltages}}}}}"#),
        ];
        let mut objectives = Vec::new();
        for (guess, counts) in guesses.iter().zip(&mut all) {
            let changes = [
                format!("control.goal={goal}"),
                format!("control.guess={guess}"),
            ];
            let loaded = read_problem(&trunk(), &changes).expect("a goal");
            let Task::Control(control) = loaded.task else {
                panic!("a problem of control");
            };
            let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
            let system = &loaded.system;
            let allowed = SolveLimits::default();
            let optimum = optimise(system, &control, None, allowed, &mut go_on);
            let solution = optimum.expect("a reachable goal").solution;
            assert!(solution.status.is_solved(), "{goal}");
            counts.push(solution.iterations.len() - 1);
            objectives.push(solution.objective);
        }
        // Optima are local: another guess may end at another one.
        let [a, b] = [objectives[0], objectives[1]];
        assert!((b - a).abs() < 0.01 * a, "{b} in place of {a}");
    }
    let [cold, simulated] = all.map(|mut counts| {
        println!("{counts:?}");
        counts.sort_unstable();
        counts[2]
    });
    assert!(simulated <= cold, "{simulated} and {cold}");
}

#[test]
fn equal_seeds_draw_equal_goals() {
    let draw = |seed| Goals::new(seed).draw(Kind::Rest).json;
    assert_eq!(draw(5), draw(5));
    assert_ne!(draw(5), draw(6));
}
