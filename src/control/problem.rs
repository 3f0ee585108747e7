//! Tasks of a problem: simulation, equilibrium, control, identification. Units g, mm, ms, N, V.
//!
//! Numbers of a problem by which its optimum is differentiated.

use crate::control::identification::{Earlier, Solution};
use crate::dynamics::Solving;
use crate::feedback::Law;
use crate::ipopt::{LinearSolver, OptionValue};
use crate::math::Signal;
use crate::model::system::{InputKind, System};
use crate::model::{Coordinates, Parameter, Role, SiUnit, Variable};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

pub use crate::control::at_rest::{AtRest, FrequencySweep, VibrationRequest};
pub use crate::control::boundary_state::{BoundaryState, Hold, Rest, SoughtHold};
pub use crate::control::costs::{CostFunction, During, Objective, QuantityCost};
pub use crate::control::costs::{EnergyCost, SourceEnergy};
pub use crate::control::goal::{Orientation, Place};
pub use crate::control::goal::{Waypoint, instant_at};
pub use crate::control::identification::{
    ChangedScene, Channel, Identification, Prior, Reading, Recording, Regime, SoughtStart,
    begin_late,
};
pub use crate::control::inputs::{Afterwards, TableEnd, Voltages, absent_loads};
pub use crate::control::limits::Limit;
pub use crate::control::regulator::{Noise, Observation, Regulator};

/// A task with everything resolved: one voltage per muscle, indices for names.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// Integrate forward in time.
    Simulate(Simulation),
    /// Find a static equilibrium.
    Equilibrium(AtRest),
    /// Find optimal voltages.
    Control(Box<Control>),
    /// Find several optimal motions with constants or inputs in common.
    Motions(Box<Motions>),
    /// Fit constants to recordings.
    Identify(Box<Identification>),
}

impl Task {
    /// The motions of a control problem, of which a single one has no name; none of another task.
    pub fn motions<'a>(&'a self, system: &'a System) -> Option<ControlTask<'a>> {
        match self {
            Self::Control(control) => Some(MotionTask::alone(system, control).into()),
            Self::Motions(motions) => Some(motions.task()),
            Self::Simulate(_) | Self::Equilibrium(_) | Self::Identify(_) => None,
        }
    }

    /// The problems of these motions, with their names.
    pub fn controls_mut(&mut self) -> Vec<(&str, &mut Control)> {
        match self {
            Self::Control(control) => vec![("", &mut **control)],
            Self::Motions(motions) => {
                let all = motions.list.iter_mut();
                all.map(|one| (&*one.name, &mut one.control)).collect()
            }
            Self::Simulate(_) | Self::Equilibrium(_) | Self::Identify(_) => Vec::new(),
        }
    }
}

/// A forward simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Length in ms.
    pub duration: f64,
    /// Step in ms; with a tolerance that of the first attempt.
    pub step: f64,
    /// Sum of the local errors that the control of the steps allows over the duration, of angles in rad, of lengths relative to
    /// the system's; `None`: equal steps.
    pub tolerance: Option<f64>,
    /// Start of the motion.
    pub start: BoundaryState,
    /// Voltages over time.
    pub voltages: Voltages,
    /// `None`: reduced.
    pub coordinates: Option<Coordinates>,
    /// Solution of the equations of a step.
    pub solving: Solving,
    /// A controller that gives the inputs of its law.
    pub controller: Option<Box<FeedbackControl>>,
}

/// A controller in a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct FeedbackControl {
    /// The law; of a controller that plans anew its inputs alone.
    pub law: Arc<Law>,
    /// The file that it was read from.
    pub path: PathBuf,
    /// Time in ms between samples.
    pub sample: f64,
    /// Time in ms from a sample to its effect.
    pub delay: f64,
    /// Noise of what is measured.
    pub noise: Noise,
    /// The plans of a controller that plans anew in each interval, in place of the law.
    pub ahead: Option<Box<Ahead>>,
}

/// A simulation with a part of its disturbance.
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbed {
    /// The part; 1 is that of the problem.
    pub size: f64,
    /// The system.
    pub system: System,
    /// The simulation.
    pub task: Simulation,
}

/// A motion that a controller plans anew over a receding horizon.
#[derive(Clone, Debug, PartialEq)]
pub struct Ahead {
    /// The system of which it knows.
    pub system: System,
    /// The problem whose optimum it follows.
    pub control: Control,
    /// Costs of deviations.
    pub regulator: Regulator,
    /// Number of intervals of the horizon.
    pub intervals: usize,
}

impl Ahead {
    /// Most intervals of a horizon.
    pub const MOST_INTERVALS: usize = 10_000;
}

/// An optimal control problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Final time.
    pub duration: Duration,
    /// Number of intervals N ≥ 1.
    pub intervals: usize,
    /// Neighbouring intervals over which an input has one value; 1 of a problem whose objective counts rates.
    pub input_intervals: usize,
    /// True if this number is that of a first grid, refined until the verification of the optimum confirms an accuracy.
    pub is_refined: bool,
    /// Initial state.
    pub start: BoundaryState,
    /// Final state, at rest unless it is free.
    pub goal: BoundaryState,
    /// Bounds of the voltages that are sought in V.
    pub voltage_bounds: [f64; 2],
    /// Bounds of the loads that are sought (N or N mm, by source).
    pub load_bounds: BTreeMap<usize, [f64; 2]>,
    /// Voltages and loads that are given (by source): no unknowns.
    pub given: BTreeMap<usize, Signal>,
    /// Voltages in intervals of time, where they are given: none is looked for.
    pub course: Option<Voltages>,
    /// Constants of the system that are sought.
    pub parameters: Vec<Parameter>,
    /// Numbers by which the optimum is differentiated.
    pub varied: Vec<Varied>,
    /// Outcomes that are differentiated; where there are none, all that an optimum has.
    pub outcomes: Vec<OutcomeOf>,
    /// True where the start is the end of a motion that is sought with this one, and where the end is the start of one: those of phases. The state at
    /// the start is where the solver begins.
    pub continues: [bool; 2],
    /// Search for the inputs that hold the goal.
    pub sought_hold: SoughtHold,
    /// Treatment of a goal that cannot be kept.
    pub hold: Hold,
    /// Objective that is minimised.
    pub objective: Objective,
    /// Path limits.
    pub limits: Vec<Limit>,
    /// Places, orientations and coordinates on the way of the motion.
    pub waypoints: Vec<Waypoint>,
    /// `None`: reduced.
    pub coordinates: Option<Coordinates>,
    /// Initial guess of the solver.
    pub guess: Guess,
    /// Options of the solver.
    pub solver: Solver,
}

impl Control {
    /// The value of a variable of the intervals that is given at a time in ms, in its unit; `None` where the time is an unknown on which it
    /// depends.
    pub fn given(&self, variable: &Variable, time: f64) -> Option<f64> {
        let source = variable.source?;
        match self.follows_time(source) {
            true => None,
            false => self.given_voltage(source, time),
        }
    }

    /// The voltage of a source that is given at a time in ms.
    pub fn given_voltage(&self, source: usize, time: f64) -> Option<f64> {
        let of_course = || match &self.course {
            Some(course) if self.is_given(source) => Some(course.at(time)[source]),
            _ => None,
        };
        let given = self.given.get(&source).map(|signal| signal.at(time));
        given.or_else(of_course)
    }

    /// Returns true if the voltage of a source is given.
    pub fn is_given(&self, source: usize) -> bool {
        let is_of_course = self.course.is_some() && !self.load_bounds.contains_key(&source);
        is_of_course || self.given.contains_key(&source)
    }

    /// Units of the terms of the objective (see [`Objective::units`]).
    pub fn objective_units(&self, system: &System) -> Vec<String> {
        self.objective.units(system, &self.input_kinds(system))
    }

    /// Kinds of the inputs that are sought, each once: the objective counts them all.
    fn input_kinds(&self, system: &System) -> Vec<InputKind> {
        let mut kinds = Vec::new();
        for (source, named) in system.sources().into_iter().enumerate() {
            if named.acts() && !self.is_given(source) && !kinds.contains(&named.kind) {
                kinds.push(named.kind);
            }
        }
        kinds
    }

    /// Bounds of an input that is sought, in V, N or N mm.
    pub fn bounds(&self, variable: &Variable) -> [f64; 2] {
        let of_load = variable.source.and_then(|s| self.load_bounds.get(&s));
        match variable.role {
            Role::Load => *of_load.unwrap_or(&[f64::NEG_INFINITY, f64::INFINITY]),
            _ => self.voltage_bounds,
        }
    }

    /// The middle of interval `k` in ms, where the duration is given or at its guess.
    pub fn middle(&self, k: usize) -> f64 {
        (k as f64 + 0.5) * self.duration.first() / self.intervals as f64
    }
}

/// Motions whose free parameters are the same, and the inputs that are the same in all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Motions {
    /// The motions.
    pub list: Vec<Motion>,
    /// Names of the sources whose inputs are sought once for all motions.
    pub shared_inputs: Vec<String>,
    /// The objective of all of them.
    pub combined: Combined,
}

/// Objective of several motions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Combined {
    /// The sum of their objectives.
    #[default]
    Sum,
    /// The greatest of their objectives.
    Worst,
    /// The sum of those of phases: each motion goes on where the one before ended. They have this duration in ms together, where one is given.
    InSequence(Option<f64>),
}

impl Motions {
    /// The motions as a task.
    pub fn task(&self) -> ControlTask<'_> {
        let motions = self.list.iter().map(|motion| MotionTask {
            name: &motion.name,
            ..MotionTask::alone(&motion.system, &motion.control)
        });
        ControlTask {
            motions: motions.collect(),
            shared_inputs: &self.shared_inputs,
            combined: self.combined,
        }
    }
}

/// A motion that is solved for, alone or with others.
#[derive(Clone, Copy, Debug)]
pub struct MotionTask<'a> {
    /// Its name among several.
    pub name: &'a str,
    /// The system that moves.
    pub system: &'a System,
    /// Its problem.
    pub control: &'a Control,
    /// The solution that it starts from, in the place of the guess of its problem.
    pub earlier: Option<&'a Solution>,
}

impl<'a> MotionTask<'a> {
    /// Returns true of a motion that has no name, as there is no other.
    pub fn is_alone(&self) -> bool {
        self.name.is_empty()
    }

    /// A motion that has no name, as there is no other.
    pub fn alone(system: &'a System, control: &'a Control) -> Self {
        Self {
            name: "",
            system,
            control,
            earlier: None,
        }
    }
}

/// Motions that are solved for as one program, of which a single one is a case.
#[derive(Clone, Debug)]
pub struct ControlTask<'a> {
    /// The motions, one or more.
    pub motions: Vec<MotionTask<'a>>,
    /// Names of the sources whose inputs are sought once for all motions.
    pub shared_inputs: &'a [String],
    /// The objective of all of them.
    pub combined: Combined,
}

impl<'a> From<MotionTask<'a>> for ControlTask<'a> {
    fn from(motion: MotionTask<'a>) -> Self {
        Self {
            motions: vec![motion],
            shared_inputs: &[],
            combined: Combined::Sum,
        }
    }
}

impl<'a> ControlTask<'a> {
    /// The same motions with other problems.
    pub fn with<'b>(&self, controls: impl IntoIterator<Item = &'b Control>) -> ControlTask<'b>
    where
        'a: 'b,
    {
        let motions = self.motions.iter().zip(controls);
        let motions = motions.map(|(motion, control)| MotionTask { control, ..*motion });
        ControlTask {
            motions: motions.collect(),
            ..*self
        }
    }

    /// The problems without limits of amounts of muscles that an earlier motion has: with the same constants they are one.
    pub fn with_limits_once(&self) -> Vec<Cow<'a, Control>> {
        let each = self.motions.iter().enumerate();
        let each = each.map(|(number, motion)| {
            let is_known = |limit: &Limit| {
                let mut before = self.motions[..number].iter();
                before.any(|one| {
                    one.control.limits.contains(limit) && limit.is_as_in(motion.system, one.system)
                })
            };
            let mut out = Cow::Borrowed(motion.control);
            if motion.control.limits.iter().any(is_known) {
                out.to_mut().limits.retain(|limit| !is_known(limit));
            }
            out
        });
        each.collect()
    }

    /// The first motion whose time grid differs from that of motion 0 or is free; inputs cannot be shared with it.
    pub fn other_grid(&self) -> Option<MotionTask<'a>> {
        let grid = |motion: &MotionTask<'_>| match motion.control.duration {
            Duration::Given(duration) => Some((
                duration,
                motion.control.intervals,
                motion.control.is_refined,
            )),
            Duration::Free { .. } => None,
        };
        let first = self.motions.first().and_then(grid);
        let mut each = self.motions.iter().copied();
        each.find(|motion| grid(motion).is_none() || grid(motion) != first)
    }
}

/// A motion among others.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Its name, another one for each motion.
    pub name: String,
    /// The system that moves.
    pub system: System,
    /// Its problem.
    pub control: Control,
}

/// Initial guess of the solver.
#[derive(Clone, Debug, PartialEq)]
pub enum Guess {
    /// Smooth interpolation 3s² − 2s³ between start and goal; rest voltages of the goal plus 100 V.
    Interpolate,
    /// A simulation under given voltages.
    Simulate(Voltages),
    /// An earlier solution, also from another grid.
    Solution(Earlier),
}

/// Options of the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Solver {
    /// Relative tolerance of the optimality conditions.
    pub tolerance: f64,
    /// Limit of iterations.
    pub max_iterations: usize,
    /// Solver of the linear systems, unless the options name another one.
    pub linear_solver: LinearSolver,
    /// Options passed to Ipopt by name.
    pub ipopt: BTreeMap<String, OptionValue>,
}

impl Default for Solver {
    /// Tolerance 10⁻¹⁰, 500 iterations.
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            max_iterations: 500,
            linear_solver: LinearSolver::Auto,
            ipopt: BTreeMap::new(),
        }
    }
}

impl Simulation {
    /// Default tolerance of steps whose length is not given.
    pub const TOLERANCE: f64 = 1e-3;
    /// The first step that a tolerance controls, as a part of the duration.
    pub const FIRST: f64 = 1e-2;
}

/// Final time of a control problem in ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Duration {
    /// Given.
    Given(f64),
    /// Free between bounds.
    Free {
        /// Lower bound.
        min: f64,
        /// Upper bound.
        max: f64,
        /// Value at which the solver starts.
        guess: f64,
    },
}

impl Duration {
    /// Returns the value at which the solver starts.
    pub fn first(self) -> f64 {
        match self {
            Self::Given(duration) => duration,
            Self::Free { guess, .. } => guess,
        }
    }

    /// The duration allowed that is nearest to `other`.
    pub fn nearest(self, other: f64) -> f64 {
        match self {
            Self::Given(duration) => duration,
            Self::Free { min, max, .. } => other.clamp(min, max),
        }
    }
}

/// A number of a problem by which its optimum is differentiated.
#[derive(Clone, Debug, PartialEq)]
pub struct Varied {
    /// Name for messages and files: its path in the scene or in the problem.
    pub name: String,
    /// The number.
    pub of: VariedOf,
    /// Its value, in the unit inside.
    pub value: f64,
    /// Its tolerance: it may be so much smaller or larger.
    pub tolerance: Option<f64>,
    /// Its unit of the International System.
    pub unit: SiUnit,
}

/// Kind of a number of a problem.
#[derive(Clone, Debug, PartialEq)]
pub enum VariedOf {
    /// Constants of the system, as one that is sought.
    Constants(Parameter),
    /// The duration, where it is given, in ms.
    Duration,
    /// A joint coordinate of the goal, in rad or mm.
    GoalJoint(usize),
    /// A component of the place of a marker at the goal, in mm.
    GoalPlace {
        /// The marker.
        marker: usize,
        /// Its component, 0 to 2.
        axis: usize,
    },
    /// The voltage or load of a source under which the goal is at rest.
    GoalVoltage(usize),
    /// A joint coordinate of the start, in rad or mm.
    StartJoint(usize),
    /// The rate of a joint coordinate at the start, in rad/ms or mm/ms.
    StartRate(usize),
    /// The voltage or load of a source under which the start is at rest.
    StartVoltage(usize),
    /// The lower or the upper bound of voltages in V.
    VoltageBound(usize),
    /// The lower or the upper bound of a load, by its source.
    LoadBound(usize, usize),
    /// A weight of the objective.
    Weight(WeightOf),
}

/// A weight of the objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightOf {
    /// That of the effort.
    Effort,
    /// That of the rate.
    Rate,
    /// That of the duration.
    Duration,
}

/// An outcome of an optimum that is differentiated; times are those of the nearest instant in ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutcomeOf {
    /// A free duration in ms.
    Duration,
    /// A constant that was sought, by its place in the problem.
    Parameter(usize),
    /// The voltage or load of a source at a time, in V, N or N mm.
    Input {
        /// The source.
        source: usize,
        /// The time.
        time: f64,
    },
    /// The coordinate of a joint at a time, in rad or mm; in reduced coordinates.
    Joint {
        /// The joint.
        joint: usize,
        /// The time.
        time: f64,
    },
    /// A component of the place of a marker at a time, in mm.
    Marker {
        /// The marker.
        marker: usize,
        /// Its component, 0 to 2.
        axis: usize,
        /// The time.
        time: f64,
    },
    /// The multiplier of an equation or limit, in the order of the program.
    Multiplier(usize),
}

impl Varied {
    /// Constants of a system at their guess, which is their value there.
    pub fn constants(parameter: Parameter, tolerance: Option<f64>, system: &System) -> Self {
        Self {
            name: parameter.name.clone(),
            value: parameter.guess,
            tolerance,
            unit: parameter.unit(system),
            of: VariedOf::Constants(parameter),
        }
    }

    /// The constants that it is, where it is one of the system.
    pub fn parameter(&self) -> Option<&Parameter> {
        match &self.of {
            VariedOf::Constants(parameter) => Some(parameter),
            _ => None,
        }
    }
}
