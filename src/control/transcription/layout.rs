//! Unknowns, equations and limits of a horizon, laid out without their values.
//!
//! Inputs and joint coordinates that are functions of time, where times are unknowns: each value is an unknown with an equation of its own.
//!
//! ```text
//! v − S(c h) = 0,     c = k at instant k, k + ½ in interval k, N behind the end,
//! ```
//!
//! so that all other rows and the objective read values alone. Its derivatives are 1 by v, −c S′ by h, and −c² S″ by h twice; at a corner of S
//! those of the time after it.

use crate::control::boundary_conditions::{BoundaryConditions, Rests};
use crate::control::limits::BoundedQuantity;
use crate::control::numbering::{Column, Numbering, Row, Span};
use crate::control::problem::{BoundaryState, Control, Duration};
use crate::control::transcription::limit_rows::{LimitRow, limit_rows};
use crate::coordinates::{Configuration, CoordinateMap};
use crate::functional::Horizon;
use crate::math::Signal;
use crate::model::{Model, Role};

/// Number of intervals from which on a horizon is evaluated in two stretches.
const TWO_STRETCHES: usize = 16;

/// Variables and rows of the program of a control problem on a number of intervals.
#[derive(Clone, Debug)]
pub(in crate::control) struct Layout {
    pub(in crate::control) span: Span,
    /// True where the balances of start and end are added to those of other phases.
    continues: [bool; 2],
    pub(super) horizon: Horizon,
    pub(in crate::control) unknowns: Numbering,
    /// Functions of time behind the equations of motion.
    pub(super) times: TimeRows,
    pub(in crate::control) limits: Vec<LimitRow>,
    /// Limit, and instant or interval, of each row behind the equations.
    pub(in crate::control) limit_rows: Vec<(usize, usize)>,
}

impl Layout {
    /// The layout of a motion of `end` intervals, whatever number the problem names.
    pub(in crate::control) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        control: &Control,
        end: usize,
    ) -> Self {
        let span = Span {
            end,
            all: end + usize::from(control.seeks_hold()),
            is_closed: control.goal == BoundaryState::Periodic,
            held: control.input_intervals,
        };
        let map = &model.action.map;
        // A node that multipliers hold rests with what they hold it to: its balance gives their last value.
        let mut is_held = vec![false; map.coordinates];
        for (i, j) in model.action.layout().same.entries() {
            if i >= map.coordinates && j < map.coordinates {
                is_held[j] = true;
            }
        }
        let is_in_rest = |i: usize| match boundary.goal.rests {
            Rests::Everything => true,
            Rests::Bodies => !map.nodes().contains(&i) || is_held[i],
            Rests::Nothing => false,
        };
        let rests = |i: usize| is_in_rest(i) && !model.is_memory(i);
        let [_, goes_on] = control.continues;
        let is_balanced =
            |k: usize, i: usize| (k != end || goes_on || rests(i)) && !model.is_prescribed(i);
        let is_given = |column| is_given(column, model, boundary, control, end);
        let mut unknowns = Numbering::new(&model.variables, span, is_given, is_balanced);
        let times = TimeRows::new(model, control, end, &mut unknowns);
        let limits = limit_rows(
            model,
            &boundary.limits.list,
            &boundary.rest,
            span,
            &unknowns,
        );
        let mut limit_rows = Vec::new();
        for (index, limit) in limits.iter().enumerate() {
            for k in limit.at.clone() {
                unknowns.rows.push(Row::Limit { limit: index, k });
                limit_rows.push((index, k));
            }
        }
        Self {
            span,
            continues: control.continues,
            horizon: match control.duration {
                Duration::Given(_) => Horizon::Given,
                Duration::Free { .. } => Horizon::Free,
            },
            unknowns,
            times,
            limits,
            limit_rows,
        }
    }

    /// Number of inputs that are sought.
    pub(in crate::control) fn sought_inputs(&self) -> usize {
        let inputs = self.unknowns.inputs.iter();
        let sought = inputs.filter(|input| self.times.place(input.column).is_none());
        sought.count()
    }

    /// Returns true of a balance that is an equation with that of another phase alone.
    pub(super) fn is_of_junction(&self, row: Row) -> bool {
        let [before, after] = self.continues;
        match row {
            Row::Instant { k, .. } => before && k == 0 || after && k == self.span.end,
            _ => false,
        }
    }

    /// First of the rows of functions of time.
    pub(super) fn first_time_row(&self) -> usize {
        self.unknowns.rows.len() - self.limit_rows.len() - self.times.len()
    }

    /// The row of a column that is a function of time.
    pub(in crate::control) fn row_of_time(&self, column: Option<usize>) -> Option<usize> {
        Some(self.first_time_row() + self.times.place(column?)?)
    }

    /// Gives an instant that has the coordinates of another one these, and its charts.
    pub(super) fn share(&self, instants: &mut [Configuration], map: &CoordinateMap) {
        let Some(of) = self.span.twin() else {
            return;
        };
        let (before, twin) = instants.split_at_mut(self.span.all);
        let (from, to) = (&before[of].z, &mut twin[0].z);
        to[..map.coordinates].copy_from_slice(&from[..map.coordinates]);
        to[map.unknowns()..].copy_from_slice(&from[map.unknowns()..]);
    }

    /// Instant at which a long horizon is cut in two.
    pub(super) fn middle(&self) -> Option<usize> {
        let is_cut = self.horizon == Horizon::Given && self.span.all >= TWO_STRETCHES;
        is_cut.then_some(self.span.all / 2)
    }
}

/// Returns true if a variable is given: by the start, the goal at instant `end`, or the problem, unless its value follows a time that is sought.
fn is_given(
    column: Column,
    model: &Model,
    boundary: &BoundaryConditions,
    control: &Control,
    end: usize,
) -> bool {
    let variable = column.of(&model.variables);
    let is_followed = || control.followed(model, column).is_some();
    match (column, variable.role) {
        (Column::Instant { k, i }, Role::Coordinate) => {
            let is_sought = control.start == BoundaryState::Free
                || control.continues[0]
                || boundary.sought_rest[0];
            let is_start = k == 0 && !is_sought && control.goal != BoundaryState::Periodic;
            is_start
                || (k == end && boundary.goal.coordinates[i].is_some())
                || (model.is_prescribed(i) && !is_followed())
        }
        // No balance at the end, so nothing that a constraint force would balance.
        (Column::Instant { k, .. }, _) => k == end && boundary.goal.rests == Rests::Nothing,
        (Column::Interval { .. }, _) => {
            let is_given = |source| control.is_given(source);
            variable.source.is_some_and(is_given) && !is_followed()
        }
        (Column::Parameter { .. }, _) => false,
        (Column::Horizon, _) => matches!(control.duration, Duration::Given(_)),
    }
}

/// The variables and equations that the program of a control problem has.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Columns and rows.
    pub unknowns: Numbering,
    /// Limits and goals, to which rows refer.
    pub limits: Vec<BoundedQuantity>,
}

impl Outline {
    /// The outline of the program of a problem.
    pub fn new(model: &Model, boundary: &BoundaryConditions, control: &Control) -> Self {
        let layout = Layout::new(model, boundary, control, control.intervals);
        let limits = layout.limits.into_iter().map(|limit| limit.bounded);
        Self {
            limits: limits.collect(),
            unknowns: layout.unknowns,
        }
    }
}

/// The rows behind the equations of motion.
#[derive(Clone, Debug, Default)]
pub(super) struct TimeRows {
    /// Each function once, with the entry of z or the scalar that it gives.
    functions: Vec<(Column, Signal)>,
    rows: Vec<TimeRow>,
}

/// The equation of one value.
#[derive(Clone, Copy, Debug)]
struct TimeRow {
    /// Column of v.
    column: usize,
    function: usize,
    /// Time over the interval length, c.
    lengths: f64,
}

impl TimeRows {
    /// Adds a row for each column that follows a function of time; the motion ends at instant `end`.
    pub(super) fn new(
        model: &Model,
        control: &Control,
        end: usize,
        unknowns: &mut Numbering,
    ) -> Self {
        let mut out = Self::default();
        for (number, &column) in unknowns.columns.iter().enumerate() {
            let Some(signal) = control.followed(model, column) else {
                continue;
            };
            let lengths = match column {
                Column::Instant { k, .. } => k as f64,
                Column::Interval { k, .. } if k < end => k as f64 + 0.5,
                _ => end as f64,
            };
            let of = first(column);
            let mut known = out.functions.iter();
            let function = known.position(|(one, _)| *one == of).unwrap_or_else(|| {
                out.functions.push((of, signal.clone()));
                out.functions.len() - 1
            });
            unknowns.rows.push(Row::Time {
                place: out.rows.len(),
                of: column,
            });
            out.rows.push(TimeRow {
                column: number,
                function,
                lengths,
            });
        }
        out
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Number of the column of a row.
    pub(super) fn column(&self, place: usize) -> usize {
        self.rows[place].column
    }

    /// Place of the row of a column.
    pub(super) fn place(&self, column: usize) -> Option<usize> {
        self.rows
            .binary_search_by_key(&column, |row| row.column)
            .ok()
    }

    /// The function of a row with its first two derivatives by the interval length h in ms.
    pub(super) fn derivatives(&self, place: usize, h: f64) -> [f64; 3] {
        let TimeRow {
            function, lengths, ..
        } = self.rows[place];
        let [value, rate, second] = self.functions[function].1.derivatives(lengths * h);
        [value, lengths * rate, lengths * lengths * second]
    }

    /// Columns with their values where the interval length is h.
    pub(super) fn values(&self, h: f64) -> impl Iterator<Item = (usize, f64)> {
        let value = move |place: usize| (self.column(place), self.derivatives(place, h)[0]);
        (0..self.len()).map(value)
    }
}

/// The column of the same variable at the first time.
fn first(column: Column) -> Column {
    match column {
        Column::Instant { i, .. } => Column::Instant { k: 0, i },
        Column::Interval { s, .. } => Column::Interval { k: 0, s },
        other => other,
    }
}
