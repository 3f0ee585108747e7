//! The objective on a horizon: costs of inputs, of quantities and of energies, with its scale.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::objective::Cost;
use crate::control::problem::Control;
use crate::control::transcription::cost_rows::{CostRow, cost_rows};
use crate::control::transcription::energy_rows::{EnergyRow, energy_rows};
use crate::control::transcription::layout::Layout;
use crate::model::{Model, Time, Variable};

/// The objective of a control problem on its grid.
#[derive(Clone, Debug)]
pub(super) struct Objective {
    pub(super) cost: Cost,
    /// Costs of quantities.
    pub(super) quantities: Vec<CostRow>,
    /// Costs of energies.
    pub(super) energies: Vec<EnergyRow>,
    /// Voltages and loads of an interval.
    pub(super) inputs: Vec<CostInput>,
    /// Factor that brings the objective near 1, which follows from its value at the guess.
    pub(super) scale: f64,
}

/// A voltage or load in the objective.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostInput {
    /// Its place among the scalars.
    pub(super) scalar: usize,
    /// Slot of its second derivative with itself.
    pub(super) slot: usize,
    /// Size of one kV, N or N m in the unit inside; infinite of a given one, which costs nothing.
    pub(super) unit: f64,
    /// Scale of its variable in kV, N or N m.
    pub(super) scale: f64,
    /// Scale of its variable in the unit inside.
    pub(super) size: f64,
}

impl CostInput {
    /// The voltages and loads of an interval of a model.
    fn of_model(model: &Model, control: &Control) -> Vec<Self> {
        let slots = &model.action.layout().scalars;
        let input = |(s, variable): (usize, &Variable)| {
            let source = variable.source.expect("an input of a source");
            let unit = unit_of(model, control, source);
            let size = control.size(variable, model);
            Self {
                scalar: s,
                slot: slots
                    .find(s, s)
                    .expect("an input has a curvature of its own"),
                unit,
                scale: size / unit,
                size,
            }
        };
        let variables = &model.variables.of(Time::Interval)[model.variables.sources_range()];
        variables.iter().enumerate().map(input).collect()
    }
}

impl Objective {
    /// The objective of a problem on a layout.
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        (control, layout): (&Control, &Layout),
    ) -> Self {
        let objective = &control.objective;
        let (paid, energies) = (&objective.quantities, &objective.energies);
        let inputs = CostInput::of_model(model, control);
        let ends = boundary.rest.each_ref();
        let ends = ends.map(|row| row.as_ref().map(|row| counted(model, &inputs, row)));
        Self {
            cost: Cost::new(objective, inputs.len(), layout.span(), ends),
            quantities: cost_rows(
                model,
                paid,
                energies,
                boundary.limits.quantities().len(),
                layout.end,
            ),
            energies: energy_rows(model, energies, &boundary.rest, layout.intervals),
            inputs,
            scale: 1.0,
        }
    }
}

/// Size of one kV, N or N m of an input in the unit inside; infinite of a given one, which costs nothing.
pub(super) fn unit_of(model: &Model, control: &Control, source: usize) -> f64 {
    match control.is_given(source) {
        true => f64::INFINITY,
        false => model.input_kind(source).counted().1,
    }
}

/// Inputs of an interval in kV, N and N m, from those of all sources.
pub(super) fn counted(model: &Model, inputs: &[CostInput], row: &[f64]) -> Vec<f64> {
    let values = model.variables.sources().map(|source| row[source]);
    let values = values.zip(inputs);
    values.map(|(value, input)| value / input.unit).collect()
}
