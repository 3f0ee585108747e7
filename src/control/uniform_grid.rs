//! Resampling of a motion in unequal steps to a uniform grid, from which a transcription starts.

use std::borrow::Cow;

use crate::control::solution::Solution;
use crate::coordinates::CoordinateMap;

/// Deviation of an instant, in mean steps, that is rounding.
const ROUNDING: f64 = 1e-6;

/// The motion as it is where its steps are equal, otherwise at as many equal ones: coordinates along lines, voltages and
/// potentials of the step that the middle of an interval is in; costates belong to other rows and are left out. `map` is
/// what the coordinates mean, where they are those of the model.
pub(super) fn on_uniform_grid<'s>(
    solved: &'s Solution,
    map: Option<&CoordinateMap>,
) -> Cow<'s, Solution> {
    let intervals = solved.intervals();
    let end = solved.times[intervals];
    let time = |k: f64| end * k / intervals as f64;
    let is_even =
        |(k, &t): (usize, &f64)| (t - time(k as f64)).abs() <= ROUNDING * end / intervals as f64;
    if solved.times.iter().enumerate().all(is_even) {
        return Cow::Borrowed(solved);
    }
    let step_at = |time: f64| {
        let after = solved.times.partition_point(|&t| t <= time);
        after.clamp(1, intervals) - 1
    };
    let along = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let row = |k: usize| {
            let at = time(k as f64);
            let i = step_at(at);
            let part = (at - solved.times[i]) / (solved.times[i + 1] - solved.times[i]);
            let ends = rows[i].iter().zip(&rows[i + 1]);
            ends.map(|(a, b)| a + part * (b - a)).collect()
        };
        (0..=intervals).map(row).collect()
    };
    let configurations = || {
        let mut z = along(&solved.z);
        let Some(map) = map else {
            return z;
        };
        for (k, z) in z.iter_mut().enumerate() {
            let at = time(k as f64);
            let i = step_at(at);
            let part = (at - solved.times[i]) / (solved.times[i + 1] - solved.times[i]);
            let ends = [(1.0 - part, &*solved.z[i]), (part, &*solved.z[i + 1])];
            map.mean_of_charts(&ends, z);
        }
        z
    };
    let within = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let row = |k: usize| rows.get(step_at(time(k as f64 + 0.5))).cloned();
        (0..intervals).filter_map(row).collect()
    };
    let near = |k: usize| {
        let at = time(k as f64);
        let i = step_at(at);
        i + usize::from(2.0 * at > solved.times[i] + solved.times[i + 1])
    };
    Cow::Owned(Solution {
        coordinates: solved.coordinates,
        multiplier_time: solved.multiplier_time,
        hold: solved.hold.clone(),
        meshes: solved.meshes.clone(),
        parameters: solved.parameters.clone(),
        times: (0..=intervals).map(|k| time(k as f64)).collect(),
        joints: along(&solved.joints),
        poses: (0..=intervals)
            .filter_map(|k| solved.poses.get(near(k)).cloned())
            .collect(),
        z: configurations(),
        momentum: solved.momentum.clone(),
        voltages: within(&solved.voltages),
        potentials: within(&solved.potentials),
        costates: None,
        barrier: None,
    })
}
