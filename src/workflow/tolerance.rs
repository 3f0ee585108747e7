//! Simulation by a tolerance: the error of the motion is confirmed against the same motion in steps of other lengths, and the local errors
//! that are allowed shrink until it is below the tolerance.
//!
//! Local errors add up to the error of a motion only where they neither grow nor decay. The motion is therefore repeated in pairs of its
//! steps, and in pairs of these pairs; where that does not show the order of the method, in halves of its steps and in halves of these.
//!
//! Errors of motions in steps of second order, from two refinements that agree.
//!
//! With d the distance between two motions of which the second has steps of half the length, the error left on the second is d/3 and that on
//! the first 4 d/3, where steps are short enough for their order to show: then the distance before, between the first and a motion in steps of
//! twice the length, is about 4 d. An estimate is confirmed where that ratio lies between 2.5 and 6.5, or where both distances are
//! rounding.

use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, Drive, Lengths, Solving, StepControl, StepError, distance_between, go_on,
};
use crate::model::Model;
use crate::nlp::Status;
use crate::stop;
use crate::workflow::motion::{Distance, solved_of};
use std::ops::{ControlFlow, RangeInclusive};

/// Largest number of times that a motion is begun again with a tighter tolerance.
const AGAIN: usize = 4;
/// A tolerance is tightened to leave this part of the one that was asked for.
const LEAVES: f64 = 0.6;
/// Largest factors by which it is tightened, and where nothing is confirmed.
const MOST: f64 = 0.01;
const UNCONFIRMED: f64 = 0.1;
/// Fewest steps in which a motion is repeated in longer ones, and the largest part of the time that may have steps without a partner: one
/// that is a larger part than this of both together has none.
const FEWEST: usize = 4;
const MOST_ALONE: f64 = 0.05;
const LARGEST_PART: f64 = 0.7;

/// Parts of a motion by a tolerance.
pub(crate) struct ByTolerance<'a> {
    pub(crate) model: &'a Model,
    pub(crate) solving: Solving,
    pub(crate) control: StepControl<'a>,
    pub(crate) drive: &'a dyn Drive,
}

/// A motion by a tolerance.
pub(crate) struct Found {
    pub(crate) discrete: DiscreteTrajectory,
    /// Reason why it ended early.
    pub(crate) failure: Option<StepError>,
    /// Its error, where it did not.
    pub(crate) error: Option<EstimatedError>,
    /// Reason why its error was not confirmed to be below the tolerance.
    pub(crate) stopped: Option<Status>,
}

impl ByTolerance<'_> {
    /// The motion resumed from where it has `begun`, or one in shorter steps whose error is confirmed to be below the tolerance.
    pub(crate) fn run(
        &self,
        begun: DiscreteTrajectory,
        mut observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
    ) -> Found {
        let Self { control, .. } = *self;
        let start = at_start(&begun);
        let (motion, failure) = self.go_on(begun, Lengths::Controlled(control), &mut observer);
        let mut found = self.assessed(motion, failure);
        for _ in 0..AGAIN {
            let Some(error) = found.error.filter(|_| found.stopped.is_none()) else {
                return found;
            };
            if error.is_below(control.tolerance) {
                return found;
            }
            let factor = match error.is_confirmed {
                true => (LEAVES * control.tolerance / error.error).max(MOST),
                false => UNCONFIRMED,
            };
            let mut again = start.clone();
            let used = found.discrete.end.tolerance.unwrap_or(control.tolerance);
            again.end.tolerance = Some(used * factor);
            let (tighter, failure) = self.go_on(again, Lengths::Controlled(control), &mut observer);
            let is_whole = tighter.times.last() == found.discrete.times.last();
            if !is_whole && stop::reason().is_none() {
                // Steps that short fail: the motion before is the best there is.
                return found;
            }
            found = self.assessed(tighter, failure);
        }
        found
    }

    /// A motion with its error; a stop leaves the error unknown where it is not confirmed before.
    fn assessed(&self, discrete: DiscreteTrajectory, failure: Option<StepError>) -> Found {
        let error = match failure {
            None => self.error(&discrete),
            Some(_) => None,
        };
        let is_below = |error: &EstimatedError| error.is_below(self.control.tolerance);
        let stopped = match error.as_ref().is_some_and(is_below) {
            true => None,
            false => stop::reason(),
        };
        Found {
            error: error.filter(|error| error.is_confirmed || stopped.is_none()),
            discrete,
            failure,
            stopped,
        }
    }

    fn go_on(
        &self,
        begun: DiscreteTrajectory,
        lengths: Lengths<'_>,
        observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
    ) -> (DiscreteTrajectory, Option<StepError>) {
        let Self { drive, .. } = *self;
        go_on(self.solving, self.model, begun, lengths, drive, observer)
    }

    /// The error of a whole motion; none of one that ended early.
    fn error(&self, discrete: &DiscreteTrajectory) -> Option<EstimatedError> {
        let end = discrete.times.last().copied()?;
        if end < self.control.duration * (1.0 - 1e-12) {
            return None;
        }
        let coarse = self.error_by_pairs(discrete);
        coarse.or_else(|| self.error_by_halves(discrete))
    }

    /// The error from the motion in pairs of its steps and in pairs of these; none where that does not confirm it, or where too much of the
    /// time has steps without a partner.
    fn error_by_pairs(&self, discrete: &DiscreteTrajectory) -> Option<EstimatedError> {
        let times = |places: &[usize]| -> Vec<f64> {
            places.iter().map(|&place| discrete.times[place]).collect()
        };
        let all: Vec<usize> = (0..discrete.times.len()).collect();
        let pairs = self.pairs(discrete, &all);
        let fours = self.pairs(discrete, &pairs);
        let [each, in_two, in_four] = [&all, &pairs, &fours].map(|places| times(places));
        if !are_doubled(&each, &in_two) || !are_doubled(&in_two, &in_four) {
            return None;
        }
        let in_pairs = self.repeated(discrete, &in_two)?;
        let in_fours = self.repeated(discrete, &in_four)?;
        let among = fours.iter().filter_map(|k| pairs.binary_search(k).ok());
        let among: Vec<usize> = among.collect();
        let before = self.apart(&in_pairs, &among, &in_fours);
        let last = self.apart(discrete, &pairs, &in_pairs);
        let error = EstimatedError::of_finest(before, last);
        error.is_confirmed.then_some(error)
    }

    /// The error from the motion in halves of its steps and in halves of these.
    fn error_by_halves(&self, discrete: &DiscreteTrajectory) -> Option<EstimatedError> {
        let halves = halved(&discrete.times);
        let in_halves = self.repeated(discrete, &halves)?;
        let every_other = |count: usize| (0..count).step_by(2).collect::<Vec<_>>();
        let before = self.apart(&in_halves, &every_other(halves.len()), discrete);
        let quarters = halved(&halves);
        let Some(in_quarters) = self.repeated(discrete, &quarters) else {
            return Some(EstimatedError {
                error: 4.0 / 3.0 * before.size,
                place: 4.0 / 3.0 * before.place,
                is_confirmed: false,
            });
        };
        let last = self.apart(&in_quarters, &every_other(quarters.len()), &in_halves);
        Some(EstimatedError::of_first(before, last))
    }

    /// Every other of some instants of a motion, those at which voltages may switch included.
    fn pairs(&self, discrete: &DiscreteTrajectory, places: &[usize]) -> Vec<usize> {
        let switches = self.control.switches;
        let is_end = |place: usize| {
            place == 0
                || place + 1 == discrete.times.len()
                || switches.contains(&discrete.times[place])
        };
        let mut is_second = false;
        let is_kept = |&place: &usize| {
            let is_kept = is_end(place) || is_second;
            is_second = !is_kept;
            is_kept
        };
        places.iter().copied().filter(is_kept).collect()
    }

    fn repeated(&self, discrete: &DiscreteTrajectory, times: &[f64]) -> Option<DiscreteTrajectory> {
        repeated(self.solving, self.model, self.drive, discrete, times)
    }

    /// Greatest distance between some instants of a motion and all of another.
    fn apart(
        &self,
        fine: &DiscreteTrajectory,
        places: &[usize],
        coarse: &DiscreteTrajectory,
    ) -> Apart {
        let model = self.model;
        let [of_fine, of_coarse] = [fine, coarse].map(|one| Trajectory::from_discrete(model, one));
        let place = distance_between(model, (fine, &of_fine), places, (coarse, &of_coarse));
        let fine = solved_of(model, fine, of_fine, None);
        let coarse = solved_of(model, coarse, of_coarse, None);
        let each = places.iter().enumerate();
        let distances = each.map(|(k, &place)| Distance::between(model, &fine, place, &coarse, k));
        let greatest = distances.fold(Distance::default(), Distance::max);
        let size = greatest.size(model);
        Apart { size, place }
    }
}

/// A motion in steps between other times; none where a step fails.
pub(super) fn repeated(
    solving: Solving,
    model: &Model,
    drive: &dyn Drive,
    discrete: &DiscreteTrajectory,
    times: &[f64],
) -> Option<DiscreteTrajectory> {
    let (begun, lengths) = (at_start(discrete), Lengths::Between(times));
    let each = |_: &DiscreteTrajectory| ControlFlow::Continue(());
    let (motion, failure) = go_on(solving, model, begun, lengths, drive, each);
    let is_whole = failure.is_none() && motion.times.len() == times.len();
    is_whole.then_some(motion)
}

/// A motion before its first step.
fn at_start(discrete: &DiscreteTrajectory) -> DiscreteTrajectory {
    let mut start = DiscreteTrajectory {
        times: vec![0.0],
        z: discrete.z[..1].to_vec(),
        momenta: discrete.momenta[..1].to_vec(),
        rates: discrete.rates.clone(),
        ..DiscreteTrajectory::default()
    };
    start.end.of.clone_from(&discrete.end.of);
    start
}

/// Returns true if almost all of the time has steps of two of the finer ones, and enough of them that their order shows.
fn are_doubled(finer: &[f64], coarser: &[f64]) -> bool {
    let is_alone = |ends: &&[f64]| {
        let first = finer.partition_point(|&time| time < ends[0]);
        let parts = finer[first..].windows(2);
        let parts = parts.take_while(|part| part[0] < ends[1]);
        let longest = parts.map(|part| part[1] - part[0]).fold(0.0, f64::max);
        longest > LARGEST_PART * (ends[1] - ends[0])
    };
    let alone = coarser.windows(2).filter(is_alone);
    let alone: f64 = alone.map(|ends| ends[1] - ends[0]).sum();
    let whole = coarser[coarser.len() - 1] - coarser[0];
    coarser.len() > FEWEST && alone <= MOST_ALONE * whole
}

/// Times with one in the middle of each two.
pub(super) fn halved(times: &[f64]) -> Vec<f64> {
    let first = times.first().copied();
    let others = times.windows(2);
    let others = others.flat_map(|ends| [0.5 * (ends[0] + ends[1]), ends[1]]);
    first.into_iter().chain(others).collect()
}

/// Ratios of two distances that show the order two.
const OF_ORDER_TWO: RangeInclusive<f64> = 2.5..=6.5;
/// Distances below this are rounding, in rad and lengths of the system.
const ROUNDING: f64 = 1e-11;

/// The error of a motion, estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedError {
    /// Its greatest distance from the exact motion, in rad and lengths of the system.
    pub error: f64,
    /// The same of its points alone, in mm.
    pub place: f64,
    /// True if a second refinement shows the order of the method.
    pub is_confirmed: bool,
}

/// Greatest distance between two motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Apart {
    /// In rad and lengths of the system.
    pub(crate) size: f64,
    /// Of points, in mm.
    pub(crate) place: f64,
}

impl EstimatedError {
    /// Returns true if it is confirmed to be no greater than a tolerance.
    pub(crate) fn is_below(&self, tolerance: f64) -> bool {
        self.is_confirmed && self.error <= tolerance
    }

    /// Of the finest of three motions, each in steps of half the length: from the distance `before` between the first two and `last`
    /// between the last two.
    pub(crate) fn of_finest(before: Apart, last: Apart) -> Self {
        let ratio = before.size / last.size;
        let is_rounding = before.size.max(last.size) < ROUNDING;
        let part = match ratio.is_finite() {
            true => 1.0 / (ratio.clamp(1.5, 4.0) - 1.0),
            false => 1.0,
        };
        Self {
            error: part * last.size,
            place: part * last.place,
            is_confirmed: is_rounding || OF_ORDER_TWO.contains(&ratio),
        }
    }

    /// Of the first of three motions.
    pub(crate) fn of_first(before: Apart, last: Apart) -> Self {
        let finest = Self::of_finest(before, last);
        Self {
            error: finest.error + last.size + before.size,
            place: finest.place + last.place + before.place,
            ..finest
        }
    }
}
