//! All that the controllers of a receding horizon share: model, motion to follow with its costs, and the law that they fall back to.

use crate::control::problem::{
    Ahead, BoundaryState, Control, Duration, Guess, Limit, Objective, Regulator, Rest, SoughtHold,
};
use crate::control::{BoundaryConditions, BoundaryError, InitialGuess, Rests, Transcription};
use crate::dynamics::{DiscreteTrajectory, Independent, step_inputs};
use crate::feedback::{Law, Measured};
use crate::ipopt::{IpoptError, Options, StartingPoint, solve};
use crate::model::{Model, Role, System, Time};
use crate::nlp::{Nlp, Status};
use crate::stop::{self, Stopped};
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::{Iterate, discrete_trajectory};
use crate::workflow::optimise::optimise;
use crate::workflow::optimum::SolveLimits;
use crate::workflow::receding::program::{Program, Reference, Steered};
use crate::workflow::regulator::{Along, NOTHING_HOLDS, NoRegulator, predicting};
use std::ops::ControlFlow;
use thiserror::Error;

/// Words on integrals.
const INTEGRAL: &str =
    "an \"integral\" of feedback (an observer with \"lasting\" forces does its work)";

/// A motion to follow, with all that its controllers share.
#[derive(Debug)]
pub struct Horizon {
    pub(super) model: Model,
    boundary: BoundaryConditions,
    /// The problem in short steps.
    control: Control,
    reference: Reference,
    law: Law,
    pub(super) steered: Steered,
    /// Weight of inputs as parts of their ranges, the unit of the barrier.
    pub(super) of_inputs: f64,
    /// Intervals from a measurement to its effect.
    delay: usize,
}

impl Horizon {
    /// Creates the horizon of a reference motion of a system, with a number of intervals as long as those of the motion. Integrals are not offered:
    /// constant disturbances of an observer do their work.
    ///
    /// # Errors
    /// There is none.
    ///
    /// # Panics
    /// If there is no interval.
    pub fn new(
        system: &System,
        along: Along<'_>,
        task: &Regulator,
        intervals: usize,
    ) -> Result<Self, NoHorizon> {
        assert!(intervals > 0, "an interval or more");
        let Along { control, rest, .. } = along;
        offered(along.model, control)?;
        if task.integral > 0.0 {
            return Err(NoHorizon::NotOffered(INTEGRAL));
        }
        let found = predicting(along, task);
        let found = found.map_err(NoHorizon::Regulator)?;
        let not_held = || {
            let reason = found.not_held.clone();
            NoHorizon::NotHeld(reason.unwrap_or_else(|| NOTHING_HOLDS.to_owned()))
        };
        let rest = rest.ok_or_else(not_held)?;
        let h = found.law.h;
        let parts = (h / task.step - 1e-9).ceil().max(1.0) as usize;
        let control = ahead(control, rest, intervals * parts, h / parts as f64);
        let refused = |error: BoundaryError| NoHorizon::Program(error.to_string());
        let (model, mut boundary) =
            BoundaryConditions::resolve(system, &control, h / parts as f64).map_err(refused)?;
        if boundary.goal.rests != Rests::Everything {
            return Err(NoHorizon::NotOffered("a goal at which only bodies rest"));
        }
        boundary.goal.coordinates.fill(None);
        boundary.start.momentum.fill(0.0);
        let measured = found.law.measured.iter();
        let (rates, places): (Vec<&Measured>, Vec<_>) = measured.partition(|one| one.is_rate);
        let is_inert = |&c: &usize| rates.iter().any(|rate| rate.name == places[c].name);
        let inputs = step_inputs(&model).into_iter().zip(&found.law.inputs);
        let forces = found.law.lasting().iter();
        let coordinates: Vec<usize> = places.iter().map(|one| named(&model, &one.name)).collect();
        let steered = Steered {
            independent: Independent::of(&model, coordinates.clone()),
            rates: found.steps[0].rates[..places.len()].to_vec(),
            forced: forces.map(|one| named(&model, &one.name)).collect(),
            coordinates,
            inert: (0..places.len()).filter(is_inert).collect(),
            inputs: inputs
                .map(|(input, of)| (input.scalar, of.is_squared))
                .collect(),
            parts,
            h: h / parts as f64,
        };
        let reference = Reference::new(&found, &model, &steered).ok_or_else(not_held)?;
        Ok(Self {
            delay: task.delayed(h),
            of_inputs: task.inputs,
            control: Control {
                start: BoundaryState::Free,
                input_intervals: parts,
                ..control
            },
            law: found.law,
            reference,
            boundary,
            model,
            steered,
        })
    }

    /// The horizon of a problem that is solved for it.
    ///
    /// # Errors
    /// There is none.
    pub fn solved(of: &Ahead) -> Result<Self, NoHorizon> {
        let Ahead {
            system,
            control,
            regulator,
            intervals,
        } = of;
        let limits = SolveLimits::default();
        let go_on = &mut |_: &Iterate<'_>| ControlFlow::Continue(());
        let optimum = optimise(system, control, None, limits, go_on);
        let optimum = optimum.map_err(|error| match stop::unless_stopped(error) {
            WorkflowError::Stopped(stopped) => NoHorizon::Stopped(stopped),
            error @ WorkflowError::NoEquilibrium { .. } => NoHorizon::Unsolved(error.to_string()),
            error => NoHorizon::Program(error.to_string()),
        })?;
        if let Some(status) = optimum.stopped.or_else(stop::reason) {
            return Err(NoHorizon::Stopped(Stopped(status)));
        }
        if !optimum.is_solved() {
            let word = optimum.word().replace('_', " ");
            return Err(NoHorizon::Unsolved(format!("no optimum was found: {word}")));
        }
        let discrete = discrete_trajectory(&optimum.model, &optimum.motion);
        let along = Along::new(&optimum, &discrete, control);
        Self::new(system, along, regulator, *intervals)
    }

    /// The law to which controllers fall back: names of all that is measured and of the inputs, bounds, length of the intervals.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// Intervals from a measurement to the effect of its inputs, over which the state is predicted.
    pub fn delay(&self) -> usize {
        self.delay
    }

    /// Number of intervals of the horizon.
    pub fn intervals(&self) -> usize {
        self.control.intervals / self.steered.parts
    }

    /// The inputs of the first interval of the optimum from a state, in the order of the law, and the status of the solver: iterated to the end, whereas
    /// a controller takes one iteration.
    ///
    /// # Errors
    /// The solver refuses the program.
    pub fn optimum(
        &self,
        interval: usize,
        state: &[f64],
    ) -> Result<(Vec<f64>, Status), IpoptError> {
        let mut program = self.program();
        program.begin = interval;
        let start = program.readings.iter().zip(state);
        let start = start.take(self.steered.coordinates.len());
        let values: Vec<f64> = start.map(|(reading, v)| v / reading.scale).collect();
        let mut z = self.boundary.start.z.clone();
        let followers = self.steered.independent.followers();
        let of_motion = &self.reference.at(interval).followers;
        let near = followers.iter().zip(of_motion);
        near.for_each(|(&i, value)| z[i] = *value);
        let momentum = self.steered.start(&self.model, state, z).momentum;
        let momenta: Vec<f64> = self.steered.moved().map(|i| momentum[i]).collect();
        program.hold_start(&values, &momenta);
        let mut x = vec![0.0; program.variables().count()];
        program.refer_all(&mut x);
        let start = StartingPoint { x, costates: None };
        let found = solve(&mut program, &start, &Options::default(), &mut |_, _| {
            ControlFlow::Continue(())
        })?;
        let mut inputs = vec![0.0; self.law.inputs.len()];
        program.first_inputs(&found.x, &mut inputs);
        Ok((inputs, found.status))
    }

    /// The program of the horizon at the start of the motion.
    pub(super) fn program(&self) -> Program<'_> {
        let guess = self.guess();
        // A moment's work that stays whole when it is time to stop.
        let _unwatched = stop::unwatched();
        let program = Transcription::of_any(&self.model, &self.boundary, &self.control, &guess);
        // Nothing stops it, and nothing else is an error.
        let program = program.expect("a program whose equations are not counted");
        Program::new(program, &self.reference, &self.steered)
    }

    /// The motion to follow over the first horizon.
    fn guess(&self) -> InitialGuess {
        let steps = self.control.intervals;
        let Steered { parts, h, .. } = self.steered;
        let mut z = vec![self.boundary.start.z.clone(); steps + 1];
        for (k, z) in z.iter_mut().enumerate() {
            let at = self.reference.at(k / parts);
            let followers = self.steered.independent.followers();
            let each = self.steered.coordinates.iter().zip(&at.state);
            let each = each.chain(followers.iter().zip(&at.followers));
            each.for_each(|(&i, value)| z[i] = *value);
        }
        let count = self.model.variables.of(Time::Interval).len();
        let mut scalars = vec![vec![0.0; count]; steps];
        for (k, scalars) in scalars.iter_mut().enumerate() {
            let inputs = &self.reference.at(k / parts).inputs;
            for (&(scalar, is_squared), value) in self.steered.inputs.iter().zip(inputs) {
                scalars[scalar] = if is_squared { value.sqrt() } else { *value };
            }
        }
        InitialGuess::of_motion(DiscreteTrajectory::in_steps(h, z, scalars), h)
    }
}

/// The coordinate of a name in a law.
fn named(model: &Model, name: &str) -> usize {
    let coordinates = model.variables.with(Role::Coordinate);
    let own = coordinates.iter().position(|one| one.name == name);
    own.expect("a coordinate of the law")
}

/// Returns an error for what the horizon can not see ahead.
fn offered(model: &Model, control: &Control) -> Result<(), NoHorizon> {
    let not = |what| Err(NoHorizon::NotOffered(what));
    if !model.prescribed.is_empty() {
        return not("a prescribed joint");
    }
    if !control.given.is_empty() || control.course.is_some() {
        return not("a given input");
    }
    if !control.parameters.is_empty() {
        return not("a free parameter");
    }
    if control.goal == BoundaryState::Periodic {
        return not("a periodic motion");
    }
    match control.limits.iter().any(Limit::is_of_steps) {
        true => not("a limit of rates, currents, powers or reactions, or at a single time"),
        false => Ok(()),
    }
}

/// The problem of a horizon of intervals of h ms: it ends in the state that is held, without costs of its own.
fn ahead(control: &Control, rest: &[f64], intervals: usize, h: f64) -> Control {
    Control {
        duration: Duration::Given(intervals as f64 * h),
        intervals,
        is_refined: false,
        goal: BoundaryState::RestAtVoltages(rest.to_vec(), Rest::Everything),
        sought_hold: SoughtHold::Never,
        objective: Objective::default(),
        varied: Vec::new(),
        outcomes: Vec::new(),
        waypoints: Vec::new(),
        guess: Guess::Interpolate,
        ..control.clone()
    }
}

/// Reason why there is no controller with a receding horizon.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoHorizon {
    /// There is no regulator of the motion, whose costs it takes.
    #[error(transparent)]
    Regulator(NoRegulator),
    /// Nothing holds the goal after the end.
    #[error("the goal is not held after the end: {0}")]
    NotHeld(String),
    /// The program of the horizon does not exist.
    #[error("{0}")]
    Program(String),
    /// Something of the problem is not offered.
    #[error("{0}, which a receding horizon does not take in")]
    NotOffered(&'static str),
    /// The problem has no optimum that was found.
    #[error("{0}")]
    Unsolved(String),
    /// It was time to stop.
    #[error("{}", .0.0.word())]
    Stopped(Stopped),
}

impl NoHorizon {
    /// The same as an error at a place of a problem, with words in front.
    pub(crate) fn at(self, place: &str, words: &str) -> WorkflowError {
        let place = place.to_owned();
        let reason = format!("{words}{self}");
        match self {
            Self::Stopped(stopped) => stopped.into(),
            Self::Unsolved(_) => WorkflowError::Unsolved { place, reason },
            _ => WorkflowError::Problem { place, reason },
        }
    }
}
