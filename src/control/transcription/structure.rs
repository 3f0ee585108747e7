//! Structures of Jacobian and Hessian: the entries of the periodic values that they keep.

use crate::control::error::BoundaryError;
use crate::control::numbering::{Column, Row};
use crate::control::transcription::cost_rows::{CostInput, Jump, Objective};
use crate::control::transcription::layout::Layout;
use crate::control::transcription::limit_rows::LimitRow;
use crate::model::{Model, Role};
use crate::nlp::Entries;
use crate::stop;
use std::collections::BTreeMap;

/// An entry of a matrix of the program: where its value is found, and its scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gather {
    pub(super) place: usize,
    pub(super) scale: f64,
}

/// A matrix of the program.
#[derive(Debug, Default)]
pub(super) struct Matrix {
    pub(super) entries: Entries,
    /// Its entries, in this order, but those of jumps.
    pub(super) kept: Vec<Gather>,
}

/// Matrices of the program.
#[derive(Debug)]
pub(super) struct Structure {
    pub(super) jacobian: Matrix,
    /// Lower triangle of the Hessian; its last entries are those of the jumps.
    pub(super) hessian: Matrix,
    /// Voltages of neighbouring intervals that meet in the objective.
    pub(super) jumps: Vec<Jump>,
}

impl Structure {
    /// Lays out the matrices, with scales of one.
    ///
    /// # Errors
    /// It is time to stop.
    pub(super) fn new(
        model: &Model,
        layout: &Layout,
        objective: &Objective,
    ) -> Result<Self, BoundaryError> {
        let jacobian = jacobian(model, layout)?;
        let mut hessian = hessian(model, layout)?;
        let jumps = jumps(layout, objective, &mut hessian.entries);
        stop::check()?;
        Ok(Self {
            jacobian,
            hessian,
            jumps,
        })
    }
}

impl Matrix {
    /// Adds an entry that takes the value at a place, unless its row or column is none of the program.
    fn add(&mut self, row: Option<usize>, col: Option<usize>, place: usize) {
        if let (Some(row), Some(col)) = (row, col) {
            self.entries.push(row, col);
            self.kept.push(Gather { place, scale: 1.0 });
        }
    }

    /// Scales the entries by their rows and columns.
    pub(super) fn scale(&mut self, rows: &[f64], columns: &[f64]) {
        for (kept, (row, col)) in self.kept.iter_mut().zip(self.entries.places()) {
            kept.scale = rows[row] * columns[col];
        }
    }
}

/// Hands over the entries of ∇²Ŝ step by step: the variables of row and column, the place of the value, and true of an entry whose transpose came
/// before or comes in its own order. Constraints are instantaneous: of them there is none by the interval length.
fn entries(
    model: &Model,
    layout: &Layout,
    mut add: impl FnMut(Column, Column, usize, bool),
) -> Result<(), BoundaryError> {
    let pattern = model.action.layout();
    let at = |k: usize, i: usize| Column::Instant { k, i };
    for k in 0..=layout.span.all {
        stop::check()?;
        for (slot, (i, j)) in pattern.same.entries().enumerate() {
            add(at(k, i), at(k, j), pattern.same_at(k) + slot, i < j);
        }
        for i in 0..model.coordinate_count() {
            add(at(k, i), Column::Horizon, pattern.horizon_at(k) + i, false);
        }
        if k == layout.span.all {
            break;
        }
        let within = |s: usize| Column::Interval { k, s };
        for (slot, (i, j)) in pattern.cross.entries().enumerate() {
            add(at(k + 1, i), at(k, j), pattern.lower_at(k) + slot, false);
            add(at(k, i), at(k + 1, j), pattern.upper_at(k) + slot, true);
        }
        for side in 0..2 {
            for (slot, (i, s)) in pattern.mixed.entries().enumerate() {
                let place = pattern.mixed_at(k, side) + slot;
                add(at(k + side, i), within(s), place, false);
                add(within(s), at(k + side, i), place, true);
            }
        }
        for (slot, (s, t)) in pattern.scalars.entries().enumerate() {
            let place = pattern.scalars_at(k) + slot;
            add(within(s), within(t), place, false);
            if s != t {
                add(within(t), within(s), place, true);
            }
        }
        for s in 0..pattern.interval_scalars {
            let place = pattern.horizon_scalars_at(k) + s;
            add(within(s), Column::Horizon, place, false);
        }
    }
    Ok(())
}

/// Entries of the Jacobian that the terms have, step by step, then those of the limits and of functions of time.
fn jacobian(model: &Model, layout: &Layout) -> Result<Matrix, BoundaryError> {
    let (u, mut matrix) = (&layout.unknowns, Matrix::default());
    entries(model, layout, |row, col, place, _| {
        matrix.add(u.row_of(row), u.number(col), place);
    })?;
    let first = u.rows.len() - layout.limit_rows.len();
    let mut place = model.action.layout().values(layout.span.all);
    for (r, &(limit, k)) in layout.limit_rows.iter().enumerate() {
        for &entry in &layout.limits[limit].entries {
            matrix.add(Some(first + r), u.column_of_entry(k, entry), place);
            place += 1;
        }
    }
    let first = layout.first_time_row();
    for r in 0..layout.times.len() {
        let column = Some(layout.times.column(r));
        matrix.add(Some(first + r), column, place);
        matrix.add(Some(first + r), u.horizon(), place + 1);
        place += 2;
    }
    stop::check()?;
    Ok(matrix)
}

/// Entries of the lower triangle of the Hessian that the terms have, step by step.
fn hessian(model: &Model, layout: &Layout) -> Result<Matrix, BoundaryError> {
    let (u, mut matrix) = (&layout.unknowns, Matrix::default());
    entries(model, layout, |row, col, place, is_transpose| {
        let pair = u.number(row).zip(u.number(col));
        if let Some((row, col)) = pair.filter(|_| !is_transpose) {
            matrix.add(Some(row.max(col)), Some(row.min(col)), place);
        }
    })?;
    let square = model.action.layout().horizon_square_at(layout.span.all);
    matrix.add(u.horizon(), u.horizon(), square);
    stop::check()?;
    add_squares(model, layout, &mut matrix);
    Ok(matrix)
}

/// Adds the couplings of a coordinate with itself between neighbouring instants that share it, a second time: an entry of a square counts for
/// both of its sides.
fn add_squares(model: &Model, layout: &Layout, matrix: &mut Matrix) {
    let instant = layout.span.all;
    let Some(of) = layout.span.twin().filter(|of| of + 1 == instant) else {
        return;
    };
    let (pattern, u) = (model.action.layout(), &layout.unknowns);
    for (slot, (i, j)) in pattern.cross.entries().enumerate() {
        let [row, col] = [(instant, i), (of, j)].map(|(k, i)| u.unknown(k, i));
        if let Some(square) = row.filter(|_| row == col) {
            matrix.add(Some(square), Some(square), pattern.lower_at(of) + slot);
        }
    }
}

/// Inputs that meet those of the interval before, with the energies that couple them; adds their entries.
fn jumps(layout: &Layout, objective: &Objective, entries: &mut Entries) -> Vec<Jump> {
    let u = &layout.unknowns;
    let inputs = objective.inputs.iter().enumerate();
    let coupling = inputs.filter_map(|(input, &CostInput { scalar: s, .. })| {
        let mut rows = objective.energies.iter();
        let energy = rows.position(|row| row.scalar == s && row.couples_intervals());
        let is_any = objective.cost.couples_intervals() || energy.is_some();
        is_any.then_some((input, s, energy))
    });
    let coupling: Vec<_> = coupling.collect();
    let mut jumps = Vec::new();
    let first = usize::from(!layout.span.is_closed);
    for (k, before) in (first..layout.span.all).filter_map(|k| Some((k, layout.span.before(k)?))) {
        for &(input, s, energy) in &coupling {
            if let (Some(row), Some(col)) = (u.scalar(k, s), u.scalar(before, s)) {
                entries.rows.push(row.max(col) as u32);
                entries.cols.push(row.min(col) as u32);
                jumps.push(Jump { k, input, energy });
            }
        }
    }
    jumps
}

/// That there are more equations than unknowns on a number of intervals, where it is so.
pub(in crate::control) fn overdetermined(
    layout: &Layout,
    model: &Model,
    intervals: usize,
) -> Option<BoundaryError> {
    let rows = &layout.unknowns.rows;
    let is_goal = |l: &&LimitRow| l.bounded.when.is_single() && l.bounded.lower == l.bounded.upper;
    let goals = layout.limits.iter().filter(is_goal);
    let mut named = BTreeMap::new();
    goals.for_each(|goal| *named.entry(goal.bounded.name.clone()).or_insert(0) += 1);
    let balances = rows.iter().filter(|row| !matches!(row, Row::Limit { .. }));
    let balances = balances.filter(|row| !layout.is_of_junction(**row));
    let equations = balances.count() + named.values().sum::<usize>();
    let unknowns = layout.unknowns.columns.len();
    if equations <= unknowns {
        return None;
    }
    let coordinates = model.variables.range(Role::Coordinate);
    let is_rest = |row: &&Row| match **row {
        Row::Instant { k, i } => k == intervals && coordinates.contains(&i),
        _ => false,
    };
    let is_given = |i: &usize| layout.unknowns.unknown(intervals, *i).is_none();
    let rest = rows.iter().filter(is_rest).count();
    let given = coordinates.clone().filter(is_given).count();
    Some(BoundaryError::Overdetermined(format!(
        "{equations} equations for {unknowns} unknowns. {}; {} voltages are sought in {intervals} intervals. {}",
        asked(rest, given, &named),
        layout.sought_inputs(),
        cures(!model.solids.is_empty(), rest)
    )))
}

/// Largest number of goals listed.
const TOLD: usize = 6;

/// Lists the parts of the goal with their numbers of equations.
fn asked(rest: usize, given: usize, goals: &BTreeMap<String, usize>) -> String {
    let mut parts = Vec::new();
    if rest > 0 {
        parts.push(format!("rest at the end is {rest} equations"));
    }
    if given > 0 {
        parts.push(format!("the goal gives {given} coordinates"));
    }
    let told = goals.iter().take(TOLD);
    parts.extend(told.map(|(name, count)| format!("{name} is {count}")));
    if goals.len() > TOLD {
        parts.push(format!("and {} more conditions", goals.len() - TOLD));
    }
    parts.join(", ")
}

/// Returns the changes that make them fewer.
fn cures(has_elements: bool, rest: usize) -> &'static str {
    match has_elements && rest > 0 {
        true => {
            "A few voltages cannot bring every node to rest: write \"rest\": \"bodies\" in the goal, so that bodies and the markers of the goal rest, \
             with \"hold\" for the voltages that are held afterwards; or take fewer final conditions or more intervals"
        }
        false => "Take fewer final conditions, more intervals or more muscles",
    }
}
