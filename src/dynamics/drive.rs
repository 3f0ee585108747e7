//! Voltages as the steps of a motion ask for them.

/// Voltages in V as functions of time, by scalar of an interval.
pub trait Drive {
    /// Those at a part, from 0 to 1, of a step between two times in ms; at its ends the limits from within the step.
    fn at(&self, step: [f64; 2], part: f64) -> Vec<f64>;

    /// Those at both ends of a step; `None` where they are constant over the steps.
    fn ends(&self, _step: [f64; 2]) -> Option<[Inputs; 2]> {
        None
    }
}

/// Inputs at an end of a step, as the limits from within the step, by scalar of an interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Values in V and units of loads.
    pub values: Vec<f64>,
    /// Their rates per ms.
    pub rates: Vec<f64>,
}

/// Voltages that are constant over each step: a function of its two times.
impl<F: Fn(f64, f64) -> Vec<f64>> Drive for F {
    fn at(&self, [from, to]: [f64; 2], _part: f64) -> Vec<f64> {
        self(from, to)
    }
}
