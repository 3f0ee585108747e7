//! Rest: the potential energy and the constraints of the action on an interval whose two instants are one.
//!
//! With q_k = q_{k+1} = q the sum of both rows is −h Pᵀ∇V − h₀ Gᵀλ, and the tangent is the sum of the four blocks. Inertia and
//! viscosity would vanish from both sums only up to the rounding of M/h and D: they are left out, so that a state of rest depends
//! neither on masses nor on the step. Potentials keep the rows of Gauss's law. Weights are constant forces on the vectors, so that a
//! part of them is a part of these forces; loads are inputs, of which the same part acts. A stiffness σ on every coordinate may be
//! added to the tangent, which makes any state's tangent that of a minimum.
//!
//! Loads that follow what they act on have no potential, and the tangent no symmetry: then its eigenvalues decide whether a state is
//! stable (`growing_motions`).

use crate::coordinates::{Configuration, Scratch};
use crate::dynamics::equilibrium::rest_state::{Examined, RestState};
use crate::dynamics::equilibrium::static_matrix::{Inertia, matrix, places, turned_pairs};
use crate::dynamics::error::EquilibriumError;
use crate::dynamics::newton_matrix::{GridTangent, Iterated, NewtonMatrix};
use crate::dynamics::solving::MultigridUse;
use crate::dynamics::tangent::Tangent;
use crate::functional::{Order, Sample};
use crate::math::Vector;
use crate::model::{Model, OPEN, Role};
use crate::sparse::Singular;
use crate::sparse::multigrid::MultigridReport;
use crate::stop;

/// Limit of Newton iterations.
pub(super) const ITERATIONS: usize = 30;
/// Convergence of the Newton update, relative to angles of one radian and the length of the system.
const UPDATE: f64 = 1e-11;
/// Largest ratio of the second update to the first one on a path: beyond it Newton's method may end on another path.
const CONTRACTION: f64 = 0.25;
/// Updates below this are not compared: a path has kinks where tendons tighten and stops are met.
const SHORT: f64 = 1e-4;
/// An update longer than this leaves the region in which the tangent says anything.
const LONG: f64 = 0.5;

/// Most unknowns whose matrix is factorised for its inertia after an iteration has found the state.
const EXAMINED: usize = 100_000;
/// Residual of solutions of an iteration that are no updates of Newton's method, relative to that of zero.
const RESIDUAL: f64 = 1e-6;

/// Range of the updates of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum UpdateRange {
    /// Start from anywhere: long updates are shortened.
    Far,
    /// Start near: a long update is a failure, for it may end elsewhere.
    Near,
    /// Start at a prediction on a path: a first update longer than this, or a second one that is not much shorter, is a failure, for it
    /// may end on another path.
    Within(f64),
}

/// Outcome of Newton's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NewtonOutcome {
    Converged,
    Failed,
}

/// Rows and tangent of rest.
#[derive(Debug)]
pub(super) struct Statics<'m> {
    pub(super) model: &'m Model,
    pub(super) a: Configuration,
    b: Configuration,
    pub(super) scratch: Scratch,
    pub(super) values: Vec<f64>,
    pub(super) scalars: Vec<f64>,
    /// Weights on the vectors.
    pub(super) gravity: Vec<Vector>,
    /// Inputs with all voltages zero.
    pub(super) loads: Vec<f64>,
    /// Part of the weights and loads that acts.
    pub(super) weight: f64,
    /// First place of the added stiffness in the values: one a coordinate, one a scalar with an equation.
    pub(super) added: usize,
    pub(super) matrix: NewtonMatrix,
    pub(super) inertia: Inertia,
    /// The lowest mode found without factors.
    pub(super) examined: Examined,
    /// Counts of an iteration that solves, and of the systems for which factors took over.
    pub(super) multigrid: MultigridReport,
    pub(super) fallbacks: usize,
    /// Stiffness σ that was added to the tangent taken last.
    pub(super) sigma: f64,
    /// Rows, then the Newton update.
    pub(super) residual: Vec<f64>,
    pub(super) scales: Vec<f64>,
    /// Coordinates that turn behind each chart.
    pub(super) charted: Vec<[usize; 3]>,
    /// 1 where their axes are a right-handed triad, otherwise −1.
    pub(super) handedness: Vec<f64>,
    /// First place of the curvature of charts in the values: three a chart.
    pub(super) curved: usize,
    pub(super) iterations: usize,
}

impl<'m> Statics<'m> {
    /// Rest of a model under inputs whose loads act with the weights, by factors.
    pub(super) fn new(model: &'m Model, inputs: &[f64]) -> Self {
        Self::by(model, inputs, None)
    }

    /// The same, by an iteration on box grids where that is possible and wanted.
    pub(super) fn by(model: &'m Model, inputs: &[f64], multigrid: Option<MultigridUse>) -> Self {
        let map = &model.action.map;
        let size = model.variables.unknown_count();
        let (matrix, inertia) = matrix(model, multigrid);
        let mut statics = Self {
            model,
            a: map.instant(),
            b: map.instant(),
            scratch: model.action.scratch(Order::Gradient),
            values: Vec::new(),
            scalars: vec![0.0; model.action.intervals.scalars],
            gravity: weights(model),
            loads: model
                .variables
                .inputs_where(inputs, |role| role == Role::Load),
            weight: 1.0,
            added: 0,
            matrix,
            inertia,
            examined: Examined::default(),
            multigrid: MultigridReport::default(),
            fallbacks: 0,
            sigma: 0.0,
            residual: vec![0.0; size],
            scales: model.sizes(),
            charted: map.tree.charted(),
            handedness: map.tree.handedness(),
            curved: 0,
            iterations: 0,
        };
        if !statics.is_iterated() {
            statics.lay_down();
        }
        statics
    }

    /// Makes room for the values of the tangent.
    pub(super) fn lay_down(&mut self) {
        let (map, size) = (&self.model.action.map, self.scales.len());
        let [curved, added] = places(self.model);
        self.scratch = self.model.action.scratch(Order::Hessian);
        self.values = vec![0.0; added + map.coordinates + (size - map.unknowns())];
        (self.curved, self.added) = (curved, added);
    }

    /// Places both instants at a state.
    pub(super) fn place(&mut self, state: &RestState) {
        let map = &self.model.action.map;
        let m = map.unknowns();
        for instant in [&mut self.a, &mut self.b] {
            instant.z[..m].copy_from_slice(&state[..m]);
            instant.z[m..].copy_from_slice(&state.charts);
            map.place(instant);
        }
    }

    /// Rows and second derivatives at a state under voltages.
    pub(super) fn evaluate(&mut self, state: &RestState, voltages: &[f64]) {
        self.place(state);
        let m = self.model.action.map.unknowns();
        let variables = &self.model.variables;
        let scalars = &mut self.scalars;
        scalars[variables.inputs()].copy_from_slice(voltages);
        scalars[variables.range(Role::Load)]
            .iter_mut()
            .for_each(|load| *load *= self.weight);
        scalars[variables.algebraic()].copy_from_slice(&state[m..]);
        self.differentiate();
    }

    /// Second derivatives once more where they were evaluated last, for factors that take over.
    pub(super) fn evaluate_again(&mut self) {
        let residual = vec![0.0; self.scales.len()];
        let before = std::mem::replace(&mut self.residual, residual);
        self.differentiate();
        self.residual = before;
    }

    /// Rows and second derivatives where both instants are placed; rows are no numbers where it was time to stop.
    fn differentiate(&mut self) {
        let action = &self.model.action;
        let m = action.map.unknowns();
        let variables = &self.model.variables;
        let Self {
            a,
            b,
            scratch,
            values,
            scalars,
            residual,
            gravity,
            weight,
            matrix,
            ..
        } = self;
        values.fill(0.0);
        for instant in [&mut *a, &mut *b] {
            instant.forces.fill(Vector::zeros());
        }
        let interval = Sample::of_interval(scalars, self.model.multiplier_time);
        let is_whole = match matrix.grids_mut() {
            Some(grids) => grids.write(|nodes| {
                action.evaluate_at_rest([a, b], &interval, scratch, Some(nodes));
            }),
            None => {
                action.evaluate_at_rest([a, b], &interval, scratch, None);
                action.pull_back_interval(Order::Hessian, [a, b], &interval, 0, scratch, values);
                true
            }
        };
        for (force, other) in a.forces.iter_mut().zip(&b.forces) {
            *force += other;
        }
        if *weight != 1.0 {
            for (force, all) in a.forces.iter_mut().zip(gravity) {
                *force += (*weight - 1.0) * *all;
            }
        }
        // Blocks on box grids have no constraints.
        if matrix.direct().is_some() {
            action.evaluate_instant(Order::Hessian, a, &[], scratch);
            action.pull_back_instant(Order::Hessian, a, 0, scratch, values);
        }
        residual.fill(0.0);
        action.rows(a, scratch, &mut residual[..m]);
        let rows = &scratch.interval.plain.rows[variables.algebraic()];
        residual[m..].copy_from_slice(rows);
        if !is_whole {
            residual.fill(f64::NAN);
        }
        self.add_curvature();
    }

    /// Largest stiffness on the diagonal, in N mm for each rad or length of the system; 1 where there is none.
    pub(super) fn largest_stiffness(&self) -> f64 {
        let mut diagonal = vec![0.0; self.scales().len()];
        for ((i, j), value) in self.stiffness() {
            if i == j {
                diagonal[i] += value;
            }
        }
        let scaled = diagonal.iter().zip(self.scales());
        let largest = scaled.fold(0.0, |m, (k, s)| f64::max(m, (k * s * s).abs()));
        if largest > 0.0 { largest } else { 1.0 }
    }

    /// Stiffness of the state evaluated last along a direction of the coordinates, potentials being held.
    pub(super) fn stiffness_along(&self, direction: &[f64]) -> f64 {
        if let NewtonMatrix::Grids(grids) = &self.matrix {
            return -grids.along(direction) / self.model.multiplier_time;
        }
        let products = self.stiffness();
        products
            .map(|((i, j), value)| value * direction[i] * direction[j])
            .sum()
    }

    /// Summands of the stiffness of the state evaluated last, by coordinates: those of each block between both instants.
    fn stiffness(&self) -> impl Iterator<Item = ((usize, usize), f64)> + '_ {
        let layout = self.model.action.layout();
        let (n, h) = (self.scales().len(), self.model.multiplier_time);
        let same = layout.same.entries().enumerate();
        let same = same.flat_map(|(slot, entry)| {
            [layout.same_at(0), layout.same_at(1)].map(|first| (entry, first + slot))
        });
        let cross = layout.cross.entries().enumerate();
        let cross = cross.flat_map(|(slot, entry)| {
            [layout.lower_at(0), layout.upper_at(0)].map(|first| (entry, first + slot))
        });
        let pairs = self.charted.iter().flat_map(turned_pairs).enumerate();
        let curved = pairs.flat_map(|(place, [i, j, _])| {
            let place = self.curved + place;
            [((i, j), place), ((j, i), place)]
        });
        let is_stiffness = move |((i, j), _): &((usize, usize), usize)| *i < n && *j < n;
        same.chain(cross)
            .chain(curved)
            .filter(is_stiffness)
            .map(move |(entry, place)| (entry, -self.values[place] / h))
    }

    /// Size of an update, relative to angles of one radian and the length of the system; of turns behind a chart their angle, whatever
    /// axes they have.
    pub(super) fn size(&self, update: &[f64]) -> f64 {
        let worst = |a: f64, b: f64| if b.is_nan() { b } else { a.max(b) };
        let singles = update.iter().zip(&self.scales).map(|(u, s)| (u / s).abs());
        let angle =
            |turns: &[usize; 3]| turns.map(|i| update[i]).iter().map(|u| u * u).sum::<f64>();
        let angles = self.charted.iter().map(|turns| angle(turns).sqrt());
        singles.chain(angles).fold(0.0, worst)
    }

    /// Newton at one load.
    pub(super) fn newton(
        &mut self,
        state: &mut RestState,
        voltages: &[f64],
        reach: UpdateRange,
    ) -> Result<NewtonOutcome, EquilibriumError> {
        let (mut last, mut first) = (f64::INFINITY, 0.0);
        if let Some(grids) = self.matrix.grids_mut() {
            grids.start();
        }
        for iteration in 0..ITERATIONS {
            stop::check()?;
            self.iterations += 1;
            self.evaluate(state, voltages);
            stop::check()?;
            if self.residual.iter().any(|r| !r.is_finite()) {
                return Ok(NewtonOutcome::Failed);
            }
            if let Err(singular) = self.factor() {
                return Err(EquilibriumError::Singular {
                    name: self.model.variables.unknown(singular.column).to_string(),
                    redundant: self.model.redundant_constraints(&self.configuration(state)),
                });
            }
            let mut update = std::mem::take(&mut self.residual);
            self.solve_for_update(&mut update);
            if let Err(stopped) = stop::check() {
                self.residual = update;
                return Err(stopped.into());
            }
            let size = self.size(&update);
            // Potentials follow from one update.
            let moved = self.size(&update[..self.scales().len()]);
            let is_far = match (reach, iteration) {
                (UpdateRange::Far, _) => false,
                (UpdateRange::Within(most), 0) => moved > most.max(SHORT),
                (UpdateRange::Within(_), 1) => moved > (CONTRACTION * first).max(SHORT),
                _ => size > LONG,
            };
            if iteration == 0 {
                first = moved;
            }
            if size.is_nan() || is_far {
                self.residual = update;
                return Ok(NewtonOutcome::Failed);
            }
            let damping = if size > LONG { LONG / size } else { 1.0 };
            *state = self.moved(state, -damping, &update);
            self.residual = update;
            if size < UPDATE || (size < 1e-8 && size >= 0.5 * last) {
                if let Some((constraint, gap)) =
                    self.model.open_loop(&self.configuration(state), OPEN)
                {
                    return Err(EquilibriumError::OpenLoop { constraint, gap });
                }
                return Ok(NewtonOutcome::Converged);
            }
            last = size;
        }
        Ok(NewtonOutcome::Failed)
    }

    /// Scales of coordinates: 1 rad, and the length of the system.
    pub(super) fn scales(&self) -> &[f64] {
        &self.scales[..self.model.action.map.coordinates]
    }

    /// Weights of the squares of a state's entries in the length of a path.
    pub(super) fn weights(&self) -> Vec<f64> {
        let count = self.scales.len() as f64;
        let weight = |scale: &f64| 1.0 / (scale * scale * count);
        self.scales.iter().map(weight).collect()
    }
}

impl Statics<'_> {
    /// Takes the tangent of the state evaluated last; factorises it where it is solved so.
    pub(super) fn factor(&mut self) -> Result<(), Singular> {
        self.factor_with(0.0)
    }

    /// The same with a stiffness σ in N mm for each rad, and each length of the system; an iteration has no inertia, for which it is added.
    pub(super) fn factor_with(&mut self, sigma: f64) -> Result<(), Singular> {
        self.sigma = sigma;
        let n = self.model.action.map.coordinates;
        let h = self.model.multiplier_time;
        for (value, scale) in self.values[self.added..].iter_mut().zip(&self.scales[..n]) {
            *value = -h * sigma / (scale * scale);
        }
        if let Some(part) = &mut self.inertia.symmetric_part {
            // Where it is singular, it gives no number of negative pivots.
            let _ = part.factor(&self.values);
        }
        let done = self.matrix.factor_unless(&self.values, &|| false);
        self.values[self.added..].fill(0.0);
        done.expect("it is never time to stop")
    }

    /// Solves with the tangent taken last, in place; what is prescribed does not move.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_by(rhs, |grids, rhs| {
            grids.solve(rhs, RESIDUAL, &|| stop::reason().is_some())
        });
    }

    /// Solves for an update of Newton's method, in place, as accurately as it deserves.
    pub(super) fn solve_for_update(&mut self, residual: &mut [f64]) {
        self.solve_by(residual, |grids, rhs| {
            grids.solve_for_update(rhs, &|| stop::reason().is_some())
        });
    }

    /// Solves by factors, or by an iteration; by factors too where that does not converge. What is stopped is no number.
    fn solve_by(
        &mut self,
        rhs: &mut [f64],
        iterate: impl FnOnce(&mut GridTangent, &mut [f64]) -> Iterated,
    ) {
        self.model.hold(rhs);
        let solved = match &mut self.matrix {
            NewtonMatrix::Direct(tangent) => return tangent.solve(rhs),
            NewtonMatrix::Grids(grids) => {
                let solved = iterate(grids, rhs);
                self.multigrid.add(grids.counted());
                solved
            }
        };
        match solved {
            Ok(Ok(())) => {}
            Ok(Err(_)) if self.fall_back() => {
                self.fallbacks += 1;
                self.evaluate_again();
                match self.factor() {
                    Ok(()) => self.solve(rhs),
                    Err(_) => rhs.fill(f64::NAN),
                }
            }
            _ => rhs.fill(f64::NAN),
        }
    }

    /// Factorises from now on, where there is room; returns true if it did not before.
    pub(super) fn fall_back(&mut self) -> bool {
        if !self.matrix.fall_back_with_room(self.model) {
            return false;
        }
        self.inertia = Inertia::new(self.model);
        self.lay_down();
        true
    }

    /// Factorises from now on, where the size allows to examine stability.
    pub(super) fn examine(&mut self) {
        if self.residual.len() <= EXAMINED {
            self.fall_back();
        }
    }

    /// Returns true if an iteration solves, which does not prove stability.
    pub(super) fn is_iterated(&self) -> bool {
        self.matrix.direct().is_none()
    }

    /// Counts of an iteration, where one has solved, and of the systems for which factors took over.
    pub(super) fn iterations_on_grids(&self) -> Option<(MultigridReport, usize)> {
        (self.multigrid.levels > 0).then_some((self.multigrid, self.fallbacks))
    }

    /// Brings potentials to Gauss's law at the state evaluated last; returns their update, or `None` where that fails.
    pub(super) fn potentials(&mut self) -> Option<Vec<f64>> {
        let m = self.model.action.map.unknowns();
        if let Some(grids) = self.matrix.grids_mut() {
            let is_over = || stop::reason().is_some();
            let found = grids.potentials_to_law(&self.residual, &is_over);
            self.multigrid.add(grids.counted());
            return Some(found.ok()??.split_off(m));
        }
        let tangent = self.inertia.electric.as_mut()?;
        tangent.factor(&self.values).ok()?;
        let mut update = self.residual[m..].to_vec();
        tangent.solve(&mut update);
        Some(update)
    }

    /// Entries of the tangent factorised last; none of one on grids.
    pub(super) fn entries(&self) -> impl Iterator<Item = ((usize, usize), f64)> + '_ {
        let tangent = self.matrix.direct().into_iter();
        tangent.flat_map(Tangent::entries)
    }
}

/// Weights on the vectors over the time of the multipliers, as rows of rest read them.
pub(super) fn weights(model: &Model) -> Vec<Vector> {
    let map = &model.action.map;
    let instant = map.placed(&vec![0.0; map.unknowns()]);
    let scalars = vec![0.0; model.action.intervals.scalars];
    let interval = Sample::of_interval(&scalars, model.multiplier_time);
    let sample = interval.between([&instant, &instant]);
    let mut out = model.action.intervals.output(Order::Gradient);
    let terms = model.action.intervals.terms.iter();
    for weight in terms.filter(|term| term.is_weight()) {
        weight.evaluate(Order::Gradient, &sample, &[], &mut out);
    }
    let [here, there] = &out.plain.forces;
    here.iter().zip(there).map(|(a, b)| a + b).collect()
}

impl Statics<'_> {
    /// The state at a configuration, potentials being zero.
    pub(super) fn state_without_field(&self, z: &[f64]) -> RestState {
        let scalars = vec![0.0; self.model.variables.algebraic().len()];
        self.state(z, &scalars)
    }

    /// The state at a configuration with scalars that have an equation. Its charts are where its bodies are: there turns are rotations about the
    /// axes of the ground or of a parent, without singularity, and a stiffness by them does not depend on the choice of these axes.
    pub(super) fn state(&self, z: &[f64], scalars: &[f64]) -> RestState {
        let map = &self.model.action.map;
        let mut instant = map.placed(z);
        map.recentre(&mut instant);
        let (unknowns, charts) = instant.z.split_at(map.unknowns());
        RestState {
            unknowns: [unknowns, scalars].concat(),
            charts: charts.to_vec(),
        }
    }

    /// Coordinates, multipliers and charts of a state.
    pub(super) fn configuration(&self, state: &RestState) -> Vec<f64> {
        let m = self.model.action.map.unknowns();
        [&state[..m], &state.charts].concat()
    }

    /// The state a step along a direction away: bodies behind charts turn by rotation vectors, so that no choice of axes matters.
    pub(super) fn moved(&self, state: &RestState, step: f64, direction: &[f64]) -> RestState {
        let mut moved = state.clone();
        let RestState { unknowns, charts } = &mut moved;
        self.model
            .action
            .map
            .advance(step, direction, unknowns, charts);
        moved
    }

    /// Makes second derivatives by turns those by rotation vectors, at turns of zero: a product of turns a, b, c about e₁, e₂, e₃ is the
    /// rotation vector a e₁ + b e₂ + c e₃ + ½ (a b e₁ × e₂ + a c e₁ × e₃ + b c e₂ × e₃) + …
    pub(super) fn add_curvature(&mut self) {
        let pairs = self.charted.iter().flat_map(turned_pairs);
        let signs = self
            .handedness
            .iter()
            .flat_map(|s| [-0.5 * s, 0.5 * s, -0.5 * s]);
        for ((place, [_, _, third]), sign) in pairs.enumerate().zip(signs) {
            self.values[self.curved + place] = sign * self.residual[third];
        }
    }

    /// Leaves the second derivatives evaluated last by turns: those by one on which nothing depends are zero, whatever the forces.
    pub(super) fn leave_out_curvature(&mut self) {
        self.values[self.curved..self.added].fill(0.0);
    }
}
