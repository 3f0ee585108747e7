//! Values and derivatives of the rows of functions of time.

use crate::control::transcription::Transcription;

impl Transcription<'_> {
    /// v − S(c h) at a point.
    pub(super) fn time_value(&self, place: usize, x: &[f64]) -> f64 {
        let column = self.layout.times.column(place);
        let [value, ..] = self.layout.times.derivatives(place, self.workspace.h);
        self.variable_scales[column] * x[column] - value
    }

    /// Gradients by v and h, behind those of the limits.
    pub(super) fn time_gradients(&mut self) {
        let times = &self.layout.times;
        let first = self.workspace.values.len() - 2 * times.len();
        let pairs = self.workspace.values[first..].chunks_exact_mut(2);
        for (place, pair) in pairs.enumerate() {
            let [_, slope, _] = times.derivatives(place, self.workspace.h);
            pair.copy_from_slice(&[1.0, -slope]);
        }
    }

    /// Adds the second derivatives along the costates of all rows to that by the interval length twice.
    pub(super) fn time_curvature(&mut self, costates: &[f64]) {
        let (times, first) = (&self.layout.times, self.layout.first_time_row());
        if times.len() == 0 {
            return;
        }
        let along = |place: usize| {
            let row = first + place;
            let [_, _, curvature] = times.derivatives(place, self.workspace.h);
            -costates[row] * self.row_scales[row] * curvature
        };
        let sum: f64 = (0..times.len()).map(along).sum();
        let square = self
            .model
            .action
            .layout()
            .horizon_square_at(self.layout.intervals);
        self.workspace.values[square] += sum;
    }
}
