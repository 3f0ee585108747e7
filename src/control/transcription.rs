//! The transcription: the discrete equations of motion over a horizon as a nonlinear program (DMOCC).
//!
//! Rows of instant k are `P(q_k)ᵀ [D₂L_d(q_{k−1}, q_k) + D₁L_d(q_k, q_{k+1}) + f⁺ + f⁻] (− h₀ Gᵀλ_k) = 0` with the
//! momentum of the start in row 0 and rest at the goal in row N, constraints where coordinates leave any, then limits.
//! The Jacobian is ∇²Ŝ, the Hessian of the Lagrangian ∇³Ŝ along the costates plus objective and limits, both exact.
//!
//! Rows and multipliers are scaled by magnitudes taken from the Jacobian at the guess, voltages are in kV, lengths in
//! the length of the system, the interval length in its guess, so that one tolerance means the same everywhere.

use crate::control::BoundaryError;
use crate::control::boundary::Boundary;
use crate::control::guess::Initial;
use crate::control::limits::{Bounded, Place};
use crate::control::objective::Cost;
use crate::control::problem::{Control, Duration, Limit};
use crate::control::solution::Costates;
use crate::control::unknowns::{Row, Unknowns, Variable};
use crate::dynamics::History;
use crate::functional::{Frame, Horizon, Level, Measure, Part, Sides};
use crate::ipopt;
use crate::math::Vector;
use crate::model::{Coordinates, Model};
use crate::nlp::{Bounds, Entries, Nlp};
use crate::reduction::{Instant, Scratch};

/// V in a kV, the unit of voltages in the program and in objectives.
const KILOVOLT: f64 = 1000.0;
/// s in a ms.
const MILLISECOND: f64 = 1e-3;

/// An entry of a matrix of the program: where its value is found, and its scale.
#[derive(Clone, Copy, Debug)]
struct Kept {
    place: usize,
    scale: f64,
}

/// A limit or goal on its way to rows.
#[derive(Clone, Debug)]
struct LimitRow {
    /// Index among the measures of its site.
    measure: usize,
    of_intervals: bool,
    lower: f64,
    upper: f64,
    /// Entries of its gradient: (side, entry of z) or (2, scalar).
    entries: Vec<(usize, usize)>,
    /// Vectors it reads.
    vectors: Vec<usize>,
    name: String,
    place: Place,
    scale: f64,
}

/// A control problem as a nonlinear program.
#[derive(Debug)]
pub struct Transcription<'m> {
    model: &'m Model,
    intervals: usize,
    horizon: Horizon,
    unknowns: Unknowns,
    limits: Vec<LimitRow>,
    /// First row, instant or interval, of each stretch of limit rows.
    limit_rows: Vec<(usize, usize)>,
    cost: Cost,
    momentum: Vec<f64>,
    bounds: Bounds,
    // The point.
    point: Vec<f64>,
    instants: Vec<Instant>,
    scalars: Vec<f64>,
    kilovolts: Vec<f64>,
    h: f64,
    // Scales: value = scale · variable, scaled row = scale · row.
    variable_scales: Vec<f64>,
    row_scales: Vec<f64>,
    // Values and what is kept of them.
    scratch: Scratch,
    measured: Part,
    /// Rows of the equations of all instants, then costates of the limits.
    rows: Vec<f64>,
    values: Vec<f64>,
    jacobian: Vec<Kept>,
    jacobian_entries: Entries,
    hessian: Vec<Kept>,
    hessian_entries: Entries,
    weights: [Vec<f64>; 2],
    /// Slot of the second derivative of each voltage with itself.
    voltage_slots: Vec<usize>,
    gradient: Vec<f64>,
}

impl<'m> Transcription<'m> {
    /// Transcribes a control problem; the guess sets the scales.
    ///
    /// # Errors
    /// There are more equations than unknowns.
    pub fn new(
        model: &'m Model,
        boundary: &Boundary,
        control: &Control,
        initial: &Initial,
    ) -> Result<Self, BoundaryError> {
        let motion = &model.action.motion;
        let (n, unknown_count) = (motion.coordinates, motion.unknowns());
        let scalar_count = model.voltages.len();
        let intervals = control.intervals;
        let horizon = match control.duration {
            Duration::Given(_) => Horizon::Given,
            Duration::Free { .. } => Horizon::Free,
        };
        let goal = &boundary.goal.coordinates;
        let given = |k: usize, i: usize| k == 0 || (k == intervals && goal[i].is_some());
        let free = horizon == Horizon::Free;
        let mut unknowns = Unknowns::new(intervals, n, unknown_count, scalar_count, free, given);
        let mut instants = vec![motion.instant(); intervals + 1];
        instants[0].z.copy_from_slice(&boundary.start.z);
        for (value, goal) in instants[intervals].z.iter_mut().zip(goal) {
            *value = goal.unwrap_or(*value);
        }
        let limits = limit_rows(model, &boundary.limits.list);
        let mut limit_at = Vec::new();
        let all_given = goal.iter().all(Option::is_some);
        for (index, limit) in limits.iter().enumerate() {
            let places = match (limit.place, limit.of_intervals) {
                (Place::Goal, _) => intervals..intervals + 1,
                (Place::Everywhere, true) => 0..intervals,
                (Place::Everywhere, false) => 1..intervals + usize::from(!all_given),
            };
            for k in places {
                unknowns.rows.push(Row::Limit { limit: index, k });
                limit_at.push((index, k));
            }
        }
        let kilo = |v: &Vec<f64>| {
            model
                .scalars(v)
                .iter()
                .map(|v| v / KILOVOLT)
                .collect::<Vec<_>>()
        };
        let ends = [
            boundary.rest[0].as_ref().map(kilo),
            boundary.rest[1].as_ref().map(kilo),
        ];
        let cost = Cost::new(control.objective, scalar_count, intervals, ends);
        let layout = model.action.layout();
        let length = model.length();
        let scale = |variable: &Variable| match *variable {
            Variable::Unknown { i, .. } if i < n && model.is_length(i) => length,
            Variable::Unknown { .. } => 1.0,
            Variable::Scalar { .. } => KILOVOLT,
            Variable::Horizon => initial.h,
        };
        let variable_scales = unknowns.variables.iter().map(scale).collect();
        let limit_count = limit_at.len();
        let extra: usize = limit_at.iter().map(|&(l, _)| limits[l].entries.len()).sum();
        let mut out = Self {
            model,
            intervals,
            horizon,
            limits,
            limit_rows: limit_at,
            cost,
            momentum: boundary.start.momentum.clone(),
            bounds: Bounds::default(),
            point: vec![f64::NAN; unknowns.variables.len()],
            instants,
            scalars: vec![0.0; intervals * scalar_count],
            kilovolts: vec![0.0; intervals * scalar_count],
            h: initial.h,
            variable_scales,
            row_scales: vec![1.0; unknowns.rows.len()],
            scratch: model.action.scratch(),
            measured: Part::new(
                motion.vectors.len(),
                scalar_count,
                &crate::functional::Couplings::default(),
            ),
            rows: vec![0.0; (intervals + 1) * unknown_count + limit_count],
            values: vec![0.0; layout.values(intervals) + extra],
            jacobian: Vec::new(),
            jacobian_entries: Entries::default(),
            hessian: Vec::new(),
            hessian_entries: Entries::default(),
            weights: [
                vec![0.0; model.action.instants.measures.len()],
                vec![0.0; model.action.intervals.measures.len()],
            ],
            gradient: vec![0.0; intervals * scalar_count],
            voltage_slots: (0..scalar_count)
                .map(|s| {
                    layout
                        .scalars
                        .find(s, s)
                        .expect("a voltage has a curvature of its own")
                })
                .collect(),
            unknowns,
        };
        out.count(&boundary.limits.list)?;
        out.lay_jacobian();
        out.lay_hessian();
        out.set_scales(&initial.history, initial.h);
        out.set_bounds(control);
        Ok(out)
    }

    fn count(&self, limits: &[Bounded]) -> Result<(), BoundaryError> {
        let goals = limits.iter().filter(|l| l.place == Place::Goal).count();
        let given = self.instants.len().saturating_sub(1);
        let equations = self
            .unknowns
            .rows
            .iter()
            .filter(|r| matches!(r, Row::Equation { .. }))
            .count()
            + goals;
        let unknowns = self.unknowns.variables.len();
        if equations > unknowns {
            let fixed = (0..self.model.coordinate_count())
                .filter(|&i| self.unknowns.unknown(given, i).is_none())
                .count();
            return Err(BoundaryError::Overdetermined {
                equations,
                goals: goals + fixed,
                unknowns,
            });
        }
        Ok(())
    }

    /// Number of intervals N.
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// Variables and equations.
    pub fn unknowns(&self) -> &Unknowns {
        &self.unknowns
    }

    /// Scale of a row: scaled row = scale · row.
    pub fn row_scale(&self, row: usize) -> f64 {
        self.row_scales[row]
    }

    fn jacobian_of(&self) -> Vec<(usize, usize, usize)> {
        let layout = self.model.action.layout();
        let u = &self.unknowns;
        let mut list = Vec::new();
        for k in 0..=self.intervals {
            for (slot, &(i, j)) in layout.same.entries().iter().enumerate() {
                list.push((u.row(k, i), u.unknown(k, j), layout.same_at(k) + slot));
            }
            for i in 0..layout.unknowns {
                list.push((u.row(k, i), u.horizon(), layout.horizon_at(k) + i));
            }
            if k == self.intervals {
                break;
            }
            for (slot, &(i, j)) in layout.cross.entries().iter().enumerate() {
                list.push((u.row(k + 1, i), u.unknown(k, j), layout.lower_at(k) + slot));
                list.push((u.row(k, i), u.unknown(k + 1, j), layout.upper_at(k) + slot));
            }
            for side in 0..2 {
                for (slot, &(i, s)) in layout.mixed.entries().iter().enumerate() {
                    list.push((
                        u.row(k + side, i),
                        Some(u.scalar(k, s)),
                        layout.mixed_at(k, side) + slot,
                    ));
                }
            }
        }
        let mut place = layout.values(self.intervals);
        let first = self.unknowns.rows.len() - self.limit_rows.len();
        for (r, &(limit, k)) in self.limit_rows.iter().enumerate() {
            for &(side, i) in &self.limits[limit].entries {
                let col = if side == 2 {
                    Some(u.scalar(k, i))
                } else {
                    u.unknown(k + side, i)
                };
                list.push((Some(first + r), col, place));
                place += 1;
            }
        }
        list.into_iter()
            .filter_map(|(row, col, place)| Some((row?, col?, place)))
            .collect()
    }

    fn lay_jacobian(&mut self) {
        // The horizon column has no entry in the rows of constraints, which are instantaneous.
        let n = self.model.coordinate_count();
        let horizon = self.unknowns.horizon();
        let exists = |&(row, col, _): &(usize, usize, usize)| {
            Some(col) != horizon
                || matches!(self.unknowns.rows[row], Row::Equation { i, .. } if i < n)
        };
        let list: Vec<_> = self.jacobian_of().into_iter().filter(exists).collect();
        for (row, col, place) in list {
            self.jacobian_entries.rows.push(row as u32);
            self.jacobian_entries.cols.push(col as u32);
            self.jacobian.push(Kept { place, scale: 1.0 });
        }
    }

    fn lay_hessian(&mut self) {
        let layout = self.model.action.layout();
        let u = &self.unknowns;
        let mut list: Vec<(Option<usize>, Option<usize>, usize)> = Vec::new();
        for k in 0..=self.intervals {
            for (slot, &(i, j)) in layout
                .same
                .entries()
                .iter()
                .enumerate()
                .filter(|(_, (i, j))| i >= j)
            {
                list.push((u.unknown(k, i), u.unknown(k, j), layout.same_at(k) + slot));
            }
            for i in 0..self.model.coordinate_count() {
                list.push((u.horizon(), u.unknown(k, i), layout.horizon_at(k) + i));
            }
            if k == self.intervals {
                break;
            }
            for (slot, &(i, j)) in layout.cross.entries().iter().enumerate() {
                list.push((
                    u.unknown(k + 1, i),
                    u.unknown(k, j),
                    layout.lower_at(k) + slot,
                ));
            }
            for side in 0..2 {
                for (slot, &(i, s)) in layout.mixed.entries().iter().enumerate() {
                    list.push((
                        Some(u.scalar(k, s)),
                        u.unknown(k + side, i),
                        layout.mixed_at(k, side) + slot,
                    ));
                }
            }
            for (slot, &(s, t)) in layout.scalars.entries().iter().enumerate() {
                list.push((
                    Some(u.scalar(k, s)),
                    Some(u.scalar(k, t)),
                    layout.scalars_at(k) + slot,
                ));
            }
            for s in 0..layout.interval_scalars {
                list.push((
                    u.horizon(),
                    Some(u.scalar(k, s)),
                    layout.horizon_scalars_at(k) + s,
                ));
            }
        }
        list.push((
            u.horizon(),
            u.horizon(),
            layout.horizon_square_at(self.intervals),
        ));
        let mut entries = Entries::default();
        for (row, col, place) in list {
            let (Some(row), Some(col)) = (row, col) else {
                continue;
            };
            entries.rows.push(row.max(col) as u32);
            entries.cols.push(row.min(col) as u32);
            let scale = self.variable_scales[row] * self.variable_scales[col];
            self.hessian.push(Kept { place, scale });
        }
        if self.cost.couples_intervals() {
            for k in 1..self.intervals {
                for s in 0..layout.interval_scalars {
                    entries.rows.push(u.scalar(k, s) as u32);
                    entries.cols.push(u.scalar(k - 1, s) as u32);
                }
            }
        }
        self.hessian_entries = entries;
    }

    /// Scales rows and multipliers by the largest entries of the Jacobian at the guess, kind by kind.
    fn set_scales(&mut self, history: &History, h: f64) {
        let n = self.model.coordinate_count();
        let count = self.model.action.motion.unknowns();
        let x = self.encode(history, h);
        let mut values = vec![0.0; self.jacobian.len()];
        self.jacobian(&x, &mut values);
        let is_multiplier = |v: &Variable| matches!(v, Variable::Unknown { i, .. } if *i >= n);
        let mut largest = vec![0.0_f64; count];
        let entries = || {
            self.jacobian_entries
                .rows
                .iter()
                .zip(&self.jacobian_entries.cols)
                .zip(&values)
        };
        let scale = |col: u32| self.variable_scales[col as usize];
        for ((&row, &col), value) in entries() {
            if let (Row::Equation { i, .. }, false) = (
                self.unknowns.rows[row as usize],
                is_multiplier(&self.unknowns.variables[col as usize]),
            ) && self.unknowns.horizon() != Some(col as usize)
            {
                largest[i] = largest[i].max((value * scale(col)).abs());
            }
        }
        let inverse = |v: f64| {
            if v.is_finite() && v > 0.0 {
                1.0 / v
            } else {
                1.0
            }
        };
        let row_scales: Vec<f64> = largest.iter().map(|&v| inverse(v)).collect();
        let mut columns = vec![0.0_f64; count];
        for ((&row, &col), value) in entries() {
            let (row, variable) = (
                self.unknowns.rows[row as usize],
                self.unknowns.variables[col as usize],
            );
            if let (Row::Equation { i: r, .. }, Variable::Unknown { i, .. }) = (row, variable)
                && i >= n
            {
                columns[i] = columns[i].max((value * row_scales[r]).abs());
            }
        }
        for (scale, variable) in self
            .variable_scales
            .iter_mut()
            .zip(&self.unknowns.variables)
        {
            match *variable {
                Variable::Unknown { i, .. } if i >= n => *scale = inverse(columns[i]),
                _ => {}
            }
        }
        for (scale, row) in self.row_scales.iter_mut().zip(&self.unknowns.rows) {
            *scale = match *row {
                Row::Equation { i, .. } => row_scales[i],
                Row::Limit { limit, .. } => self.limits[limit].scale,
            };
        }
        for ((kept, &row), &col) in self
            .jacobian
            .iter_mut()
            .zip(&self.jacobian_entries.rows)
            .zip(&self.jacobian_entries.cols)
        {
            kept.scale = self.row_scales[row as usize] * self.variable_scales[col as usize];
        }
        for ((kept, &row), &col) in self
            .hessian
            .iter_mut()
            .zip(&self.hessian_entries.rows)
            .zip(&self.hessian_entries.cols)
        {
            kept.scale = self.variable_scales[row as usize] * self.variable_scales[col as usize];
        }
        self.point.fill(f64::NAN);
    }

    fn set_bounds(&mut self, control: &Control) {
        let n = self.model.coordinate_count();
        let mut lower = vec![f64::NEG_INFINITY; n];
        let mut upper = vec![f64::INFINITY; n];
        if self.model.coordinates == Coordinates::Reduced {
            for limit in &control.limits {
                if let Limit::JointAngle { joint, min, max } = *limit
                    && let Some(c) = self.model.gauges[joint].coordinate
                {
                    (lower[c], upper[c]) = (lower[c].max(min), upper[c].min(max));
                }
            }
        }
        let bound = |(variable, &scale): (&Variable, &f64)| {
            let [low, high] = match *variable {
                Variable::Unknown { i, .. } if i < n => [lower[i], upper[i]],
                Variable::Unknown { .. } => [f64::NEG_INFINITY, f64::INFINITY],
                Variable::Scalar { .. } => control.voltage_bounds,
                Variable::Horizon => match control.duration {
                    Duration::Free { min, max, .. } => {
                        [min, max].map(|t| t / self.intervals as f64)
                    }
                    Duration::Given(_) => [self.h; 2],
                },
            };
            (low / scale, high / scale)
        };
        let (lower, upper) = self
            .unknowns
            .variables
            .iter()
            .zip(&self.variable_scales)
            .map(bound)
            .unzip();
        self.bounds = Bounds { lower, upper };
    }

    /// The variables of a motion with interval length h (ms).
    pub fn encode(&self, history: &History, h: f64) -> Vec<f64> {
        let value = |variable: &Variable| match *variable {
            Variable::Unknown { k, i } => history.z[k][i],
            Variable::Scalar { k, s } => history.scalars[k][s],
            Variable::Horizon => h,
        };
        self.unknowns
            .variables
            .iter()
            .zip(&self.variable_scales)
            .map(|(v, scale)| value(v) / scale)
            .collect()
    }

    /// The motion of a point of the program.
    pub fn decode(&mut self, x: &[f64]) -> History {
        self.load(x);
        let scalar_count = self.model.voltages.len();
        History {
            times: (0..=self.intervals).map(|k| k as f64 * self.h).collect(),
            z: self
                .instants
                .iter()
                .map(|instant| instant.z.clone())
                .collect(),
            scalars: (0..self.intervals)
                .map(|k| self.scalars[k * scalar_count..(k + 1) * scalar_count].to_vec())
                .collect(),
            ..History::default()
        }
    }

    /// A start of the solver from a guess.
    pub fn start(&self, initial: &Initial) -> ipopt::Point {
        let x = self.encode(&initial.history, initial.h);
        let fits = |c: &&Costates| {
            c.rows.len() == self.unknowns.rows.len()
                && c.lower.len() == x.len()
                && c.upper.len() == x.len()
        };
        let divide = |list: &[f64], scales: &[f64]| {
            list.iter()
                .zip(scales)
                .map(|(v, s)| v / s)
                .collect::<Vec<_>>()
        };
        let times = |list: &[f64], scales: &[f64]| {
            list.iter()
                .zip(scales)
                .map(|(v, s)| v * s)
                .collect::<Vec<_>>()
        };
        let costates = initial
            .costates
            .as_ref()
            .filter(fits)
            .map(|c| ipopt::Costates {
                constraints: divide(&c.rows, &self.row_scales),
                lower: times(&c.lower, &self.variable_scales),
                upper: times(&c.upper, &self.variable_scales),
            });
        ipopt::Point { x, costates }
    }

    /// Unscaled costates of a solution.
    pub fn costates(&self, costates: &ipopt::Costates) -> Costates {
        let divide = |list: &[f64], scales: &[f64]| {
            list.iter()
                .zip(scales)
                .map(|(v, s)| v / s)
                .collect::<Vec<_>>()
        };
        let times = |list: &[f64], scales: &[f64]| {
            list.iter()
                .zip(scales)
                .map(|(v, s)| v * s)
                .collect::<Vec<_>>()
        };
        Costates {
            rows: times(&costates.constraints, &self.row_scales),
            lower: divide(&costates.lower, &self.variable_scales),
            upper: divide(&costates.upper, &self.variable_scales),
        }
    }

    /// Reads a point; vectors and columns of all instants follow unless they stand there already.
    fn load(&mut self, x: &[f64]) {
        if self.point == x {
            return;
        }
        self.point.copy_from_slice(x);
        let scalar_count = self.model.voltages.len();
        for ((variable, scale), value) in self
            .unknowns
            .variables
            .iter()
            .zip(&self.variable_scales)
            .zip(x)
        {
            let value = scale * value;
            match *variable {
                Variable::Unknown { k, i } => self.instants[k].z[i] = value,
                Variable::Scalar { k, s } => {
                    self.scalars[k * scalar_count + s] = value;
                    self.kilovolts[k * scalar_count + s] = value / KILOVOLT;
                }
                Variable::Horizon => self.h = value,
            }
        }
        for instant in &mut self.instants {
            self.model.action.motion.place(instant);
        }
    }

    fn clear_forces(&mut self) {
        for instant in &mut self.instants {
            instant.forces.fill(Vector::zeros());
            instant.contracted.fill(Vector::zeros());
        }
    }

    /// Interval by interval, then instant by instant: forces, and second derivatives into the values.
    fn sweep(&mut self, level: Level) {
        let action = &self.model.action;
        let scalar_count = self.model.voltages.len();
        if level >= Level::Hessian {
            self.values.fill(0.0);
        }
        let mut square = 0.0;
        self.scratch.start();
        for k in 0..self.intervals {
            let (left, right) = self.instants.split_at_mut(k + 1);
            let (a, b) = (&mut left[k], &mut right[0]);
            let scalars = &self.scalars[k * scalar_count..(k + 1) * scalar_count];
            let weights = interval_weights(
                &mut self.weights[1],
                &self.limits,
                &self.limit_rows,
                &self.rows,
                k,
            );
            let scratch = &mut self.scratch;
            action.evaluate_interval(
                level,
                a,
                b,
                scalars,
                self.h,
                self.horizon,
                Sides::ALL,
                weights,
                scratch,
            );
            scratch.carry(level);
            action.pull_back_interval(
                level,
                a,
                b,
                self.horizon,
                Sides::CARRIED,
                k,
                scratch,
                &mut self.values,
            );
            square += scratch.interval.contracted.horizon;
        }
        let last = &self.instants[self.intervals];
        action.pull_back_last(
            level,
            last,
            self.intervals,
            &mut self.scratch,
            &mut self.values,
        );
        for (k, instant) in self.instants.iter_mut().enumerate() {
            let weights = instant_weights(
                &mut self.weights[0],
                &self.limits,
                &self.limit_rows,
                &self.rows,
                k,
            );
            action.evaluate_instant(level, instant, weights, &mut self.scratch);
            action.pull_back_instant(level, instant, k, &mut self.scratch, &mut self.values);
            if level != Level::Third {
                let count = action.motion.unknowns();
                let rows = &mut self.rows[k * count..(k + 1) * count];
                rows.fill(0.0);
                action.rows(instant, &self.scratch, rows);
            }
        }
        if level == Level::Third && self.horizon == Horizon::Free {
            self.values[action.layout().horizon_square_at(self.intervals)] += square;
        }
    }

    /// The frame in which a measure is read at instant or interval k.
    fn frame(&self, of_intervals: bool, k: usize) -> Frame<'_> {
        let scalar_count = self.model.voltages.len();
        let next = if of_intervals { k + 1 } else { k };
        Frame {
            vectors: [&self.instants[k].x, &self.instants[next].x],
            along: [&self.instants[k].w, &self.instants[next].w],
            scalars: if of_intervals {
                &self.scalars[k * scalar_count..(k + 1) * scalar_count]
            } else {
                &[]
            },
            scalars_along: &[],
            h: self.h,
            horizon: Horizon::Given,
            sides: Sides::ALL,
            weights: &[],
        }
    }

    fn measure(&self, limit: &LimitRow) -> &'m dyn Measure {
        let action = &self.model.action;
        let site = if limit.of_intervals {
            &action.intervals
        } else {
            &action.instants
        };
        site.measures[limit.measure].as_ref()
    }

    fn limit_value(&self, limit: &LimitRow, k: usize) -> f64 {
        self.measure(limit)
            .value(&self.frame(limit.of_intervals, k))
    }

    /// Largest violation of the unscaled rows, with its row.
    pub fn worst_violation(&mut self, x: &[f64]) -> Option<(f64, usize)> {
        let bounds = self.constraints();
        let mut g = vec![0.0; self.unknowns.rows.len()];
        self.constraint(x, &mut g);
        let excess = |r: usize| {
            (bounds.lower[r] - g[r])
                .max(g[r] - bounds.upper[r])
                .max(0.0)
        };
        let worst = (0..g.len()).max_by(|&a, &b| excess(a).total_cmp(&excess(b)))?;
        Some((excess(worst), worst))
    }
}

/// Weights of the measures of the intervals: the costates of their rows, which stand in `rows` behind the equations.
fn interval_weights<'w>(
    weights: &'w mut [f64],
    limits: &[LimitRow],
    places: &[(usize, usize)],
    rows: &[f64],
    k: usize,
) -> &'w [f64] {
    fill_weights(weights, limits, places, rows, k, true);
    weights
}

/// Weights of the measures of the instants.
fn instant_weights<'w>(
    weights: &'w mut [f64],
    limits: &[LimitRow],
    places: &[(usize, usize)],
    rows: &[f64],
    k: usize,
) -> &'w [f64] {
    fill_weights(weights, limits, places, rows, k, false);
    weights
}

fn fill_weights(
    weights: &mut [f64],
    limits: &[LimitRow],
    places: &[(usize, usize)],
    rows: &[f64],
    k: usize,
    of_intervals: bool,
) {
    if weights.is_empty() {
        return;
    }
    weights.fill(0.0);
    let costates = &rows[rows.len() - places.len()..];
    for (&(limit, at), y) in places.iter().zip(costates) {
        let limit = &limits[limit];
        if at == k && limit.of_intervals == of_intervals {
            weights[limit.measure] = *y;
        }
    }
}

/// Rows of the bounded quantities, with the entries their gradients have.
fn limit_rows(model: &Model, list: &[Bounded]) -> Vec<LimitRow> {
    let motion = &model.action.motion;
    let mut next = [0, 0];
    let row = |bounded: &Bounded| {
        let of_intervals = bounded.quantity.is_of_intervals();
        let counter = &mut next[usize::from(of_intervals)];
        let measure = *counter;
        *counter += 1;
        let site = if of_intervals {
            &model.action.intervals
        } else {
            &model.action.instants
        };
        let reads = &site.measures[measure];
        let mut support: Vec<usize> = reads
            .vectors()
            .iter()
            .flat_map(|&v| motion.support(v))
            .collect();
        support.sort_unstable();
        support.dedup();
        let sides = if of_intervals { 0..2 } else { 0..1 };
        let mut entries: Vec<(usize, usize)> = sides
            .flat_map(|side| support.iter().map(move |&i| (side, i)))
            .collect();
        entries.extend(
            reads
                .scalars()
                .into_iter()
                .filter(|_| of_intervals)
                .map(|s| (2, s)),
        );
        let scale = if matches!(bounded.quantity, crate::model::Quantity::MarkerPlace { .. }) {
            1.0 / model.length()
        } else {
            1.0
        };
        LimitRow {
            measure,
            of_intervals,
            lower: bounded.lower,
            upper: bounded.upper,
            entries,
            vectors: reads.vectors(),
            name: bounded.name.clone(),
            place: bounded.place,
            scale,
        }
    };
    list.iter().map(row).collect()
}

impl Nlp for Transcription<'_> {
    fn variables(&self) -> Bounds {
        self.bounds.clone()
    }

    fn constraints(&self) -> Bounds {
        let bound = |row: &Row| match *row {
            Row::Equation { .. } => (0.0, 0.0),
            Row::Limit { limit, .. } => {
                let limit = &self.limits[limit];
                (limit.lower * limit.scale, limit.upper * limit.scale)
            }
        };
        let (lower, upper) = self.unknowns.rows.iter().map(bound).unzip();
        Bounds { lower, upper }
    }

    fn jacobian_structure(&self) -> Entries {
        self.jacobian_entries.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.hessian_entries.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.load(x);
        self.cost.value(&self.kilovolts, self.h * MILLISECOND)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.load(x);
        let by_horizon =
            self.cost
                .gradient(&self.kilovolts, self.h * MILLISECOND, &mut self.gradient);
        let scalar_count = self.model.voltages.len();
        for ((variable, scale), g) in self
            .unknowns
            .variables
            .iter()
            .zip(&self.variable_scales)
            .zip(grad)
        {
            *g = match *variable {
                Variable::Scalar { k, s } => self.gradient[k * scalar_count + s] * scale / KILOVOLT,
                Variable::Horizon => by_horizon * MILLISECOND * scale,
                Variable::Unknown { .. } => 0.0,
            };
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.load(x);
        self.clear_forces();
        self.sweep(Level::Gradient);
        let count = self.model.action.motion.unknowns();
        for (value, (row, scale)) in g
            .iter_mut()
            .zip(self.unknowns.rows.iter().zip(&self.row_scales))
        {
            *value = scale
                * match *row {
                    Row::Equation { k, i } => {
                        let start = if k == 0 && i < self.momentum.len() {
                            self.momentum[i]
                        } else {
                            0.0
                        };
                        self.rows[k * count + i] + start
                    }
                    Row::Limit { limit, k } => self.limit_value(&self.limits[limit], k),
                };
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.load(x);
        self.clear_forces();
        self.sweep(Level::Hessian);
        self.limit_gradients();
        for (value, kept) in values.iter_mut().zip(&self.jacobian) {
            *value = kept.scale * self.values[kept.place];
        }
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        self.load(x);
        self.clear_forces();
        for instant in &mut self.instants {
            instant.l.fill(0.0);
        }
        self.rows.fill(0.0);
        let total = self.rows.len() - self.limit_rows.len();
        let first = self.unknowns.rows.len() - self.limit_rows.len();
        for (r, (row, y)) in self.unknowns.rows.iter().zip(costates).enumerate() {
            let y = y * self.row_scales[r];
            match *row {
                Row::Equation { k, i } => self.instants[k].l[i] = y,
                Row::Limit { .. } => self.rows[total + r - first] = y,
            }
        }
        for instant in &mut self.instants {
            self.model.action.motion.along(instant);
        }
        self.sweep(Level::Third);
        self.objective_curvature(sigma);
        let tau = self.h * MILLISECOND;
        let (own, coupling) = values.split_at_mut(self.hessian.len());
        for (value, kept) in own.iter_mut().zip(&self.hessian) {
            *value = kept.scale * self.values[kept.place];
        }
        coupling.fill(sigma * self.cost.coupling(tau));
    }

    fn variable_name(&self, i: usize) -> String {
        match self.unknowns.variables[i] {
            Variable::Unknown { k, i } => format!("{} at instant {k}", self.model.unknown_name(i)),
            Variable::Scalar { k, s } => {
                format!(
                    "voltage of {} in interval {k}",
                    self.model.system.muscles[self.model.voltages[s]].name
                )
            }
            Variable::Horizon => "interval length".to_owned(),
        }
    }

    fn constraint_name(&self, i: usize) -> String {
        let n = self.model.coordinate_count();
        match self.unknowns.rows[i] {
            Row::Equation { k, i } if i < n && k == self.intervals => {
                format!("rest at the goal, {}", self.model.unknown_name(i))
            }
            Row::Equation { k, i } if i < n => {
                format!("motion at instant {k}, {}", self.model.unknown_name(i))
            }
            Row::Equation { k, i } => format!(
                "constraint {} at instant {k}",
                self.model.multiplier_names[i - n]
            ),
            Row::Limit { limit, k } => {
                match (self.limits[limit].place, self.limits[limit].of_intervals) {
                    (Place::Goal, _) => self.limits[limit].name.clone(),
                    (_, true) => format!("{} in interval {k}", self.limits[limit].name),
                    (_, false) => format!("{} at instant {k}", self.limits[limit].name),
                }
            }
        }
    }
}

impl Transcription<'_> {
    /// Gradients of the limits, behind the periodic values.
    fn limit_gradients(&mut self) {
        let motion = &self.model.action.motion;
        let mut place = self.model.action.layout().values(self.intervals);
        for index in 0..self.limit_rows.len() {
            let (limit, k) = self.limit_rows[index];
            let measure = self.measure(&self.limits[limit]);
            let of_intervals = self.limits[limit].of_intervals;
            let mut part = std::mem::take(&mut self.measured);
            measure.gradient(
                &self.frame(of_intervals, k),
                &mut part.forces,
                &mut part.rows,
            );
            let sides = if of_intervals { 2 } else { 1 };
            // Rows of the coordinates of one side at a time, in the storage of one instant's rows.
            let count = motion.unknowns();
            let mut at = 0;
            for side in 0..sides {
                let rows = &mut self.rows[..count];
                rows.fill(0.0);
                for &vector in &self.limits[limit].vectors {
                    motion.pull_back_one(
                        vector,
                        &self.instants[k + side].columns,
                        &part.forces[side][vector],
                        rows,
                    );
                }
                while let Some(&(_, i)) = self.limits[limit]
                    .entries
                    .get(at)
                    .filter(|(s, _)| *s == side)
                {
                    self.values[place] = rows[i];
                    (at, place) = (at + 1, place + 1);
                }
            }
            for &(_, s) in &self.limits[limit].entries[at..] {
                self.values[place] = part.rows[s];
                place += 1;
            }
            for &vector in &self.limits[limit].vectors {
                for side in &mut part.forces {
                    side[vector] = Vector::zeros();
                }
            }
            part.rows.fill(0.0);
            self.measured = part;
        }
    }

    /// Adds σ∇²f to the values.
    fn objective_curvature(&mut self, sigma: f64) {
        let layout = self.model.action.layout();
        let scalar_count = self.model.voltages.len();
        let tau = self.h * MILLISECOND;
        for k in 0..self.intervals {
            let curvature = sigma * self.cost.curvature(k, tau) / (KILOVOLT * KILOVOLT);
            for s in 0..scalar_count {
                self.values[layout.scalars_at(k) + self.voltage_slots[s]] += curvature;
            }
        }
        if self.horizon == Horizon::Free {
            let square = self.cost.horizon(&self.kilovolts, tau, &mut self.gradient);
            for k in 0..self.intervals {
                let at = layout.horizon_scalars_at(k);
                for s in 0..scalar_count {
                    self.values[at + s] +=
                        sigma * self.gradient[k * scalar_count + s] * MILLISECOND / KILOVOLT;
                }
            }
            self.values[layout.horizon_square_at(self.intervals)] +=
                sigma * square * MILLISECOND * MILLISECOND;
        }
    }
}
