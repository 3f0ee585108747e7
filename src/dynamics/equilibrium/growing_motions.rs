//! Stability under following loads.
//!
//! The damped motion B q̇ = −K q about a state, with a stiffness K without symmetry and B of the scales of the coordinates, returns where all eigenvalues of K v = μ B v have positive real parts.
//!
//! Where the symmetric part S of K is positive definite they have. Otherwise τ > 0 makes S + τ B so; then the eigenvalues θ = 1/(μ + τ) of
//! (K + τ B)⁻¹ B that belong to growing motions are beyond all others, and Arnoldi's method finds them first.

use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::math::{Random, Vector};
use crate::model::Role;
use crate::stop;
use faer::Mat;
use nalgebra::{Complex, DMatrix, DVector};

/// Largest dimension of a Krylov space, and the dimensions after which its eigenvalues are compared.
const LARGEST: usize = 120;
const COMPARED: usize = 10;
/// Relative change of the least real part that ends the iteration.
const SAME: f64 = 1e-3;
/// First τ as a part of the largest stiffness, the factor of later ones, and their number.
const FIRST: f64 = 1e-4;
const FACTOR: f64 = 4.0;
const SHIFTS: usize = 40;
/// Parts of the largest θ below this are rounding.
const ROUNDING: f64 = 1e-12;

impl Statics<'_> {
    /// Number of directions in which a disturbance of the state evaluated and factorised last grows, potentials following; `None`
    /// where the factorisation does not give them.
    pub(super) fn unstable(&mut self) -> Option<usize> {
        let falling = self.falling();
        match (falling, &self.inertia.symmetric_part) {
            (Some(0), _) | (_, None) => falling,
            (_, Some(_)) => self.growing(),
        }
    }

    /// Number of negative eigenvalues of the stiffness, of its symmetric part where it has no symmetry.
    ///
    /// The tangent is −h S with S the saddle of coordinates, multipliers and potentials: each multiplier has one negative
    /// eigenvalue of S, potentials have those of their own block, what remains belongs to the coordinates.
    pub(super) fn falling(&mut self) -> Option<usize> {
        let part = self.inertia.symmetric_part.as_ref();
        let tangent = part.or_else(|| self.matrix.direct())?;
        let positive = tangent.negative_pivots()?;
        let negative = self.residual.len() - positive;
        let electric = match &mut self.inertia.electric {
            Some(tangent) => {
                tangent.factor(&self.values).ok()?;
                let scalars = self.residual.len() - self.model.action.map.unknowns();
                scalars - tangent.negative_pivots()?
            }
            None => 0,
        };
        negative.checked_sub(self.model.action.map.multipliers + electric)
    }

    /// Number of eigenvalues with a negative real part of the stiffness evaluated and factorised last; `None` where they are not found.
    pub(super) fn growing(&mut self) -> Option<usize> {
        let sigma = self.sigma;
        let first = FIRST * self.largest_stiffness();
        let shifts = (0..SHIFTS).map(|k| first * FACTOR.powi(k as i32));
        let mut found = None;
        for tau in shifts {
            if self.factor_with(sigma + tau).is_ok() && self.falling() == Some(0) {
                found = self.beyond(tau);
                break;
            }
        }
        self.factor_with(sigma).ok()?;
        found
    }

    /// Number of eigenvalues μ with a negative real part, where K + τ B is factorised.
    fn beyond(&mut self, tau: f64) -> Option<usize> {
        let n = self.scales().len();
        let most = n.min(LARGEST);
        let mut random = Random::new(1);
        let first = DVector::from_fn(n, |_, _| random.between(-1.0, 1.0));
        let mut basis = vec![first.normalize()];
        let mut projected = DMatrix::<f64>::zeros(most + 1, most);
        let mut before: Option<(usize, f64)> = None;
        for j in 0..most {
            if stop::reason().is_some() {
                return None;
            }
            let mut next = self.inverse(&basis[j]);
            for _ in 0..2 {
                for (i, other) in basis.iter().enumerate() {
                    let part = other.dot(&next);
                    projected[(i, j)] += part;
                    next.axpy(-part, other, 1.0);
                }
            }
            let length = next.norm();
            let is_whole = j + 1 == n || length <= ROUNDING * projected.column(j).norm();
            if is_whole || (j + 1) % COMPARED == 0 {
                let (count, least) =
                    least(projected.view((0, 0), (j + 1, j + 1)).into_owned(), tau)?;
                let is_same = before.is_some_and(|(other, last)| {
                    let size = least.abs().max(SAME * SAME * tau);
                    other == count && (last - least).abs() <= SAME * size
                });
                if is_whole || is_same {
                    return Some(count);
                }
                before = Some((count, least));
            }
            projected[(j + 1, j)] = length;
            basis.push(next / length);
        }
        None
    }

    /// (K + τ B)⁻¹ B of a vector by the scales of the coordinates.
    fn inverse(&mut self, vector: &DVector<f64>) -> DVector<f64> {
        let mut rows = vec![0.0; self.residual.len()];
        let by_scale = vector.iter().zip(&self.scales);
        for (row, (value, scale)) in rows.iter_mut().zip(by_scale) {
            // The tangent is −h K.
            *row = -self.model.multiplier_time * value / scale;
        }
        self.solve(&mut rows);
        DVector::from_fn(vector.len(), |i, _| rows[i] / self.scales[i])
    }
}

/// Eigenvalues of a matrix.
pub(super) fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let (rows, columns) = matrix.shape();
    let matrix = Mat::from_fn(rows, columns, |i, j| matrix[(i, j)]);
    let values = matrix.eigenvalues().ok()?;
    Some(
        values
            .iter()
            .map(|value| Complex::new(value.re, value.im))
            .collect(),
    )
}

/// Number of growing motions by eigenvalues θ, and the least real part of μ.
fn least(matrix: DMatrix<f64>, tau: f64) -> Option<(usize, f64)> {
    let found = eigenvalues(&matrix)?;
    let size = |theta: &Complex<f64>| theta.re.hypot(theta.im);
    let largest = found.iter().map(size).fold(0.0, f64::max);
    let found = found
        .iter()
        .filter(|theta| size(theta) > ROUNDING * largest);
    // Re μ = Re θ/|θ|² − τ.
    let parts = found.map(|theta| theta.re / size(theta).powi(2) - tau);
    let parts: Vec<f64> = parts.collect();
    let growing = parts.iter().filter(|part| **part < 0.0).count();
    Some((growing, parts.into_iter().fold(f64::INFINITY, f64::min)))
}

impl Statics<'_> {
    /// Inputs with all voltages zero.
    pub(super) fn without_voltages(&self, inputs: &[f64]) -> Vec<f64> {
        let variables = &self.model.variables;
        variables.inputs_where(inputs, |role| role != Role::Voltage)
    }

    /// Returns true if a voltage is other than zero.
    pub(super) fn is_driven(&self, inputs: &[f64]) -> bool {
        let mut inputs = self.model.variables.with_roles(inputs);
        inputs.any(|(value, role)| role == Role::Voltage && value != 0.0)
    }

    /// Returns true if anything has a weight, or a load acts.
    pub(super) fn has_weight(&self) -> bool {
        let acts = self.loads.iter().any(|load| *load != 0.0);
        acts || self.gravity.iter().any(|force| *force != Vector::zeros())
    }

    /// Adds the derivative of the rows by the part of the weights and loads that acts, at the state evaluated last.
    pub(super) fn add_weight(&self, rows: &mut [f64]) {
        let map = &self.model.action.map;
        map.pull_back(&self.a.columns, &self.gravity, &mut rows[..map.coordinates]);
        self.add_load(&self.loads, rows);
    }

    /// Adds the derivative of the rows along a change of the inputs, at the state evaluated last.
    pub(super) fn add_load(&self, change: &[f64], rows: &mut [f64]) {
        let variables = &self.model.variables;
        let change = &variables.scalars(change);
        if let NewtonMatrix::Grids(grids) = &self.matrix {
            let (map, nodes) = (&self.model.action.map, grids.nodes());
            for (vector, s, sum) in nodes.of_vectors() {
                map.pull_back_one(vector, &[], &(sum * change[s]), rows);
            }
            for (s, t, sum) in nodes.of_scalars() {
                if let Some(row) = variables.place(s) {
                    rows[row] += sum * change[t];
                }
            }
            return;
        }
        let layout = self.model.action.layout();
        for side in 0..2 {
            for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                if variables.place(s).is_none() {
                    rows[i] += self.values[layout.mixed_at(0, side) + slot] * change[s];
                }
            }
        }
        for (slot, (s, t)) in layout.scalars.entries().enumerate() {
            if let (Some(row), None) = (variables.place(s), variables.place(t)) {
                rows[row] += self.values[layout.scalars_at(0) + slot] * change[t];
            }
        }
    }
}
