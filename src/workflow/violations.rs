//! Violated equations and limits of a point, by name.

use serde::Serialize;

use crate::control::{Row, Transcription};
use crate::model::{Role, Size};
use crate::nlp::Nlp;

/// A row that does not hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Equation or limit of the row.
    pub row: String,
    /// Distance to its bounds in its unit; absent where the row has no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub violation: Option<f64>,
    /// The unit; none of a pure number.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// The same, scaled as in the solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled: Option<f64>,
}

/// The worst `count` rows that are violated by more than `tolerance` in the measure of the solver.
pub fn violations(
    program: &mut Transcription<'_>,
    x: &[f64],
    tolerance: f64,
    count: usize,
) -> Vec<Violation> {
    let bounds = program.constraints().clone();
    let mut g = vec![0.0; bounds.lower.len()];
    program.constraint(x, &mut g);
    let excess = |row: usize| bounds.excess(row, g[row]);
    let mut rows: Vec<usize> = (0..g.len()).filter(|&r| excess(r) > tolerance).collect();
    rows.sort_by(|&a, &b| excess(b).total_cmp(&excess(a)));
    rows.truncate(count);
    let describe = |row: usize| {
        let scaled = Some(excess(row)).filter(|excess| excess.is_finite());
        let scale = program.row_scale(row);
        let (violation, unit) = match program.unknowns().rows[row] {
            Row::Limit { limit, .. } => {
                let plain = |value: f64| program.plain(limit, value / scale);
                let bound = match g[row] < bounds.lower[row] {
                    true => bounds.lower[row],
                    false => bounds.upper[row],
                };
                let (value, unit) = plain(g[row]);
                ((value - plain(bound).0).abs(), unit)
            }
            other => of_equation(program, other, excess(row) / scale),
        };
        Violation {
            row: program.constraint_name(row),
            violation: scaled.map(|_| violation),
            unit,
            scaled,
        }
    };
    rows.into_iter().map(describe).collect()
}

/// The violation of an equation with its unit: the momentum that a balance misses, the value of a constraint of places and directions, or the
/// charge that is missing at an electrode times the interval; of a value that is a function of time, the value.
fn of_equation(program: &Transcription<'_>, row: Row, violation: f64) -> (f64, &'static str) {
    let model = program.model();
    let Some(variable) = row.of(&model.variables) else {
        return (violation, "");
    };
    if let Row::Time { .. } = row {
        let of_coordinate = match variable.size {
            Size::Length => "mm",
            _ => "rad",
        };
        let of_input = variable.source.map(|s| model.input_kind(s).unit());
        return (violation, of_input.unwrap_or(of_coordinate));
    }
    match (variable.role, variable.size) {
        (Role::Coordinate, Size::Length) => (violation, "N ms"),
        (Role::Coordinate, _) => (violation, "N mm ms"),
        (Role::Multiplier, _) => (violation / model.multiplier_time, ""),
        (Role::Potential, _) => (violation / variable.unit, "mC ms"),
        _ => (violation, ""),
    }
}
