//! Conversion of what the midpoint rule sees in the middle of intervals to values at instants, by means over both intervals next to each.

use crate::dynamics::trajectory::Column;

/// Linear and angular momentum by axis.
pub(super) type Momenta = [f64; 6];

/// Values at one instant.
#[derive(Debug)]
pub(super) struct State {
    pub(super) charges: Vec<f64>,
    pub(super) kinetic: f64,
    pub(super) potential: Vec<f64>,
    pub(super) momenta: Momenta,
    /// Values of the [parts](crate::dynamics::part_columns::PartColumns).
    pub(super) parts: Vec<f64>,
}

impl State {
    /// Charges, kinetic, potential and total energy, in the order of their columns.
    pub(super) fn of_intervals(&self) -> Vec<f64> {
        let total = self.kinetic + self.potential.iter().sum::<f64>();
        let values = self.charges.iter().copied().chain([self.kinetic]);
        let values = values.chain(self.potential.iter().copied());
        values.chain([total]).collect()
    }
}

/// Turns values in the middle of the intervals that end at the rows into values at the rows; `last` holds those of the last one.
pub(super) fn to_instants(times: &[f64], columns: &mut [Column], last: &[f64]) {
    let end = times.len() - 1;
    let length = |k: usize| times[k] - times[k - 1];
    for (column, value) in columns.iter_mut().zip(last) {
        for k in 1..end {
            let (before, after) = (length(k), length(k + 1));
            let sum = column.values[k] * after + column.values[k + 1] * before;
            column.values[k] = sum / (before + after);
        }
        column.values[end] = *value;
    }
}

/// Turns momenta as the interval before each row sees them into means of both intervals next to it, each weighted by the length of
/// the other, so that a constant reaction cancels; `before` holds what the interval that ends at a row sees at the row before.
pub(super) fn means(times: &[f64], columns: &mut [Column], before: &[Momenta], last: &State) {
    let end = times.len() - 1;
    for (i, column) in columns.iter_mut().enumerate() {
        for k in 1..end {
            let [earlier, later] = [times[k] - times[k - 1], times[k + 1] - times[k]];
            let sum = column.values[k] * later + before[k + 1][i] * earlier;
            column.values[k] = sum / (earlier + later);
        }
        column.values[end] = last.momenta[i];
    }
}
