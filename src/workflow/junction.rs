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
use crate::control::problem::ControlTask;
use crate::model::{Model, Role};
use crate::nlp::joined::{Joined, SharedRow, SharedVariable};
use crate::workflow::error::WorkflowError;

/// Refuses what cannot go on from one phase to the next.
///
/// # Errors
/// The coordinates of both are not the same, or a joint turns about a point, or closes a loop.
fn check(pair: [&Model; 2], names: [&str; 2]) -> Result<(), WorkflowError> {
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

/// The coordinates of all junctions of phases, by their names, and the balances there; phases are the first ones of a number of programs.
///
/// # Errors
/// As of [`check`].
pub(super) fn shared(
    names: &[&str],
    phases: &[&Transcription<'_>],
    programs: usize,
) -> Result<(Vec<SharedVariable>, Vec<SharedRow>), WorkflowError> {
    let (mut variables, mut rows) = (Vec::new(), Vec::new());
    for (first, pair) in phases.windows(2).enumerate() {
        let [a, b] = [pair[0], pair[1]];
        check(
            [a, b].map(Transcription::model),
            [names[first], names[first + 1]],
        )?;
        let columns = |i: usize| {
            let own = a.unknowns().unknown(a.intervals(), i);
            own.zip(b.unknowns().unknown(0, i))
        };
        let balances = |i: usize| {
            let own = a.unknowns().row(a.intervals(), i);
            own.zip(b.unknowns().row(0, i))
        };
        for i in a.model().variables.range(Role::Coordinate) {
            variables.extend(columns(i).map(|(one, other)| {
                let mut places = vec![None; programs];
                places[first] = Some((one, 1.0));
                places[first + 1] = Some((other, a.column_scale(one) / b.column_scale(other)));
                SharedVariable(places)
            }));
            rows.extend(balances(i).map(|(one, other)| {
                let factor = a.row_scale(one) / b.row_scale(other);
                SharedRow(vec![(first, one, 1.0), (first + 1, other, factor)])
            }));
        }
    }
    Ok((variables, rows))
}

/// The program of phases with the sum of their durations in ms as a row, where some are sought.
pub(super) fn lasting<'m>(
    program: Joined<Transcription<'m>>,
    task: &ControlTask<'_>,
    whole: f64,
) -> Joined<Transcription<'m>> {
    let (mut terms, mut left) = (Vec::new(), whole);
    for (number, (part, phase)) in program.parts().zip(&task.motions).enumerate() {
        match part.unknowns().horizon() {
            Some(own) => {
                let (column, factor) = program.places().variable_of(number, own);
                let length = part.intervals() as f64 * part.column_scale(own);
                terms.push((column, factor * length));
            }
            None => left -= phase.control.duration.first(),
        }
    }
    if terms.is_empty() {
        return program;
    }
    let terms = terms
        .into_iter()
        .map(|(column, length)| (column, length / left));
    program.with_sum("the sum of the durations", terms.collect(), 1.0)
}
