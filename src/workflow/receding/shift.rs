//! A plan one interval later: what it says of an instant or step becomes that of an interval before.

use std::hash::Hash;

use crate::control::{Column, Row};
use crate::workflow::receding::iteration::Iteration;
use crate::workflow::receding::layout::{Between, places};
use crate::workflow::receding::program::Program;

/// Successors of columns and rows, which stand behind them.
#[derive(Debug)]
pub(super) struct Shift {
    columns: Vec<(usize, usize)>,
    rows: Vec<(usize, usize)>,
    /// Columns of coordinates within the last interval, with those at both of its ends, and the part of it that has passed there.
    between: Vec<Between>,
    /// Columns of the inputs of the last interval.
    last: Vec<usize>,
}

impl Shift {
    pub(super) fn new(program: &Program<'_>) -> Self {
        let (columns, rows) = program.numbers();
        let parts = program.layout.parts;
        let n = program.layout.width();
        let (end, _) = program.layout.coordinates[(program.layout.intervals - 1) * n];
        Self {
            columns: successors(columns, |column| match column {
                Column::Instant { k, i } => Column::Instant { k: k + parts, i },
                Column::Interval { k, s } => Column::Interval { k: k + parts, s },
                other => other,
            }),
            rows: successors(rows, |row| match row {
                Row::Instant { k, i } => Row::Instant { k: k + parts, i },
                Row::Interval { k, s } => Row::Interval { k: k + parts, s },
                Row::Limit { limit, k } => Row::Limit {
                    limit,
                    k: k + parts,
                },
                other => other,
            }),
            between: program
                .between
                .iter()
                .filter(|(_, [from, _], _)| *from >= end)
                .copied()
                .collect(),
            last: program.layout.last_inputs().collect(),
        }
    }

    /// Shifts a plan. In the last interval the inputs of the motion that is followed act; the end keeps its deviation.
    pub(super) fn apply(
        &self,
        of: &mut Iteration<Program<'_>>,
        before: &mut [f64],
        after: &mut [f64],
    ) {
        let end = of.program.layout.intervals;
        before.fill(0.0);
        of.program.refer(end, before);
        of.program.begin += 1;
        after.fill(0.0);
        of.program.refer(end, after);
        for &(to, from) in &self.columns {
            of.x[to] = of.x[from];
            of.z.iter_mut().for_each(|z| z[to] = z[from]);
        }
        for &(to, from) in &self.rows {
            of.y[to] = of.y[from];
            if let (Some(to), Some(from)) = (of.slack(to), of.slack(from)) {
                of.x[to] = of.x[from];
                of.z.iter_mut().for_each(|z| z[to] = z[from]);
            }
        }
        let values = of.x[..of.columns].iter_mut();
        for ((value, before), after) in values.zip(&*before).zip(&*after) {
            *value += after - before;
        }
        for &(i, [from, to], part) in &self.between {
            of.x[i] = of.x[from] + part * (of.x[to] - of.x[from]);
        }
        of.program.refer(end - 1, after);
        for &i in &self.last {
            of.x[i] = after[i];
            of.centre(i);
        }
    }
}

/// Places of entries with the places of their successors.
fn successors<T: Copy + Eq + Hash>(list: &[T], next: impl Fn(T) -> T) -> Vec<(usize, usize)> {
    let places = places(list);
    let all = list.iter().enumerate();
    all.filter_map(|(i, one)| Some((i, *places.get(&next(*one))?)))
        .filter(|(i, next)| i != next)
        .collect()
}
