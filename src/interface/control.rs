//! Optimal control problems.

use crate::control;
use crate::control::problem::{
    Ahead, BoundaryState, Combined, CostFunction, Duration, During, EnergyCost, Guess, Limit,
    MotionTask, OutcomeOf, QuantityCost, Regulator, SoughtHold, Varied, Voltages, Waypoint,
};
use crate::control::{Earlier, EarlierSolution, Motions, problem};
use crate::interface::error::{Entry, Result, source};
use crate::interface::handle::{Handle, Input, builder};
use crate::interface::motion::Optimum;
use crate::interface::state::State;
use crate::math::{Signal, refuse, shortest};
use crate::model::components::Load;
use crate::model::system::{Joint, Muscle, Source};
use crate::model::{Parameter, System, What};
use crate::nlp::Nlp;
use crate::tasks;
use crate::tasks::SolveRequest;
use crate::workflow::WorkflowError;
use crate::workflow::memory::Occasion;
use crate::workflow::optimum::SolveLimits;
use crate::workflow::program::with_joined;
use crate::workflow::receding::Horizon;
use crate::workflow::{Iterate, memory};
use std::collections::BTreeMap;
use std::ops::{ControlFlow, RangeInclusive};

/// An optimal control problem: voltages and loads that steer a system from rest to rest, or along a path.
#[derive(Clone, Debug)]
pub struct Control {
    /// The task but for its ends and inputs, whose parts are found in a system.
    pub(super) task: problem::Control,
    start: State,
    goal: State,
    load_bounds: Vec<(Handle<Load>, [f64; 2])>,
    voltages: Vec<(Input, Signal)>,
    pub(super) peak_voltage: f64,
    max_seconds: Option<f64>,
}

impl Control {
    /// Over a given duration in ms in this number of intervals, from rest without voltages to the reference configuration.
    pub fn over(duration: f64, intervals: usize) -> Self {
        let (nowhere, nothing) = (BoundaryState::Free, Voltages::default());
        Self {
            task: problem::Control {
                voltage_bounds: [0.0, f64::INFINITY],
                course: None,
                sought_hold: SoughtHold::default(),
                ..problem::Control::of_course(&nowhere, &nothing, duration, intervals)
            },
            start: State::rest(),
            goal: State::Reference,
            load_bounds: Vec::new(),
            voltages: Vec::new(),
            peak_voltage: 0.0,
            max_seconds: None,
        }
    }

    /// A free duration between bounds in ms; the solver starts in their middle.
    pub fn over_free(duration: RangeInclusive<f64>, intervals: usize) -> Self {
        let (min, max) = (*duration.start(), *duration.end());
        let guess = 0.5 * (min + max);
        let mut free = Self::over(guess, intervals);
        free.task.duration = Duration::Free { min, max, guess };
        free
    }

    /// Solves; an optimum that a simulation under its voltages does not reproduce is solved again on finer grids.
    ///
    /// # Errors
    /// System or problem make no sense, or start or goal do not exist. A problem without a solution is no error: see
    /// [`Optimum::is_solved`].
    pub fn solve(&self, system: &System) -> Result<Optimum> {
        let system = &system.checked()?;
        let control = self.resolve(system)?;
        let limits = SolveLimits {
            iterations: None,
            seconds: self.max_seconds,
        };
        let request = SolveRequest {
            wanted: None,
            limits,
        };
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        Ok(Optimum::from_result(tasks::solve(
            system, &control, request, go_on,
        )?))
    }

    /// Hands the transcription to `read` as a nonlinear program, with the point where the solver would start.
    ///
    /// # Errors
    /// As of [`Control::solve`].
    pub fn with_program<R>(
        &self,
        system: &System,
        read: impl FnOnce(&mut dyn Nlp, &[f64]) -> R,
    ) -> Result<R> {
        let system = &system.checked()?;
        memory::of_elements(system, Occasion::Factors)?;
        let control = self.resolve(system)?;
        let task = MotionTask::alone(system, &control).into();
        Ok(with_joined(&task, read)?)
    }

    pub(super) fn resolve(&self, system: &System) -> Result<problem::Control> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        let (first, bounds) = match self.task.duration {
            Duration::Given(duration) => (duration, [duration; 2]),
            Duration::Free { min, max, guess } => (guess, [min, max]),
        };
        let holds = positive(first) && bounds.map(positive) == [true; 2] && bounds[0] <= bounds[1];
        refuse!(unless holds, Entry("control");
            found format!("a duration within {bounds:?} ms"), expected "positive numbers that grow");
        refuse!(if self.task.intervals == 0, Entry("control");
            found "no interval", expected "one or more");
        let [lower, upper] = self.task.voltage_bounds;
        refuse!(unless lower < upper, Entry("control");
            found format!("voltages within {:?} V", self.task.voltage_bounds), expected "bounds that grow");
        let sources = system.sources();
        refuse!(unless sources.iter().any(Source::acts), Entry("control");
            found "a system without a muscle that takes a voltage, or a load",
            expected "a muscle with a permittivity, or a load");
        let load_bounds = self.load_bounds(system)?;
        let given = self.given(system, &load_bounds)?;
        let is_open = |s: usize| sources[s].acts() && !given.contains_key(&s);
        let open = !self.task.parameters.is_empty() || (0..sources.len()).any(is_open);
        refuse!(unless open, Entry("control");
            found "all voltages and loads",
            expected "a voltage or load to look for, or a free parameter");
        let weights = &self.task.objective;
        let weights = [
            weights.effort,
            weights.rate,
            weights.duration,
            self.peak_voltage,
        ];
        let costs = &self.task.objective.quantities;
        let energies = &self.task.objective.energies;
        let is_any = !costs.is_empty() || !energies.is_empty() || weights != [0.0; 4];
        let holds = weights.iter().all(|w| *w >= 0.0 && w.is_finite()) && is_any;
        refuse!(unless holds, Entry("control");
            found format!("weights {weights:?} of effort, rate, time and peak"),
            expected "weights of which one is positive");
        let is_open = matches!(self.goal, State::Periodic | State::Free);
        check_costs(costs, is_open, system)?;
        check_energies(energies, system)?;
        check_waypoints(&self.task.waypoints, is_open, system)?;
        check_limits(&self.task.limits, system)?;
        let control = problem::Control {
            start: self.start.resolve(system)?,
            goal: self.goal.resolve(system)?,
            load_bounds,
            given,
            ..self.task.clone()
        };
        self.with_peak(control, system)
    }

    /// Bounds of the loads that are sought, by source.
    fn load_bounds(&self, system: &System) -> Result<BTreeMap<usize, [f64; 2]>> {
        let bounds = |&(load, bounds): &(Handle<Load>, [f64; 2])| {
            refuse!(unless bounds[0] < bounds[1], Entry("control");
                found format!("loads within {bounds:?}"), expected "bounds that grow");
            Ok((source(&load.into(), system)?, bounds))
        };
        self.load_bounds.iter().map(bounds).collect()
    }

    /// The voltages and loads that are given, by source: loads that nothing names are zero.
    fn given(
        &self,
        system: &System,
        sought: &BTreeMap<usize, [f64; 2]>,
    ) -> Result<BTreeMap<usize, Signal>> {
        let mut functions = self.voltages.iter().map(|(_, function)| function);
        let jump = functions.find_map(|function| self.task.duration.jump(function));
        let time = shortest(jump.unwrap_or_default(), 6);
        refuse!(if jump.is_some(), Entry("control");
            found format!("a voltage or load that jumps at {time} ms where the duration is free"),
            expected "functions of time without jumps, or a given duration");
        let place =
            |(input, signal): &(Input, Signal)| Ok((source(input, system)?, signal.clone()));
        let mut given: BTreeMap<usize, Signal> =
            self.voltages.iter().map(place).collect::<Result<_>>()?;
        let both = given.keys().any(|source| sought.contains_key(source));
        refuse!(if both, Entry("control");
            found "a load that is given and sought", expected "one of both");
        let is_named = |s: usize| sought.contains_key(&s) || given.contains_key(&s);
        let absent: Vec<_> = problem::absent_loads(system, is_named).collect();
        given.extend(absent);
        Ok(given)
    }
}

builder! {
    impl Control;
    /// Seeks a load within bounds in N, or N mm of a torque; loads that are neither sought nor given are zero.
    load_within(load: Handle<Load>, range: RangeInclusive<f64>) |of| of.load_bounds.push((load, range.into_inner().into()));
    /// A load that is given: a constant in N, or N mm of a torque, or a [`Signal`] whose value in the middle of each interval acts during
    /// the interval.
    load(load: Handle<Load>, size: impl Into<Signal>) |of| of.voltages.push((load.into(), size.into()));
    /// Another start.
    start(start: State) |of| of.start = start;
    /// The goal, at rest unless it is [`State::Free`] or [`State::Periodic`].
    goal(goal: State) |of| of.goal = goal;
    /// Does not seek inputs that hold a goal of places or joint coordinates. Otherwise, where the motion leaves such a goal under its last
    /// inputs, the problem is solved again with [these](Self::find_hold) as unknowns.
    without_hold() |of| of.task.sought_hold = SoughtHold::Never;
    /// Seeks the voltages and loads that hold a goal of places or joint coordinates together with the motion: the goal is an equilibrium under
    /// them, and they count as those of one more interval.
    find_hold() |of| of.task.sought_hold = SoughtHold::Always;
    /// Bounds of all voltages in V; from 0 to infinity where nothing is said.
    voltage_bounds(lower: f64, upper: f64) |of| of.task.voltage_bounds = [lower, upper];
    /// Minimises Σ h |V|² of the inputs V in kV, N or N m, h in s, with a weight.
    effort(weight: f64) |of| of.task.objective.effort = weight;
    /// Minimises Σ |ΔV|²/h of the changes of the inputs, with a weight.
    rate(weight: f64) |of| of.task.objective.rate = weight;
    /// Minimises the duration in s, with a weight.
    time(weight: f64) |of| of.task.objective.duration = weight;
    /// Minimises a function of a quantity; [`Control::track`] and its neighbours make the usual ones.
    minimise(cost: QuantityCost) |of| of.task.objective.quantities.push(cost);
    /// A voltage that is given: a constant in V, or a [`Signal`] whose value in the middle of each interval acts during the interval.
    voltage(input: impl Into<Input>, signal: impl Into<Signal>) |of| of.voltages.push((input.into(), signal.into()));
    /// Seeks constants of the system within bounds; see [`Optimum::parameters`].
    seek(parameter: Parameter) |of| of.task.parameters.push(parameter);
    /// Differentiates the optimum by a number of the problem; see [`Optimum::sensitivities`](crate::interface::Optimum::sensitivities).
    sensitivity(varied: Varied) |of| of.task.varied.push(varied);
    /// Differentiates this outcome, others that are named, and the objective, and nothing else; see
    /// [`Optimum::gradients`](crate::interface::Optimum::gradients). A few outcomes by many numbers take less work than all by each number.
    outcome(outcome: OutcomeOf) |of| of.task.outcomes.push(outcome);
    /// Starts from an earlier solution, also of another grid or goal.
    starting_from(earlier: impl EarlierSolution + 'static) |of| of.task.guess = Guess::Solution(Earlier::new(earlier));
    /// Stops the solver after this number of seconds.
    max_seconds(seconds: f64) |of| of.max_seconds = Some(seconds);
}

impl Control {
    /// Solves the problem, for controllers that plan anew over a horizon of a number of its intervals, with the usual costs of deviations.
    ///
    /// # Errors
    /// As of [`solve`](Self::solve); no optimum was found, nothing holds the goal, or the problem has something that is not offered.
    pub fn horizon(&self, system: &System, intervals: usize) -> Result<Horizon> {
        refuse!(if intervals == 0, Entry("horizon");
            found format!("{intervals} intervals"), expected "1 or more");
        refuse!(if intervals > Ahead::MOST_INTERVALS, Entry("horizon");
            found format!("{intervals} intervals"), expected "no more than 10000");
        let system = system.checked()?;
        let ahead = Ahead {
            control: self.resolve(&system)?,
            regulator: Regulator::default(),
            system,
            intervals,
        };
        Ok(Horizon::solved(&ahead).map_err(|error| error.at("horizon", ""))?)
    }
}

/// Motions that are optimised together: parameters of the same names are one, and the objective is the sum of theirs, or the [greatest](Self::worst).
#[derive(Clone, Debug, Default)]
pub struct Together<'a> {
    motions: Vec<(&'a System, &'a Control)>,
    shared: Vec<Input>,
    combined: Combined,
}

impl<'a> Together<'a> {
    /// No motion yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a motion of a system.
    pub fn motion(mut self, system: &'a System, control: &'a Control) -> Self {
        self.motions.push((system, control));
        self
    }

    /// Seeks the input of a part once for all motions, which have then one given duration and one number of intervals.
    pub fn shared_input(mut self, input: impl Into<Input>) -> Self {
        self.shared.push(input.into());
        self
    }

    /// Minimises the greatest of the objectives in place of their sum.
    pub fn worst(self) -> Self {
        let combined = Combined::Worst;
        Self { combined, ..self }
    }

    /// Makes the motions phases: each goes on where the one before ended. The first one has the start; all but the last have the goal
    /// [`State::Free`]. A `duration` in ms is that of all together.
    pub fn in_sequence(self, duration: Option<f64>) -> Self {
        let combined = Combined::InSequence(duration);
        Self { combined, ..self }
    }

    /// Solves; each motion is verified as one by itself, and solved again on a finer grid where a simulation under its inputs does not reproduce it.
    ///
    /// # Errors
    /// As of [`Control::solve`], or something cannot be the same in all motions. A problem without a solution is no error: see
    /// [`Optimum::is_solved`] of each.
    pub fn solve(&self) -> Result<Vec<Optimum>> {
        refuse!(if self.motions.is_empty(), Entry("motions"); found "none", expected "one or more");
        let mut list = Vec::new();
        for (number, (system, control)) in self.motions.iter().enumerate() {
            let system = system.checked()?;
            list.push(control::Motion {
                name: format!("motion{}", number + 1),
                control: control.resolve(&system)?,
                system,
            });
        }
        let sources = list[0].system.sources();
        let name = |input: &Input| {
            let found = input.source(&list[0].system);
            refuse!(if found.is_none(), Entry("shared inputs");
                found format!("{input:?}"), expected "a muscle, driven electrode or load of all systems");
            Ok(sources[found.unwrap_or_default()].name.clone())
        };
        let shared_inputs = self.shared.iter().map(name).collect::<Result<_>>()?;
        let is_in_sequence = matches!(self.combined, Combined::InSequence(_));
        refuse!(if is_in_sequence && !self.shared.is_empty(), Entry("shared inputs");
            found "inputs in common", expected "none of phases, which follow one another");
        let motions = match self.combined {
            Combined::InSequence(whole) => Motions::in_sequence(list, whole).map_err(|fault| {
                let reason = format!("found {}, expected {}", fault.finding(), fault.expected);
                WorkflowError::problem(format!("control.{}", fault.at), reason)
            })?,
            combined => Motions {
                list,
                shared_inputs,
                combined,
            },
        };
        let go_on = &mut |_: usize, _: &Iterate<'_>| ControlFlow::Continue(());
        let found = tasks::solve_motions(&motions.task(), SolveRequest::default(), go_on)?;
        Ok(found.list.into_iter().map(Optimum::from_result).collect())
    }
}

/// Refuses costs of parts that the system does not have, and weights and functions of time that are not finite.
fn check_costs(costs: &[QuantityCost], is_open: bool, system: &System) -> Result<()> {
    for cost in costs {
        let quantity = &cost.quantity;
        let is_behind = |source: usize| {
            let muscle = system.muscles.get(source);
            muscle.is_some_and(Muscle::is_behind_resistor)
        };
        // An impulse is bounded, not squared.
        let is_rate = !quantity.is_step() || quantity.rate_factor(system).is_some();
        let is_single = quantity.before().is_none() && quantity.source().is_none_or(is_behind);
        let exists = quantity.what.exists(system) && is_single && is_rate;
        let is_followed = match &cost.function {
            CostFunction::Square { reference } => reference.is_sound(),
            CostFunction::Itself => true,
        };
        let is_timed = match cost.during {
            During::At(part) => is_on_the_way(part, is_open),
            During::Motion | During::End => true,
        };
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite() && is_followed && is_timed;
        refuse!(unless exists && is_sound, Entry("cost");
            found format!("{cost:?}"),
            expected "a positive weight of a marker, of a joint with one coordinate, or of a quantity of a lumped muscle (of its source behind a resistor), along finite values or at a part of the duration above 0 and below 1");
    }
    Ok(())
}

/// Refuses energies of parts that are no lumped muscles, and weights that are not positive.
fn check_energies(costs: &[EnergyCost], system: &System) -> Result<()> {
    for cost in costs {
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite();
        refuse!(unless cost.exists(system) && is_sound, Entry("cost");
            found format!("{cost:?}"), expected "a positive weight of a lumped muscle with a permittivity");
    }
    Ok(())
}

/// Refuses limits of parts that the system does not have, and those that leave nothing.
fn check_limits(limits: &[Limit], system: &System) -> Result<()> {
    for limit in limits {
        let is_then = limit.part.is_none_or(|part| part > 0.0 && part <= 1.0);
        let has_field = !matches!(limit.what, What::Field(_)) || limit.max > 0.0;
        let leaves = limit.min <= limit.max && has_field;
        refuse!(unless limit.what.exists(system) && leaves && is_then, Entry("limit");
            found format!("{limit:?}"), expected "a range of a part of the system");
    }
    Ok(())
}

/// Refuses waypoints of parts that the system does not have, and those that are not on the way.
fn check_waypoints(waypoints: &[Waypoint], is_open: bool, system: &System) -> Result<()> {
    for waypoint in waypoints {
        let of_joint = |(joint, value): (&usize, &f64)| {
            let joint = system.joints.get(*joint);
            joint.is_some_and(Joint::has_coordinate) && value.is_finite()
        };
        let mut given = waypoint.places.values().flat_map(|place| place.given());
        let holds = is_on_the_way(waypoint.part, is_open)
            && waypoint.places.keys().all(|&m| m < system.markers.len())
            && given.all(|(_, value)| value.is_finite())
            && waypoint.angles.iter().all(of_joint);
        refuse!(unless holds, Entry("waypoint");
            found format!("{waypoint:?}"),
            expected "a finite place of a marker or joint at a part of the duration above 0 and below 1");
    }
    Ok(())
}

/// Returns true if a part of the duration lies on the way: the end of a motion does that is periodic or has no goal.
fn is_on_the_way(part: f64, is_open: bool) -> bool {
    part > 0.0 && (part < 1.0 || (is_open && part == 1.0))
}
