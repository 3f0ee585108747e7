//! Lumped muscles on their way to no length, where their energy has no value: steps must not jump over it.
//!
//! Forces are those at the middle of a step, which says nothing of an end on the other side: a span that turns by a right
//! angle or more within a step may have passed through zero.

use crate::dynamics::History;
use crate::model::Model;
use crate::model::system::Fidelity;
use crate::reduction::Instant;

/// Below this stretch a muscle is named where a step fails; pull-in of an ideal dielectric is at 0.63.
const SHORT: f64 = 0.5;

/// The lumped muscles: index, and vector of the span.
fn lumped(model: &Model) -> impl Iterator<Item = (usize, usize)> + '_ {
    let muscles = model.system.muscles.iter().enumerate();
    muscles
        .filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped)
        .map(|(m, _)| (m, model.spans[m]))
}

/// The first lumped muscle whose span turns by a right angle or more from one placed instant to another.
pub(super) fn reversed(model: &Model, before: &Instant, after: &Instant) -> Option<usize> {
    let turns = |span: usize| before.x[span].dot(&after.x[span]) <= 0.0;
    lumped(model)
        .find(|&(_, span)| turns(span))
        .map(|(muscle, _)| muscle)
}

/// The shortest lumped muscle of a placed instant, if it is rather short: its index and its stretch.
pub(super) fn shortest(model: &Model, at: &Instant) -> Option<(usize, f64)> {
    let stretch = |(m, span): (usize, usize)| {
        let length = model.system.muscles[m].length();
        (m, at.x[span].norm() / length)
    };
    let short = lumped(model).map(stretch).filter(|(_, s)| *s < SHORT);
    short.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The first interval of a motion in which the span of a lumped muscle turns by a right angle or more, and the muscle.
pub fn reversed_muscle(model: &Model, history: &History) -> Option<(usize, usize)> {
    let placed = |z: &[f64]| {
        let mut instant = model.action.motion.instant();
        instant.z.copy_from_slice(z);
        model.action.motion.place(&mut instant);
        instant
    };
    let mut pairs = history.z.windows(2).enumerate();
    pairs.find_map(|(k, ends)| {
        let muscle = reversed(model, &placed(&ends[0]), &placed(&ends[1]))?;
        Some((k, muscle))
    })
}
