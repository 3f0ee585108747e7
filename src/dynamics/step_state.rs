//! The state of a stepper at the end of a step: from it the next steps have the bits that they would have had without a stop.
//!
//! Besides the state of the equations that is the tangent which was factorised last, where later steps go on with it: its factors are made
//! again from the same matrix by the same method.

use crate::dynamics::step_report::StepperReport;
use crate::sparse::MethodState;

/// All that the next steps follow from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepState {
    /// State of the equations, list by list; none before the first step.
    pub lists: Vec<(String, Vec<f64>)>,
    /// The tangent that is kept, where one is.
    pub tangent: Option<TangentState>,
    /// What the steps took.
    pub report: StepperReport,
    /// Length in ms that the next step may have, where a tolerance controls it.
    pub wanted: Option<f64>,
}

/// A tangent that is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TangentState {
    /// Step in ms that it belongs to; none where there are no factors.
    pub step: Option<f64>,
    /// Whether the symmetric part of the matrix is factorised.
    pub is_approximate: bool,
    /// How it is factorised.
    pub method: MethodState,
    /// Entries of the matrix.
    pub matrix: Vec<f64>,
}
