//! Rates and momenta: of coordinates, of vectors, and of the whole system.

use crate::coordinates::{Configuration, Interval};
use crate::dynamics::discrete_trajectory::DiscreteTrajectory;
use crate::functional::{BlockMask, Order};
use crate::kinematics::{Carrier, MaterialVector, Pose};
use crate::math::Vector;
use crate::model::Model;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

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

/// Rates of the coordinates z with given momenta, those of prescribed ones at a time in ms; with nodes iterated for, as it is asked for
/// often.
pub fn rates_of_momentum(model: &Model, z: &[f64], time: f64, momentum: &[f64]) -> Vec<f64> {
    let map = &model.action.map;
    let decomposed = if map.of_nodes.is_empty() {
        DECOMPOSED
    } else {
        0
    };
    rates_by(model, &mut map.placed(z), time, momentum, decomposed)
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
    let interval = Interval {
        sides: BlockMask::FORWARD,
        ..Interval::given(scalars, discrete.times[k + 1] - discrete.times[k])
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
        for term in &vector.terms {
            let (place, total) = match term.carrier {
                Carrier::Body(body) => (term.at(&places.poses[body]), momentum + impulse),
                Carrier::Ground => (term.at(&Pose::GROUND), *momentum),
                // A vector that terms read holds no more than one node, and nothing else.
                Carrier::Node(_) => (*x, momentum + impulse),
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
        let mut instant = model.action.map.instant();
        instant.z.copy_from_slice(&z);
        model.action.map.place(&mut instant);
        let momentum = model.action.momentum(&mut instant, rates);
        Self {
            z,
            momentum,
            rates: Some(rates.to_vec()),
            time: 0.0,
        }
    }

    /// With the momentum of each coordinate.
    pub fn moving(model: &Model, z: Vec<f64>, momentum: Vec<f64>) -> Self {
        let mut instant = model.action.map.placed(&z);
        let rates = rates(model, &mut instant, 0.0, &momentum);
        Self {
            z,
            momentum,
            rates: Some(rates),
            time: 0.0,
        }
    }

    /// With a velocity of the centre of mass (mm/ms) and an angular velocity (rad/ms), both in the ground frame, of each body that is solved for;
    /// nodes rest. What the coordinates do not let move counts as an impulse on its supports.
    pub fn with_velocities(model: &Model, z: Vec<f64>, velocities: &[[Vector; 2]]) -> Self {
        let map = &model.action.map;
        let instant = map.placed(&z);
        let poses = model.condensed_poses(&instant);
        let rate = |vector: &MaterialVector| {
            let terms = vector.terms.iter().map(|term| match term.carrier {
                Carrier::Body(b) => {
                    let [velocity, spin] = velocities[b];
                    velocity * term.centre + spin.cross(&(poses[b].directors * term.directors))
                }
                _ => Vector::zeros(),
            });
            terms.sum()
        };
        let rates: Vec<Vector> = model.vectors.iter().map(rate).collect();
        let momenta = vector_momenta(model, &instant.x, &rates);
        let mut momentum = vec![0.0; model.coordinate_count()];
        map.pull_back(&instant.columns, &momenta, &mut momentum);
        Self {
            z,
            momentum,
            rates: None,
            time: 0.0,
        }
    }
}
