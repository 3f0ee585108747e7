//! Report of the linear systems of a solve.

use crate::ipopt::option_value::NoStages;
use crate::kkt::Statistics;
use crate::nlp::Status;

/// Report of the linear systems of a solve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Name of the linear solver: `stages`, or a name that Ipopt knows.
    pub solver: String,
    /// Reason why this Ipopt did not take `stages`, where nothing else was asked for.
    pub why_not: Option<NoStages>,
    /// Counts and times of `stages`; nothing for other solvers.
    pub stages: Option<StagesReport>,
}

/// Counts and times of the linear solver along the horizon in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StagesReport {
    /// Patterns analysed: 1, or 0 where the pattern was that of the solve before.
    pub analyses: usize,
    /// Factorisations, solutions and their errors.
    pub statistics: Statistics,
    /// Reason why the last factorisation was stopped before its end, if it was.
    pub stopped: Option<Status>,
    /// Seconds in analyses.
    pub analysis: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Factorisations of whole systems where others were condensed.
    pub wholes: usize,
    /// Seconds in these.
    pub whole: f64,
    /// Seconds in solutions.
    pub solution: f64,
}

/// Seconds in whole systems that a user has felt.
const FELT: f64 = 10.0;

impl LinearReport {
    /// Returns a note on the reason why the linear systems took longer than they might, if they did.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let instead = self
            .why_not
            .map(|why| format!("linear systems were solved by MUMPS, which takes longer: {why}"));
        instead.or_else(|| self.whole_systems())
    }

    /// Returns the reason why factorisations took long, where most of their time went into systems that were not condensed although others were.
    fn whole_systems(&self) -> Option<String> {
        let report = self.stages?;
        let statistics = report.statistics;
        (report.whole > FELT && 2.0 * report.whole > report.factorisation).then(|| {
            let why = match statistics.repeated < report.wholes {
                true => "could not be condensed, as in the restoration phase of Ipopt, which seeks a point that violates the equations less",
                false => "needed factors that are more exact than condensed ones",
            };
            format!(
                "{:.0} of {:.0} s in factorisations went into {} of {} linear systems that {why}",
                report.whole, report.factorisation, report.wholes, statistics.factorisations
            )
        })
    }
}
