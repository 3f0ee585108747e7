//! Notes on joints that a motion presses into their stops.

use crate::dynamics::trajectory::Trajectory;
use crate::math::significant;
use crate::model::System;

/// For each joint that passes a stop, how far and when.
pub(crate) fn notes(system: &System, motion: &Trajectory) -> Vec<String> {
    let joints = system.joints.iter().filter(|joint| joint.has_coordinate());
    let units = motion.coordinates(system);
    let passed = joints
        .zip(units)
        .enumerate()
        .filter_map(|(u, (joint, of))| {
            let stops = joint.stops?;
            let beyond = motion.joints.iter().map(|row| stops.beyond(row[u]));
            let (k, far) = beyond.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
            let (far, unit) = match of.unit {
                "rad" => (far.to_degrees(), "deg"),
                other => (far, other),
            };
            (far > 0.0).then(|| {
                format!(
                    "{} is pressed into its stop by up to {} {unit}, at {} s",
                    joint.name,
                    significant(far, 3),
                    significant(motion.times[k] / 1e3, 4)
                )
            })
        });
    passed.collect()
}
