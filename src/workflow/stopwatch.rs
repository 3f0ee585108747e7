//! Times of one evaluation of each effect.

use std::hint::black_box;
use std::time::Instant;

use crate::coordinates::Interval;
use crate::functional::{Order, Output, Sample, Term};
use crate::model::Model;

/// Most evaluations of one effect.
const MOST: u32 = 10_000;
/// Number of means, of which the least is reported.
const ROUNDS: u32 = 3;

/// Time in µs of one evaluation with second derivatives of each effect at the reference configuration, those of the intervals
/// first; about `spent` seconds or one evaluation go into each.
pub(crate) fn times(model: &Model, spent: f64) -> Vec<f64> {
    let action = &model.action;
    let start = model.reference_coordinates();
    let instant = action.map.placed(&start);
    let scalars = vec![0.0; action.intervals.scalars];
    let interval = Interval::given(&scalars, model.analysis.interval);
    let of_interval = interval.sample([&instant, &instant]);
    let multipliers = vec![0.0; action.instants.scalars];
    let of_instant = Sample {
        scalars: &multipliers,
        ..of_interval
    };
    let mut times = Vec::new();
    for (sum, sample) in [
        (&action.intervals, &of_interval),
        (&action.instants, &of_instant),
    ] {
        let mut output = sum.output(Order::Hessian);
        times.extend(
            sum.terms()
                .map(|term| 1e6 * time(term, sample, &mut output, spent)),
        );
    }
    times
}

/// Time of one evaluation in s.
fn time(
    (effect, slots): (&dyn Term, &[u32]),
    sample: &Sample<'_>,
    output: &mut Output,
    spent: f64,
) -> f64 {
    let mut run = |count: u32| {
        let began = Instant::now();
        for _ in 0..count {
            effect.evaluate(Order::Hessian, black_box(sample), slots, output);
        }
        black_box(&output);
        began.elapsed().as_secs_f64() / f64::from(count)
    };
    let once = run(1);
    if once > spent {
        return once;
    }
    let rounds = f64::from(ROUNDS) * once.max(1e-9);
    let count = ((spent / rounds) as u32).clamp(1, MOST);
    (0..ROUNDS).map(|_| run(count)).fold(once, f64::min)
}
