//! Kinetic energy of constant masses: the one term whose second derivative never changes.

use crate::functional::{
    BlockMask, Coupling, Horizon, NodeBlocks, Order, Output, Sample, Term, TermKind,
};
use crate::math::{Vector, compact_index};
use std::sync::Arc;

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
}

/// `h ½ Σ m_ij v_i·v_j`, v = (x_{k+1} − x_k)/h.
///
/// Every inertia of the scene is of this form: a body is its centre and three directors with E_i = ½(J_j + J_k − J_i),
/// a rod of mass m is its midpoint with m and its span with m/12, an elastic block has the consistent mass matrix of its
/// nodes.
#[derive(Clone, Debug)]
pub struct Inertia {
    name: String,
    masses: usize,
    entries: Vec<MassEntry>,
}

/// One entry of the mass matrix.
#[derive(Clone, Copy, Debug)]
struct MassEntry {
    row: u32,
    column: u32,
    mass: f64,
}

impl MassEntry {
    /// The two vectors.
    fn vectors(self) -> [usize; 2] {
        [self.row as usize, self.column as usize]
    }
}

impl Inertia {
    /// Masses under one name.
    pub fn new(name: &str, masses: Vec<Mass>) -> Self {
        let mut entries = Vec::new();
        for m in &masses {
            let [a, b] = m.vectors;
            let pairs = [(a, b), (b, a)];
            let count = if a == b { 1 } else { 2 };
            entries.extend(pairs[..count].iter().map(|&(row, column)| MassEntry {
                row: compact_index(row),
                column: compact_index(column),
                mass: m.mass,
            }));
        }
        Self {
            name: name.to_owned(),
            masses: masses.len(),
            entries,
        }
    }
}

impl Term for Inertia {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.masses
    }

    fn couple(&self, to: &mut dyn FnMut(Option<Coupling>)) {
        for [a, b] in self.entries.iter().map(|e| e.vectors()) {
            to(Some(Coupling::Isotropic(a, b)));
        }
    }

    fn reading(&self, is_meant: &dyn Fn(usize) -> bool) -> Option<Arc<dyn Term>> {
        let reads = |entry: &&MassEntry| entry.vectors().into_iter().any(is_meant);
        let entries: Vec<_> = self.entries.iter().filter(reads).copied().collect();
        let inertia = |entries: Vec<_>| Self {
            name: self.name.clone(),
            masses: entries.len(),
            entries,
        };
        (!entries.is_empty()).then(|| Arc::new(inertia(entries)) as Arc<dyn Term>)
    }

    fn kind(&self) -> TermKind {
        TermKind::Kinetic
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let [x, y] = sample.vectors;
        let product = |e: &MassEntry| {
            let [a, b] = e.vectors();
            e.mass * (y[a] - x[a]).dot(&(y[b] - x[b]))
        };
        self.entries.iter().map(product).sum::<f64>() * 0.5 / (sample.h * sample.h)
    }

    fn momentum(&self, _x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        for e in &self.entries {
            let [a, b] = e.vectors();
            out[a] += v[b] * e.mass;
        }
    }

    fn momentum_along(&self, _at: [&[Vector]; 2], by: [&[Vector]; 2], out: &mut [Vector]) {
        self.momentum(by[0], by[1], out);
    }

    fn evaluate(&self, order: Order, sample: &Sample<'_>, slots: &[u32], out: &mut Output) {
        let r = 1.0 / sample.h;
        let is_free = sample.horizon == Horizon::Free;
        let plain = &mut out.plain;
        self.add_momenta(sample.vectors, r, 1.0, &mut plain.forces);
        if order >= Order::Hessian {
            match &mut plain.nodes {
                Some(nodes) => self.add_to_nodes(r, sample.sides, nodes),
                None => self.add_blocks(r, sample.sides, slots, &mut plain.blocks.isotropic),
            }
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
    /// Adds ∓c m r (y − x) to the forces at both instants.
    fn add_momenta(
        &self,
        [x, y]: [&[Vector]; 2],
        r: f64,
        c: f64,
        [here, next]: &mut [Vec<Vector>; 2],
    ) {
        for e in &self.entries {
            let [a, b] = e.vectors();
            let momentum = (y[b] - x[b]) * (e.mass * r) * c;
            here[a] -= momentum;
            next[a] += momentum;
        }
    }

    /// Adds ±r m to the blocks that are asked for.
    fn add_blocks(&self, r: f64, mask: BlockMask, slots: &[u32], blocks: &mut [[f64; 4]]) {
        let factors = factors(r, mask);
        for (e, &slot) in self.entries.iter().zip(slots) {
            for (entry, factor) in blocks[slot as usize].iter_mut().zip(factors) {
                *entry += factor * e.mass;
            }
        }
    }

    /// Adds the sum of the blocks that are asked for to a matrix of nodes.
    fn add_to_nodes(&self, r: f64, mask: BlockMask, nodes: &mut NodeBlocks) {
        let factor: f64 = factors(r, mask).iter().sum();
        for e in &self.entries {
            let [a, b] = e.vectors();
            if let Some(pair) = nodes.pair(a, b) {
                nodes.add_isotropic(pair, factor * e.mass);
            }
        }
    }

    /// Adds 2 r³ Σ m_ij (y − x)_j·w_i of the differences y − x of the vectors and w of the direction.
    fn add_horizon(&self, r: f64, sample: &Sample<'_>, sum: &mut f64) {
        let [[x, y], [wx, wy]] = [sample.vectors, sample.along];
        for e in &self.entries {
            let [a, b] = e.vectors();
            *sum += 2.0 * e.mass * (y[b] - x[b]).dot(&(wy[a] - wx[a])) * r * r * r;
        }
    }
}

/// Factors ±r of the blocks that are asked for; zero of others.
fn factors(r: f64, mask: BlockMask) -> [f64; 4] {
    const SIGNS: [f64; 4] = [1.0, -1.0, -1.0, 1.0];
    let mut factors = [0.0; 4];
    for side in (0..4).filter(|&side| mask.blocks[side]) {
        factors[side] = SIGNS[side] * r;
    }
    factors
}
