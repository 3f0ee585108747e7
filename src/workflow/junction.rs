//! Phases: motions of which each goes on where the one before ended.
//!
//! At the junction of two phases the coordinates are the same unknowns, and both balances of momentum are one equation, as between any two intervals:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_N) + D₁L_d(q_N, q_{N+1}) = 0,
//! ```
//!
//! the first term with the constants of the phase before, the second one with those of the phase behind it. Where the masses differ what is picked up
//! was at rest, and what is left behind goes on as it moved. Durations that are sought are unknowns of each phase; their sum may be given.

use crate::control::Transcription;
use crate::control::problem::{Combined, ControlTask, Duration};
use crate::model::{Model, Role};
use crate::nlp::joined::{Joined, SharedRow, SharedVariable};
use crate::workflow::error::WorkflowError;

/// Refuses what cannot go on from one phase to the next.
///
/// # Errors
/// The coordinates of both are not the same, or a joint turns about a point, or closes a loop.
pub(super) fn check(pair: [&Model; 2], names: [&str; 2]) -> Result<(), WorkflowError> {
    let names_of = |model: &Model| -> Vec<String> {
        let all = model.variables.with(Role::Coordinate).iter();
        all.map(|variable| variable.name.clone()).collect()
    };
    let [a, b] = pair.map(names_of);
    let has = |is: fn(&Model) -> bool| pair.into_iter().any(is);
    let reason = match () {
        () if a != b => {
            "their coordinates are other ones; expected phases in which the same bodies can move by the same joints"
        }
        () if has(|one| !one.variables.range(Role::Multiplier).is_empty()) => {
            "constraints hold bodies or joints; expected joint coordinates, without loops"
        }
        () if has(|one| one.action.map.unknowns() < one.action.map.instant().z.len()) => {
            "a spherical or floating joint turns from a rotation of its own; expected joints that turn about axes"
        }
        () => return Ok(()),
    };
    let [before, after] = names;
    let reason = format!("\"{after}\" cannot go on where \"{before}\" ends: {reason}");
    Err(WorkflowError::problem("control.phases", reason))
}

/// The coordinates of the junction of the phases `first` and `first + 1` among a number of programs, and their balances.
pub(super) fn shared(
    pair: [&Transcription<'_>; 2],
    first: usize,
    programs: usize,
) -> (Vec<SharedVariable>, Vec<SharedRow>) {
    let [a, b] = pair;
    let end = a.intervals();
    let (mut variables, mut rows) = (Vec::new(), Vec::new());
    for i in a.model().variables.range(Role::Coordinate) {
        if let (Some(one), Some(other)) = (a.unknowns().unknown(end, i), b.unknowns().unknown(0, i))
        {
            let mut places = vec![None; programs];
            places[first] = Some((one, 1.0));
            places[first + 1] = Some((other, a.column_scale(one) / b.column_scale(other)));
            variables.push(SharedVariable(places));
        }
        if let (Some(one), Some(other)) = (a.unknowns().row(end, i), b.unknowns().row(0, i)) {
            let factor = a.row_scale(one) / b.row_scale(other);
            rows.push(SharedRow(vec![
                (first, one, 1.0),
                (first + 1, other, factor),
            ]));
        }
    }
    (variables, rows)
}

/// The sum of the durations of phases, where it is given and some are sought.
pub(super) struct Durations {
    /// For each phase whose duration is sought the column of its interval length and the duration of a length of one there.
    sought: Vec<(usize, usize, f64)>,
    /// Their sum in ms.
    left: f64,
}

impl Durations {
    pub(super) fn new<'p, 'm: 'p>(
        phases: impl Iterator<Item = &'p Transcription<'m>>,
        task: &ControlTask<'_>,
    ) -> Self {
        let length = |(number, program): (usize, &Transcription<'_>)| {
            let column = program.unknowns().horizon()?;
            let length = program.intervals() as f64 * program.column_scale(column);
            Some((number, column, length))
        };
        let given = task
            .motions
            .iter()
            .map(|phase| match phase.control.duration {
                Duration::Given(duration) => duration,
                Duration::Free { .. } => 0.0,
            });
        let whole = match task.combined {
            Combined::InSequence(whole) => whole,
            Combined::Sum | Combined::Worst => None,
        };
        let sought = phases.enumerate().filter_map(length);
        Self {
            sought: sought.filter(|_| whole.is_some()).collect(),
            left: whole.unwrap_or_default() - given.sum::<f64>(),
        }
    }

    /// The program of the phases with the sum as a row.
    pub(super) fn of<'m>(&self, program: Joined<Transcription<'m>>) -> Joined<Transcription<'m>> {
        if self.sought.is_empty() {
            return program;
        }
        let term = |&(number, own, length): &(usize, usize, f64)| {
            let (column, factor) = program.places().variable_of(number, own);
            (column, factor * length / self.left)
        };
        let terms = self.sought.iter().map(term).collect();
        program.with_sum("the sum of the durations", terms, 1.0)
    }
}
