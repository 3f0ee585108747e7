//! Voltages as the steps of a motion ask for them.

/// Voltages in V as functions of time, by scalar of an interval.
pub trait Drive {
    /// Those at a part, from 0 to 1, of a step between two times in ms; at its ends the limits from within the step.
    fn at(&self, step: [f64; 2], part: f64) -> Vec<f64>;
}

/// Voltages that are constant over each step: a function of its two times.
impl<F: Fn(f64, f64) -> Vec<f64>> Drive for F {
    fn at(&self, [from, to]: [f64; 2], _part: f64) -> Vec<f64> {
        self(from, to)
    }
}
