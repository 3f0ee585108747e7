//! Kinetic energy of constant masses: the one term whose second derivative never changes.

use crate::functional::{Couplings, Horizon, Kind, Order, Output, Sample, Term};
use crate::math::Vector;

/// A mass m on a material vector, ½ m |ẋ|², or between two, m ẋ·ẏ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Indices of the vectors; the same twice for a point mass.
    pub vectors: [usize; 2],
    /// Mass in g; for a director the Euler inertia in g mm².
    pub mass: f64,
}

impl Mass {
    /// A mass on one vector.
    pub fn point(vector: usize, mass: f64) -> Self {
        Self {
            vectors: [vector; 2],
            mass,
        }
    }

    fn is_point(&self) -> bool {
        self.vectors[0] == self.vectors[1]
    }
}

/// `h ½ Σ m_ij v_i·v_j`, v = (x_{k+1} − x_k)/h.
///
/// Every inertia of the scene is of this form: a body is its centre and three directors with E_i = ½(J_j + J_k − J_i),
/// a rod of mass m is its midpoint with m and its span with m/12, an elastic block has the consistent mass matrix of its
/// nodes.
#[derive(Clone, Debug)]
pub struct Inertia {
    name: String,
    masses: Vec<Mass>,
}

impl Inertia {
    /// Masses under one name.
    pub fn new(name: &str, masses: Vec<Mass>) -> Self {
        Self {
            name: name.to_owned(),
            masses,
        }
    }
}

impl Term for Inertia {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.masses.len()
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for m in &self.masses {
            let slot = couplings.add_isotropic(m.vectors[0], m.vectors[1]);
            slots.extend([slot, couplings.transposed_isotropic(slot)].map(|slot| slot as u32));
        }
    }

    fn kind(&self) -> Kind {
        Kind::Kinetic
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let [x, y] = sample.vectors;
        let product = |m: &Mass| {
            let [a, b] = m.vectors;
            let once = m.mass * (y[a] - x[a]).dot(&(y[b] - x[b]));
            if m.is_point() { once } else { 2.0 * once }
        };
        self.masses.iter().map(product).sum::<f64>() * 0.5 / (sample.h * sample.h)
    }

    fn momentum(&self, _x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        for m in &self.masses {
            let [a, b] = m.vectors;
            out[a] += v[b] * m.mass;
            if !m.is_point() {
                out[b] += v[a] * m.mass;
            }
        }
    }

    fn evaluate(&self, order: Order, sample: &Sample<'_>, slots: &[u32], out: &mut Output) {
        for (m, slots) in self.masses.iter().zip(slots.chunks_exact(2)) {
            let [a, b] = m.vectors;
            add(order, sample, m.mass, [a, b], slots[0] as usize, out);
            if !m.is_point() {
                add(order, sample, m.mass, [b, a], slots[1] as usize, out);
            }
        }
    }
}

/// The rows of vector `a` against the rate of vector `b`.
#[inline]
fn add(
    order: Order,
    sample: &Sample<'_>,
    mass: f64,
    [a, b]: [usize; 2],
    slot: usize,
    out: &mut Output,
) {
    let ([x, y], [wx, wy]) = (sample.vectors, sample.along);
    let r = 1.0 / sample.h;
    let step = y[b] - x[b];
    let momentum = step * (mass * r);
    out.plain.forces[0][a] -= momentum;
    out.plain.forces[1][a] += momentum;
    if order >= Order::Hessian {
        let block = &mut out.plain.blocks.isotropic[slot];
        let c = mass * r;
        block[0] += c;
        block[1] -= c;
        block[2] -= c;
        block[3] += c;
        if sample.horizon == Horizon::Free {
            out.plain.horizon_forces[0][a] += momentum * r;
            out.plain.horizon_forces[1][a] -= momentum * r;
        }
    }
    if order == Order::Third {
        let momentum_w = (wy[b] - wx[b]) * (mass * r);
        out.contracted.forces[0][a] -= momentum_w;
        out.contracted.forces[1][a] += momentum_w;
        if sample.horizon == Horizon::Free {
            out.contracted.horizon_forces[0][a] += momentum_w * r;
            out.contracted.horizon_forces[1][a] -= momentum_w * r;
            let step_w = wy[a] - wx[a];
            out.contracted.horizon += 2.0 * mass * step.dot(&step_w) * r * r * r;
        }
    }
}
