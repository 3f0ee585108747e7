//! Which unknowns and equations a horizon has: the one place that drops what is given.
//!
//! Interleaved step by step: coordinates and multipliers of instant k, then the scalars of interval k; the interval
//! length last. Given coordinates and voltages are no variables; the constraints of an instant are equations only where one of its
//! coordinates is a variable.

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    /// Coordinate or multiplier `i` of instant `k`.
    Unknown {
        /// Instant.
        k: usize,
        /// Entry of z.
        i: usize,
    },
    /// Scalar `s` of interval `k`: a voltage, or a potential.
    Scalar {
        /// Interval.
        k: usize,
        /// Which scalar.
        s: usize,
    },
    /// The interval length.
    Horizon,
}

/// An equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// Row of coordinate `i` (momentum balance) or of multiplier `i` (constraint) of instant `k`.
    Equation {
        /// Instant.
        k: usize,
        /// Entry of z.
        i: usize,
    },
    /// Gauss's law of the potential that is scalar `s` of interval `k`.
    Gauss {
        /// Interval.
        k: usize,
        /// Which scalar.
        s: usize,
    },
    /// Limit or goal `limit` at instant or interval `k`.
    Limit {
        /// Index of the limit.
        limit: usize,
        /// Instant or interval.
        k: usize,
    },
}

/// How many entries the instants and intervals of a horizon have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Number of intervals.
    pub intervals: usize,
    /// Coordinates of an instant.
    pub coordinates: usize,
    /// Coordinates and multipliers of an instant.
    pub unknowns: usize,
    /// Voltages of an interval.
    pub voltages: usize,
    /// Voltages and potentials of an interval.
    pub scalars: usize,
}

/// Variables and equations of a horizon of `intervals`.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// All variables, in order.
    pub variables: Vec<Variable>,
    /// All equations, in order; limits follow where they are added.
    pub rows: Vec<Row>,
    of_unknown: Vec<Option<usize>>,
    of_scalar: Vec<Option<usize>>,
    row_of_scalar: Vec<Option<usize>>,
    of_horizon: Option<usize>,
    row_of: Vec<Option<usize>>,
    unknowns: usize,
    scalars: usize,
}

impl Numbering {
    /// `given(k, i)` says whether coordinate i of instant k is given, `balanced(k, i)` whether its momentum balance is an
    /// equation, `prescribed(s)` whether voltage s is given.
    pub fn new(
        counts: Counts,
        free_horizon: bool,
        given: impl Fn(usize, usize) -> bool,
        balanced: impl Fn(usize, usize) -> bool,
        prescribed: impl Fn(usize) -> bool,
    ) -> Self {
        let Counts {
            intervals,
            coordinates,
            unknowns,
            voltages,
            scalars,
        } = counts;
        let mut out = Self {
            variables: Vec::new(),
            rows: Vec::new(),
            of_unknown: vec![None; (intervals + 1) * unknowns],
            of_scalar: vec![None; intervals * scalars],
            row_of_scalar: vec![None; intervals * scalars],
            of_horizon: None,
            row_of: vec![None; (intervals + 1) * unknowns],
            unknowns,
            scalars,
        };
        for k in 0..=intervals {
            let all_given = (0..coordinates).all(|i| given(k, i));
            for i in 0..unknowns {
                let is_coordinate = i < coordinates;
                if !is_coordinate || !given(k, i) {
                    out.of_unknown[k * unknowns + i] = Some(out.variables.len());
                    out.variables.push(Variable::Unknown { k, i });
                }
                let is_row = match is_coordinate {
                    true => balanced(k, i),
                    false => !all_given,
                };
                if is_row {
                    out.row_of[k * unknowns + i] = Some(out.rows.len());
                    out.rows.push(Row::Equation { k, i });
                }
            }
            if k < intervals {
                for s in (0..scalars).filter(|&s| !prescribed(s)) {
                    out.of_scalar[k * scalars + s] = Some(out.variables.len());
                    out.variables.push(Variable::Scalar { k, s });
                    if s >= voltages {
                        out.row_of_scalar[k * scalars + s] = Some(out.rows.len());
                        out.rows.push(Row::Gauss { k, s });
                    }
                }
            }
        }
        if free_horizon {
            out.of_horizon = Some(out.variables.len());
            out.variables.push(Variable::Horizon);
        }
        out
    }

    /// Variable of entry i of z at instant k.
    pub fn unknown(&self, k: usize, i: usize) -> Option<usize> {
        self.of_unknown[k * self.unknowns + i]
    }

    /// Variable of scalar s of interval k; a given voltage is none.
    pub fn scalar(&self, k: usize, s: usize) -> Option<usize> {
        self.of_scalar[k * self.scalars + s]
    }

    /// Row of scalar s of interval k, where it is a potential.
    pub fn row_of_scalar(&self, k: usize, s: usize) -> Option<usize> {
        self.row_of_scalar[k * self.scalars + s]
    }

    /// Variable of the interval length.
    pub fn horizon(&self) -> Option<usize> {
        self.of_horizon
    }

    /// Row of entry i of z at instant k.
    pub fn row(&self, k: usize, i: usize) -> Option<usize> {
        self.row_of[k * self.unknowns + i]
    }
}
