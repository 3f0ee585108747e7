//! A control problem and the end of its solve, with the bounds and limits that it reaches.

use crate::control::problem::{Control, Duration};
use crate::control::{BoundaryConditions, Carried, Column, Row, Solution, Transcription};
use crate::ipopt::SolverResult;
use crate::math::significant;
use crate::model::{JointReading, Model, Role, Size, joint_unit};
use crate::nlp::{Nlp, Status};
use crate::stop;
use crate::workflow::hold_check::{Afterwards, Repeated, afterwards, repeated};
use crate::workflow::motion::Distance;
use crate::workflow::reasons::Cause;
use crate::workflow::resimulate::Resimulation;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// Limits of a solve, in place of those of its problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveLimits {
    /// Iterations of the solver.
    pub iterations: Option<usize>,
    /// Seconds, set-up included.
    pub seconds: Option<f64>,
}

/// Limits of several solves since they began.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Budget {
    limits: SolveLimits,
    began: Instant,
}

impl Budget {
    /// Limits from now on.
    pub(crate) fn new(limits: SolveLimits) -> Self {
        let began = Instant::now();
        Self { limits, began }
    }

    /// A number of seconds from now on.
    pub(crate) fn of_seconds(seconds: Option<f64>) -> Self {
        Self::new(SolveLimits {
            iterations: None,
            seconds,
        })
    }

    /// Seconds that are left, where they are limited.
    pub(crate) fn left(&self) -> Option<f64> {
        let spent = self.began.elapsed().as_secs_f64();
        let seconds = self.limits.seconds;
        seconds.map(|limit| (limit - spent).max(0.0))
    }

    /// The limits of one solve with these seconds.
    pub(crate) fn left_of_limits(&self) -> SolveLimits {
        SolveLimits {
            seconds: self.left(),
            ..self.limits
        }
    }

    /// The limits of one solve of a problem with these seconds and a number of iterations at most.
    pub(crate) fn left_within(&self, iterations: usize, control: &Control) -> SolveLimits {
        let left = self.left_of_limits();
        let most = left.iterations.unwrap_or(control.solver.max_iterations);
        SolveLimits {
            iterations: Some(iterations.min(most)),
            ..left
        }
    }

    /// Returns the reason why nothing more may be begun, if there is one.
    pub(crate) fn stopped(&self) -> Option<Status> {
        if stop::requested() {
            return Some(Status::Interrupted);
        }
        let is_late = self.left().is_some_and(|seconds| seconds <= 0.0);
        stop::reason().or(is_late.then_some(Status::TimeLimit))
    }

    /// Returns true if nothing more may be begun.
    pub(crate) fn is_over(&self) -> bool {
        self.stopped().is_some()
    }
}

/// The program of one motion or several in numbers, with its result.
#[derive(Clone, Debug)]
pub struct WholeProgram {
    /// The sum of the objectives, or the greatest one.
    pub objective: f64,
    /// Weights of the objectives at the optimum, where the greatest one is minimised.
    pub weights: Option<Vec<f64>>,
    /// Number of variables.
    pub variables: usize,
    /// Number of equations and limits.
    pub constraints: usize,
    /// Nonzeros of the Jacobian.
    pub jacobian_nonzeros: usize,
    /// Nonzeros of the lower triangle of the Hessian, those of shared variables motion by motion.
    pub hessian_nonzeros: usize,
    /// The objective lies no farther above its least value nearby, in its unit.
    pub gap: f64,
    /// A warning that it is large compared with the objective.
    pub(crate) wide: Option<String>,
}

impl WholeProgram {
    /// A program with its result and its gap.
    pub(crate) fn new(program: &impl Nlp, solution: &SolverResult, gap: f64) -> Self {
        Self {
            objective: solution.objective,
            weights: None,
            variables: solution.x.len(),
            constraints: solution.constraints.len(),
            jacobian_nonzeros: program.jacobian_structure().count(),
            hessian_nonzeros: program.hessian_structure().count(),
            gap,
            wide: None,
        }
    }
}

/// The way to an optimum through contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stages {
    /// Number of stages with softer contacts that were solved before it.
    pub solved: usize,
    /// True if the first of them began with a motion that simulations found.
    pub is_simulated: bool,
    /// True if it is of such a stage itself, in which the solve was stopped.
    pub is_softer: bool,
}

/// A control problem and how its solve ended.
#[derive(Debug)]
pub struct Optimum {
    /// The model, with the parameters that were found put in.
    pub model: Arc<Model>,
    /// The model of the program, where it has free parameters.
    pub sought: Option<Arc<Model>>,
    /// Start and goal.
    pub boundary: BoundaryConditions,
    /// The motion: the optimal one, or the last iterate.
    pub motion: Solution,
    /// The result of the solver.
    pub solution: SolverResult,
    /// Interval in which the span of a muscle turns by a right angle or more, and the muscle: the discrete equations hold, but
    /// describe no motion.
    pub reversed: Option<(usize, usize)>,
    /// The worst rows that do not hold; none of a solution.
    pub violated: Vec<Violation>,
    /// Greatest scaled violation of an equation or limit.
    pub infeasibility: f64,
    /// Its program; the gap of a single motion is that of the program with its states of rest.
    pub program: WholeProgram,
    /// Seconds before the solver began.
    pub setup: f64,
    /// The use of the solution that it started from.
    pub carried: Carried,
    /// The verification of its voltages, where the solver found a solution.
    pub resimulation: Option<Resimulation>,
    /// Seconds that the test took.
    pub tested: f64,
    /// End of the first start, where another one found the optimum.
    pub restarted: Option<Restarted>,
    /// The stages with softer contacts that led to it.
    pub stages: Stages,
    /// The shortest motion, where none was found in the given time.
    pub shortest: Shortest,
    /// Half a period of the slowest vibration about rest in ms, where no motion was found and that is known.
    pub half_period: Option<f64>,
    /// Reason why other starts or finer grids were not tried to the end, where none before led to an answer.
    pub stopped: Option<Status>,
    /// Reason why the solver ended at a point that meets a weaker tolerance only, where a stop kept it from better ones.
    pub cut_short: Option<Status>,
    /// Bounds and limits that the motion reaches, the most frequent first; none of a solution.
    pub active: Vec<Active>,
    /// The motion after a goal that no voltages are known to hold.
    pub afterwards: Option<Afterwards>,
    /// A periodic motion under the same inputs again.
    pub repeated: Option<Repeated>,
    /// A note on the reason for another grid, or on the lack of a verification.
    pub refined: Option<String>,
    /// A note that inputs which hold the goal were sought and not found.
    pub not_found: Option<&'static str>,
}

impl Optimum {
    /// Returns true for an optimal motion: the solver found it, and a simulation under its voltages reproduces it.
    pub fn is_solved(&self) -> bool {
        self.meets_equations() && self.cause().is_none()
    }

    /// Holds the voltages of the goal after its end, or those of the last interval where none are known, if it is reproduced; repeats a
    /// periodic motion.
    pub(crate) fn hold(&mut self, control: &Control) {
        if self.is_solved() {
            let path_length = match &self.resimulation {
                Some(tested) => tested.path_length,
                None => Distance::path_length(&self.model, &self.motion, 1),
            };
            self.afterwards = afterwards(&self.model, control, &self.motion, path_length);
            let start = &self.boundary.start;
            self.repeated = repeated(&self.model, control, start, &self.motion, path_length);
        }
        let Self {
            model,
            boundary,
            motion,
            resimulation: Some(tested),
            ..
        } = self
        else {
            return;
        };
        if tested.cause.is_none() {
            tested.hold(model, boundary, motion);
        }
    }

    /// Returns true if it meets the discrete equations, reproduced or not.
    pub(crate) fn meets_equations(&self) -> bool {
        self.solution.status.is_solved() && self.reversed.is_none()
    }

    /// The reason why a simulation does not reproduce it.
    pub fn cause(&self) -> Option<&Cause> {
        self.resimulation.as_ref()?.cause.as_ref()
    }

    /// Its status, in a word.
    pub fn word(&self) -> &'static str {
        if let Some(status) = self.stopped {
            return status.word();
        }
        match self.cause() {
            _ if self.reversed.is_some() => "unresolved",
            Some(_) => "not_reproduced",
            None => self.solution.status.word(),
        }
    }
}

/// Start of an optimum that the first start did not find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restarted {
    /// Status of the first start.
    pub first: Status,
    /// Start of the other one, in words.
    pub from: &'static str,
}

/// Result of a solve with a free duration, for a problem whose duration is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shortest {
    /// It was not tried, or not to the end.
    #[default]
    Unknown,
    /// A motion of the duration asked for.
    AsGiven,
    /// The shortest motion found is longer, in ms.
    Longer(f64),
    /// None was found up to this duration in ms.
    NotUpTo(f64),
}

/// A bound that is reached.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Active {
    /// Quantity that reaches it, and its value with unit.
    pub what: String,
    /// Number of its rows that are reached.
    pub count: usize,
    /// Number of its rows.
    pub of: usize,
    /// `interval` or `instant`; nothing for a bound that exists once.
    pub noun: &'static str,
    /// True if it is a bound of voltages.
    pub is_voltage: bool,
}

/// A value this near to a bound, relative to the range or the bound, has reached it.
const NEAR: f64 = 1e-3;

/// Active bounds, most frequent first. Zero lower bounds of voltages are not listed.
pub fn active(
    program: &mut Transcription<'_>,
    x: &[f64],
    model: &Model,
    control: &Control,
) -> Vec<Active> {
    let mut seen = ActiveLimits::default();
    let bounds = program.variables().clone();
    for (i, &column) in program.unknowns().columns.iter().enumerate() {
        let side = reached(x[i], bounds.lower[i], bounds.upper[i]);
        match (column, column.of(&model.variables).role) {
            (Column::Interval { k, .. }, _) if k >= program.intervals() => {}
            (_, Role::Voltage | Role::Load) => {
                let variable = column.of(&model.variables);
                let source = variable.source.expect("an input of a source");
                let unit = model.input_kind(source).unit();
                let given = control.bounds(variable);
                let listed = given.map(|bound| if bound == 0.0 { f64::INFINITY } else { bound });
                seen.add(&variable.name, OF_INPUT, listed, side, |bound| {
                    (bound, unit)
                });
            }
            (Column::Instant { i, .. }, Role::Coordinate) => {
                seen.add_coordinate(i, model, control, side);
            }
            (Column::Parameter { .. }, _) => {
                let parameter = model.parameter(column.of(&model.variables));
                let unit = parameter.unit(&model.system);
                let given = [parameter.lower, parameter.upper];
                let plain = |bound: f64| (bound * unit.factor, unit.symbol);
                seen.add(&parameter.name, ["bound", ""], given, side, plain);
            }
            (Column::Horizon, _) => {
                if let Duration::Free { min, max, .. } = control.duration {
                    let plain = |bound: f64| (bound / 1e3, "s");
                    seen.add("the duration", ["bound", ""], [min, max], side, plain);
                }
            }
            _ => {}
        }
    }
    let bounds = program.constraints().clone();
    let mut values = vec![0.0; bounds.count()];
    program.constraint(x, &mut values);
    for (r, row) in program.unknowns().rows.iter().enumerate() {
        let Row::Limit { limit, .. } = *row else {
            continue;
        };
        let bounded = program.limit(limit);
        if !bounded.when.is_single() {
            let side = reached(values[r], bounds.lower[r], bounds.upper[r]);
            let kind = match bounded.quantity.is_of_intervals() {
                true => ["limit", "interval"],
                false => ["limit", "instant"],
            };
            let plain = |bound: f64| bounded.quantity.plain(bound, &model.system);
            seen.add(&bounded.name, kind, bounded.bounds(), side, plain);
        }
    }
    seen.list()
}

/// Returns for its lower and its upper bound true if a value has reached it, or is beyond.
fn reached(value: f64, low: f64, high: f64) -> [bool; 2] {
    let range = high - low;
    let size = |bound: f64| match range.is_finite() {
        true => range,
        false => bound.abs().max(1.0),
    };
    [
        value - low <= NEAR * size(low),
        high - value <= NEAR * size(high),
    ]
}

/// Counts by name.
#[derive(Debug, Default)]
struct ActiveLimits(BTreeMap<String, Active>);

/// Bounds of inputs, in words and by what they are counted.
const OF_INPUT: [&str; 2] = ["bound", "interval"];

impl ActiveLimits {
    /// Counts a row of a quantity at those of its bounds that are finite, by words for these and for what is counted; `plain` gives a bound
    /// in its unit.
    fn add<'u>(
        &mut self,
        name: &str,
        [word, noun]: [&'static str; 2],
        bounds: [f64; 2],
        side: [bool; 2],
        plain: impl Fn(f64) -> (f64, &'u str),
    ) {
        let both = bounds.into_iter().zip(side);
        for (bound, is_reached) in both.filter(|(bound, _)| bound.is_finite()) {
            let (value, unit) = plain(bound);
            let what = format!("{name} at its {word} of {} {unit}", significant(value, 4));
            let what = what.trim_end().to_owned();
            let entry = self.0.entry(what).or_insert_with_key(|what| Active {
                what: what.clone(),
                count: 0,
                of: 0,
                noun,
                is_voltage: [word, noun] == OF_INPUT && unit == "V",
            });
            entry.of += 1;
            entry.count += usize::from(is_reached);
        }
    }

    /// The limits of the joint of a coordinate at an instant.
    fn add_coordinate(&mut self, i: usize, model: &Model, control: &Control, side: [bool; 2]) {
        let of = |reading: &JointReading| reading.coordinate == Some(i);
        let Some(joint) = model.joint_readings.iter().position(of) else {
            return;
        };
        let name = &model.system.joints[joint].name;
        let unit = joint_unit(&model.system, joint);
        let limits = control.limits.iter();
        for limit in limits.filter(|one| one.joint() == Some(joint) && one.part.is_none()) {
            let kind = ["limit", "instant"];
            self.add(name, kind, limit.bounds(), side, |bound| (bound, unit));
        }
    }

    fn list(self) -> Vec<Active> {
        let reached = self.0.into_values().filter(|active| active.count > 0);
        let mut list: Vec<Active> = reached.collect();
        list.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.what.cmp(&b.what)));
        list
    }
}

impl Active {
    /// In words, such as `m1b at its bound of 500 V in 43 of 60 intervals`.
    pub fn message(&self) -> String {
        let Self {
            what,
            count,
            of,
            noun,
            ..
        } = self;
        match *noun {
            "" => what.clone(),
            "interval" => format!("{what} in {count} of {of} intervals"),
            noun => format!("{what} at {count} of {of} {noun}s"),
        }
    }
}

/// A row that does not hold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Violation {
    /// Equation or limit of the row.
    pub row: String,
    /// Distance to its bounds in its unit; absent where the row has no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub violation: Option<f64>,
    /// The unit; none of a pure number.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// The same, scaled as in the solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scaled: Option<f64>,
}

/// The worst `count` rows that are violated by more than `tolerance` in the measure of the solver.
pub fn violations(
    program: &mut Transcription<'_>,
    x: &[f64],
    tolerance: f64,
    count: usize,
) -> Vec<Violation> {
    let bounds = program.constraints().clone();
    let mut g = vec![0.0; bounds.count()];
    program.constraint(x, &mut g);
    let excess = |row: usize| bounds.excess(row, g[row]);
    let mut rows: Vec<usize> = (0..g.len()).filter(|&r| excess(r) > tolerance).collect();
    rows.sort_by(|&a, &b| excess(b).total_cmp(&excess(a)));
    rows.truncate(count);
    let describe = |row: usize| {
        let scaled = Some(excess(row)).filter(|excess| excess.is_finite());
        let scale = program.row_scale(row);
        let (violation, unit) = match program.unknowns().rows[row] {
            Row::Limit { limit, .. } => {
                let plain = |value: f64| program.plain(limit, value / scale);
                let bound = match g[row] < bounds.lower[row] {
                    true => bounds.lower[row],
                    false => bounds.upper[row],
                };
                let (value, unit) = plain(g[row]);
                ((value - plain(bound).0).abs(), unit)
            }
            other => of_equation(program, other, excess(row) / scale),
        };
        Violation {
            row: program.constraint_name(row),
            violation: scaled.map(|_| violation),
            unit,
            scaled,
        }
    };
    rows.into_iter().map(describe).collect()
}

/// The violation of an equation with its unit: the momentum that a balance misses, the value of a constraint of places and directions, or the
/// charge that is missing at an electrode times the interval; of a value that is a function of time, the value.
fn of_equation(program: &Transcription<'_>, row: Row, violation: f64) -> (f64, &'static str) {
    let model = program.model();
    let Some(variable) = row.of(&model.variables) else {
        return (violation, "");
    };
    if let Row::Time { .. } = row {
        let of_coordinate = match variable.size {
            Size::Length => "mm",
            _ => "rad",
        };
        let of_input = variable.source.map(|s| model.input_kind(s).unit());
        return (violation, of_input.unwrap_or(of_coordinate));
    }
    match (variable.role, variable.size) {
        (Role::Coordinate, Size::Length) => (violation, "N ms"),
        (Role::Coordinate, _) => (violation, "N mm ms"),
        (Role::Multiplier, _) => (violation / model.multiplier_time, ""),
        (Role::Potential, _) => (violation / variable.unit, "mC ms"),
        _ => (violation, ""),
    }
}
