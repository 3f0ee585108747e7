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
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

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
        self.assemble(instant);
        let mut prescribed = vec![0.0; self.model.action.map.unknowns()];
        self.model.prescribe_rates(time, &mut prescribed);
        let right = self.without(momentum, &prescribed);
        let found = self.solved(&right);
        let mut rates = found.or_else(|| self.within(&right, momentum.len()))?;
        for (rate, prescribed) in rates.iter_mut().zip(prescribed) {
            *rate += prescribed;
        }
        Some(rates)
    }

    /// Evaluates masses and gradients of constraints at a placed instant.
    pub(super) fn assemble(&mut self, instant: &mut Configuration) {
        let action = &self.model.action;
        self.values.fill(0.0);
        // The gradients of the constraints alone: neither forces nor multipliers bend them.
        let mut bare = instant.clone();
        bare.z[action.map.coordinates..action.map.unknowns()].fill(0.0);
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
    }

    /// Right-hand sides of what is not prescribed: momenta and constraints, less those of the prescribed rates.
    pub(super) fn without(&self, momentum: &[f64], prescribed: &[f64]) -> Vec<f64> {
        let mut right = momentum.to_vec();
        right.resize(prescribed.len(), 0.0);
        if !self.model.prescribed.is_empty() {
            let (same, n) = (&self.model.action.layout().same, momentum.len());
            for ((i, j), value) in same.entries().zip(&self.values) {
                if i < n || j < n {
                    right[i] -= value * prescribed[j];
                }
            }
        }
        self.hold(&mut right);
        right
    }

    /// Lets a right-hand side do nothing to coordinates that are prescribed or have no inertia.
    pub(super) fn hold(&self, right: &mut [f64]) {
        self.model.strains().for_each(|i| right[i] = 0.0);
        self.model.hold(right);
    }

    fn solved(&mut self, right: &[f64]) -> Option<Vec<f64>> {
        self.factor()?;
        self.solve(right)
    }

    /// Factorises the bordered masses; `None` where they have no inverse.
    pub(super) fn factor(&mut self) -> Option<()> {
        self.tangent.factor(&self.values).ok()
    }

    /// Rates that solve the factorised equations; `None` where they are not finite.
    pub(super) fn solve(&mut self, right: &[f64]) -> Option<Vec<f64>> {
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
        let (mass, mut gradients) = self.dense(n);
        let prescribed = &self.model.prescribed;
        let largest = gradients.amax().max(1.0);
        for one in prescribed {
            gradients.row_mut(one.coordinate).fill(0.0);
        }
        let met = gradients.ncols();
        gradients = gradients.insert_columns(met, prescribed.len(), 0.0);
        for (column, one) in (met..).zip(prescribed) {
            gradients[(one.coordinate, column)] = largest;
        }
        let mut values = right[n..].to_vec();
        values.resize(gradients.ncols(), 0.0);
        Some(constrained((&mass, &gradients), [&right[..n], &values]))
    }

    /// Masses, and the gradients of the constraints as columns, of all `n` coordinates.
    fn dense(&self, n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let mut mass = DMatrix::<f64>::zeros(n, n);
        let mut gradients = DMatrix::<f64>::zeros(n, self.model.action.map.multipliers);
        let entries = self.model.action.layout().same.entries();
        for ((i, j), &value) in entries.zip(&self.values) {
            match (i < n, j < n) {
                (true, true) => mass[(i, j)] += value,
                (true, false) => gradients[(i, j - n)] += value,
                _ => {}
            }
        }
        (mass, gradients)
    }

    /// The same of systems that are small enough for it.
    pub(super) fn small(&self) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let n = self.model.coordinate_count();
        (n <= DECOMPOSED).then(|| self.dense(n))
    }

    /// Zero for each coordinate, then the rates of the constraints with rates of the coordinates.
    pub(super) fn opening(&self, rates: &[f64]) -> Vec<f64> {
        let n = rates.len();
        let mut sums = vec![0.0; self.model.action.map.unknowns()];
        let entries = self.model.action.layout().same.entries();
        for ((i, j), value) in entries.zip(&self.values) {
            if i < n && j >= n {
                sums[j] += value * rates[i];
            }
        }
        sums
    }

    /// Rates of the constraints with rates of the coordinates, each relative to the size of its gradient.
    pub(super) fn of_constraints(&self, rates: &[f64]) -> Vec<f64> {
        let n = rates.len();
        let mut squares = vec![f64::MIN_POSITIVE; self.model.action.map.unknowns()];
        let entries = self.model.action.layout().same.entries();
        for ((i, j), value) in entries.zip(&self.values) {
            if i < n && j >= n {
                squares[j] += value * value;
            }
        }
        let opening = self.opening(rates);
        let both = opening[n..].iter().zip(&squares[n..]);
        both.map(|(rate, square)| rate / square.sqrt()).collect()
    }
}

/// The v of least ½ vᵀM v − pᵀv with Gᵀv = g, or the least squares of it where constraints contradict each other; G has columns.
pub(super) fn constrained(
    (mass, gradients): (&DMatrix<f64>, &DMatrix<f64>),
    [momentum, values]: [&[f64]; 2],
) -> Vec<f64> {
    let n = mass.nrows();
    let (square, [free, held]) = directions(gradients);
    let of_constraints = gradients * DVector::from_column_slice(values);
    let mut met = DVector::<f64>::zeros(n);
    for i in held {
        let vector = square.eigenvectors.column(i);
        met += vector * (vector.dot(&of_constraints) / square.eigenvalues[i]);
    }
    let left = DVector::from_column_slice(momentum) - mass * &met;
    let basis = square.eigenvectors.select_columns(&free);
    let rates = rates_within(mass, &basis, left.as_slice());
    rates
        .iter()
        .zip(&met)
        .map(|(free, met)| free + met)
        .collect()
}

/// Eigenvectors of G Gᵀ, and which of them the constraints leave free and hold.
pub(super) fn directions(gradients: &DMatrix<f64>) -> (SymmetricEigen<f64, Dyn>, [Vec<usize>; 2]) {
    let square = SymmetricEigen::new(gradients * gradients.transpose());
    let least = DEPENDENT * square.eigenvalues.amax();
    let all = 0..gradients.nrows();
    let (free, held) = all.partition(|&i| square.eigenvalues[i] <= least);
    (square, [free, held])
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
