//! Structures of Jacobian and Hessian: the entries of the periodic values that they keep.

use crate::control::error::BoundaryError;
use crate::control::numbering::{Row, Twin};
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

/// Row, column and place among the values of an entry before those of given values are left out.
type Candidate = (Option<usize>, Option<usize>, usize);

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
    fn add(&mut self, row: usize, col: usize, place: usize) {
        self.entries.push(row, col);
        self.kept.push(Gather { place, scale: 1.0 });
    }

    /// Scales the entries by their rows and columns.
    pub(super) fn scale(&mut self, rows: &[f64], columns: &[f64]) {
        for (kept, (row, col)) in self.kept.iter_mut().zip(self.entries.places()) {
            kept.scale = rows[row] * columns[col];
        }
    }
}

/// Entries of the Jacobian that the terms have, step by step, then those of the limits.
fn jacobian_candidates(model: &Model, layout: &Layout) -> Result<Vec<Candidate>, BoundaryError> {
    let (pattern, u) = (model.action.layout(), &layout.unknowns);
    let mut list = Vec::new();
    for k in 0..=layout.intervals {
        stop::check()?;
        for (slot, (i, j)) in pattern.same.entries().enumerate() {
            list.push((u.row(k, i), u.unknown(k, j), pattern.same_at(k) + slot));
        }
        for i in 0..pattern.unknowns {
            list.push((u.row(k, i), u.horizon(), pattern.horizon_at(k) + i));
        }
        if k == layout.intervals {
            break;
        }
        for (slot, (i, j)) in pattern.cross.entries().enumerate() {
            let [lower, upper] = [pattern.lower_at(k), pattern.upper_at(k)];
            list.push((u.row(k + 1, i), u.unknown(k, j), lower + slot));
            list.push((u.row(k, i), u.unknown(k + 1, j), upper + slot));
        }
        for side in 0..2 {
            for (slot, (i, s)) in pattern.mixed.entries().enumerate() {
                let place = pattern.mixed_at(k, side) + slot;
                list.push((u.row(k + side, i), u.scalar(k, s), place));
                list.push((u.row_of_scalar(k, s), u.unknown(k + side, i), place));
            }
        }
        for (slot, (s, t)) in pattern.scalars.entries().enumerate() {
            let place = pattern.scalars_at(k) + slot;
            list.push((u.row_of_scalar(k, s), u.scalar(k, t), place));
            if s != t {
                list.push((u.row_of_scalar(k, t), u.scalar(k, s), place));
            }
        }
        for s in 0..pattern.interval_scalars {
            let place = pattern.horizon_scalars_at(k) + s;
            list.push((u.row_of_scalar(k, s), u.horizon(), place));
        }
    }
    let first = u.rows.len() - layout.limit_rows.len();
    let mut place = pattern.values(layout.intervals);
    for (r, &(limit, k)) in layout.limit_rows.iter().enumerate() {
        for &entry in &layout.limits[limit].entries {
            list.push((Some(first + r), u.column_of_entry(k, entry), place));
            place += 1;
        }
    }
    let first = layout.first_time_row();
    for r in 0..layout.times.len() {
        let column = Some(layout.times.column(r));
        list.push((Some(first + r), column, place));
        list.push((Some(first + r), u.horizon(), place + 1));
        place += 2;
    }
    Ok(list)
}

fn jacobian(model: &Model, layout: &Layout) -> Result<Matrix, BoundaryError> {
    let u = &layout.unknowns;
    // The horizon column has no entry in the rows of constraints, which are instantaneous; limits name theirs.
    let horizon = u.horizon();
    let lasts = |row: Row| {
        let variable = row.of(&model.variables);
        variable.is_none_or(|variable| variable.role != Role::Multiplier)
    };
    let candidates = jacobian_candidates(model, layout)?;
    stop::check()?;
    let mut matrix = Matrix::default();
    for (row, col, place) in candidates {
        let (Some(row), Some(col)) = (row, col) else {
            continue;
        };
        if Some(col) != horizon || lasts(u.rows[row]) {
            matrix.add(row, col, place);
        }
    }
    Ok(matrix)
}

/// Entries of the lower triangle of the Hessian that the terms have, step by step.
fn hessian_candidates(model: &Model, layout: &Layout) -> Result<Vec<Candidate>, BoundaryError> {
    let (pattern, u) = (model.action.layout(), &layout.unknowns);
    let mut list = Vec::new();
    for k in 0..=layout.intervals {
        stop::check()?;
        let same = pattern.same.entries().enumerate();
        for (slot, (i, j)) in same.filter(|(_, (i, j))| i >= j) {
            list.push((u.unknown(k, i), u.unknown(k, j), pattern.same_at(k) + slot));
        }
        for i in 0..model.coordinate_count() {
            list.push((u.horizon(), u.unknown(k, i), pattern.horizon_at(k) + i));
        }
        if k == layout.intervals {
            break;
        }
        for (slot, (i, j)) in pattern.cross.entries().enumerate() {
            let place = pattern.lower_at(k) + slot;
            list.push((u.unknown(k + 1, i), u.unknown(k, j), place));
        }
        for side in 0..2 {
            for (slot, (i, s)) in pattern.mixed.entries().enumerate() {
                let place = pattern.mixed_at(k, side) + slot;
                list.push((u.scalar(k, s), u.unknown(k + side, i), place));
            }
        }
        for (slot, (s, t)) in pattern.scalars.entries().enumerate() {
            let place = pattern.scalars_at(k) + slot;
            list.push((u.scalar(k, s), u.scalar(k, t), place));
        }
        for s in 0..pattern.interval_scalars {
            let place = pattern.horizon_scalars_at(k) + s;
            list.push((u.horizon(), u.scalar(k, s), place));
        }
    }
    let square = pattern.horizon_square_at(layout.intervals);
    list.push((u.horizon(), u.horizon(), square));
    Ok(list)
}

fn hessian(model: &Model, layout: &Layout) -> Result<Matrix, BoundaryError> {
    let candidates = hessian_candidates(model, layout)?;
    stop::check()?;
    let mut matrix = Matrix::default();
    for (row, col, place) in candidates {
        if let (Some(row), Some(col)) = (row, col) {
            matrix.add(row.max(col), row.min(col), place);
        }
    }
    add_squares(model, layout, &mut matrix);
    Ok(matrix)
}

/// Adds the couplings of a coordinate with itself between neighbouring instants that share it, a second time: an entry of a square counts for
/// both of its sides.
fn add_squares(model: &Model, layout: &Layout, matrix: &mut Matrix) {
    let Some(Twin { instant, of, .. }) = layout.twin.filter(|twin| twin.instant == twin.of + 1)
    else {
        return;
    };
    let (pattern, u) = (model.action.layout(), &layout.unknowns);
    for (slot, (i, j)) in pattern.cross.entries().enumerate() {
        let [row, col] = [(instant, i), (of, j)].map(|(k, i)| u.unknown(k, i));
        if let Some(square) = row.filter(|_| row == col) {
            matrix.add(square, square, pattern.lower_at(of) + slot);
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
    let first = usize::from(!layout.is_closed());
    for (k, before) in (first..layout.intervals).filter_map(|k| Some((k, u.before(k)?))) {
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
    Some(BoundaryError::Overdetermined {
        equations,
        unknowns,
        rest: rows.iter().filter(is_rest).count(),
        given: coordinates.clone().filter(is_given).count(),
        goals: named.into_iter().collect(),
        voltages: layout.sought_inputs(),
        intervals,
        has_elements: !model.solids.is_empty(),
    })
}
