//! Rates from momenta: the mass matrix of an instant, bordered by its constraints.
//!
//! Rates v of momenta p that a step left without the reactions at its end solve
//!
//! ```text
//! M v + Gᵀ μ = p,     G v = 0
//! ```
//!
//! so that they meet the constraints; without constraints this is M v = p. Where coordinates have no inertia or constraints follow from
//! others, it is solved in a basis N of the null space of G, NᵀM N w = Nᵀp with v = N w, and what has no inertia rests.

use crate::coordinates::{Configuration, Destination, Scratch};
use crate::dynamics::momenta::{DECOMPOSED, rates_within};
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::functional::{BlockMask, Blocks, Order, Sample, SumDerivatives, TermKind};
use crate::math::Vector;
use crate::model::Model;
use crate::sparse::Symmetry;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Parts of the largest square of a constraint gradient that count as none.
const DEPENDENT: f64 = 1e-14;

/// Storage of the bordered mass matrix.
#[derive(Debug)]
pub(super) struct Kinetic<'m> {
    model: &'m Model,
    scratch: Scratch,
    masses: SumDerivatives,
    values: Vec<f64>,
    tangent: Tangent,
}

impl<'m> Kinetic<'m> {
    /// Lays the matrix down.
    pub(super) fn new(model: &'m Model) -> Self {
        let action = &model.action;
        let (layout, n) = (action.layout(), action.map.coordinates);
        let mut entries = EntryList::default();
        for (slot, (i, j)) in layout.same.entries().enumerate() {
            if i < n || j < n {
                entries.add(slot, (i, j));
            }
        }
        let mut held = model.prescribed_coordinates();
        held.extend(model.strains());
        entries.hold(&held, 1.0);
        let size = action.map.unknowns();
        Self {
            scratch: action.scratch(Order::Hessian),
            masses: action.intervals.output(Order::Hessian).plain,
            values: vec![0.0; layout.values(0)],
            tangent: entries.tangent(size, Symmetry::Symmetric, None),
            model,
        }
    }

    /// Rates of the coordinates of a placed instant at a time in ms; nothing where masses are missing or constraints are redundant, and coordinates too
    /// many for a null space.
    pub(super) fn rates(
        &mut self,
        instant: &mut Configuration,
        time: f64,
        momentum: &[f64],
    ) -> Option<Vec<f64>> {
        let action = &self.model.action;
        self.values.fill(0.0);
        // The gradients of the constraints alone: neither forces nor multipliers bend them.
        let mut bare = instant.clone();
        bare.z[momentum.len()..action.map.unknowns()].fill(0.0);
        bare.forces.fill(Vector::zeros());
        action.evaluate_instant(Order::Hessian, &mut bare, &[], &mut self.scratch);
        action.pull_back_instant(
            Order::Hessian,
            &mut bare,
            0,
            &mut self.scratch,
            &mut self.values,
        );
        let blocks = masses(self.model, &instant.x);
        for (sum, mass) in self
            .masses
            .blocks
            .isotropic
            .iter_mut()
            .zip(&blocks.isotropic)
        {
            sum[0] = mass[3];
        }
        for (sum, mass) in self.masses.blocks.full.iter_mut().zip(&blocks.full) {
            sum[0] = mass[3];
        }
        let target = Destination {
            blocks: [0; 4],
            mixed: [usize::MAX; 2],
            scalars: usize::MAX,
        };
        action.pull_back_part(
            [instant, instant],
            &self.masses,
            BlockMask::HERE,
            &target,
            &mut self.scratch,
            &mut self.values,
        );
        let mut prescribed = vec![0.0; action.map.unknowns()];
        self.model.prescribe_rates(time, &mut prescribed);
        let right = self.without(momentum, &prescribed);
        let found = self.solved(&right);
        let mut rates = found.or_else(|| self.within(&right, momentum.len()))?;
        for (rate, prescribed) in rates.iter_mut().zip(prescribed) {
            *rate += prescribed;
        }
        Some(rates)
    }

    /// Right-hand sides of what is not prescribed: momenta and constraints, less those of the prescribed rates.
    fn without(&self, momentum: &[f64], prescribed: &[f64]) -> Vec<f64> {
        let mut right = momentum.to_vec();
        right.resize(prescribed.len(), 0.0);
        self.model.strains().for_each(|i| right[i] = 0.0);
        if !self.model.prescribed.is_empty() {
            let (same, n) = (&self.model.action.layout().same, momentum.len());
            for ((i, j), value) in same.entries().zip(&self.values) {
                if i < n || j < n {
                    right[i] -= value * prescribed[j];
                }
            }
            self.model.hold(&mut right);
        }
        right
    }

    fn solved(&mut self, right: &[f64]) -> Option<Vec<f64>> {
        self.tangent.factor(&self.values).ok()?;
        let mut rates = right.to_vec();
        self.tangent.solve(&mut rates);
        rates.truncate(self.model.action.map.coordinates);
        rates.iter().all(|rate| rate.is_finite()).then_some(rates)
    }

    /// The same in the null space of the constraints, from the shortest rates that meet them.
    fn within(&self, right: &[f64], n: usize) -> Option<Vec<f64>> {
        if n > DECOMPOSED || right.iter().any(|p| !p.is_finite()) {
            return None;
        }
        let mut mass = DMatrix::<f64>::zeros(n, n);
        let mut gradients = DMatrix::<f64>::zeros(n, self.model.action.map.multipliers);
        let entries = self.model.action.layout().same.entries();
        for ((i, j), &value) in entries.zip(&self.values) {
            match (i < n, j < n) {
                (true, true) => mass[(i, j)] += value,
                (true, false) if !self.model.is_prescribed(i) => gradients[(i, j - n)] += value,
                _ => {}
            }
        }
        let mut square = &gradients * gradients.transpose();
        let largest = square.amax();
        for one in &self.model.prescribed {
            square[(one.coordinate, one.coordinate)] = largest;
        }
        let square = SymmetricEigen::new(square);
        let least = DEPENDENT * square.eigenvalues.amax();
        let (free, held): (Vec<usize>, Vec<usize>) =
            (0..n).partition(|&i| square.eigenvalues[i] <= least);
        let of_constraints = &gradients * DVector::from_column_slice(&right[n..]);
        let mut met = DVector::<f64>::zeros(n);
        for i in held {
            let vector = square.eigenvectors.column(i);
            met += vector * (vector.dot(&of_constraints) / square.eigenvalues[i]);
        }
        let left = DVector::from_column_slice(&right[..n]) - &mass * &met;
        let basis = square.eigenvectors.select_columns(&free);
        let rates = rates_within(&mass, &basis, left.as_slice());
        Some(
            rates
                .iter()
                .zip(&met)
                .map(|(free, met)| free + met)
                .collect(),
        )
    }
}

/// Second derivatives of the kinetic energy by the rates of vectors, at rest at places `x`: the last of the four blocks of an
/// interval of length 1.
pub(super) fn masses(model: &Model, x: &[Vector]) -> Blocks {
    let action = &model.action.intervals;
    let mut out = action.output(Order::Hessian);
    let scalars = vec![0.0; action.scalars];
    let sample = Sample::of_instant(x, &scalars);
    for (term, slots) in action.terms() {
        if term.kind() == TermKind::Kinetic {
            term.evaluate(Order::Hessian, &sample, slots, &mut out);
        }
    }
    out.plain.blocks
}
