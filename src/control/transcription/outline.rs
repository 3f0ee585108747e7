//! Columns, rows and limits of a program without the program.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::bounded_quantity::BoundedQuantity;
use crate::control::numbering::Numbering;
use crate::control::problem::Control;
use crate::control::transcription::layout::Layout;
use crate::model::Model;

/// The variables and equations that the program of a control problem has.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Columns and rows.
    pub unknowns: Numbering,
    /// Limits and goals, to which rows refer.
    pub limits: Vec<BoundedQuantity>,
}

impl Outline {
    /// The outline of the program of a problem.
    pub fn new(model: &Model, boundary: &BoundaryConditions, control: &Control) -> Self {
        let layout = Layout::new(model, boundary, control, control.intervals);
        let limits = layout.limits.into_iter().map(|limit| limit.bounded);
        Self {
            limits: limits.collect(),
            unknowns: layout.unknowns,
        }
    }
}
