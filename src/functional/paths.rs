//! Functions of the length of a path of any number of spans: `−h W(L)`, L = Σ |r̄ᵢ|, at the midpoint of an interval.
//!
//! With the directions uᵢ = r̄ᵢ/|r̄ᵢ| and Kᵢ = (1 − uᵢ uᵢᵀ)/|r̄ᵢ|
//!
//! ```text
//! ∂W/∂rᵢ = W′ uᵢ,     ∂²W/∂rᵢ∂rⱼ = W″ uᵢ uⱼᵀ + δᵢⱼ W′ Kᵢ,
//! ```
//!
//! and along w, where W‴ = 0, with L_w = Σ uᵢ·wᵢ and the rates u̇ᵢ = Kᵢ wᵢ, K̇ᵢ = −(u̇ᵢ uᵢᵀ + uᵢ u̇ᵢᵀ + (uᵢ·wᵢ) Kᵢ)/|r̄ᵢ|:
//!
//! ```text
//! (∂²W)˙ᵢⱼ = W″ (u̇ᵢ uⱼᵀ + uᵢ u̇ⱼᵀ) + δᵢⱼ (W″ L_w Kᵢ + W′ K̇ᵢ).
//! ```

use crate::energy::Cable;
use crate::functional::{Couplings, Horizon, Kind, Order, Output, Part, Sample, Term};
use crate::math::{Matrix, Vector};

/// A path and the energy of its length.
#[derive(Clone, Debug)]
pub struct Path {
    /// The energy.
    pub energy: Cable,
    /// Vectors of the spans, one after the other.
    pub spans: Vec<usize>,
}

/// Paths under one name.
#[derive(Clone, Debug)]
pub struct Paths {
    name: String,
    paths: Vec<Path>,
}

/// A span at the midpoint of an interval, and its rates along the direction.
struct Span {
    /// r̄/|r̄|.
    direction: Vector,
    /// |r̄|.
    length: f64,
    /// Rate of the direction.
    turn: Vector,
    /// Rate of the length.
    stretch: f64,
}

impl Span {
    fn new(vector: usize, level: Order, frame: &Sample<'_>) -> Self {
        let middle = |v: [&[Vector]; 2]| (v[0][vector] + v[1][vector]) * 0.5;
        let r = middle(frame.vectors);
        let length = r.norm();
        let direction = r / length;
        let w = match level {
            Order::Third => middle(frame.along),
            _ => Vector::zeros(),
        };
        let stretch = direction.dot(&w);
        Self {
            direction,
            length,
            turn: (w - direction * stretch) / length,
            stretch,
        }
    }

    /// Second derivative of the length.
    fn curvature(&self) -> Matrix {
        let u = &self.direction;
        (Matrix::identity() - u * u.transpose()) / self.length
    }

    /// Its rate along the direction.
    fn curvature_rate(&self) -> Matrix {
        let (u, t) = (&self.direction, &self.turn);
        let turned = t * u.transpose();
        -(turned + turned.transpose() + self.curvature() * self.stretch) / self.length
    }
}

impl Path {
    fn length(&self, frame: &Sample<'_>) -> f64 {
        let spans = self.spans.iter();
        spans
            .map(|&v| ((frame.vectors[0][v] + frame.vectors[1][v]) * 0.5).norm())
            .sum()
    }

    /// Adds `−h` times the forces, and by the length of the interval.
    fn add_force(frame: &Sample<'_>, vector: usize, force: &Vector, part: &mut Part) {
        for side in 0..2 {
            part.forces[side][vector] -= force * (0.5 * frame.h);
            if frame.horizon == Horizon::Free {
                part.horizon_forces[side][vector] -= force * 0.5;
            }
        }
    }

    fn add_block(frame: &Sample<'_>, slot: u32, block: &Matrix, part: &mut Part) {
        let to = &mut part.blocks.full[slot as usize];
        for side in (0..4).filter(|&side| frame.sides.blocks[side]) {
            to[side] -= block * (0.25 * frame.h);
        }
    }

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        let [_, tension, stiffness] = self.energy.of_length(self.length(frame));
        if tension == 0.0 {
            return;
        }
        let span = |&vector: &usize| Span::new(vector, level, frame);
        let stretch: f64 = match level {
            Order::Third => self.spans.iter().map(|v| span(v).stretch).sum(),
            _ => 0.0,
        };
        let rows = slots.chunks_exact(self.spans.len());
        for ((i, v), row) in self.spans.iter().enumerate().zip(rows) {
            let a = span(v);
            Self::add_force(frame, *v, &(a.direction * tension), &mut out.plain);
            if level == Order::Third {
                let rate = a.direction * (stiffness * stretch) + a.turn * tension;
                Self::add_force(frame, *v, &rate, &mut out.contracted);
            }
            if level < Order::Hessian {
                continue;
            }
            for ((j, other), &slot) in self.spans.iter().enumerate().zip(row) {
                let b = span(other);
                let (u, v) = (&a.direction, b.direction.transpose());
                let mut block = u * v * stiffness;
                if i == j {
                    block += a.curvature() * tension;
                }
                Self::add_block(frame, slot, &block, &mut out.plain);
                if level == Order::Third {
                    let mut rate = (a.turn * v + u * b.turn.transpose()) * stiffness;
                    if i == j {
                        rate += a.curvature() * (stiffness * stretch);
                        rate += a.curvature_rate() * tension;
                    }
                    Self::add_block(frame, slot, &rate, &mut out.contracted);
                }
            }
        }
    }
}

impl Paths {
    /// Paths under one name.
    pub fn new(name: &str, paths: Vec<Path>) -> Self {
        Self {
            name: name.to_owned(),
            paths,
        }
    }
}

impl Term for Paths {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.paths.len()
    }

    fn couple(&self, couplings: &mut Couplings, slots: &mut Vec<u32>) {
        for Path { spans, .. } in &self.paths {
            for &a in spans {
                slots.extend(spans.iter().map(|&b| couplings.add_full(a, b) as u32));
            }
        }
    }

    fn kind(&self) -> Kind {
        Kind::Potential
    }

    fn energy(&self, frame: &Sample<'_>) -> f64 {
        let energy = |path: &Path| path.energy.of_length(path.length(frame))[0];
        self.paths.iter().map(energy).sum()
    }

    fn momentum(&self, _x: &[Vector], _v: &[Vector], _out: &mut [Vector]) {}

    fn evaluate(&self, level: Order, frame: &Sample<'_>, slots: &[u32], out: &mut Output) {
        let mut slots = slots;
        for path in &self.paths {
            let (own, rest) = slots.split_at(path.spans.len() * path.spans.len());
            path.evaluate(level, frame, own, out);
            slots = rest;
        }
    }
}
