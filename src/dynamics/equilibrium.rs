//! Static equilibrium: the same action on an interval whose two instants are one.
//!
//! With q_k = q_{k+1} = q inertia and viscosity vanish from the rows by themselves, and the sum of both rows is
//! −h Pᵀ∇V − h₀ Gᵀλ; the tangent is the sum of the four blocks. Voltages grow in steps of V², cut when Newton fails.

use crate::dynamics::EquilibriumError;
use crate::functional::{Horizon, Level, Sides};
use crate::model::Model;
use crate::reduction::{Instant, Scratch};
use crate::sparse::Direct;
use nalgebra::{DMatrix, SymmetricEigen};

/// Limit of Newton iterations for one load.
const ITERATIONS: usize = 30;
/// Fraction of the load (in V²) that is tried first.
const FIRST: f64 = 0.25;
/// Load increments below this end the path.
const SMALLEST: f64 = 1e-6;
/// Convergence of the Newton update, relative to angles of one radian and the length of the system.
const UPDATE: f64 = 1e-11;

/// A state of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Eigenvalues of the stiffness in joint coordinates, ascending, in N mm/rad or N/mm; empty in redundant coordinates.
    pub stiffness: Vec<f64>,
    /// Newton iterations over all loads.
    pub iterations: usize,
}

impl Equilibrium {
    /// Whether the equilibrium is stable; `None` where the stiffness is not known.
    pub fn is_stable(&self) -> Option<bool> {
        self.stiffness.first().map(|&smallest| smallest > 0.0)
    }
}

struct Statics<'m> {
    model: &'m Model,
    a: Instant,
    b: Instant,
    scratch: Scratch,
    values: Vec<f64>,
    gather: Vec<(usize, usize)>,
    entries: Vec<(usize, usize)>,
    matrix: Vec<f64>,
    solver: Direct,
    residual: Vec<f64>,
    iterations: usize,
}

impl<'m> Statics<'m> {
    fn new(model: &'m Model) -> Self {
        let motion = &model.action.motion;
        let layout = model.action.layout();
        let mut entries = Vec::new();
        let mut gather = Vec::new();
        let mut take = |at: usize, list: &[(usize, usize)]| {
            for (slot, &entry) in list.iter().enumerate() {
                gather.push((at + slot, entries.len()));
                entries.push(entry);
            }
        };
        take(layout.same_at(0), layout.same.entries());
        take(layout.lower_at(0), layout.cross.entries());
        take(layout.upper_at(0), layout.cross.entries());
        take(layout.same_at(1), layout.same.entries());
        Self {
            model,
            a: motion.instant(),
            b: motion.instant(),
            scratch: model.action.scratch(),
            values: vec![0.0; layout.values(1)],
            gather,
            matrix: vec![0.0; entries.len()],
            solver: Direct::new(motion.unknowns(), &entries),
            entries,
            residual: vec![0.0; motion.unknowns()],
            iterations: 0,
        }
    }

    fn evaluate(&mut self, z: &[f64], scalars: &[f64]) {
        let action = &self.model.action;
        let h = self.model.multiplier_time;
        let Self {
            a,
            b,
            scratch,
            values,
            ..
        } = self;
        values.fill(0.0);
        for instant in [&mut *a, &mut *b] {
            instant.z.copy_from_slice(z);
            action.motion.place(instant);
            instant.forces.fill(crate::math::Vector::zeros());
        }
        action.evaluate_interval(
            Level::Hessian,
            a,
            b,
            scalars,
            h,
            Horizon::Given,
            Sides::ALL,
            &[],
            scratch,
        );
        action.pull_back_interval(
            Level::Hessian,
            a,
            b,
            Horizon::Given,
            Sides::ALL,
            0,
            scratch,
            values,
        );
        for (force, other) in a.forces.iter_mut().zip(&b.forces) {
            *force += other;
        }
        action.evaluate_instant(Level::Hessian, a, &[], scratch);
        action.pull_back_instant(Level::Hessian, a, 0, scratch, values);
        self.residual.fill(0.0);
        action.rows(a, scratch, &mut self.residual);
        self.matrix.fill(0.0);
        for &(value, entry) in &self.gather {
            self.matrix[entry] += values[value];
        }
    }

    /// Newton at one load; `Ok(false)` when it does not converge.
    fn solve(&mut self, z: &mut [f64], scalars: &[f64]) -> Result<bool, EquilibriumError> {
        let n = self.model.coordinate_count();
        let length = self.model.length();
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            self.iterations += 1;
            self.evaluate(z, scalars);
            if self.residual.iter().any(|r| !r.is_finite()) {
                return Ok(false);
            }
            if let Err(singular) = self.solver.factor(&self.matrix) {
                return Err(EquilibriumError::Singular {
                    name: self.model.unknown_name(singular.column),
                });
            }
            self.solver.solve(&mut self.residual);
            let relative = |(i, d): (usize, &f64)| {
                if self.model.is_length(i) {
                    d.abs() / length
                } else {
                    d.abs()
                }
            };
            let size = self.residual[..n]
                .iter()
                .enumerate()
                .map(relative)
                .fold(0.0, f64::max);
            // A long update leaves the region in which the tangent says anything.
            let damping = if size > 0.5 { 0.5 / size } else { 1.0 };
            for (value, update) in z.iter_mut().zip(&self.residual) {
                *value -= damping * update;
            }
            if size < UPDATE || (size < 1e-8 && size >= 0.5 * last) {
                return Ok(true);
            }
            last = size;
        }
        Ok(false)
    }

    fn stiffness(&mut self, z: &[f64], scalars: &[f64]) -> Vec<f64> {
        let n = self.model.action.motion.unknowns();
        if self.model.action.motion.multipliers > 0 || self.model.action.motion.tree.is_none() {
            return Vec::new();
        }
        self.evaluate(z, scalars);
        let mut matrix = DMatrix::<f64>::zeros(n, n);
        for (&(row, col), value) in self.entries.iter().zip(&self.matrix) {
            matrix[(row, col)] -= value / self.model.multiplier_time;
        }
        let mut eigenvalues: Vec<f64> = SymmetricEigen::new(matrix)
            .eigenvalues
            .iter()
            .copied()
            .collect();
        eigenvalues.sort_by(f64::total_cmp);
        eigenvalues
    }
}

/// The static equilibrium under constant voltages (by scalar of an interval), on the path from `start`.
///
/// # Errors
/// The path ends before the voltages are reached, or nothing holds the system.
pub fn equilibrium(
    model: &Model,
    start: &[f64],
    scalars: &[f64],
) -> Result<Equilibrium, EquilibriumError> {
    let mut statics = Statics::new(model);
    let mut z = start.to_vec();
    let loaded = |fraction: f64| {
        scalars
            .iter()
            .map(|v| v * fraction.sqrt())
            .collect::<Vec<_>>()
    };
    let (mut reached, mut increment) = (0.0, FIRST);
    if !statics.solve(&mut z, &loaded(0.0))? {
        return Err(EquilibriumError::LimitPoint { fraction: 0.0 });
    }
    while reached < 1.0 && scalars.iter().any(|&v| v != 0.0) {
        let target = f64::min(reached + increment, 1.0);
        let mut trial = z.clone();
        match statics.solve(&mut trial, &loaded(target)) {
            Ok(true) => {
                (z, reached) = (trial, target);
                increment *= 2.0;
            }
            Ok(false) | Err(_) => increment *= 0.5,
        }
        if increment < SMALLEST {
            return Err(EquilibriumError::LimitPoint {
                fraction: reached.sqrt(),
            });
        }
    }
    let stiffness = statics.stiffness(&z, scalars);
    Ok(Equilibrium {
        z,
        stiffness,
        iterations: statics.iterations,
    })
}
