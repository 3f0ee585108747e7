//! Simulations.

use crate::control::problem;
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{DiscreteTrajectory, Integrator, Newton, Solving};
use crate::interface::error::{Entry, Error, Result, signals};
use crate::interface::handle::{Handle, Input, builder};
use crate::interface::motion::Motion;
use crate::interface::state::State;
use crate::math::{Signal, refuse};
use crate::model::components::Load;
use crate::model::{Model, System};
use crate::stop;
use crate::tasks::{self, SimulationRequest};
use crate::workflow::Simulated;
use std::sync::Arc;

/// A simulation under given voltages.
#[derive(Clone, Debug)]
pub struct Simulation {
    duration: f64,
    step: Option<f64>,
    start: State,
    voltages: Vec<(Input, Signal)>,
    integrator: Integrator,
}

impl Simulation {
    /// Over a duration in ms, from the reference configuration at rest, without voltages, by the midpoint variational integrator
    /// with steps that a tolerance of 10⁻³ controls.
    pub fn over(duration: f64) -> Self {
        Self {
            duration,
            step: None,
            start: State::Reference,
            voltages: Vec::new(),
            integrator: Integrator::default(),
        }
    }

    /// Simulates.
    ///
    /// # Errors
    /// System or simulation make no sense, a step fails, or Ctrl-C is pressed where
    /// [`interrupt`](crate::stop) listens.
    pub fn run(&self, system: &System) -> Result<Motion> {
        let system = &system.checked()?;
        let task = self.resolve(system)?;
        let request = SimulationRequest::default();
        let go_on = &mut |_: usize, _: &Model, _: &DiscreteTrajectory| stop::go_on();
        let result = tasks::simulate(system, &task, request, go_on)?;
        let moved = &result.simulated;
        let trajectory = Trajectory::from_discrete(&moved.model, &moved.discrete);
        let assessment = result.assess(system, &task, &trajectory);
        let Simulated {
            model,
            discrete,
            failure,
            ..
        } = result.simulated;
        let motion = Box::new(Motion {
            exchange: assessment.exchange,
            model: Arc::new(model),
            discrete: Arc::new(discrete),
            trajectory,
            remarks: assessment.remarks.0,
        });
        match failure {
            Some(source) => Err(Error::Step { source, motion }),
            None if result.stopped.is_some() => Err(Error::Interrupted { motion }),
            None => Ok(*motion),
        }
    }

    fn resolve(&self, system: &System) -> Result<problem::Simulation> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        refuse!(unless positive(self.duration), Entry("simulation");
            found format!("a duration of {} ms", self.duration), expected "a positive one");
        if let Some(step) = self.step {
            refuse!(unless positive(step) && step <= self.duration, Entry("simulation");
                found format!("steps of {step} ms"), expected "positive steps within the duration");
        }
        let controlled = self.step.is_none();
        let holds = !controlled || self.integrator == Integrator::Midpoint;
        refuse!(unless holds, Entry("simulation");
            found format!("{} without a step", self.integrator.name()),
            expected "a step: only the midpoint rule chooses its steps");
        let signals = signals(&self.voltages, "simulation", system)?;
        Ok(problem::Simulation {
            duration: self.duration,
            step: self
                .step
                .unwrap_or(problem::Simulation::FIRST * self.duration),
            tolerance: controlled.then_some(problem::Simulation::TOLERANCE),
            start: self.start.resolve(system)?,
            voltages: signals.into(),
            coordinates: None,
            solving: Solving {
                integrator: self.integrator,
                newton: Newton::for_system(system),
                ..Solving::default()
            },
            controller: None,
        })
    }
}

builder! {
    impl Simulation;
    /// The size of a load in N, or N mm of a torque: a constant or a [`Signal`], whose value in the middle of each step acts during the
    /// step.
    load(load: Handle<Load>, size: impl Into<Signal>) |of| of.voltages.push((load.into(), size.into()));
    /// Equal steps in ms.
    step(step: f64) |of| of.step = Some(step);
    /// Another start.
    start(start: State) |of| of.start = start;
    /// The voltage of a muscle or electrode: a constant in V or a [`Signal`]; its value in the middle of each step acts during
    /// the step.
    voltage(input: impl Into<Input>, signal: impl Into<Signal>) |of| of.voltages.push((input.into(), signal.into()));
    /// Another method; it needs a step of given length.
    integrator(integrator: Integrator) |of| of.integrator = integrator;
}
