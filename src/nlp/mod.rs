//! A nonlinear program: minimise f(x) subject to g_L ≤ g(x) ≤ g_U and x_L ≤ x ≤ x_U.

pub mod differences;
pub mod joined;
pub(crate) mod squares;

use std::fmt;

/// Lower and upper bounds, one of each per entry; ±∞ where there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

impl Bounds {
    /// No bounds of a number of entries.
    pub fn none(count: usize) -> Self {
        Self {
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
        }
    }

    /// Number of entries.
    pub const fn count(&self) -> usize {
        self.lower.len()
    }

    /// Returns true if both bounds of entry `i` are equal.
    pub fn are_equal(&self, i: usize) -> bool {
        self.lower[i] == self.upper[i]
    }

    /// Adds the bounds of one more entry.
    pub fn push(&mut self, lower: f64, upper: f64) {
        self.lower.push(lower);
        self.upper.push(upper);
    }

    /// Moves values that are outside to the nearest bound.
    pub fn keep(&self, values: &mut [f64]) {
        for ((x, lower), upper) in values.iter_mut().zip(&self.lower).zip(&self.upper) {
            if *x < *lower {
                *x = *lower;
            } else if *x > *upper {
                *x = *upper;
            }
        }
    }

    /// Distance of entry `i` from its bounds with a value; infinite of a value that is no finite number.
    pub fn excess(&self, i: usize, value: f64) -> f64 {
        match value.is_finite() {
            true => (self.lower[i] - value).max(value - self.upper[i]).max(0.0),
            false => f64::INFINITY,
        }
    }

    /// Greatest distance of values from their bounds; infinite where one of them is no finite number.
    pub fn violation(&self, values: &[f64]) -> f64 {
        let excesses = values.iter().enumerate().map(|(i, &v)| self.excess(i, v));
        excesses.fold(0.0, f64::max)
    }
}

/// Places of the stored entries of a sparse matrix, zero-based; a place listed twice counts as a sum.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entries {
    /// Row of each entry.
    pub rows: Vec<u32>,
    /// Column of each entry.
    pub cols: Vec<u32>,
}

impl Entries {
    /// Number of entries.
    pub const fn count(&self) -> usize {
        self.rows.len()
    }

    /// Adds an entry.
    pub fn push(&mut self, row: usize, col: usize) {
        self.rows.push(row as u32);
        self.cols.push(col as u32);
    }

    /// Row and column of each entry.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let places = self.rows.iter().zip(&self.cols);
        places.map(|(&row, &col)| (row as usize, col as usize))
    }

    /// Row, column and value of each entry.
    pub fn with<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = (usize, usize, f64)> {
        let entries = self.places().zip(values);
        entries.map(|((row, col), &value)| (row, col, value))
    }

    /// Adds Aᵀ v to a list.
    pub fn add_transposed(&self, values: &[f64], v: &[f64], to: &mut [f64]) {
        for (row, col, value) in self.with(values) {
            to[col] += value * v[row];
        }
    }
}

/// Position of a variable along a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// In a stage; equations couple neighbouring ones.
    Of(u32),
    /// In a stage, as the multiplier of a constraint: it enters its equations linearly.
    Multiplier(u32),
    /// In none: it couples all of them.
    Border,
}

/// Minimise f(x) subject to g_L ≤ g(x) ≤ g_U and x_L ≤ x ≤ x_U.
///
/// Structures never change during the life of the object; bounds may change between solves. A quantity that does not exist at `x`
/// (an inverted element, a muscle of no length) is written as NaN; solvers then step back.
pub trait Nlp {
    /// Bounds of the variables.
    fn variables(&self) -> &Bounds;
    /// Bounds of the constraints; an equality has equal bounds.
    fn constraints(&self) -> &Bounds;
    /// Places of the constraint Jacobian ∇g.
    fn jacobian_structure(&self) -> Entries;
    /// Places of the Lagrangian Hessian, lower triangle.
    fn hessian_structure(&self) -> Entries;
    /// f(x).
    fn objective(&mut self, x: &[f64]) -> f64;
    /// ∇f(x).
    fn gradient(&mut self, x: &[f64], grad: &mut [f64]);
    /// g(x).
    fn constraint(&mut self, x: &[f64], g: &mut [f64]);
    /// Values of ∇g(x) at the places of `jacobian_structure`.
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]);
    /// Values of σ ∇²f(x) + Σ yᵢ ∇²gᵢ(x) at the places of `hessian_structure`.
    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]);
    /// Factor that brings f near 1, so that a tolerance means the same whatever f is measured in.
    fn objective_scale(&self) -> f64 {
        1.0
    }
    /// Stage of each variable, where there is a horizon: linear systems are solved along it.
    fn stages(&self) -> Option<Vec<Stage>> {
        None
    }
    /// Variables x ≥ 0 that enter f and g by their squares alone, to the first power: a solver may take the squares as unknowns. A bound that x
    /// reaches at zero, where no function has a slope by x, is then one like any other.
    fn squares(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Returns the name of variable `i`, for messages.
    fn variable_name(&self, i: usize) -> String {
        format!("x[{i}]")
    }
    /// Returns the name of constraint `i`, for messages.
    fn constraint_name(&self, i: usize) -> String {
        format!("g[{i}]")
    }
}

/// ∂/∂x of s f + Σ yᵢ gᵢ with a factor s of the objective.
pub(crate) fn slopes(
    program: &mut dyn Nlp,
    jacobian: &Entries,
    scale: f64,
    x: &[f64],
    y: &[f64],
) -> Vec<f64> {
    let mut slopes = vec![0.0; x.len()];
    program.gradient(x, &mut slopes);
    slopes.iter_mut().for_each(|slope| *slope *= scale);
    let mut values = vec![0.0; jacobian.count()];
    program.jacobian(x, &mut values);
    jacobian.add_transposed(&values, y, &mut slopes);
    slopes
}

impl<N: Nlp + ?Sized> Nlp for &mut N {
    fn variables(&self) -> &Bounds {
        (**self).variables()
    }

    fn constraints(&self) -> &Bounds {
        (**self).constraints()
    }

    fn jacobian_structure(&self) -> Entries {
        (**self).jacobian_structure()
    }

    fn hessian_structure(&self) -> Entries {
        (**self).hessian_structure()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        (**self).objective(x)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        (**self).gradient(x, grad);
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        (**self).constraint(x, g);
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        (**self).jacobian(x, values);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        (**self).hessian(x, sigma, costates, values);
    }

    fn objective_scale(&self) -> f64 {
        (**self).objective_scale()
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        (**self).stages()
    }

    fn squares(&self) -> Vec<usize> {
        (**self).squares()
    }

    fn variable_name(&self, i: usize) -> String {
        (**self).variable_name(i)
    }

    fn constraint_name(&self, i: usize) -> String {
        (**self).constraint_name(i)
    }
}

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
