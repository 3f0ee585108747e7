//! State at one instant, the storage of the equations of a step, and the positions of their derivatives.

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::energies::Work;
use crate::dynamics::error::StepError;
use crate::dynamics::galerkin::lobatto::Lobatto;
use crate::dynamics::galerkin::rule::{Alpha, Massless, Rule, Weights};
use crate::dynamics::momenta::{Start, masses, rates, vector_momenta};
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::resolution::typical_energy;
use crate::dynamics::solving::{Drive, Integrator, Solving};
use crate::dynamics::stepper::Steps;
use crate::dynamics::tangent::EntryList;
use crate::functional::{
    BlockMask, Blocks, Horizon, Order, Output, Sample, SumDerivatives, TermKind,
};
use crate::math::Vector;
use crate::model::Model;
use crate::sparse::Symmetry;

/// The part of the first step after which the first acceleration is read from the rates; twice it where mass is missing.
pub(super) const FIRST: f64 = 0.01;

/// One sample of the sum over an interval.
#[derive(Debug)]
pub(super) struct StagePoint {
    pub(super) weights: Weights,
    /// x_a and x_b.
    pub(super) x: [Vec<Vector>; 2],
    pub(super) out: Output,
    /// Scalars of the sample.
    pub(super) scalars: Vec<f64>,
}

/// State at one instant and the storage of the equations of a step.
#[derive(Debug)]
pub struct GalerkinEquations<'m> {
    pub(super) model: &'m Model,
    pub(super) rule: Rule,
    /// The start of the step and its points.
    pub(super) points: Vec<Configuration>,
    pub(super) samples: Vec<StagePoint>,
    pub(super) momentum: Vec<f64>,
    /// Coordinates of the last points with their times, for the first guess.
    pub(super) trail: Vec<(f64, Vec<f64>)>,
    pub(super) time: f64,
    pub(super) scratch: Scratch,
    pub(super) places: Places,
    pub(super) values: Vec<f64>,
    /// Blocks between two points.
    pub(super) combined: SumDerivatives,
    /// Second derivatives of the kinetic energy at h = 1.
    pub(super) masses: Blocks,
    pub(super) accelerations: Vec<Vector>,
    /// Multipliers of the rows of each point, in the order of the points ν.
    pub(super) multipliers: Vec<Vec<f64>>,
    /// Multipliers, and scalars with an equation, before an attempt.
    pub(super) saved: (Vec<Vec<f64>>, Vec<Vec<f64>>),
    pub(super) dissipates: bool,
    /// Scalars in the middle of the step, for the work over a step of one point.
    pub(super) middle: Vec<f64>,
    pub(super) massless: Massless,
    pub(super) work: Option<Work>,
    /// Energy that is typical of the system, in mJ.
    pub(super) typical_energy: f64,
    /// Derivatives of the potentials at a sample, where inputs change within a step.
    pub(super) potentials: Output,
}

impl<'m> Steps<GalerkinEquations<'m>> {
    /// Starts a motion by the method of `solving`, which is not the midpoint rule; `h` is the length of the first step.
    ///
    /// # Errors
    /// The first acceleration of the generalised-α method is not found.
    pub fn stages(
        model: &'m Model,
        start: &Start,
        solving: Solving,
        h: f64,
        drive: &dyn Drive,
    ) -> Result<Self, StepError> {
        let rule = match solving.integrator {
            Integrator::Midpoint => Rule::Galerkin(Lobatto::new(1)),
            Integrator::Galerkin { degree } => Rule::Galerkin(Lobatto::new(degree)),
            Integrator::ImplicitEuler => Rule::Euler(moving(model, start).1),
            Integrator::GeneralisedAlpha { spectral_radius } => {
                let (mut v, p) = moving(model, start);
                let first = FIRST * h;
                let mut euler = Self::with(model, start, Rule::Euler(p), solving);
                euler.go([0.0, first], first, drive)?;
                let rates = euler.equations.last_rates();
                euler.go([first, 2.0 * first], first, drive)?;
                let later = euler.equations.last_rates();
                // No momentum tells the rates of vectors without mass: those of two steps are extrapolated.
                for &i in euler.equations.massless.vectors() {
                    v[i] = rates[i] * 2.0 - later[i];
                }
                let a = rates.iter().zip(&v).map(|(after, v)| (after - v) / first);
                let a = a.collect();
                Rule::Alpha(Alpha::new(spectral_radius, v, a))
            }
        };
        Ok(Self::with(model, start, rule, solving))
    }

    fn with(model: &'m Model, start: &Start, rule: Rule, solving: Solving) -> Self {
        let action = &model.action;
        let map = &action.map;
        let degree = rule.degree();
        let mut points = vec![map.instant(); degree + 1];
        points[0].z.copy_from_slice(&start.z);
        map.place(&mut points[0]);
        let sample = |weights: Weights| StagePoint {
            x: [points[0].x.clone(), points[0].x.clone()],
            out: action.intervals.output(Order::Hessian),
            scalars: vec![0.0; action.intervals.scalars],
            weights,
        };
        let samples: Vec<StagePoint> = rule.samples().into_iter().map(sample).collect();
        let rows: Vec<usize> = (1..=degree).map(|point| rule.row(point)).collect();
        let (places, mut entries) = Places::new(model, &rows, samples.len());
        let points_of =
            |coordinate: usize| (0..degree).map(move |p| p * map.unknowns() + coordinate);
        let held = model.prescribed_coordinates().into_iter();
        let held: Vec<usize> = held.flat_map(points_of).collect();
        entries.hold(&held, 1.0);
        let combined = action.intervals.output(Order::Hessian).plain;
        let n = map.coordinates;
        let multipliers = vec![start.z[n..map.unknowns()].to_vec(); degree];
        let algebraic = model.variables.algebraic();
        let mut terms = action.intervals.terms.iter();
        let equations = GalerkinEquations {
            model,
            trail: vec![(start.time, start.z[..n].to_vec())],
            momentum: start.momentum.clone(),
            time: start.time,
            scratch: action.scratch(Order::Hessian),
            values: vec![0.0; places.values],
            masses: masses(model, &points[0].x),
            accelerations: vec![Vector::zeros(); points[0].x.len()],
            saved: (
                multipliers.clone(),
                vec![vec![0.0; algebraic.len()]; samples.len()],
            ),
            multipliers,
            massless: Massless::new(model, &rule),
            dissipates: terms.any(|e| e.kind().is_virtual_work()),
            middle: vec![0.0; action.intervals.scalars],
            work: None,
            typical_energy: typical_energy(model),
            potentials: action.intervals.output(Order::Gradient),
            rule,
            points,
            samples,
            places,
            combined,
        };
        let sizes = model.sizes();
        let (of_points, of_samples) = sizes.split_at(map.unknowns());
        let mut scales = of_points.repeat(degree);
        scales.extend(of_samples.repeat(equations.samples.len()));
        let tangent = entries.tangent(scales.len(), Symmetry::Unsymmetric, solving.backend);
        let matrix = NewtonMatrix::Direct(Box::new(tangent));
        Self::by(equations, matrix, held, scales, solving.newton)
    }
}

/// Rates and momenta of all vectors at the start.
fn moving(model: &Model, start: &Start) -> (Vec<Vector>, Vec<Vector>) {
    let map = &model.action.map;
    let mut instant = map.placed(&start.z);
    let known = start.rates.clone();
    let rates = known.unwrap_or_else(|| rates(model, &mut instant, start.time, &start.momentum));
    instant.l.fill(0.0);
    instant.l[..rates.len()].copy_from_slice(&rates);
    map.along(&mut instant);
    let momenta = vector_momenta(model, &instant.x, &instant.w);
    (instant.w, momenta)
}

/// Returns the input of terms on an interval of given length.
pub(super) fn between<'a>(vectors: [&'a [Vector]; 2], scalars: &'a [f64], h: f64) -> Sample<'a> {
    Sample {
        vectors,
        along: vectors,
        scalars,
        scalars_along: &[],
        h,
        horizon: Horizon::Given,
        sides: BlockMask::ALL,
        outer: &[],
    }
}

impl GalerkinEquations<'_> {
    /// Places the points and evaluates the samples.
    pub(super) fn sample(&mut self, order: Order, h: f64) {
        let Self {
            model,
            rule,
            points,
            samples,
            ..
        } = self;
        let action = &model.action;
        for point in &mut points[1..] {
            action.map.place(point);
        }
        for point in samples {
            for (side, x) in point.x.iter_mut().enumerate() {
                let take = &point.weights.take[side];
                for (i, x) in x.iter_mut().enumerate() {
                    *x = Vector::zeros();
                    for (from, &weight) in points.iter().zip(take) {
                        *x += from.x[i] * weight;
                    }
                    if let Rule::Alpha(alpha) = rule {
                        *x += alpha.carried_rate(i, h) * (0.5 * h * [-1.0, 1.0][side]);
                    }
                }
            }
            let [a, b] = &point.x;
            let sample = between([a, b], &point.scalars, h);
            action.intervals.evaluate(order, &sample, &mut point.out);
        }
    }

    /// Energy that inputs which change within a step of a Galerkin method add to the potentials of its samples: `∫ ∂V/∂u u̇ dt` by the
    /// quadrature of the step.
    pub(super) fn supplied(&mut self, h: f64) -> f64 {
        let (Rule::Galerkin(lobatto), samples) = (&self.rule, &self.samples) else {
            return 0.0;
        };
        let inputs = self.model.variables.inputs();
        let change = |scalar: usize, slopes: &[f64]| -> f64 {
            let first = samples[0].scalars[scalar];
            let values = samples.iter().map(|sample| sample.scalars[scalar] - first);
            values.zip(slopes).map(|(value, slope)| value * slope).sum()
        };
        let mut supplied = 0.0;
        for (point, slopes) in samples.iter().zip(&lobatto.derivatives) {
            if inputs.clone().all(|input| change(input, slopes) == 0.0) {
                continue;
            }
            self.potentials.plain.clear(false);
            let [a, b] = &point.x;
            let sample = between([a, b], &point.scalars, h);
            let terms = self.model.action.intervals.terms.iter();
            for term in terms.filter(|term| term.kind() == TermKind::Potential) {
                term.evaluate(Order::Gradient, &sample, &[], &mut self.potentials);
            }
            let rows = &self.potentials.plain.rows;
            let by_inputs = inputs.clone().map(|i| rows[i] * change(i, slopes));
            // The action has the potentials with the opposite sign, times the length of the step.
            supplied -= point.weights.quadrature * by_inputs.sum::<f64>() / h;
        }
        supplied
    }

    /// Forces of all samples on the rows of a point.
    pub(super) fn forces(&mut self, point: usize) {
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
            self.massless.add_forces(weights, point, &out.plain, forces);
        }
    }

    /// Adds what the rule carries from the start of the step to the forces on the end.
    pub(super) fn add_carried(&mut self, h: f64) {
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
                for term in &self.model.action.intervals.terms {
                    term.momentum(&end.x, &self.accelerations, &mut end.forces);
                }
            }
        }
    }
}

impl GalerkinEquations<'_> {
    /// Rates of all vectors over the last step of a method with one point.
    pub(super) fn last_rates(&self) -> Vec<Vector> {
        // The points of an accepted step have changed places.
        let [now, before] = [&self.points[0].x, &self.points[1].x];
        let times: Vec<f64> = self.trail.iter().rev().map(|(time, _)| *time).collect();
        let ends = now.iter().zip(before);
        ends.map(|(y, x)| (y - x) / (times[0] - times[1])).collect()
    }

    /// Counts the turns that are kept for the next guess from the charts at the end of a step, to first order.
    pub(super) fn follow_charts(&mut self) {
        let Some((_, end)) = self.trail.last().cloned() else {
            return;
        };
        for turn in self.model.action.map.tree.charted().into_iter().flatten() {
            for (_, u) in &mut self.trail {
                u[turn] -= end[turn];
            }
        }
    }

    /// Returns the largest number of points from which the next guess may be made.
    fn most_points(&self) -> usize {
        self.points.len().max(3)
    }

    /// Makes room for this number of points of the next guess, one or more.
    pub(super) fn resize_trail(&mut self, count: f64) {
        let last = self.trail[self.trail.len() - 1].clone();
        self.trail
            .resize((count as usize).clamp(1, self.most_points()), last);
    }

    /// Keeps the coordinates of the points for the next guess: those of the last step, three at least.
    pub(super) fn remember(&mut self, h: f64) {
        let n = self.model.action.map.coordinates;
        let most = self.most_points();
        let times = self.rule.points();
        for (point, at) in self.points.iter().zip(times).skip(1) {
            if self.trail.len() == most {
                self.trail.remove(0);
            }
            self.trail.push((self.time + at * h, point.z[..n].to_vec()));
        }
    }
}

/// Segments of the values: one of instants for each point, one for each pair of rows and points, those of each sample.
#[derive(Clone, Debug)]
pub(super) struct Places {
    /// Point of the rows that go with each point ν = 1 … s.
    rows: Vec<usize>,
    same: usize,
    cross: usize,
    mixed: usize,
    scalars: usize,
    samples: usize,
    /// Length of the values.
    pub(super) values: usize,
}

impl Places {
    /// Lays the segments down, and the entries of the matrix that take them.
    pub(super) fn new(model: &Model, rows: &[usize], samples: usize) -> (Self, EntryList) {
        let layout = model.action.layout();
        let map = &model.action.map;
        let has_scalars = !model.variables.algebraic().is_empty();
        let [same, cross] = [&layout.same, &layout.cross].map(|p| p.entries().len());
        let [mixed, scalars] = match has_scalars {
            true => [&layout.mixed, &layout.scalars].map(|p| p.entries().len()),
            false => [0, 0],
        };
        let degree = rows.len();
        let mut places = Self {
            rows: rows.to_vec(),
            same,
            cross,
            mixed,
            scalars,
            samples,
            values: 0,
        };
        places.values = places.scalars(samples);
        let (n, m) = (map.coordinates, map.unknowns());
        let mut entries = EntryList::default();
        let block = |point: usize| (point - 1) * m;
        for row in 1..=degree {
            for point in 1..=degree {
                let pattern = match rows[row - 1] == point {
                    true => &layout.same,
                    false => &layout.cross,
                };
                let at = places.pair(row, point);
                for (slot, (i, j)) in pattern.entries().enumerate() {
                    if i < n && j < n {
                        entries.add(at + slot, (block(row) + i, block(point) + j));
                    }
                }
            }
            let (of_rows, of_point) = (places.same(rows[row - 1]), places.same(row));
            for (slot, (i, j)) in layout.same.entries().enumerate() {
                // Multipliers act where the rows are, constraints hold at the point.
                if i < n && j >= n {
                    entries.add(of_rows + slot, (block(row) + i, block(row) + j));
                }
                if i >= n && j < n {
                    entries.add(of_point + slot, (block(row) + i, block(row) + j));
                }
            }
        }
        if has_scalars {
            places.add_scalars(model, samples, &mut entries);
        }
        (places, entries)
    }

    /// Scalars with an equation of each sample against the points, and against each other.
    fn add_scalars(&self, model: &Model, samples: usize, entries: &mut EntryList) {
        let layout = model.action.layout();
        let m = model.action.map.unknowns();
        for sample in 0..samples {
            let place = |s: usize| model.variables.place_of(self.rows.len(), sample, s);
            for point in 1..=self.rows.len() {
                let [rows, columns] = self.mixed(sample, point);
                let block = (point - 1) * m;
                for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                    if let Some(s) = place(s) {
                        entries.add(rows + slot, (block + i, s));
                        entries.add(columns + slot, (s, block + i));
                    }
                }
            }
            for (slot, (s, t)) in layout.scalars.entries().enumerate() {
                if let (Some(s), Some(t)) = (place(s), place(t)) {
                    let at = self.scalars(sample) + slot;
                    entries.add(at, (s, t));
                    if s != t {
                        entries.add(at, (t, s));
                    }
                }
            }
        }
    }

    /// Second derivatives at a point.
    pub(super) fn same(&self, point: usize) -> usize {
        point * self.same
    }

    /// Rows that go with one point by the coordinates of another; those of the point itself where the rows are its own.
    pub(super) fn pair(&self, row: usize, point: usize) -> usize {
        if self.rows[row - 1] == point {
            return self.same(point);
        }
        let degree = self.rows.len();
        self.same(degree + 1) + ((row - 1) * degree + point - 1) * self.cross
    }

    /// Rows that go with a point by the scalars of a sample, and rows of these by the coordinates of the point.
    pub(super) fn mixed(&self, sample: usize, point: usize) -> [usize; 2] {
        let degree = self.rows.len();
        let first = self.same(degree + 1) + degree * degree * self.cross;
        let at = first + (sample * degree + point - 1) * 2 * self.mixed;
        [at, at + self.mixed]
    }

    /// Scalars of a sample against each other.
    pub(super) fn scalars(&self, sample: usize) -> usize {
        self.mixed(self.samples, 1)[0] + sample * self.scalars
    }
}
