//! Some instants of a motion in unequal steps: those that are asked for, with what belongs to them.

use proboscis::dynamics::DiscreteTrajectory;
use proboscis::dynamics::trajectory::{Column, Observations, Trajectory};
use proboscis::report::sampled::{Sampled, thinned};
use proboscis::workflow::{Tracked, TrackingError};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Times at the ends of steps.
fn times(steps: &[f64]) -> Vec<f64> {
    let mut time = 0.0;
    let ends = steps.iter().map(|step| {
        time += step;
        time
    });
    [0.0].into_iter().chain(ends).collect()
}

fn observed(times: &[f64]) -> Observations {
    Observations {
        columns: vec![Column {
            name: "time".to_owned(),
            unit: "ms",
            values: times.to_vec(),
        }],
    }
}

/// A motion whose only source has a voltage of its own in each interval.
fn motion(times: &[f64]) -> Trajectory {
    Trajectory {
        times: times.to_vec(),
        joints: times.iter().map(|time| vec![2.0 * time]).collect(),
        poses: vec![Vec::new(); times.len()],
        marks: vec![Vec::new(); times.len()],
        voltages: (1..times.len()).map(|k| vec![(k * k) as f64]).collect(),
        ..Trajectory::default()
    }
}

proptest! {
    #[test]
    fn instants_are_those_nearest_to_multiples(steps in prop::collection::vec(0.05..3.0_f64, 2..40)) {
        let times = times(&steps);
        let last = times.len() - 1;
        let mut nearest = BTreeSet::from([0, last]);
        for multiple in 1..=times[last] as usize {
            let far = |k: &usize| (times[*k] - multiple as f64).abs();
            nearest.extend((0..=last).min_by(|a, b| far(a).total_cmp(&far(b))));
        }
        let expected = (nearest.len() <= last).then(|| nearest.into_iter().collect::<Vec<_>>());
        let found = Sampled::from_observations(&observed(&times), Some(1.0));
        prop_assert_eq!(found.map(|sampled| sampled.instants), expected);
    }

    #[test]
    fn voltages_are_means_over_time(steps in prop::collection::vec(0.05..3.0_f64, 9)) {
        let times = times(&steps);
        let full = motion(&times);
        let instants = vec![0, 1, 4, 9];
        let shown = Sampled { instants: instants.clone() }.trajectory(&full);
        for (ends, row) in instants.windows(2).zip(&shown.voltages) {
            // The integral by steps, over the length.
            let within = ends[0]..ends[1];
            let areas = within.map(|k| full.voltages[k][0] * steps[k]);
            let integral: f64 = areas.sum();
            let mean = integral / (times[ends[1]] - times[ends[0]]);
            prop_assert!((row[0] - mean).abs() < 1e-9 * mean);
        }
        prop_assert_eq!(&shown.joints[2], &full.joints[4]);
        prop_assert_eq!(shown.times, vec![0.0, times[1], times[4], times[9]]);
    }
}

#[test]
fn an_instant_comes_with_the_voltages_before_it_and_its_deviation() {
    let sampled = Sampled {
        instants: vec![0, 2, 3, 5],
    };
    let numbers = |count: usize| (0..count).map(|k| vec![k as f64]).collect::<Vec<_>>();
    let full = DiscreteTrajectory {
        times: times(&[1.0, 2.0, 1.0, 3.0, 1.0]),
        z: numbers(6),
        scalars: numbers(5),
        ..DiscreteTrajectory::default()
    };
    let shown = sampled.discrete_trajectory(&full);
    assert_eq!(shown.times, [0.0, 3.0, 4.0, 8.0]);
    assert_eq!(shown.z.concat(), [0.0, 2.0, 3.0, 5.0]);
    assert_eq!(shown.scalars.concat(), [1.0, 2.0, 4.0]);
    let tracked = Tracked {
        kind: "joint",
        name: "joint1".to_owned(),
        unit: "rad",
        error: TrackingError {
            rms: 1.0,
            maximum: 5.0,
            time_of_maximum: 8e-3,
        },
        simulated: None,
        paths: Vec::new(),
        deviation: numbers(6).concat(),
    };
    let shown = sampled.tracked(&[tracked]);
    assert_eq!(shown[0].deviation, [0.0, 2.0, 3.0, 5.0]);
}

#[test]
fn what_is_drawn_beside_a_motion_is_thinned_to_its_ends() {
    let full = motion(&times(&vec![1.0; 9001]));
    let shown = thinned(&full);
    assert!(
        (2001..4500).contains(&shown.times.len()),
        "{}",
        shown.times.len()
    );
    assert_eq!(shown.times.last(), full.times.last());
    assert_eq!(shown.voltages.len(), shown.times.len() - 1);
    let few = motion(&times(&[1.0; 300]));
    assert_eq!(thinned(&few), few);
}
