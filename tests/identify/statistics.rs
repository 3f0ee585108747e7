//! Covariances, intervals and ellipsoids against SciPy and against many recordings.

use crate::oscillator::{DAMPING, STIFFNESS, place, recording, system, task};
use nalgebra::{Matrix2, Vector2};
use proboscis::control::problem::{Recording, SoughtStart};
use proboscis::identify::{Grid, Problem, Unknowns, identify};
use proboscis::math::Random;

/// Constants that fit the closed form to a recording from rest at 5 mm, by Newton's method on the sum of squares with differences.
pub(crate) fn closed_form(recording: &Recording, near: &[f64]) -> [f64; 2] {
    let mut at = Vector2::new(near[0], near[1]);
    for _ in 0..20 {
        let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for reading in recording.readings() {
            let of = |v: Vector2<f64>| place(reading.time, [v[0], v[1]], [5.0, 0.0]);
            let slope = Vector2::from_fn(|j, _| {
                let step = Vector2::ith(j, 1e-5 * at[j]);
                (of(at + step) - of(at - step)) / (2e-5 * at[j])
            });
            matrix += slope * slope.transpose();
            right += slope * (reading.value - of(at));
        }
        at += matrix.try_inverse().unwrap() * right;
    }
    [at[0], at[1]]
}

fn noisy(sought: SoughtStart, is_known: bool) -> proboscis::identify::Identified {
    let noise = &mut Random::new(7);
    let mut own = recording("free", [5.0, 0.0], (41, 200.0), Some((0.05, noise)));
    own.sought_start = sought;
    own.channels[0].is_deviation_known = is_known;
    let mut task = task(vec![own]);
    task.step = Some(2.5);
    identify(&system(), &task, &mut |_, _| {}).unwrap()
}

/// `scipy.optimize.least_squares` of SciPy 1.x, 3-point differences, on the closed form with the same noise: constants, then the
/// covariance (JᵀJ)⁻¹ with residuals in standard deviations.
const SCIPY: [f64; 5] = [
    0.20035695,
    0.59636782,
    8.26332692e-8,
    3.76125512e-7,
    1.97219600e-5,
];
/// The sum of the squared residuals over 39 degrees of freedom.
const REDUCED: f64 = 1.263793987;
/// With an unknown place and velocity at the start.
const OPEN: [f64; 5] = [
    0.200327847,
    0.594085482,
    2.22759721e-7,
    1.18910718e-7,
    4.26110640e-5,
];

#[test]
fn covariances_are_those_of_scipy() {
    let cases = [
        (SoughtStart::Nothing, true, SCIPY, 1.0),
        (SoughtStart::Nothing, false, SCIPY, REDUCED),
        (SoughtStart::State, true, OPEN, 1.0),
    ];
    for (sought, is_known, expected, factor) in cases {
        let found = noisy(sought, is_known);
        let values = found.fit.of_constants();
        let covariance = &found.information.covariance;
        let own = [
            values[0],
            values[1],
            covariance[(0, 0)] / factor,
            covariance[(0, 1)] / factor,
            covariance[(1, 1)] / factor,
        ];
        for (k, (a, b)) in own.iter().zip(expected).enumerate() {
            assert!(
                (a / b - 1.0).abs() < 1e-4,
                "{sought:?} {is_known} {k}: {a} {b}"
            );
        }
        assert!(found.is_white());
        assert_eq!(found.p.is_some(), is_known);
    }
}

#[test]
fn ellipsoids_of_95_percent_hold_the_truth_in_95_percent_of_all_recordings() {
    let inside = |seeds: std::ops::Range<u64>| seeds.filter(|&seed| holds_truth(seed)).count();
    let inside: usize = std::thread::scope(|scope| {
        let halves = [0..500, 500..1000].map(|seeds| scope.spawn(move || inside(seeds)));
        halves.map(|half| half.join().unwrap()).iter().sum()
    });
    println!("{inside}");
    assert!((933..=967).contains(&inside), "{inside}");
}

/// Returns true if the ellipsoid of a fit to a recording with errors holds the truth.
fn holds_truth(seed: u64) -> bool {
    let noise = Some((0.2, &mut Random::new(seed)));
    let task = task(vec![recording("free", [5.0, 0.0], (21, 100.0), noise)]);
    let begin = Unknowns::of_values(&[STIFFNESS, DAMPING], &[&[]]);
    let grid = Grid {
        intervals: vec![10],
        meets_corners: vec![true; 8],
    };
    let found = Problem {
        system: &system(),
        task: &task,
    }
    .fit(&[0], begin, 0, &grid)
    .unwrap();
    let information = found.information(&task);
    let values = found.of_constants();
    let off = Vector2::new(values[0] - STIFFNESS, values[1] - DAMPING);
    let covariance: Matrix2<f64> = information.covariance.fixed_view::<2, 2>(0, 0).into_owned();
    let square = (off.transpose() * covariance.try_inverse().unwrap() * off)[0];
    square <= information.ellipsoid
}
