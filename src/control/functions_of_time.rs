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
    /// The function of time that gives the input of a source, where one does.
    pub fn function(&self, source: usize) -> Option<&Signal> {
        let of_course = || match &self.course {
            Some(Voltages::Signals(signals)) if self.is_given(source) => signals.get(source),
            _ => None,
        };
        self.given.get(&source).or_else(of_course)
    }

    /// Returns true if an input is a function of a time that is an unknown.
    pub fn follows_time(&self, source: usize) -> bool {
        let is_free = matches!(self.duration, Duration::Free { .. });
        let function = self.function(source).filter(|_| is_free);
        function.is_some_and(|function| !function.is_constant())
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
        let function = match column {
            Column::Instant { i, .. } => {
                let mut motions = model.prescribed.iter();
                motions
                    .find(|one| one.coordinate == i)
                    .map(|one| &one.motion)
            }
            Column::Interval { s, .. } => {
                self.function(model.variables.of(Time::Interval)[s].source?)
            }
            Column::Parameter { .. } | Column::Horizon => None,
        };
        function.filter(|function| !function.is_constant())
    }
}
