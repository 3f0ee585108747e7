//! Squares of residuals at the ends of intervals, against those of the closed form.

use crate::oscillator::{place, recording, system, task};
use nalgebra::{Matrix2, Vector2};
use proboscis::identify::{Identified, identify};
use proboscis::math::Random;

const START: [f64; 2] = [5.0, 0.0];

fn found(deviation: f64) -> Identified {
    let noise = Some((deviation, &mut Random::new(11)));
    let mut task = task(vec![recording("free", START, (41, 200.0), noise)]);
    task.step = Some(2.5);
    identify(&system(), &task, &mut |_, _| {}).unwrap()
}

/// Rises at the ends of the interval of a constant over those that derivatives foretell; the other one makes up for what it can.
fn expected(found: &Identified, j: usize) -> [f64; 2] {
    let values = found.fit.of_constants();
    let at = Vector2::new(values[0], values[1]);
    let series = &found.series[0];
    let of = |time: f64, at: Vector2<f64>| place(time, [at[0], at[1]], START);
    let (mut matrix, mut squares) = (Matrix2::zeros(), 0.0);
    for (k, &time) in series.times.iter().enumerate() {
        let slope = Vector2::from_fn(|i, _| {
            let step = Vector2::ith(i, 1e-5 * at[i]);
            (of(time, at + step) - of(time, at - step)) / (2e-5 * at[i] * series.deviations[k])
        });
        matrix += slope * slope.transpose();
        squares += ((series.measured[k] - of(time, at)) / series.deviations[k]).powi(2);
    }
    let other = 1 - j;
    let mut change = Vector2::ith(j, found.information.half(j));
    change[other] = -change[j] * matrix[(other, j)] / matrix[(other, other)];
    let foretold = (change.transpose() * matrix * change)[0];
    [-1.0, 1.0].map(|side| {
        let moved = at + change * side;
        let all = series.times.iter().enumerate().map(|(k, &time)| {
            ((series.measured[k] - of(time, moved)) / series.deviations[k]).powi(2)
        });
        (all.sum::<f64>() - squares) / foretold
    })
}

#[test]
fn squares_rise_at_the_ends_of_intervals_as_those_of_the_closed_form() {
    for (deviation, is_confirmed) in [(0.05, true), (3.0, false)] {
        let found = found(deviation);
        let unlike: Vec<usize> = found.rises.unlike().map(|(j, _)| j).collect();
        println!("{deviation}: {:?}", found.rises);
        assert_eq!(unlike.is_empty(), is_confirmed, "{unlike:?}");
        for (j, own) in found.rises.0.iter().enumerate() {
            for (rise, expected) in own.iter().zip(expected(&found, j)) {
                let rise = rise.expect("bounds are far");
                assert!((rise / expected - 1.0).abs() < 2e-3, "{rise} {expected}");
            }
        }
    }
}
