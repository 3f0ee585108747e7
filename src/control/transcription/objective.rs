//! The objective on a horizon: costs of voltages, of quantities and of energies, with its scale.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::guess::InitialGuess;
use crate::control::objective::{Cost, objective_scale};
use crate::control::problem::Control;
use crate::control::transcription::cost_rows::{CostRow, cost_rows, costs_size};
use crate::control::transcription::energy_rows::{EnergyRow, energies_size, energy_rows};
use crate::control::transcription::units::{KILOVOLT, MILLISECOND};
use crate::model::{Model, Role};

/// The objective of a control problem on its grid.
#[derive(Clone, Debug)]
pub(super) struct Objective {
    pub(super) cost: Cost,
    /// Costs of quantities.
    pub(super) quantities: Vec<CostRow>,
    /// Costs of energies.
    pub(super) energies: Vec<EnergyRow>,
    /// Each voltage of an interval: its place among the scalars, and the slot of its second derivative with itself.
    pub(super) voltages: Vec<(usize, usize)>,
    /// Factor that brings the objective near 1.
    pub(super) scale: f64,
    /// Unit of voltages in kV.
    pub(super) kilovolt: f64,
}

impl Objective {
    /// The objective of a problem; the guess gives the length of an interval.
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        control: &Control,
        initial: &InitialGuess,
    ) -> Self {
        let (objective, intervals) = (&control.objective, control.intervals);
        let (paid, energies) = (&objective.quantities, &objective.energies);
        let voltages = model.variables.range(Role::Voltage);
        let kilovolts = |volts: &Vec<f64>| {
            let scalars = model.scalars(volts);
            scalars.iter().map(|v| v / KILOVOLT).collect::<Vec<_>>()
        };
        let ends = boundary.rest.each_ref();
        let ends = ends.map(|volts| volts.as_ref().map(kilovolts));
        let duration = intervals as f64 * initial.h * MILLISECOND;
        let volts = control.voltage_unit(&model.system);
        let size = costs_size(model, paid, duration) + energies_size(model, energies, volts);
        let scalars = &model.action.layout().scalars;
        let slot = |s: usize| {
            let slot = scalars.find(s, s);
            (s, slot.expect("a voltage has a curvature of its own"))
        };
        Self {
            cost: Cost::new(objective, voltages.len(), intervals, ends),
            quantities: cost_rows(model, paid, boundary.limits.list.len(), intervals),
            energies: energy_rows(model, energies, &boundary.rest, intervals),
            voltages: voltages.map(slot).collect(),
            scale: objective_scale(objective, volts / KILOVOLT, duration, size),
            kilovolt: volts / KILOVOLT,
        }
    }
}
