//! The controller of a receding horizon: inputs of each interval from what is measured at its start.
//!
//! A step has two parts. [`RecedingHorizon::prepare`] shifts the plan by an interval, evaluates and factorises; it is called when the inputs went
//! out. [`RecedingHorizon::step`] enters what is measured and takes the iteration that was prepared; it prepares first where that was not done.
//! Every step gives inputs, and says where they come from:
//!
//! ```text
//! measured, plan prepared                        → the iteration                 Source::Plan
//! nothing measured in time                       → the plan as it was            Source::Late
//! no finite numbers, or too far from the plan    → the plan as it was            Source::Unusable
//! no factors, or no step                         → the plan as it was            Source::Kept
//! the same again and again                       → the law of the regulator      Source::Regulator, and a new plan
//! ```
//!
//! A step does a bounded amount of work and allocates nothing: one iteration, and up to three further ones where the bounds of limits cut it.
//! `workflow/receding/state.rs` finds the state from readings, and predicts it over a delay:
//! the plan begins where its inputs act. Constant disturbances enter the plan with its preparation.

use crate::control::{Column, Row};
use crate::coordinates::Configuration;
use crate::dynamics::Closing;
use crate::math::Vector;
use crate::nlp::Nlp;
use crate::stop;
use crate::workflow::receding::horizon::Horizon;
use crate::workflow::receding::iteration::{Iteration, Residual};
use crate::workflow::receding::program::{Between, Program, Reading};
use crate::workflow::receding::state::{Predicted, Source};
use rustc_hash::FxHashMap;

/// The barrier parameter, as a part of the weight of inputs.
const BARRIER: f64 = 1e-7;
/// Steps that fail one after the other before the law of the regulator takes over.
const PATIENCE: usize = 3;
/// Deviation from the predicted state that is taken for an error of the measurement, in rad, and as a part of the length of the system; and the change in an
/// interval by a deviation of a rate from that of the motion: a push makes large rates at once.
const ABSURD: f64 = 1.0;
const ABSURD_RATE: f64 = 10.0;
/// Residual of the equations from which on a plan that does not improve has failed.
const FAR: f64 = 1.0;
/// Most further iterations of a step that the bounds of limits cut.
const FURTHER: usize = 3;
/// The last sample: a later time, of a wrong time stamp, is that of it.
const LAST_SAMPLE: f64 = 1e15;
/// Iterations of the first plan, and the residual at which they end.
const FIRST: usize = 100;
const SMALL: f64 = 1e-9;

/// Inputs of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer<'a> {
    /// Their origin.
    pub source: Source,
    /// In the order of the law: V, N, N mm; within their bounds.
    pub inputs: &'a [f64],
}

/// The controller.
#[derive(Debug)]
pub struct RecedingHorizon<'h> {
    of: &'h Horizon,
    iteration: Iteration<Program<'h>>,
    shift: Shift,
    state: Predicted<'h>,
    /// Interval of the plan.
    interval: usize,
    /// True if the plan has factors; none before it was prepared.
    prepared: Option<bool>,
    /// Interval of the last answer, and its origin.
    answered: Option<(usize, Source)>,
    /// The first interval that has an answer of its own: the next one, or that behind the answer before a leap of the time.
    next: usize,
    /// Steps without an iteration one after the other, and implausible measurements.
    failures: usize,
    implausible: usize,
    residual: Residual,
    inputs: Vec<f64>,
    /// Places of the state that is measured.
    instant: Configuration,
    closing: Closing,
    moving: Vec<Vector>,
    rates: Vec<f64>,
    momenta: Vec<f64>,
    /// Changes of the state at the start, and of its rows.
    changes: Vec<(usize, f64)>,
    rows: Vec<(usize, f64)>,
    /// Room for points.
    points: [Vec<f64>; 2],
}

impl<'h> RecedingHorizon<'h> {
    /// A controller that begins at the start of the motion.
    pub fn new(of: &'h Horizon) -> Self {
        let program = of.program();
        let columns = program.variables().count();
        let width = of.steered.coordinates.len();
        let mut is_held = vec![false; columns];
        let start = program.readings[..width].iter();
        start.for_each(|reading| is_held[reading.column] = true);
        let shift = Shift::new(&program);
        let law = of.law();
        let model = &of.model;
        let [changes, rows] = [width, program.momentum.len()].map(|n| vec![(0, 0.0); n]);
        let x = vec![0.0; columns];
        let mut out = Self {
            iteration: Iteration::new(program, &x, &is_held, BARRIER * of.of_inputs),
            shift,
            state: Predicted::new(law, of.delay()),
            interval: 0,
            prepared: None,
            answered: None,
            next: 0,
            failures: 0,
            implausible: 0,
            residual: Residual::default(),
            inputs: vec![0.0; law.inputs.len()],
            instant: model.action.map.placed(&model.reference_coordinates()),
            closing: Closing::new(model, &of.steered.independent),
            moving: vec![Vector::zeros(); model.action.map.vectors.len()],
            rates: vec![0.0; model.coordinate_count()],
            momenta: vec![0.0; model.coordinate_count()],
            changes,
            rows,
            points: [vec![0.0; columns], vec![0.0; columns]],
            of,
        };
        out.follow(0);
        out.converge();
        out
    }

    /// Takes the motion that is followed for the plan from an interval on.
    fn follow(&mut self, interval: usize) {
        let Iteration { program, x, .. } = &mut self.iteration;
        program.begin = interval;
        program.refer_all(x);
        self.iteration.begin();
        self.interval = interval;
        self.prepared = None;
        self.failures = 0;
    }

    /// Iterates for the plan from the state at its start, until it is time to stop.
    fn converge(&mut self) {
        self.stay();
        for _ in 0..FIRST {
            self.factor();
            let left = self.residual;
            let is_met = left.equations < SMALL && left.gradient < SMALL;
            if self.prepared != Some(true) || is_met || stop::reason().is_some() {
                break;
            }
            self.iteration
                .advance(&self.changes, &self.rows, &mut self.points[0]);
        }
    }

    /// Prepares the step of the next interval: once, after its inputs went out.
    pub fn prepare(&mut self) {
        let answered = self.answered.map(|(interval, _)| interval);
        if answered == Some(self.interval) {
            self.go_on();
        }
        if self.prepared.is_none() {
            let (forces, against) = self.state.lasting();
            self.iteration.program.load(forces, against);
            self.predict();
            self.factor();
        }
    }

    /// Shifts the plan by an interval.
    fn go_on(&mut self) {
        let [before, after] = &mut self.points;
        self.shift.apply(&mut self.iteration, before, after);
        self.interval += 1;
        self.prepared = None;
    }

    /// The momenta of the plan at its start.
    fn predict(&mut self) {
        self.iteration.program.momentum.fill(0.0);
        self.iteration.evaluate_rows();
        let Iteration { program, g, .. } = &mut self.iteration;
        let rows = program.momenta[0].iter();
        for (momentum, &(row, scale)) in program.momentum.iter_mut().zip(rows) {
            *momentum = -g[row] / scale;
        }
    }

    fn factor(&mut self) {
        let before = self.residual.equations;
        let has_factors = self.iteration.prepare();
        self.residual = self.iteration.residual();
        let equations = self.residual.equations;
        // Not a number is worse than any.
        let is_near = equations <= FAR || equations <= 0.5 * before;
        self.prepared = Some(has_factors && is_near);
    }

    /// The inputs that act from a time in ms on, or the delay of the feedback later, with what is measured there, in the order of the law: the state
    /// in rad, mm, rad/ms, mm/ms, or the readings of its observer; none where it did not come in time. Called again within an interval, or at a time
    /// before it or that is no finite number, it gives the same inputs. After a leap of the time by more than the horizon, earlier times have answers of
    /// their own again: the leap may have been a wrong time stamp.
    pub fn step(&mut self, time: f64, measured: Option<&[f64]>) -> Answer<'_> {
        let sample = (time / self.of.law().h + 1e-6).clamp(0.0, LAST_SAMPLE) as usize;
        let interval = sample + self.of.delay();
        if let Some((last, source)) = self.answered
            && (interval < self.next || interval == last || !time.is_finite())
        {
            return self.answer(source);
        }
        let is_leap = interval > self.interval + self.of.intervals();
        if is_leap || interval < self.interval {
            self.follow(interval);
        }
        if !is_leap {
            self.next = interval + 1;
        }
        while self.interval < interval {
            self.go_on();
        }
        self.prepare();
        let source = match self.state.find(sample, measured) {
            Ok(()) => self.decide(),
            Err(source) => self.keep(source),
        };
        self.state.sent(interval, &self.inputs);
        self.answered = Some((interval, source));
        self.answer(source)
    }

    fn answer(&self, source: Source) -> Answer<'_> {
        Answer {
            source,
            inputs: &self.inputs,
        }
    }

    fn decide(&mut self) -> Source {
        let is_far = self.take();
        self.implausible = if is_far { self.implausible + 1 } else { 0 };
        if is_far && self.implausible <= PATIENCE {
            self.state.distrust();
            return self.keep(Source::Unusable);
        }
        if self.prepared == Some(true) && !is_far {
            let full = &mut self.points[0];
            if self.iteration.advance(&self.changes, &self.rows, full) {
                self.iterate_further();
                self.failures = 0;
                self.read();
                return Source::Plan;
            }
        }
        self.failures += 1;
        if self.failures <= PATIENCE && !is_far {
            return self.keep(Source::Kept);
        }
        self.state.regulate(self.interval, &mut self.inputs);
        self.follow(self.interval);
        Source::Regulator
    }

    /// Iterates a few times more from the measured state, where the bounds of limits cut the step.
    fn iterate_further(&mut self) {
        for _ in 0..FURTHER {
            if !self.iteration.is_cut {
                return;
            }
            self.stay();
            let moved = self.of.steered.moved();
            let momenta = self.iteration.program.momentum.iter_mut();
            momenta.zip(moved).for_each(|(to, i)| *to = self.momenta[i]);
            let full = &mut self.points[0];
            if !self.iteration.prepare() || !self.iteration.advance(&self.changes, &self.rows, full)
            {
                return;
            }
        }
    }

    /// Changes nothing of the state at the start.
    fn stay(&mut self) {
        let all = self.changes.iter_mut().chain(&mut self.rows);
        all.for_each(|(_, change)| *change = 0.0);
    }

    /// The inputs of the plan as it is.
    fn keep(&mut self, source: Source) -> Source {
        let x = &self.iteration.x[..self.iteration.columns];
        self.points[0].copy_from_slice(x);
        self.read();
        source
    }

    /// Reads the inputs of the first interval of the first point, within their bounds.
    fn read(&mut self) {
        let program = &self.iteration.program;
        program.first_inputs(&self.points[0], &mut self.inputs);
        for (value, input) in self.inputs.iter_mut().zip(&self.of.law().inputs) {
            let [low, high] = input.bounds;
            *value = value.max(low).min(high);
        }
    }

    /// Enters the state as changes of that of the plan; true if it is too far from it.
    fn take(&mut self) -> bool {
        let (coordinates, model) = (&self.of.steered.coordinates, &self.of.model);
        let (places, rates) = self.state.values().split_at(coordinates.len());
        let Iteration { program, x, .. } = &self.iteration;
        self.rates.fill(0.0);
        let unit = |c: usize| match model.is_length(coordinates[c]) {
            true => model.length(),
            false => 1.0,
        };
        let mut is_far = false;
        for (c, value) in places.iter().enumerate() {
            let Reading { column, scale, .. } = program.readings[c];
            let change = value - scale * x[column];
            is_far |= change.abs() > ABSURD * unit(c);
            self.changes[c] = (column, change / scale);
            self.instant.z[coordinates[c]] = *value;
        }
        let law = self.of.law();
        let motion = &law.at(law.h * self.interval as f64).state[places.len()..];
        for ((&c, rate), motion) in program.steered.inert.iter().zip(rates).zip(motion) {
            is_far |= (rate - motion).abs() * law.h > ABSURD_RATE * unit(c);
            self.rates[coordinates[c]] = *rate;
        }
        let followers = self.of.steered.independent.followers().iter();
        for (&i, &(column, scale)) in followers.zip(&program.followers) {
            self.instant.z[i] = scale * x[column];
        }
        let (action, instant) = (&model.action, &mut self.instant);
        is_far |= !self.closing.close(model, instant, &mut self.rates);
        action.map.place(instant);
        let (moving, momenta) = (&mut self.moving, &mut self.momenta);
        action.momentum_into(instant, &self.rates, moving, momenta);
        for (place, i) in self.of.steered.moved().enumerate() {
            let (row, scale) = program.momenta[0][place];
            let change = self.momenta[i] - program.momentum[place];
            self.rows[place] = (row, scale * change);
        }
        is_far
    }

    /// Residual of the plan when it was prepared last.
    pub fn residual(&self) -> Residual {
        self.residual
    }
}

/// Successors of columns and rows, which stand behind them.
#[derive(Debug)]
pub(super) struct Shift {
    columns: Vec<(usize, usize)>,
    rows: Vec<(usize, usize)>,
    /// Columns of coordinates within the last interval, with those at both of its ends, and the part of it that has passed there.
    between: Vec<Between>,
    /// Columns of the inputs of the last interval.
    last: Vec<usize>,
}

impl Shift {
    pub(super) fn new(program: &Program<'_>) -> Self {
        let unknowns = program.unknowns();
        let parts = program.steered.parts;
        let last = program.intervals - 1;
        let end = program.at(last)[0].column;
        let between = program.between.iter().copied();
        let last = program.of_inputs(last).iter();
        let column = |of: &Column| match *of {
            Column::Instant { k, i } => unknowns.unknown(k + parts, i),
            Column::Interval { k, s } => unknowns.scalar(k + parts, s),
            _ => None,
        };
        let places: FxHashMap<Row, usize> = unknowns.rows.iter().copied().zip(0..).collect();
        let row = |of: &Row| {
            let mut next = *of;
            if let Row::Instant { k, .. } | Row::Interval { k, .. } | Row::Limit { k, .. } =
                &mut next
            {
                *k += parts;
            }
            places.get(&next).copied().filter(|_| next != *of)
        };
        Self {
            columns: successors(&unknowns.columns, column),
            rows: successors(&unknowns.rows, row),
            between: between.filter(|(_, [from, _], _)| *from >= end).collect(),
            last: last.map(|input| input.column).collect(),
        }
    }

    /// Shifts a plan. In the last interval the inputs of the motion that is followed act; the end keeps its deviation.
    pub(super) fn apply(
        &self,
        of: &mut Iteration<Program<'_>>,
        before: &mut [f64],
        after: &mut [f64],
    ) {
        let end = of.program.intervals;
        before.fill(0.0);
        of.program.refer(end, before);
        of.program.begin += 1;
        after.fill(0.0);
        of.program.refer(end, after);
        for &(to, from) in &self.columns {
            of.x[to] = of.x[from];
            of.z.iter_mut().for_each(|z| z[to] = z[from]);
        }
        for &(to, from) in &self.rows {
            of.y[to] = of.y[from];
            if let (Some(to), Some(from)) = (of.slack(to), of.slack(from)) {
                of.x[to] = of.x[from];
                of.z.iter_mut().for_each(|z| z[to] = z[from]);
            }
        }
        let values = of.x[..of.columns].iter_mut();
        for ((value, before), after) in values.zip(&*before).zip(&*after) {
            *value += after - before;
        }
        for &(i, [from, to], part) in &self.between {
            of.x[i] = of.x[from] + part * (of.x[to] - of.x[from]);
        }
        of.program.refer(end - 1, after);
        for &i in &self.last {
            of.x[i] = after[i];
            of.centre(i);
        }
    }
}

/// Places of entries with those of their successors.
fn successors<T>(list: &[T], next: impl Fn(&T) -> Option<usize>) -> Vec<(usize, usize)> {
    let all = list.iter().enumerate();
    all.filter_map(|(i, one)| Some((i, next(one)?))).collect()
}
