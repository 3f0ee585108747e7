//! Rates and momenta: of coordinates, of vectors, and of the whole system.
//!
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
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::dynamics::trajectory::DiscreteTrajectory;
use crate::functional::{BlockMask, Blocks, Order, Sample, SumDerivatives, TermKind};
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm};
use crate::math::Vector;
use crate::model::Model;
use crate::sparse::Symmetry;
use nalgebra::{DMatrix, DVector, Dyn, SymmetricEigen};

/// Eigenvalues of the mass matrix below this fraction of the largest belong to coordinates without inertia.
const MASSLESS: f64 = 1e-13;
/// Number of coordinates up to which the mass matrix is decomposed.
pub(super) const DECOMPOSED: usize = 500;
/// The residual of rates that are iterated for, relative to the momenta.
const LEFT: f64 = 1e-13;

/// Rates of the coordinates with given momenta at a placed instant, those of prescribed ones at a time in ms; coordinates without
/// inertia rest.
pub(super) fn rates(
    model: &Model,
    instant: &mut Configuration,
    time: f64,
    momentum: &[f64],
) -> Vec<f64> {
    rates_by(model, instant, time, momentum, DECOMPOSED)
}

/// The same, with a mass matrix that is decomposed up to a number of coordinates.
fn rates_by(
    model: &Model,
    instant: &mut Configuration,
    time: f64,
    momentum: &[f64],
    decomposed: usize,
) -> Vec<f64> {
    if model.prescribed.is_empty() {
        return free_rates(model, instant, momentum, decomposed);
    }
    let mut rates = vec![0.0; momentum.len()];
    model.prescribe_rates(time, &mut rates);
    let carried = model.action.momentum(instant, &rates);
    let mut left: Vec<f64> = momentum.iter().zip(carried).map(|(p, c)| p - c).collect();
    model.hold(&mut left);
    for (rate, free) in rates
        .iter_mut()
        .zip(free_rates(model, instant, &left, decomposed))
    {
        *rate += free;
    }
    rates
}

/// Rates of the coordinates z with given momenta that meet the constraints, those of prescribed ones at a time in ms; with nodes iterated for, as
/// it is asked for often.
pub fn rates_of_momentum(model: &Model, z: &[f64], time: f64, momentum: &[f64]) -> Vec<f64> {
    let map = &model.action.map;
    let decomposed = if map.of_nodes.is_empty() {
        DECOMPOSED
    } else {
        0
    };
    let instant = &mut map.placed(z);
    let within = match map.multipliers {
        0 => None,
        _ => Kinetic::new(model).rates(instant, time, momentum),
    };
    within.unwrap_or_else(|| rates_by(model, instant, time, momentum, decomposed))
}

/// The same where what is prescribed rests and has no momentum.
fn free_rates(
    model: &Model,
    instant: &mut Configuration,
    momentum: &[f64],
    decomposed: usize,
) -> Vec<f64> {
    let n = momentum.len();
    if momentum.iter().all(|&p| p == 0.0) {
        return vec![0.0; n];
    }
    let mut momentum = momentum.to_vec();
    let mut is_free: Vec<bool> = (0..n).map(|i| !model.is_prescribed(i)).collect();
    let mut inert = n;
    for i in model.strains() {
        (is_free[i], momentum[i]) = (false, 0.0);
        inert -= 1;
    }
    if inert > decomposed {
        return iterated(model, instant, &momentum);
    }
    let free: Vec<usize> = (0..n).filter(|&i| is_free[i]).collect();
    let mut mass = DMatrix::<f64>::zeros(free.len(), free.len());
    let mut unit = vec![0.0; n];
    for (mut column, &i) in mass.column_iter_mut().zip(&free) {
        unit[i] = 1.0;
        let of_unit = model.action.momentum(instant, &unit);
        for (entry, &row) in column.iter_mut().zip(&free) {
            *entry = of_unit[row];
        }
        unit[i] = 0.0;
    }
    let basis = DMatrix::identity(free.len(), free.len());
    let momenta: Vec<f64> = free.iter().map(|&i| momentum[i]).collect();
    let mut rates = vec![0.0; n];
    for (&i, rate) in free.iter().zip(rates_within(&mass, &basis, &momenta)) {
        rates[i] = rate;
    }
    rates
}

/// Rates with given momenta of a mass matrix, within the span of a basis with orthonormal columns.
pub(super) fn rates_within(
    mass: &DMatrix<f64>,
    basis: &DMatrix<f64>,
    momentum: &[f64],
) -> Vec<f64> {
    if basis.ncols() == 0 {
        return vec![0.0; momentum.len()];
    }
    let p = basis.tr_mul(&DVector::from_column_slice(momentum));
    let SymmetricEigen {
        eigenvectors: q,
        eigenvalues,
    } = SymmetricEigen::new(basis.tr_mul(&(mass * basis)));
    let smallest = MASSLESS * eigenvalues.amax();
    let mut modes = q.tr_mul(&p);
    for (mode, &value) in modes.iter_mut().zip(&eigenvalues) {
        *mode = if value > smallest { *mode / value } else { 0.0 };
    }
    (basis * (q * modes)).iter().copied().collect()
}

/// The same by conjugate gradients in coordinates relative to their sizes, for the well-conditioned masses of many nodes.
fn iterated(model: &Model, instant: &mut Configuration, momentum: &[f64]) -> Vec<f64> {
    let n = momentum.len();
    let sizes = DVector::from_vec(model.sizes()[..n].to_vec());
    let mut of = |direction: &DVector<f64>| {
        let rates = direction.component_mul(&sizes);
        let mut momentum = model.action.momentum(instant, rates.as_slice());
        model.hold(&mut momentum);
        DVector::from_vec(momentum).component_mul(&sizes)
    };
    let mut residual = DVector::from_column_slice(momentum).component_mul(&sizes);
    let mut rates = DVector::zeros(n);
    let mut direction = residual.clone();
    let mut squared = residual.norm_squared();
    let enough = LEFT * LEFT * squared;
    for _ in 0..n {
        if squared <= enough {
            break;
        }
        let moved = of(&direction);
        let length = squared / direction.dot(&moved);
        rates.axpy(length, &direction, 1.0);
        residual.axpy(-length, &moved, 1.0);
        let before = std::mem::replace(&mut squared, residual.norm_squared());
        direction = &residual + direction * (squared / before);
    }
    rates.component_mul(&sizes).iter().copied().collect()
}

/// Momentum `P_Nᵀ (D₂L_d + f⁺)` of each coordinate at the end of the last interval of a motion by the midpoint rule; none of a motion without an
/// interval, or where it is not finite.
pub fn last_momentum(model: &Model, discrete: &DiscreteTrajectory) -> Option<Vec<f64>> {
    let (scalars, k) = (discrete.scalars.last()?, discrete.intervals() - 1);
    let action = &model.action;
    let mut ends = [k, k + 1].map(|k| action.map.placed(&discrete.z[k]));
    let mut scratch = action.scratch(Order::Gradient);
    let interval = Sample {
        sides: BlockMask::FORWARD,
        ..Sample::of_interval(scalars, discrete.times[k + 1] - discrete.times[k])
    };
    let [here, next] = &mut ends;
    action.evaluate_interval(Order::Gradient, [here, next], &interval, &mut scratch);
    let mut momentum = vec![0.0; action.map.coordinates];
    let forces = &scratch.interval.plain.forces[1];
    action.map.pull_back(&next.columns, forces, &mut momentum);
    momentum.iter().all(|p| p.is_finite()).then_some(momentum)
}

/// Momenta ∂T/∂ẋ of all vectors at a placed instant with these rates of the coordinates.
pub(super) fn moving(model: &Model, instant: &mut Configuration, rates: &[f64]) -> Vec<Vector> {
    instant.l.fill(0.0);
    instant.l[..rates.len()].copy_from_slice(rates);
    model.action.map.along(instant);
    vector_momenta(model, &instant.x, &instant.w)
}

/// Momenta ∂T/∂ẋ of vectors x with rates v.
pub(super) fn vector_momenta(model: &Model, x: &[Vector], v: &[Vector]) -> Vec<Vector> {
    let mut momenta = vec![Vector::zeros(); x.len()];
    for term in &model.action.intervals.terms {
        term.momentum(x, v, &mut momenta);
    }
    momenta
}

/// Positions of bodies and vectors.
pub(super) struct Places<'a> {
    pub(super) poses: &'a [Pose],
    pub(super) x: &'a [Vector],
    pub(super) pulls: &'a [[Vector; 2]],
}

/// Linear momentum Σ c π and angular momentum about the origin Σ x × π of a list of momenta π of vectors x, with c the part
/// of a translation that x takes: 1 for a point, 0 for a direction or a span. Momenta of masses count with the whole of
/// their vectors, impulses of forces with the part on bodies: what pulls at the ground does not move the system. A force on a
/// joint coordinate pulls at both bodies of the joint.
pub(super) fn momentum_maps(
    vectors: &[MaterialVector],
    places: &Places<'_>,
    momenta: &[Vector],
    impulses: &[Vector],
) -> [Vector; 2] {
    let (mut linear, mut angular) = (Vector::zeros(), Vector::zeros());
    let each = vectors
        .iter()
        .zip(places.x)
        .zip(momenta.iter().zip(impulses));
    for ((vector, x), (momentum, impulse)) in each {
        // What is left of the place for nodes.
        let mut of_nodes = *x;
        for term in &vector.terms {
            let (place, total) = match term.carrier {
                Carrier::Body(body) => (term.at(&places.poses[body]), momentum + impulse),
                Carrier::Ground => (term.at(&Pose::GROUND), *momentum),
                Carrier::Node(_) => {
                    linear += (momentum + impulse) * term.centre;
                    continue;
                }
                Carrier::Coordinate(coordinate) => {
                    let Some([force, torque]) = places.pulls.get(coordinate) else {
                        continue;
                    };
                    linear += force * impulse.x;
                    angular += torque * impulse.x;
                    continue;
                }
            };
            linear += total * term.centre;
            angular += place.cross(&total);
            of_nodes -= place;
        }
        let is_node = |term: &VectorTerm| matches!(term.carrier, Carrier::Node(_));
        if vector.terms.iter().any(is_node) {
            angular += of_nodes.cross(&(momentum + impulse));
        }
    }
    [linear, angular]
}

/// Start of a motion: coordinates z and the momentum of each coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Momenta.
    pub momentum: Vec<f64>,
    /// Rates of the coordinates, where the momenta were made of them.
    pub rates: Option<Vec<f64>>,
    /// Time in ms to which prescribed motions have come.
    pub time: f64,
}

impl Start {
    /// At rest.
    pub fn at_rest(model: &Model, z: Vec<f64>) -> Self {
        Self {
            z,
            momentum: vec![0.0; model.coordinate_count()],
            rates: None,
            time: 0.0,
        }
    }

    /// With given rates of the coordinates.
    pub fn with_rates(model: &Model, z: Vec<f64>, rates: &[f64]) -> Self {
        let mut instant = model.action.map.placed(&z);
        let momentum = model.action.momentum(&mut instant, rates);
        Self {
            momentum,
            rates: Some(rates.to_vec()),
            ..Self::at_rest(model, z)
        }
    }

    /// With the momentum of each coordinate.
    pub fn moving(model: &Model, z: Vec<f64>, momentum: Vec<f64>) -> Self {
        let mut instant = model.action.map.placed(&z);
        let rates = rates(model, &mut instant, 0.0, &momentum);
        Self {
            momentum,
            rates: Some(rates),
            ..Self::at_rest(model, z)
        }
    }
}

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
        Some(constrained(&mass, &gradients, [&right[..n], &values]))
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
    mass: &DMatrix<f64>,
    gradients: &DMatrix<f64>,
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
