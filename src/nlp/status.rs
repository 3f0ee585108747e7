//! Status of a solve at its end.
//!
//! Multipliers of constraints and bounds.

use std::fmt;

/// Status of a solve at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// A point satisfies the optimality conditions to the tolerance asked for.
    Solved,
    /// A point satisfies the optimality conditions to the weaker "acceptable" tolerance, and no further progress was seen.
    Acceptable,
    /// The violation of the constraints has a local minimum that is not zero: locally, the problem has no solution.
    Infeasible,
    /// The steps became too small to change the variables.
    SearchDirectionTooSmall,
    /// The variables grow without bound.
    Diverging,
    /// The observer or Ctrl-C asked to stop.
    Interrupted,
    /// A feasible point of a square problem was found.
    FeasiblePoint,
    /// The iterations allowed are used up.
    IterationLimit,
    /// The time allowed is used up.
    TimeLimit,
    /// The restoration phase could not bring the iterate back towards feasibility.
    RestorationFailed,
    /// The linear system of a step could not be solved.
    StepFailed,
    /// A function or derivative could not be evaluated at a point where it has to exist.
    InvalidNumber,
    /// There are more equality constraints tha free variables.
    TooFewDegreesOfFreedom,
    /// The options contradict each other or ask for something that this build of Ipopt does not have.
    InvalidOption,
    /// The problem contradicts itself, for instance by a lower bound above its upper bound.
    InvalidProblem,
    /// Memory ran out.
    OutOfMemory,
    /// Ipopt failed for a reason of its own.
    Internal,
}

impl Status {
    /// True if the point returned can be taken for a solution: `Solved`, `Acceptable` or `FeasiblePoint`.
    #[must_use]
    pub const fn is_solved(self) -> bool {
        matches!(self, Self::Solved | Self::Acceptable | Self::FeasiblePoint)
    }

    /// True if it minimises an objective, at least to the "acceptable" tolerance.
    #[must_use]
    pub const fn is_optimal(self) -> bool {
        matches!(self, Self::Solved | Self::Acceptable)
    }

    /// True if the optimality conditions hold to a tolerance, or as far as rounding allows.
    #[must_use]
    pub const fn is_stationary(self) -> bool {
        self.is_optimal() || matches!(self, Self::SearchDirectionTooSmall)
    }

    /// One word in snake case, for `summary.json`.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Acceptable => "acceptable",
            Self::Infeasible => "infeasible",
            Self::SearchDirectionTooSmall => "search_direction_too_small",
            Self::Diverging => "diverging",
            Self::Interrupted => "interrupted",
            Self::FeasiblePoint => "feasible_point",
            Self::IterationLimit => "iteration_limit",
            Self::TimeLimit => "time_limit",
            Self::RestorationFailed => "restoration_failed",
            Self::StepFailed => "step_failed",
            Self::InvalidNumber => "invalid_number",
            Self::TooFewDegreesOfFreedom => "too_few_degrees_of_freedom",
            Self::InvalidOption => "invalid_option",
            Self::InvalidProblem => "invalid_problem",
            Self::OutOfMemory => "out_of_memory",
            Self::Internal => "internal",
        }
    }

    /// Meaning of an `ApplicationReturnStatus`.
    ///
    /// The numbers are the same in all versions of Ipopt; −5, the limit of wall time, came with 3.14.
    pub(crate) const fn from_code(code: i32) -> Self {
        match code {
            0 => Self::Solved,
            1 => Self::Acceptable,
            2 => Self::Infeasible,
            3 => Self::SearchDirectionTooSmall,
            4 => Self::Diverging,
            5 => Self::Interrupted,
            6 => Self::FeasiblePoint,
            -1 => Self::IterationLimit,
            -2 => Self::RestorationFailed,
            -3 => Self::StepFailed,
            -4 | -5 => Self::TimeLimit,
            -10 => Self::TooFewDegreesOfFreedom,
            -11 => Self::InvalidProblem,
            -12 => Self::InvalidOption,
            -13 => Self::InvalidNumber,
            -102 => Self::OutOfMemory,
            _ => Self::Internal,
        }
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// Multipliers of constraints and bounds, in the sign convention of Ipopt:
/// ∇f(x) + Σ yᵢ ∇gᵢ(x) − z_L + z_U = 0 with z_L, z_U ≥ 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Multipliers {
    /// y, one per constraint.
    pub constraints: Vec<f64>,
    /// z_L, one per variable.
    pub lower: Vec<f64>,
    /// z_U, one per variable.
    pub upper: Vec<f64>,
}

impl Multipliers {
    /// Makes them zeros of a program of n variables and m constraints.
    pub(crate) fn reset(&mut self, n: usize, m: usize) {
        let lengths = [
            (&mut self.constraints, m),
            (&mut self.lower, n),
            (&mut self.upper, n),
        ];
        for (values, length) in lengths {
            values.clear();
            values.resize(length, 0.0);
        }
    }

    /// Multiplies all by a factor; numbers that are not finite become zero.
    pub(crate) fn scale(&mut self, factor: f64) {
        for values in [&mut self.constraints, &mut self.lower, &mut self.upper] {
            for value in values {
                *value = if value.is_finite() {
                    *value * factor
                } else {
                    0.0
                };
            }
        }
    }
}
