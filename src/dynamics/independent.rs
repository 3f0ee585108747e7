//! Independent changes of coordinates under constraints.
//!
//! N is a basis of the null space of the gradients G of the constraints g at coordinates z₀. The coordinates with changes δ along it solve
//!
//! ```text
//! g(z) = 0,   Nᵀ(z − z₀) = δ,        ∂z/∂δ = [Gᵀ N]⁻ᵀ [0 I]ᵀ.
//! ```
//!
//! Without constraints N holds unit vectors, and z = z₀ + N δ. Prescribed coordinates do not change.

use crate::dynamics::kinetic::{Kinetic, directions};
use crate::functional::Order;
use crate::model::Model;
use nalgebra::{DMatrix, DVector, SVD};

/// Singular values below this part of the greatest are none.
const NONE: f64 = 1e-11;
/// Updates of Newton's method.
const UPDATES: usize = 50;
/// An update this small, relative to the sizes of coordinates, is the last one.
const SETTLED: f64 = 1e-13;
/// Constraints may be violated by this part of the size of a system.
const CLOSED: f64 = 1e-9;

/// Coordinates z₀ and a basis of the changes that constraints leave free there.
#[derive(Debug)]
pub struct IndependentChanges<'m> {
    model: &'m Model,
    z: Vec<f64>,
    basis: DMatrix<f64>,
    are_memories: Vec<bool>,
}

impl<'m> IndependentChanges<'m> {
    /// The basis at coordinates z₀ and multipliers; none where constraints join more coordinates than are decomposed.
    pub fn at(model: &'m Model, z: Vec<f64>) -> Option<Self> {
        let open = (0..model.coordinate_count()).filter(|&i| !model.is_prescribed(i));
        let joined: Vec<usize> = match model.action.map.multipliers {
            0 => Vec::new(),
            _ => open.clone().filter(|&i| !model.is_memory(i)).collect(),
        };
        let mut columns: Vec<Vec<(usize, f64)>> = Vec::new();
        if !joined.is_empty() {
            let gradients = gradients(model, &z)?.select_rows(&joined);
            let (square, [free, _]) = directions(&gradients);
            let vectors = free
                .iter()
                .map(|&i| square.eigenvectors.column(i).into_owned());
            let of =
                |vector: DVector<f64>| joined.iter().copied().zip(vector.iter().copied()).collect();
            columns.extend(vectors.map(of));
        }
        let alone = open.filter(|i| !joined.contains(i));
        columns.extend(alone.map(|i| vec![(i, 1.0)]));
        let mut basis = DMatrix::zeros(model.coordinate_count(), columns.len());
        for (column, entries) in columns.iter().enumerate() {
            entries
                .iter()
                .for_each(|&(i, value)| basis[(i, column)] = value);
        }
        let of_memory =
            |entries: &Vec<(usize, f64)>| entries.iter().all(|&(i, _)| model.is_memory(i));
        Some(Self {
            are_memories: columns.iter().map(of_memory).collect(),
            model,
            z,
            basis,
        })
    }

    /// The basis, a column for each change.
    pub fn basis(&self) -> &DMatrix<f64> {
        &self.basis
    }

    /// The changes of what has momenta, by their columns: of coordinates that remember nothing.
    pub fn moving(&self) -> Vec<usize> {
        let columns = self.are_memories.iter().enumerate();
        columns
            .filter(|(_, is_memory)| !**is_memory)
            .map(|(column, _)| column)
            .collect()
    }

    /// Coordinates and multipliers with changes, and the derivatives of the coordinates by these; none where the constraints cannot be met.
    pub fn changed(&self, changes: &[f64]) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let (n, changes) = (self.basis.nrows(), DVector::from_column_slice(changes));
        let mut z = self.z.clone();
        let first = &self.basis * &changes;
        z.iter_mut()
            .zip(first.iter())
            .for_each(|(z, change)| *z += change);
        if self.model.action.map.multipliers == 0 {
            return Some((z, self.basis.clone()));
        }
        let (sizes, mut update) = (self.model.sizes(), f64::INFINITY);
        for _ in 0..UPDATES {
            if update <= SETTLED {
                break;
            }
            let values = self.values(&z);
            let moved = DVector::from_fn(n, |i, _| z[i] - self.z[i]);
            let along = self.basis.transpose() * moved - &changes;
            let gap = DVector::from_iterator(
                values.len() + along.len(),
                values.iter().chain(along.iter()).copied(),
            );
            let step = self.solved(&z, &DMatrix::from_columns(&[gap]))?;
            z.iter_mut()
                .zip(step.iter())
                .for_each(|(z, step)| *z -= step);
            let steps = step.iter().zip(&sizes);
            update = steps
                .map(|(step, size)| step.abs() / size)
                .fold(0.0, f64::max);
        }
        let largest = self
            .values(&z)
            .iter()
            .fold(0.0, |most: f64, g| most.max(g.abs()));
        let is_closed = largest <= CLOSED * self.model.length() * self.model.multiplier_time;
        let constraints = self.model.action.map.multipliers;
        let mut right = DMatrix::zeros(constraints + changes.len(), changes.len());
        right
            .view_mut((constraints, 0), (changes.len(), changes.len()))
            .fill_with_identity();
        let slopes = self.solved(&z, &right)?;
        is_closed.then_some((z, slopes))
    }

    /// Solves `[G N]ᵀ x = b`; prescribed coordinates do not change.
    fn solved(&self, z: &[f64], right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let mut gradients = gradients(self.model, z)?;
        for i in (0..gradients.nrows()).filter(|&i| self.model.is_prescribed(i)) {
            gradients.row_mut(i).fill(0.0);
        }
        let (rows, met) = (gradients.ncols(), right.nrows());
        let mut matrix = DMatrix::zeros(met, gradients.nrows());
        matrix.rows_mut(0, rows).copy_from(&gradients.transpose());
        matrix
            .rows_mut(rows, met - rows)
            .copy_from(&self.basis.transpose());
        let factors = SVD::new(matrix, true, true);
        let least = NONE * factors.singular_values.amax();
        factors.solve(right, least).ok()
    }

    /// Values of the constraints, in the unit of their gradients.
    fn values(&self, z: &[f64]) -> Vec<f64> {
        let action = &self.model.action;
        let mut scratch = action.scratch(Order::Gradient);
        let mut instant = action.map.placed(z);
        action.evaluate_instant(Order::Gradient, &mut instant, &[], &mut scratch);
        scratch.instant.plain.rows.clone()
    }
}

/// Gradients of the constraints, a column for each; none of too many coordinates.
fn gradients(model: &Model, z: &[f64]) -> Option<DMatrix<f64>> {
    let mut kinetic = Kinetic::new(model);
    kinetic.assemble(&mut model.action.map.placed(z));
    Some(kinetic.small()?.1)
}
