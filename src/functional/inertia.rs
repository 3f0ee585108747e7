//! Kinetic energy of point masses: the one effect whose second derivative never changes.

use crate::functional::{Couplings, Effect, Frame, Horizon, Kind, Level, Output};
use crate::math::Vector;

/// A mass on a material vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// Index of the vector.
    pub vector: usize,
    /// Mass in g; for a director the Euler inertia in g mm².
    pub mass: f64,
}

/// `Σ h ½ m |(x_{k+1} − x_k)/h|²`.
///
/// Every inertia of the scene is of this form: a body is its centre and three directors with E_i = ½(J_j + J_k − J_i),
/// a rod of mass m is its midpoint with m and its span with m/12.
#[derive(Clone, Debug)]
pub struct Inertia {
    name: String,
    masses: Vec<PointMass>,
    slots: Vec<usize>,
}

impl Inertia {
    /// Point masses under one name.
    pub fn new(name: &str, masses: Vec<PointMass>) -> Self {
        Self {
            name: name.to_owned(),
            masses,
            slots: Vec::new(),
        }
    }
}

impl Effect for Inertia {
    fn name(&self) -> &str {
        &self.name
    }

    fn elements(&self) -> usize {
        self.masses.len()
    }

    fn couple(&mut self, couplings: &mut Couplings) {
        self.slots = self
            .masses
            .iter()
            .map(|m| couplings.add_isotropic(m.vector, m.vector))
            .collect();
    }

    fn kind(&self) -> Kind {
        Kind::Kinetic
    }

    fn energy(&self, frame: &Frame<'_>) -> f64 {
        let [x, y] = frame.vectors;
        let square = |m: &PointMass| m.mass * (y[m.vector] - x[m.vector]).norm_squared();
        self.masses.iter().map(square).sum::<f64>() * 0.5 / (frame.h * frame.h)
    }

    fn momentum(&self, _x: &[Vector], v: &[Vector], out: &mut [Vector]) {
        for m in &self.masses {
            out[m.vector] += v[m.vector] * m.mass;
        }
    }

    fn evaluate(&self, level: Level, frame: &Frame<'_>, out: &mut Output) {
        let ([x, y], [wx, wy]) = (frame.vectors, frame.along);
        let r = 1.0 / frame.h;
        for (m, &slot) in self.masses.iter().zip(&self.slots) {
            let a = m.vector;
            let step = y[a] - x[a];
            let momentum = step * (m.mass * r);
            out.plain.forces[0][a] -= momentum;
            out.plain.forces[1][a] += momentum;
            if level >= Level::Hessian {
                let block = &mut out.plain.blocks.isotropic[slot];
                let c = m.mass * r;
                block[0] += c;
                block[1] -= c;
                block[2] -= c;
                block[3] += c;
                if frame.horizon == Horizon::Free {
                    out.plain.horizon_forces[0][a] += momentum * r;
                    out.plain.horizon_forces[1][a] -= momentum * r;
                }
            }
            if level == Level::Third {
                let step_w = wy[a] - wx[a];
                let momentum_w = step_w * (m.mass * r);
                out.contracted.forces[0][a] -= momentum_w;
                out.contracted.forces[1][a] += momentum_w;
                if frame.horizon == Horizon::Free {
                    out.contracted.horizon_forces[0][a] += momentum_w * r;
                    out.contracted.horizon_forces[1][a] -= momentum_w * r;
                    out.contracted.horizon += 2.0 * m.mass * step.dot(&step_w) * r * r * r;
                }
            }
        }
    }
}
