//! The lumped muscle: a stack of equal cells that keep their volume, with one stretch.
//!
//! All through the polynomial invariant I = Λ² = |r|²/L₀² of the span r (docs/theory.md, 3.1 to 3.3).

use crate::energy::Energy;
use crate::math::{Jet, Vector};
use nalgebra::SVector;

/// Elastic energy `V₀ μ/2 (2/√I + I − 3)` of a muscle, arguments: span r. Not finite for r = 0.
#[derive(Clone, Copy, Debug)]
pub struct ElasticCell {
    /// Rest length L₀ in mm.
    pub length: f64,
    /// Rest volume V₀ in mm³.
    pub volume: f64,
    /// Shear modulus μ in MPa.
    pub shear_modulus: f64,
}

impl ElasticCell {
    /// μ/2 V₀ (2/√I + I − 3) as a function of I: value and three derivatives.
    #[inline]
    fn of_squared_stretch(&self, i: f64) -> [f64; 4] {
        let c = 0.5 * self.shear_modulus * self.volume;
        let r = 1.0 / i;
        let s = r.sqrt();
        [
            c * (2.0 * s + i - 3.0),
            c * (1.0 - s * r),
            c * 1.5 * s * r * r,
            c * -3.75 * s * r * r * r,
        ]
    }
}

impl Energy<3> for ElasticCell {
    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> Jet<3, ORDER> {
        let i = Jet::dot(0, 0, p, w) * (1.0 / (self.length * self.length));
        i.map(self.of_squared_stretch(i.value))
    }
}

/// Electro-elastic energy of a muscle, arguments: span r and voltage V. Not finite for r = 0.
///
/// `W = V₀ { μ/2 (2/√I + I − 3) + [c₁ + c₂ I − ε/(2I)] (V/t)² }`; the charge on the electrodes is −∂W/∂V.
#[derive(Clone, Copy, Debug)]
pub struct DielectricCell {
    /// The elastic part.
    pub elastic: ElasticCell,
    /// c₁ in N/V².
    pub c1: f64,
    /// c₂ in N/V².
    pub c2: f64,
    /// ε in N/V².
    pub permittivity: f64,
    /// Layer thickness t in mm.
    pub layer: f64,
}

impl DielectricCell {
    /// Factor of (V/t)² V₀ as a function of I: value and three derivatives.
    #[inline]
    pub(super) fn electric_of_squared_stretch(&self, i: f64) -> [f64; 4] {
        let k = self.elastic.volume / (self.layer * self.layer);
        let r = 1.0 / i;
        let e = self.permittivity * r;
        [
            k * (self.c1 + self.c2 * i - 0.5 * e),
            k * (self.c2 + 0.5 * e * r),
            -k * e * r * r,
            3.0 * k * e * r * r * r,
        ]
    }
}

/// With u(I) + e(I) V² and I = |r|²/L₀² written out: `∂W/∂r = a r` with a = 2 W_I/L₀², `∂²W/∂r² = a 1 + b r rᵀ` with
/// b = 4 W_II/L₀⁴, `∂²W/∂r∂V = c r` with c = 2 W_IV/L₀², and the rates of a, b, c along w.
impl Energy<4> for DielectricCell {
    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> Jet<4, ORDER> {
        let s = 1.0 / (self.elastic.length * self.elastic.length);
        let (r, v) = (Vector::new(p[0], p[1], p[2]), p[3]);
        let i = r.norm_squared() * s;
        let u = self.elastic.of_squared_stretch(i);
        let e = self.electric_of_squared_stretch(i);
        let mut jet = Jet::constant(u[0] + e[0] * v * v);
        let a = 2.0 * s * (u[1] + e[1] * v * v);
        let grad = r * a;
        jet.gradient = [grad.x, grad.y, grad.z, 2.0 * e[0] * v].into();
        if ORDER >= 2 {
            let b = 4.0 * s * s * (u[2] + e[2] * v * v);
            let c = 4.0 * s * e[1] * v;
            for m in 0..3 {
                for n in 0..3 {
                    jet.hessian[(m, n)] = b * r[m] * r[n];
                }
                jet.hessian[(m, m)] += a;
                jet.hessian[(m, 3)] = c * r[m];
                jet.hessian[(3, m)] = c * r[m];
            }
            jet.hessian[(3, 3)] = 2.0 * e[0];
            if ORDER >= 3 {
                let (wr, wv) = (Vector::new(w[0], w[1], w[2]), w[3]);
                let iw = 2.0 * s * r.dot(&wr);
                let aw = 2.0 * s * ((u[2] + e[2] * v * v) * iw + 2.0 * e[1] * v * wv);
                let bw = 4.0 * s * s * ((u[3] + e[3] * v * v) * iw + 2.0 * e[2] * v * wv);
                let cw = 4.0 * s * (e[2] * v * iw + e[1] * wv);
                jet.value_w = jet.gradient.dot(w);
                jet.gradient_w = jet.hessian * w;
                for m in 0..3 {
                    for n in 0..3 {
                        jet.hessian_w[(m, n)] =
                            bw * r[m] * r[n] + b * (r[m] * wr[n] + wr[m] * r[n]);
                    }
                    jet.hessian_w[(m, m)] += aw;
                    jet.hessian_w[(m, 3)] = cw * r[m] + c * wr[m];
                    jet.hessian_w[(3, m)] = cw * r[m] + c * wr[m];
                }
                jet.hessian_w[(3, 3)] = 2.0 * e[1] * iw;
            }
        }
        jet
    }
}

/// Kinetic energy of the changing cross-section, `½ ρ V₀ (X̂² + Ŷ²)/192 · İ² I^(−5/2)`, arguments: r̄ and ṙ.
#[derive(Clone, Copy, Debug)]
pub struct SectionInertia {
    /// Rest length L₀ in mm.
    pub length: f64,
    /// ρ V₀ (X̂² + Ŷ²)/192 in g mm².
    pub moment: f64,
}

impl Energy<6> for SectionInertia {
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let scale = 1.0 / (self.length * self.length);
        let i = Jet::dot(0, 0, p, w) * scale;
        let rate = Jet::dot(0, 3, p, w) * (2.0 * scale);
        let power = i.sqrt() * i.squared();
        rate.squared() * power.recip() * (0.5 * self.moment)
    }
}
