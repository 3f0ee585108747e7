//! Steps with several points or samples: the equations of every [`Rule`].
//!
//! `rule` tells the methods, with the points of `lobatto`; `places` and `tangent` hold the derivatives.
//!
//! Unknowns of point ν = 1 … s are its coordinates and the multipliers of its rows; then come the potentials of each sample,
//! with Gauss's law there. Constraints hold at every point.

mod lobatto;
mod places;
mod rule;
mod tangent;

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::StepError;
use crate::dynamics::kinetic::masses;
use crate::dynamics::midpoint::scales;
use crate::dynamics::observe::{rates, vector_momenta};
use crate::dynamics::simulate::Start;
use crate::dynamics::solving::{Integrator, Solving};
use crate::dynamics::stepper::{Equations, Steps};
use crate::functional::{BlockMask, Blocks, Horizon, Kind, Order, Output, Part, Sample};
use crate::math::Vector;
use crate::model::Model;
use crate::sparse::Symmetry;
use lobatto::{Lobatto, lagrange};
use places::Places;
use rule::{Alpha, Rule, Weights};

/// The part of the first step after which the first acceleration is read from the rates.
const FIRST: f64 = 0.01;

/// One sample of the sum over an interval.
#[derive(Debug)]
struct StagePoint {
    weights: Weights,
    /// x_a and x_b.
    x: [Vec<Vector>; 2],
    out: Output,
    /// Voltages and potentials.
    scalars: Vec<f64>,
}

/// State at one instant and the storage of the equations of a step.
#[derive(Debug)]
pub struct Stages<'m> {
    model: &'m Model,
    rule: Rule,
    /// The start of the step and its points.
    points: Vec<Configuration>,
    samples: Vec<StagePoint>,
    momentum: Vec<f64>,
    /// Coordinates of the last points with their times, for the first guess.
    trail: Vec<(f64, Vec<f64>)>,
    time: f64,
    scratch: Scratch,
    places: Places,
    values: Vec<f64>,
    /// Blocks between two points.
    combined: Part,
    /// Second derivatives of the kinetic energy at h = 1.
    masses: Blocks,
    accelerations: Vec<Vector>,
    /// Multipliers of the rows of each point, in the order of the points ν.
    multipliers: Vec<Vec<f64>>,
    /// Multipliers and potentials before an attempt.
    saved: (Vec<Vec<f64>>, Vec<Vec<f64>>),
    dissipates: bool,
    work: Option<f64>,
}

impl<'m> Steps<Stages<'m>> {
    /// Starts a motion by the method of `solving`, which is not the midpoint rule; `h` and `voltages` are those of the first
    /// step.
    ///
    /// # Errors
    /// The first acceleration of the generalised-α method is not found.
    pub fn stages(
        model: &'m Model,
        start: &Start,
        solving: Solving,
        h: f64,
        voltages: &[f64],
    ) -> Result<Self, StepError> {
        let rule = match solving.integrator {
            Integrator::Midpoint => Rule::Galerkin(Lobatto::new(1)),
            Integrator::Galerkin { degree } => Rule::Galerkin(Lobatto::new(degree)),
            Integrator::ImplicitEuler => Rule::Euler(moving(model, start).1),
            Integrator::GeneralisedAlpha { spectral_radius } => {
                let (v, p) = moving(model, start);
                let first = FIRST * h;
                let mut euler = Self::with(model, start, Rule::Euler(p), solving);
                euler.step(first, voltages)?;
                let rates = euler.equations().last_rates();
                let a = rates.iter().zip(&v).map(|(after, v)| (after - v) / first);
                let a = a.collect();
                Rule::Alpha(Alpha::new(spectral_radius, v, a))
            }
        };
        Ok(Self::with(model, start, rule, solving))
    }

    fn with(model: &'m Model, start: &Start, rule: Rule, solving: Solving) -> Self {
        let action = &model.action;
        let motion = &action.motion;
        let degree = rule.degree();
        let mut points = vec![motion.instant(); degree + 1];
        points[0].z.copy_from_slice(&start.z);
        motion.place(&mut points[0]);
        let sample = |weights: Weights| StagePoint {
            x: [points[0].x.clone(), points[0].x.clone()],
            out: action.intervals.output(Order::Hessian),
            scalars: vec![0.0; action.intervals.scalars],
            weights,
        };
        let samples: Vec<StagePoint> = rule.samples().into_iter().map(sample).collect();
        let rows: Vec<usize> = (1..=degree).map(|point| rule.row(point)).collect();
        let (places, entries) = Places::new(model, &rows, samples.len());
        let combined = action.intervals.output(Order::Hessian).plain;
        let n = motion.coordinates;
        let multipliers = vec![start.z[n..motion.unknowns()].to_vec(); degree];
        let mut effects = action.intervals.effects.iter();
        let equations = Stages {
            model,
            trail: vec![(0.0, start.z[..n].to_vec())],
            momentum: start.momentum.clone(),
            time: 0.0,
            scratch: action.scratch(Order::Hessian),
            values: vec![0.0; places.values],
            masses: masses(model, &points[0].x),
            accelerations: vec![Vector::zeros(); points[0].x.len()],
            saved: (
                multipliers.clone(),
                vec![vec![0.0; model.potentials]; samples.len()],
            ),
            multipliers,
            dissipates: effects.any(|e| e.kind() == Kind::VirtualWork),
            work: None,
            rule,
            points,
            samples,
            places,
            combined,
        };
        let of_points = scales(model);
        let (of_points, potentials) = of_points.split_at(motion.unknowns());
        let mut scales = of_points.repeat(degree);
        scales.extend(potentials.repeat(equations.samples.len()));
        let tangent = entries.tangent(scales.len(), Symmetry::Unsymmetric, solving.backend);
        Self::by(equations, tangent, scales, solving.newton)
    }
}

/// Rates and momenta of all vectors at the start.
fn moving(model: &Model, start: &Start) -> (Vec<Vector>, Vec<Vector>) {
    let motion = &model.action.motion;
    let mut instant = motion.placed(&start.z);
    let known = start.rates.clone();
    let rates = known.unwrap_or_else(|| rates(model, &mut instant, &start.momentum));
    instant.l.fill(0.0);
    instant.l[..rates.len()].copy_from_slice(&rates);
    motion.along(&mut instant);
    let momenta = vector_momenta(model, &instant.x, &instant.w);
    (instant.w, momenta)
}

/// What effects read of an interval of given length.
fn frame<'a>(vectors: [&'a [Vector]; 2], scalars: &'a [f64], h: f64) -> Sample<'a> {
    Sample {
        vectors,
        along: vectors,
        scalars,
        scalars_along: &[],
        h,
        horizon: Horizon::Given,
        sides: BlockMask::ALL,
        weights: &[],
    }
}

impl Stages<'_> {
    /// Places the points and evaluates the samples.
    fn sample(&mut self, level: Order, h: f64) {
        let Self {
            model,
            rule,
            points,
            samples,
            ..
        } = self;
        let action = &model.action;
        for point in &mut points[1..] {
            action.motion.place(point);
        }
        for sample in samples {
            for (side, x) in sample.x.iter_mut().enumerate() {
                let take = &sample.weights.take[side];
                for (i, x) in x.iter_mut().enumerate() {
                    *x = Vector::zeros();
                    for (point, &weight) in points.iter().zip(take) {
                        *x += point.x[i] * weight;
                    }
                    if let Rule::Alpha(alpha) = rule {
                        *x += alpha.carried_rate(i, h) * (0.5 * h * [-1.0, 1.0][side]);
                    }
                }
            }
            let [a, b] = &sample.x;
            let frame = frame([a, b], &sample.scalars, h);
            action.intervals.evaluate(level, &frame, &mut sample.out);
        }
    }

    /// Forces of all samples on the rows of a point.
    fn forces(&mut self, point: usize) {
        let forces = &mut self.points[point].forces;
        forces.fill(Vector::zeros());
        for StagePoint { weights, out, .. } in &self.samples {
            for (give, side) in weights.give.iter().zip(&out.plain.forces) {
                let weight = weights.quadrature * give[point];
                if weight != 0.0 {
                    for (sum, force) in forces.iter_mut().zip(side) {
                        *sum += force * weight;
                    }
                }
            }
        }
    }

    /// Adds what the rule carries from the start of the step to the forces on the end.
    fn add_carried(&mut self, h: f64) {
        let (start, end) = self.points.split_at_mut(1);
        let (start, end) = (&start[0], &mut end[0]);
        match &self.rule {
            Rule::Galerkin(_) => {}
            Rule::Euler(momenta) => {
                for (force, momentum) in end.forces.iter_mut().zip(momenta) {
                    *force += momentum;
                }
            }
            Rule::Alpha(alpha) => {
                // Masses are linear in what they multiply: −h a in place of rates gives −h M a.
                for (i, a) in self.accelerations.iter_mut().enumerate() {
                    *a = alpha.acceleration(i, h, end.x[i] - start.x[i]) * -h;
                }
                for effect in &self.model.action.intervals.effects {
                    effect.momentum(&end.x, &self.accelerations, &mut end.forces);
                }
            }
        }
    }
}

impl Equations for Stages<'_> {
    fn begin(&mut self, voltages: &[f64]) {
        for sample in &mut self.samples {
            sample.scalars[..voltages.len()].copy_from_slice(voltages);
        }
    }

    /// The polynomial through the last points, carried on.
    fn guess(&mut self, h: f64) {
        let times: Vec<f64> = self.trail.iter().map(|(time, _)| *time).collect();
        let points = self.rule.points();
        let m = self.model.action.motion.unknowns();
        let (start, others) = self.points.split_at_mut(1);
        for (point, at) in others.iter_mut().zip(points.into_iter().skip(1)) {
            point.z[..m].fill(0.0);
            point.z[m..].copy_from_slice(&start[0].z[m..]);
            let weights = lagrange(&times, self.time + at * h);
            for ((_, u), weight) in self.trail.iter().zip(weights) {
                for (z, u) in point.z.iter_mut().zip(u) {
                    *z += u * weight;
                }
            }
        }
        let driven = self.model.voltages.len();
        self.saved.0.clone_from(&self.multipliers);
        for (saved, sample) in self.saved.1.iter_mut().zip(&self.samples) {
            saved.copy_from_slice(&sample.scalars[driven..]);
        }
    }

    fn evaluate(&mut self, level: Order, h: f64, residual: &mut [f64]) {
        self.sample(level, h);
        let model = self.model;
        let action = &model.action;
        let motion = &action.motion;
        let (n, m) = (motion.coordinates, motion.unknowns());
        residual.fill(0.0);
        if level >= Order::Hessian {
            self.values.fill(0.0);
        }
        let last = self.points.len() - 1;
        for point in 0..=last {
            self.forces(point);
        }
        self.add_carried(h);
        for (i, multipliers) in self.multipliers.iter().enumerate() {
            let at = self.rule.row(i + 1);
            self.points[at].z[n..m].copy_from_slice(multipliers);
        }
        for at in 0..=last {
            let instant = &mut self.points[at];
            let values = &mut self.values[self.places.same(at)..];
            action.evaluate_instant(level, instant, &[], &mut self.scratch);
            action.pull_back_instant(level, instant, 0, &mut self.scratch, values);
            if at > 0 {
                let rows = &mut residual[(at - 1) * m + n..at * m];
                rows.copy_from_slice(&self.scratch.instant.plain.rows);
            }
        }
        for point in 1..=last {
            let at = self.rule.row(point);
            let rows = &mut residual[(point - 1) * m..(point - 1) * m + n];
            if at == 0 {
                rows.copy_from_slice(&self.momentum);
            }
            let instant = &self.points[at];
            motion.pull_back(&instant.columns, &instant.forces, rows);
        }
        let driven = model.voltages.len();
        let gauss = residual[last * m..].chunks_mut(model.potentials.max(1));
        for (rows, sample) in gauss.zip(&self.samples) {
            rows.copy_from_slice(&sample.out.plain.rows[driven..]);
        }
        if level >= Order::Hessian {
            self.tangent_of_points(h);
            if model.potentials > 0 {
                self.tangent_of_potentials();
            }
        }
    }

    fn values(&self) -> &[f64] {
        &self.values
    }

    fn update(&mut self, update: &[f64]) {
        let motion = &self.model.action.motion;
        let (n, m) = (motion.coordinates, motion.unknowns());
        let points = self.points[1..].iter_mut().zip(&mut self.multipliers);
        for ((point, multipliers), update) in points.zip(update.chunks(m)) {
            for (z, update) in point.z[..n].iter_mut().zip(update) {
                *z -= update;
            }
            for (multiplier, update) in multipliers.iter_mut().zip(&update[n..]) {
                *multiplier -= update;
            }
        }
        let driven = self.model.voltages.len();
        let updates = update[(self.points.len() - 1) * m..].chunks(self.model.potentials.max(1));
        for (sample, update) in self.samples.iter_mut().zip(updates) {
            for (potential, update) in sample.scalars[driven..].iter_mut().zip(update) {
                *potential -= update;
            }
        }
    }

    fn restore(&mut self) {
        self.multipliers.clone_from(&self.saved.0);
        let driven = self.model.voltages.len();
        for (saved, sample) in self.saved.1.iter().zip(&mut self.samples) {
            sample.scalars[driven..].copy_from_slice(saved);
        }
    }

    fn model(&self) -> &Model {
        self.model
    }

    fn place_end(&mut self) {
        if let Some(end) = self.points.last_mut() {
            self.model.action.motion.place(end);
        }
    }

    fn ends(&self) -> [&Configuration; 2] {
        [&self.points[0], &self.points[self.points.len() - 1]]
    }

    fn accept(&mut self, h: f64) -> bool {
        self.sample(Order::Gradient, h);
        let model = self.model;
        let last = self.points.len() - 1;
        let forces = self
            .samples
            .iter()
            .flat_map(|s| &s.out.plain.forces)
            .flatten();
        if !forces.into_iter().all(|f| f.iter().all(|c| c.is_finite())) {
            return false;
        }
        if self.dissipates {
            let effects = model.action.intervals.effects.iter();
            let forces: Vec<_> = effects.filter(|e| e.kind() == Kind::VirtualWork).collect();
            let work = |sample: &StagePoint| {
                let [a, b] = &sample.x;
                let frame = frame([a, b], &sample.scalars, h);
                let work: f64 = forces.iter().map(|e| e.energy(&frame)).sum();
                work * sample.weights.quadrature
            };
            self.work = Some(self.samples.iter().map(work).sum());
        }
        let momenta: Vec<Vector> = match &mut self.rule {
            Rule::Galerkin(_) => {
                self.forces(last);
                self.points[last].forces.clone()
            }
            Rule::Euler(momenta) => {
                let [a, b] = &self.samples[0].out.plain.forces;
                for (momentum, (a, b)) in momenta.iter_mut().zip(a.iter().zip(b)) {
                    *momentum = (b - a) * 0.5;
                }
                momenta.clone()
            }
            Rule::Alpha(alpha) => {
                let [start, end] = [&self.points[0].x, &self.points[1].x];
                alpha.accept(h, start, end);
                vector_momenta(model, end, alpha.rates())
            }
        };
        let motion = &model.action.motion;
        self.remember(h);
        if motion.recentre(&mut self.points[last]) {
            self.follow_charts();
        }
        self.momentum.fill(0.0);
        motion.pull_back(&self.points[last].columns, &momenta, &mut self.momentum);
        if let Rule::Galerkin(_) = self.rule {
            let (n, m) = (motion.coordinates, motion.unknowns());
            let multipliers = &self.multipliers[last - 1];
            self.points[last].z[n..m].copy_from_slice(multipliers);
        }
        self.points.swap(0, last);
        self.time += h;
        true
    }

    fn unknown_name(&self, unknown: usize) -> String {
        let m = self.model.action.motion.unknowns();
        let of_points = m * (self.points.len() - 1);
        match unknown.checked_sub(of_points) {
            None => self.model.unknown_name(unknown % m),
            Some(potential) => {
                let potential = potential % self.model.potentials;
                self.model.unknown_name(m + potential)
            }
        }
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn coordinates(&self) -> &[f64] {
        &self.points[0].z
    }

    fn momentum(&self) -> &[f64] {
        &self.momentum
    }

    fn scalars(&self) -> &[f64] {
        &self.samples[self.samples.len() - 1].scalars
    }

    fn multipliers(&self) -> &[f64] {
        match self.rule {
            Rule::Galerkin(_) => &self.multipliers[0],
            Rule::Euler(_) | Rule::Alpha(_) => &[],
        }
    }

    fn work(&self) -> Option<f64> {
        self.work
    }
}

impl Stages<'_> {
    /// Rates of all vectors over the last step of a method with one point.
    fn last_rates(&self) -> Vec<Vector> {
        // The points of an accepted step have changed places.
        let [now, before] = [&self.points[0].x, &self.points[1].x];
        let times: Vec<f64> = self.trail.iter().rev().map(|(time, _)| *time).collect();
        let ends = now.iter().zip(before);
        ends.map(|(y, x)| (y - x) / (times[0] - times[1])).collect()
    }

    /// Counts the turns that are kept for the next guess from the charts at the end of a step, to first order.
    fn follow_charts(&mut self) {
        let Some((_, end)) = self.trail.last().cloned() else {
            return;
        };
        for turn in self.model.action.motion.charted().into_iter().flatten() {
            for (_, u) in &mut self.trail {
                u[turn] -= end[turn];
            }
        }
    }

    /// Keeps the coordinates of the points for the next guess: those of the last step, three at least.
    fn remember(&mut self, h: f64) {
        let n = self.model.action.motion.coordinates;
        let most = (self.points.len()).max(3);
        let times = self.rule.points();
        for (point, at) in self.points.iter().zip(times).skip(1) {
            if self.trail.len() == most {
                self.trail.remove(0);
            }
            self.trail.push((self.time + at * h, point.z[..n].to_vec()));
        }
    }
}
