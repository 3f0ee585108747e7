//! The equations of a step, which every time stepping method has.

use crate::coordinates::Configuration;
use crate::dynamics::drive::Drive;
use crate::dynamics::interval_energies::Work;
use crate::dynamics::resolution::Balance;
use crate::functional::{NodeBlocks, Order};
use crate::model::Model;

/// The equations that lead from one instant to the next.
pub trait Equations {
    /// Takes the voltages of a step between two times in ms, at the points where the method reads them.
    fn begin(&mut self, step: [f64; 2], drive: &dyn Drive);

    /// First guess of the unknowns of a step of `h` ms.
    fn guess(&mut self, h: f64);

    /// Writes the residual; at order `Hessian` also the tangent, to a matrix of nodes where there is one.
    fn evaluate(
        &mut self,
        order: Order,
        h: f64,
        residual: &mut [f64],
        nodes: Option<&mut NodeBlocks>,
    );

    /// Values of the tangent.
    fn values(&self) -> &[f64];

    /// Subtracts an update from the unknowns.
    fn update(&mut self, update: &[f64]);

    /// Undoes what a failed attempt changed in the state.
    fn restore(&mut self);

    /// The model.
    fn model(&self) -> &Model;

    /// Places the end of the step where the last update put it.
    fn place_end(&mut self);

    /// The start and the end of the step.
    fn ends(&self) -> [&Configuration; 2];

    /// Energy balance of the step that the last update led to, where the method has one.
    fn balance(&mut self, _h: f64) -> Option<Balance> {
        None
    }

    /// Local error of the step that the last update led to, relative to the sizes of the coordinates; zero where the method
    /// has no estimate.
    fn local_error(&mut self, _h: f64) -> f64 {
        0.0
    }

    /// Hands over all numbers from which the next steps follow, list by list, always in the same order; what `visit` writes is then the state.
    fn visit_state(&mut self, visit: &mut dyn FnMut(&'static str, &mut [f64]));

    /// Updates the equations after a change of the state.
    fn take_state(&mut self);

    /// Makes the end of the step the state, unless the momentum does not exist there.
    fn accept(&mut self, h: f64) -> bool;

    /// Name of an unknown.
    fn unknown_name(&self, unknown: usize) -> String;

    /// Time in ms.
    fn time(&self) -> f64;

    /// Coordinates and multipliers now.
    fn coordinates(&self) -> &[f64];

    /// Momentum of each coordinate now.
    fn momentum(&self) -> &[f64];

    /// Voltages and potentials of the last interval.
    fn scalars(&self) -> &[f64];

    /// Multipliers at the start of the step, where the method knows them there.
    fn multipliers(&self) -> &[f64];

    /// Work in mJ that forces without a potential did over the last step, where its ends alone do not determine it.
    fn work(&self) -> Option<Work> {
        None
    }
}
