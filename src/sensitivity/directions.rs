//! Changes of an opened program with each number by which its optimum is differentiated.
//!
//! Derivatives of a state of rest by constants of the system and by inputs under which it rests.
//!
//! The balances of a motion of one interval that does not move are those of rest, `r(q; p) = 0`: `dq/dp = −(∂r/∂q)⁻¹ ∂r/∂p`.

use crate::control::problem::{
    BoundaryState, Control, Duration, Objective, SoughtHold, Varied, VariedOf, WeightOf,
};
use crate::control::{
    BoundedQuantity, Column, MotionDerivatives, Row, Transcription, When, momentum_slopes,
    resolve_start,
};
use crate::dynamics::DiscreteTrajectory;
use crate::math::Signal;
use crate::model::{Model, Role, What};
use crate::nlp::Nlp;
use crate::sensitivity::conditions::{Direction, NoSensitivity, Side};
use crate::sensitivity::kernel::Kernel;
use crate::sensitivity::with_parameters::{AtRest, Mapped, Opened};
use std::collections::BTreeMap;

/// A root of a square that is zero, as a part of its bound.
const BESIDE: f64 = 1e-9;

/// Makes directions.
pub(super) struct Directions<'a> {
    opened: &'a Opened,
    program: &'a Transcription<'a>,
    /// Columns of the solved program.
    solved: &'a Mapped,
    /// The start as the problem gives it.
    start: &'a BoundaryState,
    /// Derivatives of the states of rest at start and goal by parameters of the model, then by sources.
    rests: [Option<MotionDerivatives>; 2],
    sources: [Vec<usize>; 2],
    /// Directions of the weights of the objective.
    weights: Vec<(WeightOf, Direction)>,
}

impl<'a> Directions<'a> {
    /// Those of an opened problem, at the optimum of its program.
    pub(super) fn new(
        opened: &'a Opened,
        kernel: &'a Kernel<Transcription<'a>>,
        solved: &'a Mapped,
        start: &'a BoundaryState,
    ) -> Result<Self, NoSensitivity> {
        let sources = [0, 1].map(|end| {
            let of = |one: &Varied| match one.of {
                VariedOf::StartVoltage(source) if end == 0 => Some(source),
                VariedOf::GoalVoltage(source) if end == 1 => Some(source),
                _ => None,
            };
            let all = opened.control.varied.iter().filter_map(of);
            all.collect::<Vec<_>>()
        });
        let is_any = opened.control.parameters.len() > opened.sought;
        let of = |end: usize| {
            let rest = opened.rests[end].as_ref();
            let rest = rest.filter(|_| is_any || !sources[end].is_empty());
            let by = rest.map(|rest| rest_derivatives(opened, rest, &sources[end]));
            by.transpose()
        };
        Ok(Self {
            rests: [of(0)?, of(1)?],
            weights: of_weights(opened, &solved.squares, &kernel.point())?,
            program: kernel.program(),
            opened,
            solved,
            start,
            sources,
        })
    }

    /// The direction of a number, by its unit inside.
    pub(super) fn of(&self, varied: &Varied) -> Result<Direction, NoSensitivity> {
        let not_offered = |what: &str| {
            let name = &varied.name;
            NoSensitivity::refused(format!("{name}: {what}"))
        };
        match varied.of {
            VariedOf::Constants(_) => Ok(self.of_constants(varied)),
            VariedOf::Duration => {
                let column = self.program.unknowns().horizon();
                let column = column.ok_or_else(|| not_offered("the duration is no constant"))?;
                let part = 1.0 / self.program.intervals() as f64;
                Ok(self.of_held([(column, part)]))
            }
            VariedOf::GoalJoint(joint) => self.of_goal_joint(joint).ok_or_else(|| {
                not_offered("a goal of all joints is no variable in redundant coordinates")
            }),
            VariedOf::GoalPlace { marker, axis } => Ok(self.of_goal_row(|bounded| {
                !bounded.quantity.is_step() && bounded.quantity.what == (What::Place { marker, axis })
            })),
            VariedOf::GoalVoltage(source) => self.of_rest_voltage(1, source),
            VariedOf::StartVoltage(source) => self.of_rest_voltage(0, source),
            VariedOf::StartJoint(joint) => self.of_start_joint(joint).ok_or_else(|| {
                not_offered("a start of joint coordinates is offered in reduced coordinates and at rest alone")
            }),
            VariedOf::StartRate(joint) => self.of_start_rate(joint),
            VariedOf::VoltageBound(side) => Ok(self.of_input_bounds(side, |_| true, Role::Voltage)),
            VariedOf::LoadBound(source, side) => {
                Ok(self.of_input_bounds(side, |s| s == Some(source), Role::Load))
            }
            VariedOf::Weight(weight) => {
                let own = self.weights.iter().find(|(one, _)| *one == weight);
                Ok(own.expect("a weight of the problem").1.clone())
            }
        }
    }

    fn model(&self) -> &Model {
        &self.opened.model
    }

    /// Derivatives of values of columns, in the units of the program.
    fn of_held(&self, list: impl IntoIterator<Item = (usize, f64)>) -> Direction {
        let scaled = list.into_iter();
        let scaled =
            scaled.map(|(column, value)| (column, value / self.program.column_scale(column)));
        Direction {
            held: scaled.filter(|(_, value)| *value != 0.0).collect(),
            ..Direction::default()
        }
    }

    /// Columns of coordinates of the start or the goal that are held.
    fn of_end(&self, end: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let (at, unknowns) = ([0, self.program.intervals()][end], self.program.unknowns());
        let all = 0..self.model().coordinate_count();
        let columns = all.filter_map(move |i| Some((unknowns.unknown(at, i)?, i)));
        columns.filter(move |&(column, _)| self.solved.is_new[column])
    }

    fn of_constants(&self, varied: &Varied) -> Direction {
        let parameters = &self.model().analysis.parameters;
        let place = parameters.iter().position(|one| one.name == varied.name);
        let place = place.expect("a parameter of the model");
        let s = self.model().variables.range(Role::Parameter).nth(place);
        let own = s.and_then(|s| self.program.unknowns().scalar(0, s));
        let own = own.into_iter().map(|column| (column, 1.0));
        let ends = (0..2).flat_map(|end| self.by_rest(end, place));
        self.of_held(own.chain(ends).collect::<Vec<_>>())
    }

    /// Derivatives of the coordinates of a state of rest by one of the columns of its derivatives.
    fn by_rest(&self, end: usize, column: usize) -> Vec<(usize, f64)> {
        let of = |by: &MotionDerivatives| -> Vec<_> {
            let own = self.of_end(end);
            own.filter_map(|(number, i)| Some((number, by.of_coordinate(0, i)?[column])))
                .collect()
        };
        self.rests[end].as_ref().map(of).unwrap_or_default()
    }

    fn of_rest_voltage(&self, end: usize, source: usize) -> Result<Direction, NoSensitivity> {
        let objective = &self.opened.control.objective;
        if objective.rate != 0.0 || !objective.energies.is_empty() {
            let reason = "a voltage at rest is offered where the objective counts neither rates nor energies";
            return Err(NoSensitivity::refused(reason));
        }
        let place = self.sources[end].iter().position(|one| *one == source);
        let place = place.expect("a source that is open");
        let parameters = self.opened.control.parameters.len();
        Ok(self.of_held(self.by_rest(end, parameters + place)))
    }

    /// The coordinate of the model that is that of a joint; none where constraints join coordinates.
    fn coordinate(&self, joint: usize) -> Option<usize> {
        let reading = &self.model().joint_readings[joint];
        let is_one = self.model().has_independent_joints();
        reading.coordinate.filter(|_| is_one)
    }

    fn of_goal_joint(&self, joint: usize) -> Option<Direction> {
        if let Some(c) = self.coordinate(joint) {
            let column = self.of_end(1).find(|(_, i)| *i == c)?;
            return Some(self.of_held([(column.0, 1.0)]));
        }
        let is_goal = |bounded: &BoundedQuantity| {
            !bounded.quantity.is_step()
                && matches!(bounded.quantity.what, What::Joint { joint: j, .. } if j == joint)
        };
        let found = self.of_goal_row(is_goal);
        (!found.constraint_bounds.is_empty()).then_some(found)
    }

    /// The direction of the value of goals that are equations.
    fn of_goal_row(&self, is_goal: impl Fn(&BoundedQuantity) -> bool) -> Direction {
        let mut out = Direction::default();
        for (row, of) in self.program.unknowns().rows.iter().enumerate() {
            let Row::Limit { limit, .. } = *of else {
                continue;
            };
            let bounded = self.program.limit(limit);
            if bounded.when == When::Goal && is_goal(bounded) {
                let scale = self.program.row_scale(row);
                let sides = [Side::Lower, Side::Upper];
                out.constraint_bounds
                    .extend(sides.map(|side| (row, side, scale)));
            }
        }
        out
    }

    fn of_start_joint(&self, joint: usize) -> Option<Direction> {
        let mut momenta = self.opened.boundary.start.momentum.iter();
        let is_moving = momenta.any(|p| *p != 0.0);
        let c = self.coordinate(joint).filter(|_| !is_moving)?;
        let column = self.of_end(0).find(|(_, i)| *i == c)?;
        Some(self.of_held([(column.0, 1.0)]))
    }

    /// Momenta are linear in rates.
    fn of_start_rate(&self, joint: usize) -> Result<Direction, NoSensitivity> {
        let BoundaryState::JointAngles { angles, .. } = self.start else {
            return Err(NoSensitivity::refused("the start has no rates"));
        };
        let unit = BoundaryState::JointAngles {
            angles: angles.clone(),
            rates: BTreeMap::from([(joint, 1.0)]),
            velocities: BTreeMap::new(),
        };
        let start = resolve_start(self.model(), &unit);
        let mut start = start.map_err(NoSensitivity::refused)?;
        let slopes = momentum_slopes(self.model(), &unit, &mut start);
        slopes.map_err(|_| NoSensitivity::refused("momenta are no straight line in a mass"))?;
        let momenta = start.momentum.iter().enumerate();
        let rows = momenta.filter_map(|(i, momentum)| {
            let row = self.program.unknowns().row(0, i)?;
            Some((row, self.program.row_scale(row) * momentum))
        });
        Ok(Direction {
            constraints: rows.collect(),
            ..Direction::default()
        })
    }

    fn of_input_bounds(
        &self,
        side: usize,
        is_one: impl Fn(Option<usize>) -> bool,
        role: Role,
    ) -> Direction {
        let variables = &self.model().variables;
        let side = [Side::Lower, Side::Upper][side];
        let columns = self.program.unknowns().columns.iter().enumerate();
        let bounds = columns.filter_map(|(number, column)| {
            let variable = column.of(variables);
            let is_one = variable.role == role && is_one(variable.source);
            is_one.then(|| (number, side, 1.0 / self.program.column_scale(number)))
        });
        Direction {
            bounds: bounds.collect(),
            ..Direction::default()
        }
    }
}

/// Directions of weights: the objective is linear in them, and its derivative by one is that with this weight alone. One program is built for all.
fn of_weights(
    opened: &Opened,
    squares: &[usize],
    point: &[f64],
) -> Result<Vec<(WeightOf, Direction)>, NoSensitivity> {
    let weight = |one: &Varied| match one.of {
        VariedOf::Weight(weight) => Some(weight),
        _ => None,
    };
    let list: Vec<WeightOf> = opened.control.varied.iter().filter_map(weight).collect();
    if list.is_empty() {
        return Ok(Vec::new());
    }
    let Opened {
        model,
        boundary,
        initial,
        ..
    } = opened;
    let control = Control {
        objective: Objective::default(),
        ..opened.control.clone()
    };
    let program = Transcription::of_any(model, boundary, &control, initial);
    let mut program = program.map_err(NoSensitivity::refused)?;
    let mut x = point.to_vec();
    // Where a square is zero its root has no slope: the slope by the square is that beside zero.
    for &square in squares {
        x[square] = x[square].max(BESIDE * program.variables().upper[square]);
    }
    let mut direction = |weight: WeightOf| {
        let one = |of: WeightOf| f64::from(u8::from(of == weight));
        program.weigh(&Objective {
            effort: one(WeightOf::Effort),
            rate: one(WeightOf::Rate),
            duration: one(WeightOf::Duration),
            ..Objective::default()
        });
        let mut gradient = vec![0.0; x.len()];
        program.gradient(&x, &mut gradient);
        let gradient = gradient.into_iter().enumerate();
        Direction {
            gradient: gradient.filter(|(_, value)| *value != 0.0).collect(),
            objective: program.objective(&x),
            ..Direction::default()
        }
    };
    let all = list.into_iter();
    Ok(all.map(|weight| (weight, direction(weight))).collect())
}

/// Derivatives of the coordinates of a state of rest: a column for each parameter of the model, then one for each of the sources.
fn rest_derivatives(
    opened: &Opened,
    rest: &AtRest,
    sources: &[usize],
) -> Result<MotionDerivatives, NoSensitivity> {
    let Opened { model, control, .. } = opened;
    let AtRest { state, voltages } = rest;
    let control = still(control, voltages, sources);
    let (z, scalars) = (vec![state.z.clone(); 2], vec![state.scalars.clone()]);
    let discrete = DiscreteTrajectory::in_steps(1.0, z, scalars);
    let variables = &model.variables;
    let (parameters, inputs) = (variables.range(Role::Parameter), variables.sources_range());
    let known = |column: &Column| match *column {
        Column::Parameter { s } => Some(vec![(s - parameters.start, 1.0)]),
        Column::Interval { s, .. } if inputs.contains(&s) => {
            let source = column.of(variables).source;
            let place = sources.iter().position(|one| Some(*one) == source);
            let place = place.expect("a source that is open");
            Some(vec![(parameters.len() + place, 1.0)])
        }
        _ => None,
    };
    let count = parameters.len() + sources.len();
    let found = MotionDerivatives::new(model, &control, None, &discrete, count, known);
    let found = found.map_err(NoSensitivity::refused)?;
    let singular = || NoSensitivity::refused("a state of rest has no derivative");
    found.ok_or_else(singular)
}

/// The problem of a motion of one interval of 1 ms under given inputs, but those of some sources.
fn still(control: &Control, voltages: &[f64], sources: &[usize]) -> Control {
    let given = voltages.iter().enumerate();
    let given = given.filter(|(source, _)| !sources.contains(source));
    Control {
        duration: Duration::Given(1.0),
        intervals: 1,
        start: BoundaryState::Free,
        goal: BoundaryState::Free,
        given: given.map(|(s, &v)| (s, Signal::Constant(v))).collect(),
        course: None,
        load_bounds: Default::default(),
        sought_hold: SoughtHold::Never,
        objective: Objective::default(),
        limits: Vec::new(),
        waypoints: Vec::new(),
        ..control.clone()
    }
}
