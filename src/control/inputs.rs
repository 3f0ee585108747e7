//! Voltages and loads as functions of time: constants, rows of a table or a solution, or one function for each source.

use crate::math::{Signal, in_order};
use crate::model::System;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Voltages and loads over time (V, N, N mm): a function of time for each source.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Voltages {
    /// The functions, by source.
    pub signals: Vec<Signal>,
    /// The end of the table that those in steps are read from.
    pub table: Option<TableEnd>,
}

/// The end of a table of voltages, or of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct TableEnd {
    /// Its time in ms.
    pub time: f64,
    /// Role of the voltages from then on.
    pub afterwards: Afterwards,
    /// The solution; none of a table in the problem.
    pub solution: Option<PathBuf>,
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
    /// The same all the time.
    pub fn constant(row: &[f64]) -> Self {
        let signals = row.iter().copied().map(Signal::Constant);
        signals.collect::<Vec<_>>().into()
    }

    /// The solution that they are from.
    pub fn solution(&self) -> Option<&Path> {
        self.table.as_ref()?.solution.as_deref()
    }

    /// Voltages of the sources at a time in ms.
    pub fn at(&self, time: f64) -> Vec<f64> {
        self.signals.iter().map(|signal| signal.at(time)).collect()
    }

    /// Returns true if none changes.
    pub fn are_constant(&self) -> bool {
        self.signals.iter().all(Signal::is_constant)
    }

    /// Returns true if they are constant between the ends of rows.
    pub fn are_constant_by_rows(&self) -> bool {
        let mut signals = self.signals.iter();
        signals.all(|signal| signal.is_constant() || matches!(signal, Signal::Steps { .. }))
    }

    /// Rates per ms of the voltages of the sources at a time in ms.
    pub fn rates(&self, time: f64) -> Vec<f64> {
        let rate = |signal: &Signal| signal.derivatives(time)[1];
        self.signals.iter().map(rate).collect()
    }

    /// The same with some sources that follow other functions of time.
    #[must_use]
    pub fn with(mut self, others: BTreeMap<usize, Signal>) -> Self {
        for (source, signal) in others {
            self.signals[source] = signal;
        }
        self
    }

    /// The same with a factor of each source.
    #[must_use]
    pub fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let mut out = self.clone();
        for (source, signal) in out.signals.iter_mut().enumerate() {
            *signal = signal.scaled(factor(source));
        }
        out
    }

    /// Returns true if the voltage of a source is ever other than zero.
    pub fn drive(&self, source: usize) -> bool {
        !self.signals[source].is_zero()
    }

    /// The earliest time in ms after which a table among them says nothing more.
    pub fn last_known(&self) -> Option<f64> {
        let table = self.table.as_ref();
        let table = table.filter(|table| table.afterwards == Afterwards::OfLastInterval);
        let others = self.signals.iter().filter_map(Signal::last_known);
        others.chain(table.map(|table| table.time)).reduce(f64::min)
    }

    /// Times in ms at which they may switch, or have a corner.
    pub fn switches(&self) -> Vec<f64> {
        in_order(self.signals.iter().flat_map(Signal::corners))
    }
}

impl From<Vec<Signal>> for Voltages {
    fn from(signals: Vec<Signal>) -> Self {
        Self {
            signals,
            table: None,
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
