//! Reasons why the discrete optimum is not a motion of the system.

use crate::workflow::distance::Distance;

/// Reason why the discrete optimum is not a motion of the system.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// In one interval it is another root of the equations of a step than a step forward finds.
    Root {
        /// The interval, from 0.
        interval: usize,
        /// Its time in s.
        time: f64,
        /// The joint that turns farthest in it, and its angle in rad.
        turns: Option<(String, f64)>,
        /// Distance of the simulation from the optimum after it.
        distance: Distance,
    },
    /// It violates a closing constraint that was left out.
    Open {
        /// The constraint.
        constraint: String,
        /// Its violation, in rad or relative to the length of the system.
        gap: f64,
    },
    /// A simulation with this number of steps for an interval ends early.
    Ends {
        /// Steps for an interval.
        steps: usize,
        /// Reason.
        failure: String,
    },
    /// Rounding grows until the motion is another one.
    Unstable {
        /// Rate of growth in 1/s.
        rate: f64,
        /// Greatest distance from the optimum.
        distance: Distance,
    },
    /// The grid does not resolve the motion.
    Coarse {
        /// Estimated error as a part of the path length.
        error: f64,
        /// Greatest distance from the optimum with finer steps.
        distance: Distance,
        /// True if two refinements agree on it.
        is_confirmed: bool,
    },
}

impl Cause {
    /// In words.
    pub(crate) fn message(&self) -> String {
        match self {
            Self::Root {
                interval,
                time,
                turns,
                distance,
            } => {
                let turn = turns.as_ref().map_or(String::new(), |(joint, angle)| {
                    format!(", where joint \"{joint}\" turns by {angle:.2} rad")
                });
                format!(
                    "forward simulation under the optimal inputs gives another motion: in interval {interval} (from \
                     {time:.4} s){turn}, the equations have several roots, and the optimum has another one than a forward step \
                     ({distance} apart after it); the intervals are too long for the motion"
                )
            }
            Self::Open { constraint, gap } => format!(
                "the optimum opens a loop: {constraint} was left out, as it follows from the others near the reference, and is violated by \
                 {gap:.1e} (rad, or of the length of the system)"
            ),
            Self::Ends { steps: 1, failure } => {
                format!("forward simulation under the optimal inputs ends early: {failure}")
            }
            Self::Ends { steps, failure } => format!(
                "forward simulation under the optimal inputs with {steps} steps per interval ends early: {failure}"
            ),
            Self::Unstable { rate, distance } => format!(
                "forward simulation under the optimal inputs leaves the optimum ({distance}): the motion is unstable, round-off grows at a rate of {rate:.3} 1/s"
            ),
            Self::Coarse {
                error,
                distance,
                is_confirmed,
            } => {
                let further = match is_confirmed {
                    true => "",
                    false => {
                        "; steps that are still finer lead elsewhere, so that more is possible"
                    }
                };
                format!(
                    "the intervals do not resolve the motion: under the same inputs the motion with finer steps deviates \
                     from it by up to {:.0} % of the path length ({distance}){further}",
                    100.0 * error
                )
            }
        }
    }
}
