//! Check for control problems with more equations than unknowns, and the conditions that add them.

use std::collections::BTreeMap;

use crate::control::error::BoundaryError;
use crate::control::numbering::Row;
use crate::control::transcription::layout::Layout;
use crate::control::transcription::limit_rows::LimitRow;
use crate::model::{Model, Role};

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
