//! Lumped muscles beyond the stretches for which the constants of their materials hold.

use crate::dynamics::discrete_trajectory::DiscreteTrajectory;
use crate::model::Model;
use crate::model::system::Fidelity;

/// Part of a stretch that is not told: that of rounding, and of rests that are found to a tolerance.
const SLACK: f64 = 1e-3;

/// A muscle beyond the range of its material.
#[derive(Clone, Debug, PartialEq)]
pub struct OutOfRange {
    /// The muscle.
    pub name: String,
    /// Smallest and largest stretch for which the constants hold.
    pub range: [f64; 2],
    /// Stretch that is furthest beyond, by its ratio to the end of the range.
    pub stretch: f64,
    /// Instant of this stretch in ms.
    pub time: f64,
}

/// Returns the muscles that leave the ranges of their materials at the instants of a motion.
pub fn out_of_range(model: &Model, discrete: &DiscreteTrajectory) -> Vec<OutOfRange> {
    let muscles = model.system.muscles.iter().enumerate();
    let mut watched: Vec<_> = muscles
        .filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped)
        .filter_map(|(m, muscle)| {
            let range = muscle.material.stretch_range?;
            let none = OutOfRange {
                name: muscle.name.clone(),
                range,
                stretch: 1.0,
                time: 0.0,
            };
            Some((model.spans[m], muscle.length(), 1.0 + SLACK, none))
        })
        .collect();
    if watched.is_empty() {
        return Vec::new();
    }
    let mut instant = model.action.map.instant();
    for (z, &time) in discrete.z.iter().zip(&discrete.times) {
        instant.z.copy_from_slice(z);
        model.action.map.vectors(&mut instant);
        for (span, length, furthest, found) in &mut watched {
            let stretch = instant.x[*span].norm() / *length;
            let [low, high] = found.range;
            let beyond = (low / stretch).max(stretch / high);
            if beyond > *furthest {
                *furthest = beyond;
                (found.stretch, found.time) = (stretch, time);
            }
        }
    }
    let is_beyond = |furthest: f64| furthest > 1.0 + SLACK;
    let watched = watched.into_iter();
    watched
        .filter_map(|(_, _, furthest, found)| is_beyond(furthest).then_some(found))
        .collect()
}
