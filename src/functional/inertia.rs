//! Kinetic energy of constant masses: the one term whose second derivative never changes.

use crate::functional::{BlockMask, Couplings, Horizon, Kind, Order, Output, Sample, Term};
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
        let r = 1.0 / sample.h;
        let is_free = sample.horizon == Horizon::Free;
        let plain = &mut out.plain;
        self.add_momenta(sample.vectors, r, 1.0, &mut plain.forces);
        if order >= Order::Hessian {
            self.add_blocks(r, sample.sides, slots, &mut plain.blocks.isotropic);
            if is_free {
                self.add_momenta(sample.vectors, r, -r, &mut plain.horizon_forces);
            }
        }
        if order == Order::Third {
            let along = &mut out.contracted;
            self.add_momenta(sample.along, r, 1.0, &mut along.forces);
            if is_free {
                self.add_momenta(sample.along, r, -r, &mut along.horizon_forces);
                self.add_horizon(r, sample, &mut along.horizon);
            }
        }
    }
}

impl Inertia {
    /// Each row of the mass matrix, by its vector, with the other vector and the mass.
    #[inline(always)]
    fn each_row(&self, mut row: impl FnMut(usize, usize, f64)) {
        for m in &self.masses {
            let [a, b] = m.vectors;
            let rows = [(a, b), (b, a)];
            let count = if m.is_point() { 1 } else { 2 };
            for &(a, b) in &rows[..count] {
                row(a, b, m.mass);
            }
        }
    }

    /// Adds ∓c m r (y − x) to the forces at both instants.
    fn add_momenta(
        &self,
        [x, y]: [&[Vector]; 2],
        r: f64,
        c: f64,
        [here, next]: &mut [Vec<Vector>; 2],
    ) {
        self.each_row(|a, b, mass| {
            let momentum = (y[b] - x[b]) * (mass * r) * c;
            here[a] -= momentum;
            next[a] += momentum;
        });
    }

    /// Adds ±r m to the blocks that are asked for.
    fn add_blocks(&self, r: f64, mask: BlockMask, slots: &[u32], blocks: &mut [[f64; 4]]) {
        const SIGNS: [f64; 4] = [1.0, -1.0, -1.0, 1.0];
        for side in (0..4).filter(|&side| mask.blocks[side]) {
            for (m, slots) in self.masses.iter().zip(slots.chunks_exact(2)) {
                let c = SIGNS[side] * (m.mass * r);
                blocks[slots[0] as usize][side] += c;
                if !m.is_point() {
                    blocks[slots[1] as usize][side] += c;
                }
            }
        }
    }

    /// Adds 2 r³ Σ m_ij (y − x)_j·w_i of the differences y − x of the vectors and w of the direction.
    fn add_horizon(&self, r: f64, sample: &Sample<'_>, sum: &mut f64) {
        let [[x, y], [wx, wy]] = [sample.vectors, sample.along];
        self.each_row(|a, b, mass| {
            *sum += 2.0 * mass * (y[b] - x[b]).dot(&(wy[a] - wx[a])) * r * r * r;
        });
    }
}
