//! Static equilibria.

use crate::control::problem::{AtRest, VibrationRequest};
use crate::dynamics::{EnergyExchange, Vibration};
use crate::interface::error::{Entry, Error, Result, row};
use crate::interface::handle::{Handle, Input, builder};
use crate::interface::motion::Motion;
use crate::math::refuse;
use crate::model::components::Load;
use crate::model::{NO_BRANCHES, Response, System};
use crate::tasks::{self, EquilibriumResult, EquilibriumTaskError};
use crate::workflow::WorkflowError;
use std::sync::Arc;

/// A stable static equilibrium under constant voltages and loads; zero where nothing is said.
#[derive(Clone, Debug, Default)]
pub struct Equilibrium {
    inputs: Vec<(Input, f64)>,
    response: Response,
}

impl Equilibrium {
    /// Under weights alone.
    pub fn new() -> Self {
        Self::default()
    }

    /// Finds the vibrations about it, up to `count` of those of lowest natural frequency, exact for any damping.
    ///
    /// # Errors
    /// As of [`find`](Self::find) without the errors of an unstable state, or there are no vibrations: nothing that moves has inertia, or the
    /// stiffness is singular.
    pub fn vibrations(&self, system: &System, count: usize) -> Result<Vec<Vibration>> {
        let request = VibrationRequest { count, sweep: None };
        let result = self.ask(system, Some(request))?;
        let found = result.vibrations.ok_or_else(|| {
            let remarks = result.remarks.0.iter();
            let told: Vec<&str> = remarks.map(|remark| remark.text.as_str()).collect();
            Error::Workflow(WorkflowError::problem("equilibrium", told.join("; ")))
        })?;
        Ok(found.modes.vibrations)
    }

    /// Finds it, as a motion of one instant.
    ///
    /// # Errors
    /// The system makes no sense, an input is not one of it, growing loads lose stability ([`Error::StabilityLost`] has the last equilibrium
    /// before), no stable equilibrium was found ([`Error::Unstable`] has an unstable one), or there is no equilibrium at all.
    pub fn find(&self, system: &System) -> Result<Motion> {
        let result = self.ask(system, None)?;
        let model = &result.model;
        let motion = Motion {
            exchange: EnergyExchange::new(&model.system, &result.trajectory, [None, None]),
            model: Arc::new(result.model),
            discrete: Arc::new(result.discrete),
            trajectory: result.trajectory,
            remarks: result.remarks.0,
        };
        match result.loss {
            None if result.found.is_stable() == Some(false) => Err(Error::Unstable {
                motion: Box::new(motion),
            }),
            None => Ok(motion),
            Some(loss) => Err(Error::StabilityLost {
                fraction: loss.fraction,
                motion: Box::new(motion),
            }),
        }
    }

    fn ask(
        &self,
        system: &System,
        vibrations: Option<VibrationRequest>,
    ) -> Result<EquilibriumResult> {
        let system = &system.checked()?;
        let voltages = row(&self.inputs, "equilibrium", system)?;
        let holds = self.response == Response::Relaxed || system.has_branches();
        refuse!(unless holds, Entry("equilibrium");
            found "an instantaneous response", expected NO_BRANCHES);
        let task = AtRest {
            voltages,
            coordinates: None,
            response: self.response,
            path: None,
            vibrations,
        };
        tasks::equilibrium(system, &task).map_err(|error| match error {
            EquilibriumTaskError::Workflow(error) => Error::Workflow(error),
            EquilibriumTaskError::NotFound(error) => Error::NoEquilibrium(error),
        })
    }
}

builder! {
    impl Equilibrium;
    /// The size of a load in N, or N mm of a torque.
    load(load: Handle<Load>, size: f64) |of| of.inputs.push((load.into(), size));
    /// The voltage of a muscle or electrode in V.
    voltage(input: impl Into<Input>, volts: f64) |of| of.inputs.push((input.into(), volts));
    /// The state right after the voltages and loads came to act: Maxwell branches are springs without stress in the reference
    /// configuration. Otherwise the state after a long time, in which they carry nothing.
    instantaneous() |of| of.response = Response::Instantaneous;
}
