//! What the linear systems of a solve took.

use crate::ipopt::no_stages::NoStages;
use crate::ipopt::status::Status;
use crate::kkt::Statistics;

/// What the linear systems of a solve took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Who solved them: `stages`, or a name that Ipopt knows.
    pub solver: String,
    /// Why it was not `stages`, which nothing spoke against but this Ipopt.
    pub why_not: Option<NoStages>,
    /// What that did; known of `stages` alone.
    pub stages: Option<StagesReport>,
}

/// What the linear solver along the horizon did in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StagesReport {
    /// Patterns analysed: 1, or 0 where the pattern was that of the solve before.
    pub analyses: usize,
    /// Factorisations, solutions and their errors.
    pub statistics: Statistics,
    /// Why the last factorisation was left off in its midst, if it was.
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
    /// What made the linear systems take longer than they might.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let instead = self
            .why_not
            .map(|why| format!("linear systems were solved by MUMPS, which takes longer: {why}"));
        instead.or_else(|| self.whole_systems())
    }

    /// Why factorisations took long, where most of their time went into systems that were not condensed although others were.
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
