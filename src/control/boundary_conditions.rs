//! Boundary conditions of a motion: its start and its terminal state.

use crate::control::error::BoundaryError;
use crate::control::limits::Limits;
use crate::dynamics::{Equilibrium, Start, stable_equilibrium};
use crate::model::{Analysis, Model, ModelError, Presolved, Role, with_parameters};

/// A control problem's model with its start and goal.
#[derive(Debug)]
pub struct BoundaryConditions {
    /// Start of the motion.
    pub start: Start,
    /// Changes of its momenta with sought masses.
    pub momentum_slopes: Vec<MomentumSlopes>,
    /// End of the motion.
    pub goal: TerminalState,
    /// Voltages at rest before the start and after the goal (V, one per muscle), where known.
    pub rest: [Option<Vec<f64>>; 2],
    /// True of the start, and of the goal, where it is a state of rest that depends on free parameters: its coordinates are unknowns.
    pub sought_rest: [bool; 2],
    /// Limits and goal equations.
    pub limits: Limits,
    /// Notes on both.
    pub notes: Vec<String>,
}

impl BoundaryConditions {
    /// A start in a number of coordinates, and an open end.
    pub fn without_goal(start: Start, coordinates: usize) -> Self {
        Self {
            start,
            momentum_slopes: Vec::new(),
            goal: TerminalState {
                coordinates: vec![None; coordinates],
                rests: Rests::Nothing,
                rest: None,
            },
            rest: [None, None],
            sought_rest: [false; 2],
            limits: Limits::default(),
            notes: Vec::new(),
        }
    }
}

/// Derivatives of the momenta of a start by a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentumSlopes {
    /// Index of the parameter.
    pub parameter: usize,
    /// Its value at the start.
    pub value: f64,
    /// A derivative for each coordinate.
    pub slopes: Vec<f64>,
}

/// Part of the system that comes to rest at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rests {
    /// Every coordinate.
    Everything,
    /// Bodies, and nodes that are held to them.
    Bodies,
    /// Nothing.
    Nothing,
}

/// The final state, with these coordinates given.
#[derive(Clone, Debug, PartialEq)]
pub struct TerminalState {
    /// Given coordinates; `None` where the optimisation decides.
    pub coordinates: Vec<Option<f64>>,
    /// Part of the system that rests.
    pub rests: Rests,
    /// The equilibrium that it is, where it is one under voltages that are named.
    pub rest: Option<Equilibrium>,
}

impl TerminalState {
    /// Charts of the equilibrium, behind this number of unknowns; none where the state is no equilibrium.
    pub fn charts(&self, unknowns: usize) -> &[f64] {
        self.rest.as_ref().map_or(&[], |rest| &rest.z[unknowns..])
    }

    /// Sets what the state gives in the coordinates of an instant, whose charts stand behind this number of unknowns.
    pub(super) fn give(&self, z: &mut [f64], unknowns: usize) {
        for (value, given) in z.iter_mut().zip(&self.coordinates) {
            *value = given.unwrap_or(*value);
        }
        let charts = z[unknowns..].iter_mut().zip(self.charts(unknowns));
        charts.for_each(|(value, chart)| *value = *chart);
    }
}

/// The equilibrium under voltages (V, one per muscle), with free parameters at their guesses and prescribed coordinates at a time in ms.
///
/// # Errors
/// There is none.
pub fn rest_at(
    model: &Model,
    voltages: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    let parameters = &model.analysis.parameters;
    if parameters.is_empty() {
        return equilibrium(model, voltages, place, time);
    }
    let guesses: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
    let mut found = rest_with(model, voltages, &guesses, place, time)?;
    let at = model.variables.range(Role::Parameter).start;
    found.scalars.splice(at..at, guesses);
    Ok(found)
}

/// The equilibrium with given values of the parameters: loads grow from zero, and parameters are none.
pub(super) fn rest_with(
    model: &Model,
    voltages: &[f64],
    values: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    equilibrium(&with_values(model, values)?, voltages, place, time)
}

/// The model without free parameters, with values put in their places.
pub(super) fn with_values(model: &Model, values: &[f64]) -> Result<Model, ModelError> {
    let sought = &model.analysis;
    let system = with_parameters(&model.system, &sought.parameters, values);
    // What may move is that of the model.
    let presolved = Presolved::new(&system, sought);
    let given = Analysis {
        parameters: Vec::new(),
        coordinates: Some(model.coordinates),
        ..sought.clone()
    };
    Model::of_presolved(system, given, presolved)
}

fn equilibrium(
    model: &Model,
    voltages: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    let zero = model.reference_coordinates_at(time);
    let found = stable_equilibrium(model, &zero, &model.scalars(voltages));
    found.map_err(|source| BoundaryError::NoEquilibrium { place, source })
}
