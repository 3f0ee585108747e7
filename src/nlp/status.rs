//! Status of a solve at its end.
//!
//! Multipliers of constraints and bounds.

use std::fmt;

/// Declares the statuses, each with its word and with its numbers in Ipopt.
macro_rules! statuses {
    ($($(#[$doc:meta])* $name:ident = $word:literal: $codes:pat,)*) => {
        /// Status of a solve at its end.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Status {
            $($(#[$doc])* $name,)*
        }

        impl Status {
            /// One word in snake case, for `summary.json`.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$name => $word,)*
                }
            }

            /// Meaning of an `ApplicationReturnStatus`.
            ///
            /// The numbers are the same in all versions of Ipopt; −5, the limit of wall time, came with 3.14.
            pub(crate) const fn from_code(code: i32) -> Self {
                match code {
                    $($codes => Self::$name,)*
                }
            }
        }
    };
}

statuses! {
    /// A point satisfies the optimality conditions to the tolerance asked for.
    Solved = "solved": 0,
    /// A point satisfies the optimality conditions to the weaker "acceptable" tolerance, and no further progress was seen.
    Acceptable = "acceptable": 1,
    /// The violation of the constraints has a local minimum that is not zero: locally, the problem has no solution.
    Infeasible = "infeasible": 2,
    /// The steps became too small to change the variables.
    SearchDirectionTooSmall = "search_direction_too_small": 3,
    /// The variables grow without bound.
    Diverging = "diverging": 4,
    /// The observer or Ctrl-C asked to stop.
    Interrupted = "interrupted": 5,
    /// A feasible point of a square problem was found.
    FeasiblePoint = "feasible_point": 6,
    /// The iterations allowed are used up.
    IterationLimit = "iteration_limit": -1,
    /// The time allowed is used up.
    TimeLimit = "time_limit": -4 | -5,
    /// The restoration phase could not bring the iterate back towards feasibility.
    RestorationFailed = "restoration_failed": -2,
    /// The linear system of a step could not be solved.
    StepFailed = "step_failed": -3,
    /// A function or derivative could not be evaluated at a point where it has to exist.
    InvalidNumber = "invalid_number": -13,
    /// There are more equality constraints tha free variables.
    TooFewDegreesOfFreedom = "too_few_degrees_of_freedom": -10,
    /// The options contradict each other or ask for something that this build of Ipopt does not have.
    InvalidOption = "invalid_option": -12,
    /// The problem contradicts itself, for instance by a lower bound above its upper bound.
    InvalidProblem = "invalid_problem": -11,
    /// Memory ran out.
    OutOfMemory = "out_of_memory": -102,
    /// Ipopt failed for a reason of its own.
    Internal = "internal": _,
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
                *value = match value.is_finite() {
                    true => *value * factor,
                    false => 0.0,
                };
            }
        }
    }
}
