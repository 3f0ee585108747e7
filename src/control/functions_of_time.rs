//! Functions of time that a problem gives, where the duration may be an unknown.
//!
//! With a given duration their values are data. With a free one the times of instants and intervals follow from the interval length, and so
//! do the values; without jumps they have derivatives.

use crate::control::numbering::Column;
use crate::control::problem::{Control, Duration, Voltages};
use crate::math::Signal;
use crate::model::{Model, Time};

impl Duration {
    /// Time in ms of a jump of a function of time, where it is after the start and before the longest of several durations.
    pub fn jump(self, function: &Signal) -> Option<f64> {
        match self {
            Self::Given(_) => None,
            Self::Free { max, .. } => function.jump().filter(|&time| 0.0 < time && time < max),
        }
    }

    /// Value of a function of time at the end; `None` where it differs from duration to duration.
    pub fn final_value(self, function: &Signal) -> Option<f64> {
        match self {
            Self::Given(end) => Some(function.at(end)),
            Self::Free { min, max, .. } => function.constant_within([min, max]),
        }
    }
}

impl Control {
    /// The function of time that gives the input of a source, where one that is not constant does.
    pub fn function(&self, source: usize) -> Option<&Signal> {
        let of_course = || match &self.course {
            Some(Voltages::Signals(signals)) if self.is_given(source) => signals.get(source),
            _ => None,
        };
        let function = self.given.get(&source).or_else(of_course);
        function.filter(|function| !function.is_constant())
    }

    /// Returns true if an input is a function of a time that is an unknown.
    pub fn follows_time(&self, source: usize) -> bool {
        matches!(self.duration, Duration::Free { .. }) && self.function(source).is_some()
    }

    /// The function of time that the variable of a column follows, where the time is an unknown.
    pub(in crate::control) fn followed<'a>(
        &'a self,
        model: &'a Model,
        column: Column,
    ) -> Option<&'a Signal> {
        let Duration::Free { .. } = self.duration else {
            return None;
        };
        match column {
            Column::Instant { i, .. } => {
                let mut motions = model.prescribed.iter();
                let one = motions.find(|one| one.coordinate == i)?;
                Some(&one.motion).filter(|motion| !motion.is_constant())
            }
            Column::Interval { s, .. } => {
                self.function(model.variables.of(Time::Interval)[s].source?)
            }
            Column::Parameter { .. } | Column::Horizon => None,
        }
    }
}
