//! Voltages whose squares a solver may take as unknowns.

use crate::control::numbering::Column;
use crate::control::transcription::Transcription;
use crate::control::transcription::limit_rows::Site;
use crate::model::Role;

impl Transcription<'_> {
    /// Columns of voltages between zero and a bound that enter by their squares alone: sources that drive lumped muscles and nothing else,
    /// where the objective has no rate and no energy.
    pub(super) fn voltages_by_squares(&self) -> Vec<usize> {
        if !self.objective.cost.is_of_squares() || !self.objective.energies.is_empty() {
            return Vec::new();
        }
        let model = self.model;
        let terms = model.action.intervals.terms.iter();
        let limits = self.layout.limits.iter();
        let limits = limits.filter(|limit| limit.site == Site::Intervals);
        let others = terms
            .flat_map(|term| term.not_by_squares())
            .chain(
                limits.flat_map(|limit| limit.site.measure(model, limit.measure).not_by_squares()),
            )
            .chain(
                self.objective
                    .quantities
                    .iter()
                    .flat_map(|cost| cost.scalars.clone()),
            );
        let others: Vec<usize> = others.collect();
        let is_square = |&i: &usize| {
            let column = self.layout.unknowns.columns[i];
            let (low, high) = (self.bounds.lower[i], self.bounds.upper[i]);
            let is_voltage = column.of(&model.variables).role == Role::Voltage;
            let Column::Interval { s, .. } = column else {
                return false;
            };
            is_voltage && low == 0.0 && high > 0.0 && high.is_finite() && !others.contains(&s)
        };
        (0..self.layout.unknowns.columns.len())
            .filter(is_square)
            .collect()
    }
}
