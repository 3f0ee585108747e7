//! Voltages and loads as functions of time: constants, rows of a table or a solution, or one function for each source.

use crate::math::{Signal, in_order};
use crate::model::System;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Voltages and loads over time (V, N, N mm; one per source).
#[derive(Clone, Debug, PartialEq)]
pub enum Voltages {
    /// The same in every interval.
    Constant(Vec<f64>),
    /// One row per interval of the given grid, and one for the time afterwards.
    Sampled {
        /// End of each interval in ms, increasing.
        ends: Vec<f64>,
        /// Rows of voltages, one more than ends.
        rows: Vec<Vec<f64>>,
        /// Role of the last row.
        afterwards: Afterwards,
        /// Sources that follow functions of time instead: loads.
        others: BTreeMap<usize, Signal>,
        /// The solution they were read from; none of a table in the problem.
        solution: Option<PathBuf>,
    },
    /// A function of time for each source.
    Signals(Vec<Signal>),
}

/// Voltages after the end of a solution or table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Afterwards {
    /// Those that it says are held: of a solution those of its goal.
    Held,
    /// Those of its last interval: it names no others.
    OfLastInterval,
}

impl Voltages {
    /// The solution that they are from.
    pub fn solution(&self) -> Option<&Path> {
        match self {
            Self::Constant(_) | Self::Signals(_) => None,
            Self::Sampled { solution, .. } => solution.as_deref(),
        }
    }

    /// Voltages of the sources at a time in ms.
    pub fn at(&self, time: f64) -> Cow<'_, [f64]> {
        match self {
            Self::Constant(row) => Cow::Borrowed(row),
            Self::Signals(signals) => signals.iter().map(|signal| signal.at(time)).collect(),
            Self::Sampled {
                ends, rows, others, ..
            } => {
                let k = ends.iter().position(|&end| time < end);
                let row = &rows[k.unwrap_or(ends.len())];
                if others.is_empty() {
                    return Cow::Borrowed(row);
                }
                let mut row = row.clone();
                for (&source, signal) in others {
                    row[source] = signal.at(time);
                }
                Cow::Owned(row)
            }
        }
    }

    /// Returns true if they are constant between the ends of rows.
    pub fn are_constant_by_rows(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Sampled { others, .. } => others.values().all(Signal::is_constant),
            Self::Signals(signals) => signals.iter().all(Signal::is_constant),
        }
    }

    /// Rates per ms of the voltages of the sources at a time in ms.
    pub fn rates(&self, time: f64) -> Vec<f64> {
        let rate = |signal: &Signal| signal.derivatives(time)[1];
        match self {
            Self::Constant(row) => vec![0.0; row.len()],
            Self::Signals(signals) => signals.iter().map(rate).collect(),
            Self::Sampled { rows, others, .. } => {
                let of = |source| others.get(&source).map_or(0.0, rate);
                (0..rows[0].len()).map(of).collect()
            }
        }
    }

    /// A function of time for each source; constants where all of them are.
    pub fn of_signals(signals: Vec<Signal>) -> Self {
        let constants: Option<Vec<f64>> = signals.iter().map(Signal::constant).collect();
        constants.map_or(Self::Signals(signals), Self::Constant)
    }

    /// The same with some sources that follow functions of time.
    #[must_use]
    pub fn with(mut self, others: BTreeMap<usize, Signal>) -> Self {
        if others.is_empty() {
            return self;
        }
        let mut signals: Vec<Signal> = match &mut self {
            Self::Sampled { others: known, .. } => {
                known.extend(others);
                return self;
            }
            Self::Constant(row) => row.iter().copied().map(Signal::Constant).collect(),
            Self::Signals(signals) => std::mem::take(signals),
        };
        for (source, signal) in others {
            signals[source] = signal;
        }
        Self::of_signals(signals)
    }

    /// The same with a factor of each source.
    #[must_use]
    pub fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let mut out = self.clone();
        let scale = |row: &mut Vec<f64>| {
            let values = row.iter_mut().enumerate();
            values.for_each(|(source, value)| *value *= factor(source));
        };
        match &mut out {
            Self::Constant(row) => scale(row),
            Self::Sampled { rows, others, .. } => {
                rows.iter_mut().for_each(scale);
                for (&source, signal) in others {
                    *signal = signal.scaled(factor(source));
                }
            }
            Self::Signals(signals) => {
                for (source, signal) in signals.iter_mut().enumerate() {
                    *signal = signal.scaled(factor(source));
                }
            }
        }
        out
    }

    /// Returns true if the voltage of a source is ever other than zero.
    pub fn drive(&self, source: usize) -> bool {
        match self {
            Self::Constant(row) => row[source] != 0.0,
            Self::Sampled { rows, others, .. } => match others.get(&source) {
                Some(signal) => !signal.is_zero(),
                None => rows.iter().any(|row| row[source] != 0.0),
            },
            Self::Signals(signals) => !signals[source].is_zero(),
        }
    }

    /// The earliest time in ms after which a table among them says nothing more.
    pub fn last_known(&self) -> Option<f64> {
        let first = |ends: &mut dyn Iterator<Item = f64>| ends.reduce(f64::min);
        match self {
            Self::Constant(_) => None,
            Self::Sampled {
                ends,
                afterwards,
                others,
                ..
            } => {
                let own = ends.last().copied();
                let own = own.filter(|_| *afterwards == Afterwards::OfLastInterval);
                let others = others.values().filter_map(Signal::last_known);
                first(&mut own.into_iter().chain(others))
            }
            Self::Signals(signals) => first(&mut signals.iter().filter_map(Signal::last_known)),
        }
    }

    /// Times in ms at which they may switch, or have a corner.
    pub fn switches(&self) -> Cow<'_, [f64]> {
        match self {
            Self::Constant(_) => Cow::Borrowed(&[]),
            Self::Sampled { ends, others, .. } if others.is_empty() => Cow::Borrowed(ends),
            Self::Sampled { ends, others, .. } => {
                let others = others.values().flat_map(Signal::corners);
                Cow::Owned(in_order(ends.iter().copied().chain(others)))
            }
            Self::Signals(signals) => {
                Cow::Owned(in_order(signals.iter().flat_map(Signal::corners)))
            }
        }
    }
}

/// Loads that are neither given nor sought: zero all the time, by source.
pub fn absent_loads(
    system: &System,
    is_named: impl Fn(usize) -> bool,
) -> impl Iterator<Item = (usize, Signal)> {
    let loads = system.first_load()..system.sources().len();
    let absent = loads.filter(move |&source| !is_named(source));
    absent.map(|source| (source, Signal::Constant(0.0)))
}
