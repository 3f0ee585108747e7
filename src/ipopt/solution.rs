//! Starting point, iterations, result and linear systems of a solve, and values of its options.

use crate::kkt::Statistics;
use crate::nlp::{Multipliers, Status};
use std::fmt;
use std::ops::AddAssign;
use thiserror::Error;

/// A point to start from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartingPoint {
    /// The variables.
    pub x: Vec<f64>,
    /// Their multipliers, read by the starts of [`Start`](crate::ipopt::Start) that keep them.
    pub costates: Option<Multipliers>,
}

/// One line of the iteration log, reported after the iterate was accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Number of the iteration; the starting point is number zero.
    pub iteration: usize,
    /// f(x), or the objective of the restoration phase.
    pub objective: f64,
    /// Greatest violation of a constraint, where an inequality is an equality with a slack variable.
    pub primal_infeasibility: f64,
    /// Greatest entry of the gradient of the Lagrangian.
    pub dual_infeasibility: f64,
    /// Barrier parameter.
    pub mu: f64,
    /// Greatest entry of the step in the variables.
    pub step_norm: f64,
    /// Number that was added to the diagonal of the Hessian to make the step a descent direction.
    pub regularization: f64,
    /// Fraction of the step taken in the bound multipliers.
    pub alpha_dual: f64,
    /// Fraction of the step taken in the variables.
    pub alpha_primal: f64,
    /// Points tried until one was accepted.
    pub line_search_trials: usize,
    /// True in the restoration phase, which minimises the violation of the constraints instead of f.
    pub restoration: bool,
}

/// Wall time in seconds, and where it went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seconds {
    /// Seconds from the first to the last instruction of Ipopt; waiting for another solve to end is not part of them.
    pub total: f64,
    /// Inside Ipopt and its linear solver: `total` less all of the following.
    pub solver: f64,
    /// Evaluating f.
    pub objective: f64,
    /// Evaluating ∇f.
    pub gradient: f64,
    /// Evaluating g.
    pub constraints: f64,
    /// Evaluating ∇g.
    pub jacobian: f64,
    /// Evaluating the Hessian of the Lagrangian.
    pub hessian: f64,
    /// Spent by the observer.
    pub observer: f64,
}

impl AddAssign for Seconds {
    fn add_assign(&mut self, other: Self) {
        self.total += other.total;
        self.solver += other.solver;
        self.objective += other.objective;
        self.gradient += other.gradient;
        self.constraints += other.constraints;
        self.jacobian += other.jacobian;
        self.hessian += other.hessian;
        self.observer += other.observer;
    }
}

/// Number of evaluations of each quantity by Ipopt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evaluations {
    /// Times f was evaluated.
    pub objective: usize,
    /// Times ∇f was evaluated.
    pub gradient: usize,
    /// Times g was evaluated.
    pub constraints: usize,
    /// Times ∇g was evaluated.
    pub jacobian: usize,
    /// Times the Hessian of the Lagrangian was evaluated.
    pub hessian: usize,
}

impl AddAssign for Evaluations {
    fn add_assign(&mut self, other: Self) {
        self.objective += other.objective;
        self.gradient += other.gradient;
        self.constraints += other.constraints;
        self.jacobian += other.jacobian;
        self.hessian += other.hessian;
    }
}

/// Result of a solve, whatever its status.
///
/// If the status is not [`is_solved`](Status::is_solved), `x` is the point at which Ipopt gave up or the latest iterate it
/// had reported, whichever violates constraints and bounds less; a point where f or g does not exist counts as worst.
/// The two differ if Ipopt gave up on the way to the next iterate, for instance for want of a derivative there.
/// `costates` are those of Ipopt, but of a solve that was stopped between two iterates: there they are those of the latest iterate, where
/// the multipliers of bounds are the barrier parameter over the distance.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverResult {
    /// Status at the end of the solve.
    pub status: Status,
    /// The variables.
    pub x: Vec<f64>,
    /// f(x).
    pub objective: f64,
    /// g(x).
    pub constraints: Vec<f64>,
    /// Multipliers of constraints and bounds; zero where Ipopt left something that is not a number.
    pub costates: Multipliers,
    /// One record per iteration.
    pub iterations: Vec<Iteration>,
    /// Seconds of each part.
    pub seconds: Seconds,
    /// Name of the solver of the linear systems.
    pub linear: LinearReport,
    /// Number of evaluations of each quantity.
    pub evaluations: Evaluations,
    /// Number of evaluations that met NaN or ±∞, so that the solver stepped back.
    pub failed_evaluations: usize,
}

impl SolverResult {
    /// Nothing is known yet of a program of n variables and m constraints.
    pub(super) fn of_zeros(n: usize, m: usize) -> Self {
        let mut costates = Multipliers::default();
        costates.reset(n, m);
        Self {
            status: Status::Internal,
            x: vec![0.0; n],
            objective: 0.0,
            constraints: vec![0.0; m],
            costates,
            iterations: Vec::new(),
            seconds: Seconds::default(),
            linear: LinearReport::default(),
            evaluations: Evaluations::default(),
            failed_evaluations: 0,
        }
    }

    /// The point to start a related problem from.
    #[must_use]
    pub fn to_point(&self) -> StartingPoint {
        StartingPoint {
            x: self.x.clone(),
            costates: Some(self.costates.clone()),
        }
    }
}

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

/// A value of an Ipopt option.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionValue {
    /// Integer option.
    Integer(i32),
    /// Real option.
    Number(f64),
    /// Text option.
    Text(String),
}

impl fmt::Display for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value:?}"),
            Self::Text(value) => write!(f, "\"{value}\""),
        }
    }
}

/// Version of the Ipopt that the program was built with.
pub const VERSION: &str = env!("PROBOSCIS_IPOPT");

/// Reason why this Ipopt does not take the linear solver along the horizon.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum NoStages {
    /// Nothing can be in the place of MA57.
    #[error("this Ipopt ({VERSION}) was built to load no linear solvers")]
    WithoutMa57,
    /// Nothing takes the functions.
    #[error("this Ipopt ({VERSION}) shows no function that takes a linear solver")]
    WithoutSetter,
}
