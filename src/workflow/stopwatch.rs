//! Times of one evaluation of each effect.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use crate::coordinates::Interval;
use crate::functional::{Functional, Order, Output, Sample, Term};
use crate::model::Model;

/// Most evaluations of one effect.
const MOST: u32 = 10_000;
/// Number of means, of which the least is reported.
const ROUNDS: u32 = 3;
/// Most elements of an effect that are all evaluated: of more, a part is, and the time is multiplied.
const ELEMENTS: usize = 100_000;

/// Time in µs of one evaluation with second derivatives of each effect at the reference configuration, those of the intervals
/// first; about `spent` seconds or one evaluation go into each, of large ones into a part.
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
        let parts = parts(sum);
        let timed = parts.as_ref().unwrap_or(sum);
        let mut output = timed.output(Order::Hessian);
        let whole = sum.terms.iter().map(|term| term.elements());
        for (all, part) in whole.zip(timed.terms()) {
            let times_as_many = all as f64 / part.0.elements().max(1) as f64;
            times.push(1e6 * times_as_many * time(part, sample, &mut output, spent));
        }
    }
    times
}

/// A sum of parts of the effects, so that the couplings of large ones are not laid down; `None` where there is no large one.
fn parts(sum: &Functional) -> Option<Functional> {
    let is_large = |term: &Arc<dyn Term>| term.elements() > ELEMENTS;
    sum.terms.iter().any(is_large).then(|| {
        let part = |term: &Arc<dyn Term>| match is_large(term) {
            true => {
                let read = sum.vectors * ELEMENTS / term.elements();
                let part = term.reading(&|vector| vector < read);
                part.unwrap_or_else(|| term.clone())
            }
            false => term.clone(),
        };
        let terms = sum.terms.iter().map(part).collect();
        Functional::new(terms, Vec::new(), sum.vectors, sum.scalars)
    })
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
