//! Free durations against scans of given ones.

use crate::common::cases::rest_to_rest;
use crate::common::trunk;
use crate::optimality::{cold, guessed_step, problem, solve};
use proboscis::control::problem::{Control, Duration, Objective};
use proboscis::ipopt::Start;

#[test]
fn a_free_final_time_is_the_best_of_a_scan() {
    // Effort and duration together: over fixed times the least effort plus the price of time has its minimum where the
    // free time is.
    let system = trunk(1);
    let mut control = rest_to_rest(1, 20, 60.0);
    control.objective = Objective {
        effort: 1.0,
        duration: 1.5,
        ..Objective::default()
    };
    let fixed = |t: f64| {
        let control = Control {
            duration: Duration::Given(t),
            ..control.clone()
        };
        cold(&system, &control).solution.objective
    };
    let mut free = control.clone();
    free.duration = Duration::Free {
        min: 12.0,
        max: 300.0,
        guess: 60.0,
    };
    let best = cold(&system, &free);
    let (t, value) = (
        best.discrete.times[control.intervals],
        best.solution.objective,
    );
    println!("free time {t} ms, {value}");
    assert!(t > 13.0 && t < 290.0);
    let at = fixed(t);
    assert!(
        (at - value).abs() < 1e-7 * value,
        "{at} at the same time against {value}"
    );
    for factor in [0.8, 0.9, 0.97, 1.03, 1.1, 1.4] {
        let other = fixed(factor * t);
        println!("{factor}: {other}");
        assert!(
            other > value * (1.0 + 1e-5),
            "{other} at {factor} times the best time, {value} there"
        );
    }
}

#[test]
fn the_shortest_time_is_where_feasible_times_begin() {
    let (system, control) = problem("pair_time");
    let shortest = cold(&system, &control);
    let t = shortest.discrete.times[control.intervals];
    let mut fixed = control.clone();
    fixed.objective = Objective {
        effort: 1.0,
        ..Objective::default()
    };
    for (factor, feasible) in [(0.9, false), (0.999, false), (1.001, true), (1.1, true)] {
        fixed.duration = Duration::Given(factor * t);
        let h = guessed_step(&fixed);
        let from = shortest.discrete.clone();
        let found = solve(
            &system,
            &fixed,
            Some((&from, h, None)),
            Start::Primal { mu_init: 1e-3 },
        );
        println!(
            "{factor}: {:?}, rows {:e}",
            found.solution.status, found.conditions[1]
        );
        assert_eq!(
            found.solution.status.is_solved(),
            feasible,
            "{factor}: {:?}",
            found.solution.status
        );
    }
}
