//! Limits that an optimum keeps at its instants and in its intervals, and passes between them.

use crate::sought::{pair, turn};
use proboscis::control::problem::{Control, Limit};
use proboscis::dynamics::simulate;
use proboscis::model::What;
use proboscis::tasks::{SolveRequest, SolveResult, solve};
use proboscis::workflow::Iterate;
use std::ops::ControlFlow;

/// Largest rate in rad/ms, 1.1 times the mean one.
const FASTEST: f64 = 2.2e-3;

fn limited(intervals: usize) -> (SolveResult, f64) {
    let system = pair();
    let control = Control {
        intervals,
        limits: vec![Limit::of_rate(
            What::Joint {
                joint: 0,
                near: 0.0,
            },
            [-FASTEST, FASTEST],
        )],
        ..turn(&system)
    };
    let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
    let result = solve(&system, &control, SolveRequest::default(), go_on).unwrap();
    assert!(result.verdict.is_solved);
    // Rates of the motion in steps of half the length, by differences.
    let optimum = &result.optimum;
    let (h, model) = (optimum.motion.times[1] / 2.0, &optimum.model);
    let rows = &optimum.motion.voltages;
    let scalars = |from: f64, _: f64| {
        let interval = (from / (2.0 * h) + 1e-6) as usize;
        model.scalars(&rows[interval])
    };
    let go_on = |_: &_| ControlFlow::Continue(());
    let start = &optimum.boundary.start;
    let (discrete, failure) = simulate(model, start, h, 2 * rows.len(), scalars, go_on);
    assert!(failure.is_none());
    let steps = discrete
        .z
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]) / h);
    (
        result,
        steps.fold(0.0, |most: f64, rate| most.max(rate.abs())),
    )
}

fn is_told(result: &SolveResult) -> bool {
    let mut lines = result.remarks.lines();
    lines.any(|line| line.contains("a limit is passed, rate of joint1"))
}

#[test]
fn a_rate_that_is_passed_between_instants_is_told() {
    let (coarse, rate) = limited(8);
    println!(
        "{rate} of {FASTEST}: {:?}",
        coarse.remarks.lines().collect::<Vec<_>>()
    );
    assert!(rate > 1.03 * FASTEST, "{rate}");
    assert!(is_told(&coarse));
    let (fine, rate) = limited(80);
    println!(
        "{rate} of {FASTEST}: {:?}",
        fine.remarks.lines().collect::<Vec<_>>()
    );
    assert!(rate < 1.01 * FASTEST, "{rate}");
    assert!(!is_told(&fine));
}
