//! Numbering of the columns and rows of a horizon: the one place that drops given values.
//!
//! Interleaved step by step: the variables of instant k, then those of interval k; free parameters and the interval length last. A variable has a column
//! unless start, goal or problem give its value, and a row if its role has an equation; the constraints of an instant are rows
//! only where one of its coordinates has a column.
//!
//! Sizes of the inputs, which scale their unknowns. They follow from the problem alone, so that similar robots have similar programs.

use crate::control::problem::Control;
use crate::model::system::{ElectricConstants, InputKind, Material, Muscle, Solid};
use crate::model::{Model, Role, System, Time, Variable, Variables};

/// A variable of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Variable `i` of instant `k`.
    Instant {
        /// Instant.
        k: usize,
        /// Entry of z.
        i: usize,
    },
    /// Variable `s` of interval `k`.
    Interval {
        /// Interval.
        k: usize,
        /// Scalar.
        s: usize,
    },
    /// Sought parameter, scalar `s` of every interval.
    Parameter {
        /// Scalar.
        s: usize,
    },
    /// The interval length.
    Horizon,
}

impl Column {
    /// Returns its variable.
    pub fn of(self, variables: &Variables) -> &Variable {
        match self {
            Self::Instant { i, .. } => &variables.of(Time::Instant)[i],
            Self::Interval { s, .. } | Self::Parameter { s } => &variables.of(Time::Interval)[s],
            Self::Horizon => &variables.of(Time::Horizon)[0],
        }
    }
}

/// An equation of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Row {
    /// Equation of variable `i` of instant `k`: momentum balance or constraint.
    Instant {
        /// Instant.
        k: usize,
        /// Entry of z.
        i: usize,
    },
    /// Equation of variable `s` of interval `k`: Gauss's law.
    Interval {
        /// Interval.
        k: usize,
        /// Scalar.
        s: usize,
    },
    /// That a variable has the value of a function of time, where times are unknowns.
    Time {
        /// Its place among such rows.
        place: usize,
        /// The variable.
        of: Column,
    },
    /// Limit or goal `limit` at instant or interval `k`.
    Limit {
        /// Index of the limit.
        limit: usize,
        /// Instant or interval.
        k: usize,
    },
}

impl Row {
    /// The variable whose equation it is.
    pub fn of(self, variables: &Variables) -> Option<&Variable> {
        match self {
            Self::Instant { i, .. } => Some(&variables.of(Time::Instant)[i]),
            Self::Interval { s, .. } => Some(&variables.of(Time::Interval)[s]),
            Self::Time { of, .. } => Some(of.of(variables)),
            Self::Limit { .. } => None,
        }
    }
}

/// Column of a voltage or load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputColumn {
    /// Column.
    pub column: usize,
    /// Interval.
    pub k: usize,
    /// Place in a list of the inputs of all intervals, given ones included.
    pub place: usize,
    /// Input of an interval.
    pub input: usize,
}

/// Columns and rows of a horizon.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// All columns, in order.
    pub columns: Vec<Column>,
    /// All rows, in order; limits follow where they are added.
    pub rows: Vec<Row>,
    /// Voltages and loads of all intervals with their columns.
    pub inputs: Vec<InputColumn>,
    column_of_instant: Vec<Option<usize>>,
    column_of_interval: Vec<Option<usize>>,
    column_of_horizon: Option<usize>,
    row_of_instant: Vec<Option<usize>>,
    row_of_interval: Vec<Option<usize>>,
    pub(in crate::control) span: Span,
    /// Numbers of variables of an instant and of an interval.
    counts: [usize; 2],
}

impl Numbering {
    /// Numbers the variables of a horizon. `is_given` says which values are given, `is_balanced(k, i)` whether the momentum balance of coordinate i
    /// of instant k is an equation. The last instant has no columns of its own for coordinates that are those of another one, and none of their
    /// constraints.
    pub(in crate::control) fn new(
        variables: &Variables,
        span: Span,
        is_given: impl Fn(Column) -> bool,
        is_balanced: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let counts = [Time::Instant, Time::Interval].map(|time| variables.of(time).len());
        let [of_instant, of_interval] = counts;
        let intervals = span.all;
        let mut out = Self {
            columns: Vec::new(),
            rows: Vec::new(),
            inputs: Vec::new(),
            column_of_instant: vec![None; (intervals + 1) * of_instant],
            column_of_interval: vec![None; intervals * of_interval],
            column_of_horizon: None,
            row_of_instant: vec![None; (intervals + 1) * of_instant],
            row_of_interval: vec![None; intervals * of_interval],
            span,
            counts,
        };
        let inputs = variables.sources_range();
        for k in 0..=intervals {
            let mut coordinates = variables.range(Role::Coordinate);
            let all_given = coordinates.all(|i| is_given(Column::Instant { k, i }));
            for (i, variable) in variables.of(Time::Instant).iter().enumerate() {
                let at = k * of_instant + i;
                let column = Column::Instant { k, i };
                let twin = span.twin().filter(|_| k == intervals);
                out.column_of_instant[at] = match (twin, variable.role) {
                    (Some(twin), Role::Coordinate) => out.unknown(twin, i),
                    _ => out.column(column, is_given(column)),
                };
                let is_row = match variable.role {
                    Role::Coordinate => is_balanced(k, i),
                    role => role.has_equation() && !all_given && twin.is_none(),
                };
                out.row_of_instant[at] = match (twin, variable.role) {
                    (Some(twin), Role::Coordinate) if span.is_closed => out.row(twin, i),
                    _ => out.row_where(is_row, Row::Instant { k, i }),
                };
            }
            if k == intervals {
                break;
            }
            for (s, variable) in variables.of(Time::Interval).iter().enumerate() {
                if variable.role.time() == Time::Horizon {
                    continue;
                }
                let at = k * of_interval + s;
                let column = Column::Interval { k, s };
                let is_input = inputs.contains(&s);
                let first = k - k % span.held;
                let number = match is_input && first < k {
                    true => out.scalar(first, s),
                    false => out.column(column, is_given(column)),
                };
                if let (Some(column), true) = (number, is_input) {
                    out.inputs.push(InputColumn {
                        column,
                        k,
                        place: k * inputs.len() + s,
                        input: s,
                    });
                }
                out.column_of_interval[at] = number;
                let is_row = variable.role.has_equation();
                out.row_of_interval[at] = out.row_where(is_row, Row::Interval { k, s });
            }
        }
        for s in variables.range(Role::Parameter) {
            let column = Column::Parameter { s };
            let number = out.column(column, is_given(column));
            (0..intervals).for_each(|k| out.column_of_interval[k * of_interval + s] = number);
        }
        out.column_of_horizon = out.column(Column::Horizon, is_given(Column::Horizon));
        out
    }

    fn column(&mut self, column: Column, is_given: bool) -> Option<usize> {
        (!is_given).then(|| {
            self.columns.push(column);
            self.columns.len() - 1
        })
    }

    fn row_where(&mut self, is_row: bool, row: Row) -> Option<usize> {
        is_row.then(|| {
            self.rows.push(row);
            self.rows.len() - 1
        })
    }

    /// Column of variable i of instant k; none behind the last instant.
    pub fn unknown(&self, k: usize, i: usize) -> Option<usize> {
        *self.column_of_instant.get(k * self.counts[0] + i)?
    }

    /// Column of scalar s of interval k; none behind the last interval.
    pub fn scalar(&self, k: usize, s: usize) -> Option<usize> {
        *self.column_of_interval.get(k * self.counts[1] + s)?
    }

    /// Column of the interval length.
    pub fn horizon(&self) -> Option<usize> {
        self.column_of_horizon
    }

    /// All variables with their columns: those of the columns, then inputs that are held over from an interval before.
    pub(in crate::control) fn variables(&self) -> impl Iterator<Item = (Column, usize)> {
        let own = self.columns.iter().copied().zip(0..);
        let inputs = self.inputs.iter().map(|input| {
            let (k, s) = (input.k, input.input);
            (Column::Interval { k, s }, input.column)
        });
        own.chain(inputs.filter(move |&(variable, column)| self.columns[column] != variable))
    }

    /// Number of a column, unless its value is given.
    pub fn number(&self, column: Column) -> Option<usize> {
        match column {
            Column::Instant { k, i } => self.unknown(k, i),
            Column::Interval { k, s } => self.scalar(k, s),
            Column::Parameter { s } => self.scalar(0, s),
            Column::Horizon => self.column_of_horizon,
        }
    }

    /// Row of the equation of a variable of an instant or interval.
    pub(in crate::control) fn row_of(&self, variable: Column) -> Option<usize> {
        match variable {
            Column::Instant { k, i } => self.row(k, i),
            Column::Interval { k, s } => self.row_of_scalar(k, s),
            Column::Parameter { .. } | Column::Horizon => None,
        }
    }

    /// Row of variable i of instant k.
    pub fn row(&self, k: usize, i: usize) -> Option<usize> {
        self.row_of_instant[k * self.counts[0] + i]
    }

    /// Row of scalar s of interval k.
    pub fn row_of_scalar(&self, k: usize, s: usize) -> Option<usize> {
        self.row_of_interval[k * self.counts[1] + s]
    }
}

/// Intervals of a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Intervals of the motion: the instant at which it ends.
    pub end: usize,
    /// All intervals: those of the motion and, where the inputs that hold its goal are sought, one at rest behind them.
    pub all: usize,
    /// True if the last interval comes before the first one, of a periodic motion.
    pub is_closed: bool,
    /// Neighbouring intervals, from the first on, in which an input is one column.
    pub held: usize,
}

impl Span {
    /// The instant whose coordinates the last one has: the start of a periodic motion, where their balances are one too, or its end, where an
    /// interval behind it holds the goal.
    pub(super) fn twin(self) -> Option<usize> {
        match self.is_closed {
            true => Some(0),
            false => (self.end < self.all).then_some(self.end),
        }
    }

    /// The interval before interval k: of the first one the last, where the motion is periodic.
    pub(super) fn before(self, k: usize) -> Option<usize> {
        let last = self.is_closed.then(|| self.all - 1);
        k.checked_sub(1).or(last)
    }
}

impl Control {
    /// Size of an input in V, N or N mm: the largest value that its bounds allow. Of a load without bounds it is the one that moves the mass m of
    /// the system by its length L in the duration T, m L/T².
    pub fn size(&self, variable: &Variable, model: &Model) -> f64 {
        if variable.role != Role::Load {
            return self.voltage_size(&model.system);
        }
        let sizes = self.bounds(variable).map(f64::abs).into_iter();
        let bound = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        let length = model.length();
        let kinetic_energy = mass(&model.system, length) * (length / self.duration.first()).powi(2);
        let natural = || match model.input_kind(variable.source.expect("an input of a source")) {
            InputKind::Torque => kinetic_energy,
            InputKind::Force => kinetic_energy / length,
            InputKind::Traction => kinetic_energy / length.powi(3),
            InputKind::BodyForce => kinetic_energy / length.powi(4),
            InputKind::SurfaceCharge => {
                kinetic_energy / (self.voltage_size(&model.system) * length * length)
            }
            InputKind::Charge | InputKind::Voltage => {
                kinetic_energy / self.voltage_size(&model.system)
            }
        };
        positive(bound)
            .or_else(|| positive(natural()))
            .unwrap_or(1.0)
    }

    /// Size of the voltages in V: the largest one that their bounds allow, or what moves a muscle much, t √(μ/ε), where that is less. Without
    /// either it is what moves a block much.
    pub fn voltage_size(&self, system: &System) -> f64 {
        let [low, high] = self.voltage_bounds.map(f64::abs);
        let of_muscle = |muscle: &Muscle| natural(&muscle.material, muscle.layer_thickness);
        let of_muscles = system.muscles.iter().filter_map(of_muscle);
        let size = of_muscles.fold(low.max(high), f64::min);
        let of_block = |solid: &Solid| {
            let sizes = solid
                .materials
                .iter()
                .map(|m| natural(m, solid.mesh.size()));
            sizes.flatten().reduce(f64::min)
        };
        let of_blocks = || system.solids.iter().filter_map(of_block).reduce(f64::min);
        positive(size).or_else(of_blocks).unwrap_or(1.0)
    }
}

/// The voltage t √(μ/ε) across a layer.
fn natural(material: &Material, thickness: f64) -> Option<f64> {
    let ElectricConstants {
        c1,
        c2,
        permittivity,
    } = material.electric?;
    let permittivity = permittivity - 2.0 * (c1 + c2);
    Some(thickness * (material.shear_modulus / permittivity.abs()).sqrt())
}

/// Mass in g of the bodies, and of the blocks of a system of this length, about.
fn mass(system: &System, length: f64) -> f64 {
    let bodies: f64 = system.bodies.iter().map(|body| body.mass).sum();
    let materials = system.solids.iter().flat_map(|solid| &solid.materials);
    let densities = materials.filter_map(|material| material.density);
    bodies + densities.fold(0.0, f64::max) * length.powi(3)
}

fn positive(size: f64) -> Option<f64> {
    (size.is_finite() && size > 0.0).then_some(size)
}
