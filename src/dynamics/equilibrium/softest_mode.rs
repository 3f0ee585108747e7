//! Stiffness and modes of a state of rest: the softest one, along which its potential energy rises least or falls, with the parts that move and
//! the cause of its softness; and the slowest vibration, K v = ω² M v with the smallest ω², without damping.
//!
//! The iteration K u = M v converges to this v; ω² is the quotient uᵀ K u / uᵀ M u with K u = M v. Multipliers and potentials follow the
//! coordinates.

use crate::dynamics::equilibrium::growing_motions::eigenvalues;
use crate::dynamics::equilibrium::rest_state::{
    Equilibrium, Examined, LowestMode, Mode, RestState, Route, Softening,
};
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::solving::MultigridUse;
use crate::math::Random;
use crate::model::system::Fidelity;
use crate::model::{Coordinates, Freedom, Model, Screw};
use crate::sparse::multigrid::LowestModes;
use crate::stop;
use nalgebra::{DMatrix, SymmetricEigen};
use std::f64::consts::TAU;

/// Number of coordinates up to which the eigenvalues of the stiffness are computed.
const EIGENVALUES: usize = 100;

/// Steps of the inverse iteration for larger systems.
const STEPS: usize = 30;

/// Parts of the largest motion below this are not named.
const NAMED: f64 = 0.5;

/// Maximum number of parts named.
const LISTED: usize = 3;

/// Parts of the stiffness below this of the elastic one are rounding.
const ROUNDING: f64 = 1e-9;

/// Returns true if the stiffness in joint coordinates is small enough for a full eigenvalue decomposition.
fn is_small(model: &Model) -> bool {
    let map = &model.action.map;
    let joints_alone = map.is_articulated() && map.of_nodes.is_empty() && map.of_internal == 0;
    map.multipliers == 0 && joints_alone && (1..=EIGENVALUES).contains(&map.unknowns())
}

/// The stiffness of a small system in joint coordinates, by the scales of the free ones, at the state evaluated and factorised last.
fn scaled(statics: &Statics<'_>) -> Option<(DMatrix<f64>, Vec<usize>)> {
    let model = statics.model;
    if !is_small(model) {
        return None;
    }
    let n = model.action.map.coordinates;
    let free: Vec<usize> = (0..n).filter(|&i| !model.is_prescribed(i)).collect();
    if free.is_empty() {
        return None;
    }
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    for ((row, col), value) in statics.entries() {
        let scale = statics.scales()[row] * statics.scales()[col];
        matrix[(row, col)] -= scale * value / model.multiplier_time;
    }
    Some((matrix.select_rows(&free).select_columns(&free), free))
}

/// Eigenvalues of the stiffness in joint coordinates of the state evaluated and factorised last, ascending, by rad and by mm, or by lengths of
/// the system where there are both; of a stiffness without symmetry their real parts. Empty for other coordinates.
fn stiffness(statics: &Statics<'_>) -> Vec<f64> {
    let Some((matrix, free)) = scaled(statics) else {
        return Vec::new();
    };
    let first = statics.scales()[free[0]];
    let is_mixed = free.iter().any(|&i| statics.scales()[i] != first);
    let unit = if is_mixed { 1.0 } else { first * first };
    let mut values: Vec<f64> = match &statics.inertia.symmetric_part {
        None => SymmetricEigen::new(matrix).eigenvalues.as_slice().to_vec(),
        Some(_) => {
            let values = eigenvalues(&matrix).unwrap_or_default();
            values.iter().map(|value| value.re).collect()
        }
    };
    values.sort_by(f64::total_cmp);
    values.iter().map(|value| value / unit).collect()
}

/// The eigenvector of the lowest eigenvalue of the stiffness of a small system with potential energy.
fn lowest(statics: &Statics<'_>) -> Option<Vec<f64>> {
    if statics.inertia.symmetric_part.is_some() {
        return None;
    }
    let (matrix, free) = scaled(statics)?;
    let pairs = SymmetricEigen::new(matrix);
    let (least, _) = pairs.eigenvalues.argmin();
    let mut lowest = vec![0.0; statics.scales().len()];
    for (&i, value) in free.iter().zip(pairs.eigenvectors.column(least).iter()) {
        lowest[i] = statics.scales()[i] * value;
    }
    Some(lowest)
}

/// The softest mode of the state evaluated and factorised last.
pub(super) fn softest_mode(
    statics: &mut Statics<'_>,
    state: &RestState,
    voltages: &[f64],
) -> Option<Mode> {
    let direction = match lowest(statics) {
        Some(lowest) => lowest,
        None if statics.is_iterated() => statics.lowest_mode()?.direction.clone(),
        None => inverse_iteration(statics)?,
    };
    Some(named(statics, state, voltages, direction))
}

/// The direction of the lowest eigenvalue of K by B, of the state evaluated last.
fn inverse_iteration(statics: &mut Statics<'_>) -> Option<Vec<f64>> {
    let n = statics.scales().len();
    let size = statics.residual.len();
    let mut sigma = 0.0;
    let mut count = 0;
    while statics.factor_with(sigma).is_err() || statics.unstable() != Some(0) {
        sigma = match count {
            0 => 1e-4 * statics.largest_stiffness(),
            _ => 4.0 * sigma,
        };
        count += 1;
        if count > 40 {
            return None;
        }
    }
    let mut random = Random::new(1);
    let mut vector: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
    for _ in 0..STEPS {
        let mut rhs = vec![0.0; size];
        for (i, (value, scale)) in vector.iter().zip(statics.scales()).enumerate() {
            rhs[i] = -value / (scale * scale);
        }
        statics.solve(&mut rhs);
        let largest = rhs[..n].iter().zip(statics.scales());
        let largest = largest.fold(0.0, |m, (v, s)| f64::max(m, (v / s).abs()));
        if !(largest.is_finite() && largest > 0.0) {
            return None;
        }
        vector = rhs[..n].iter().map(|v| v / largest).collect();
    }
    Some(vector)
}

/// A direction of size 1 with the parts that it moves.
fn named(
    statics: &mut Statics<'_>,
    state: &RestState,
    voltages: &[f64],
    direction: Vec<f64>,
) -> Mode {
    let relative = direction.iter().zip(statics.scales()).map(|(v, s)| v / s);
    let largest = relative.max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let size = statics.size(&direction).copysign(largest.unwrap_or(1.0));
    let direction: Vec<f64> = direction.iter().map(|d| d / size).collect();
    Mode {
        moves: moves(statics.model, &statics.configuration(state), &direction),
        softening: softening(statics, state, voltages, &direction),
        direction,
    }
}

/// The part of the stiffness along a direction that takes most from it; `None` where none does.
fn softening(
    statics: &mut Statics<'_>,
    state: &RestState,
    voltages: &[f64],
    direction: &[f64],
) -> Option<Softening> {
    let m = statics.model.action.map.unknowns();
    let mut bare = state.clone();
    bare[m..].fill(0.0);
    let none = statics.without_voltages(voltages);
    let weight = statics.weight;
    let mut along = |weight: f64, state: &RestState, voltages: &[f64]| {
        statics.weight = weight;
        statics.evaluate(state, voltages);
        statics.stiffness_along(direction)
    };
    let all = along(weight, state, voltages);
    let mechanical = along(weight, &bare, &none);
    let elastic = along(0.0, &bare, &none);
    statics.weight = weight;
    statics.evaluate(state, voltages);
    // Sums over a part of the elements say nothing.
    if statics.is_iterated() && stop::reason().is_some() {
        return None;
    }
    let parts = [
        (Softening::Voltages, all - mechanical),
        (Softening::Loads, mechanical - elastic),
        (Softening::Elastic, elastic),
    ];
    let least = parts.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    least
        .filter(|(_, part)| *part < -ROUNDING * elastic.abs())
        .map(|(softening, _)| softening)
}

/// Names the parts that move along a direction.
pub(super) fn moves(model: &Model, z: &[f64], direction: &[f64]) -> String {
    let map = &model.action.map;
    let mut instant = map.placed(z);
    instant.l[..direction.len()].copy_from_slice(direction);
    map.along(&mut instant);
    let mut words = Vec::new();
    let bodies = &direction[..map.of_bodies];
    let mut list: Vec<(String, f64)> = match model.coordinates {
        Coordinates::Reduced => {
            let mut moved: Vec<(String, f64)> = Vec::new();
            for (c, rate) in bodies.iter().enumerate() {
                let Freedom { of, screw, .. } = model.freedom(c);
                let size = match screw {
                    Screw::Slide(_) => rate.abs() / model.length(),
                    Screw::Turn(_) => rate.abs(),
                };
                match moved.last_mut().filter(|(name, _)| name == of) {
                    Some((_, largest)) => *largest = largest.max(size),
                    None => moved.push((of.to_owned(), size)),
                }
            }
            moved
        }
        Coordinates::Redundant => {
            let rates = bodies.chunks(12);
            let moved = rates
                .zip(&model.presolved.system.bodies)
                .map(|(rates, body)| {
                    let (centre, turn) = rates.split_at(3);
                    let largest = |part: &[f64]| part.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                    let moved = f64::max(largest(centre) / model.length(), largest(turn));
                    (body.name.clone(), moved)
                });
            moved.collect()
        }
    };
    list.sort_by(|a, b| b.1.total_cmp(&a.1));
    if let Some(largest) = list.first().map(|l| l.1).filter(|&l| l > NAMED) {
        let named = list.iter().filter(|(_, v)| *v >= NAMED * largest);
        words.extend(named.take(LISTED).map(|(name, _)| name.clone()));
    }
    let nodes = map.of_nodes.iter().zip(&direction[map.of_bodies..]);
    let furthest = nodes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    if let Some((&(node, _), _)) = furthest.filter(|_| words.is_empty()) {
        let (block, node) = model.node_names[node];
        let solid = &model.solids[block].solid;
        let at = solid.mesh.nodes[node];
        words.push(format!(
            "block {} around ({:.3}, {:.3}, {:.3}) mm of its reference",
            solid.name, at.x, at.y, at.z
        ));
    }
    let muscles = model.system.muscles.iter().enumerate();
    let lumped = muscles.filter(|(_, muscle)| muscle.fidelity == Fidelity::Lumped);
    let rate = lumped.map(|(m, muscle)| {
        let (span, along) = (instant.x[model.spans[m]], instant.w[model.spans[m]]);
        let rate = span.dot(&along) / (span.norm() * muscle.length());
        (muscle, rate, span.norm() / muscle.length())
    });
    let most = rate.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    if let Some((muscle, _, stretch)) = most.filter(|m| m.1.abs() > 1e-9) {
        words.push(format!("stretch of {} (at {stretch:.4})", muscle.name));
    }
    words.join(", ")
}

/// The lowest mode of a model at a state of rest: `z` of coordinates, `scalars` of voltages and potentials; `None` where something else than
/// nodes of blocks moves, or it is not found.
pub fn lowest_mode(model: &Model, z: &[f64], scalars: &[f64]) -> Option<LowestMode> {
    let [inputs, others] = model.variables.split(scalars);
    let mut statics = Statics::by(model, inputs, Some(MultigridUse::Always));
    let state = statics.state(z, others);
    statics.evaluate(&state, inputs);
    statics.factor().ok()?;
    statics.find_lowest_mode();
    statics.lowest_mode().cloned()
}

impl Statics<'_> {
    /// Finds the lowest mode at the state evaluated and taken last, where an iteration solves and it is not known already.
    pub(super) fn find_lowest_mode(&mut self) {
        let at = self.place_of_mode();
        let factor = -1.0 / self.model.multiplier_time;
        let NewtonMatrix::Grids(grids) = &mut self.matrix else {
            return;
        };
        if at == self.examined.at {
            return;
        }
        let found = grids.lowest_modes(factor, &|| stop::reason().is_some());
        self.multigrid.add(grids.counted());
        let count = self.model.action.map.coordinates;
        let found = found.ok().flatten().map(|modes| {
            let unstable = modes.below_zero();
            let LowestModes {
                quotients,
                bounds,
                iterations,
                lowest: mut direction,
                ..
            } = modes;
            direction.truncate(count);
            LowestMode {
                stiffness: quotients[0],
                bound: bounds[0],
                unstable,
                iterations,
                direction,
            }
        });
        self.examined = Examined { at, found };
    }

    /// The lowest mode of the state evaluated last, where it was found.
    pub(super) fn lowest_mode(&self) -> Option<&LowestMode> {
        let found = self.examined.found.as_ref().filter(|_| self.is_iterated());
        found.filter(|_| self.place_of_mode() == self.examined.at)
    }

    /// Number of directions in which the potential energy of the state evaluated and taken last falls, by factors or by the lowest mode.
    pub(super) fn unstable_anyhow(&mut self) -> Option<usize> {
        if !self.is_iterated() {
            return self.unstable();
        }
        self.find_lowest_mode();
        self.lowest_mode()?.unstable
    }

    /// All that the stiffness depends on.
    fn place_of_mode(&self) -> Vec<f64> {
        [&self.a.z[..], &self.scalars, &[self.weight]].concat()
    }
}

impl Equilibrium {
    /// Stiffness, stability and softest mode of a model's state of rest: `z` of coordinates and multipliers, `scalars` of
    /// voltages and potentials.
    pub fn of_state(model: &Model, z: &[f64], scalars: &[f64]) -> Self {
        let [voltages, others] = model.variables.split(scalars);
        let mut statics = Statics::new(model, voltages);
        let state = statics.state(z, others);
        Self::new(&mut statics, &state, voltages, Route::Loads)
    }

    /// A state of rest of a model, from coordinates with multipliers and potentials.
    pub(super) fn new(
        statics: &mut Statics<'_>,
        state: &RestState,
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let point = Self::on_path(statics, state, voltages, route);
        Self {
            softest: softest_mode(statics, state, voltages),
            ..point
        }
    }

    /// The same without its softest mode.
    pub(super) fn on_path(
        statics: &mut Statics<'_>,
        state: &RestState,
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let m = statics.model.action.map.unknowns();
        statics.evaluate(state, voltages);
        let is_known = statics.factor().is_ok();
        let unstable = is_known.then(|| statics.unstable_anyhow()).flatten();
        let follows = statics.inertia.symmetric_part.is_some();
        let may_flutter = follows && unstable == Some(0) && statics.falling() != Some(0);
        Self {
            z: statics.configuration(state),
            scalars: voltages.iter().chain(&state[m..]).copied().collect(),
            stiffness: stiffness(statics),
            unstable,
            may_flutter,
            lowest: statics.lowest_mode().cloned(),
            softest: None,
            route,
            iterations: statics.iterations,
            on_grids: statics.iterations_on_grids(),
        }
    }
}

/// Maximum number of iterations for a vibration, and the relative change of ω² that ends them.
const ITERATIONS: usize = 200;
const SAME: f64 = 1e-6;

impl Equilibrium {
    /// Period in ms of the slowest vibration about the state of rest of a model, without damping; `None` if the state is unstable, nothing
    /// that moves has inertia, or no period is found.
    pub fn slowest_period(&self, model: &Model) -> Option<f64> {
        let [inputs, others] = model.variables.split(&self.scalars);
        let mut statics = Statics::new(model, inputs);
        let state = statics.state(&self.z, others);
        statics.evaluate(&state, inputs);
        statics.factor().ok()?;
        if statics.unstable().is_some_and(|count| count > 0) {
            return None;
        }
        let mut instant = model.action.map.placed(&self.z);
        let (n, size) = (model.coordinate_count(), statics.residual.len());
        let mut random = Random::new(1);
        let scales = statics.scales().iter().copied();
        let scales = scales.map(|scale| if scale.is_finite() { scale } else { 1.0 });
        let first: Vec<f64> = scales.map(|s| s * random.between(-1.0, 1.0)).collect();
        let mut momentum = model.action.momentum(&mut instant, &first);
        let mut last = 0.0;
        for _ in 0..ITERATIONS {
            if stop::reason().is_some() {
                return None;
            }
            // The tangent is −h K.
            let of_tangent = momentum.iter().map(|p| -model.multiplier_time * p);
            let mut rates: Vec<f64> = of_tangent.collect();
            rates.resize(size, 0.0);
            statics.solve(&mut rates);
            rates.truncate(n);
            let after = model.action.momentum(&mut instant, &rates);
            let kinetic = dot(&rates, &after);
            let square = dot(&rates, &momentum) / kinetic;
            if !(square.is_finite() && square > 0.0) {
                return None;
            }
            if (square - last).abs() <= SAME * square {
                return Some(TAU / square.sqrt());
            }
            last = square;
            momentum = after.iter().map(|p| p / kinetic.sqrt()).collect();
        }
        None
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
