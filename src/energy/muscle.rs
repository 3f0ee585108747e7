//! The lumped muscle: a stack of equal cells that keep their volume, with one stretch.
//!
//! All through the polynomial invariant I = Λ² = |r|²/L₀² of the span r (docs/theory.md, 3.1 to 3.3).

use crate::energy::{Elasticity, Energy, NeoHooke, OfSquare};
use crate::math::Jet;
use nalgebra::SVector;

/// Elastic energy of a muscle, of the neo-Hookean law `V₀ μ/2 (2/√I + I − 3)`, arguments: span r. Not finite for r = 0.
#[derive(Clone, Copy, Debug)]
pub struct ElasticCell<L = NeoHooke> {
    /// Rest length L₀ in mm.
    pub length: f64,
    /// Rest volume V₀ in mm³.
    pub volume: f64,
    /// Shear modulus μ of small strains in MPa.
    pub shear_modulus: f64,
    /// Law of elasticity.
    pub law: L,
}

impl<L: Elasticity> ElasticCell<L> {
    /// The energy as a function of I: value and three derivatives.
    #[inline(always)]
    fn of_squared_stretch(&self, i: f64) -> [f64; 4] {
        let law = &self.law;
        law.of_squared_stretch(self.shear_modulus, self.volume, i)
    }
}

impl<L: Elasticity> Energy<3> for ElasticCell<L> {
    type Local<const ORDER: usize> = OfSquare;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> OfSquare {
        let scale = 1.0 / (self.length * self.length);
        OfSquare::new((p, w), scale, |i| self.of_squared_stretch(i), |_| [0.0; 4])
    }
}

/// Electro-elastic energy of a muscle, arguments: span r and voltage V. Not finite for r = 0.
///
/// `W = V₀ { μ/2 (2/√I + I − 3) + [c₁ + c₂ I − ε/(2I)] (V/t)² }`, or the energy of another law of elasticity; the charge on the electrodes
/// is −∂W/∂V.
#[derive(Clone, Copy, Debug)]
pub struct DielectricCell<L = NeoHooke> {
    /// The elastic part.
    pub elastic: ElasticCell<L>,
    /// c₁ in N/V².
    pub c1: f64,
    /// c₂ in N/V².
    pub c2: f64,
    /// ε in N/V².
    pub permittivity: f64,
    /// Layer thickness t in mm.
    pub layer: f64,
}

impl<L> DielectricCell<L> {
    /// Factor of (V/t)² V₀ as a function of I: value and three derivatives.
    #[inline(always)]
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

impl<L: Elasticity> Energy<4> for DielectricCell<L> {
    type Local<const ORDER: usize> = OfSquare;

    const OF_SQUARES: bool = true;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> OfSquare {
        let elastic = |i| self.elastic.of_squared_stretch(i);
        let electric = |i| self.electric_of_squared_stretch(i);
        let scale = 1.0 / (self.elastic.length * self.elastic.length);
        OfSquare::new((p, w), scale, elastic, electric)
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
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    const READINGS: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let scale = 1.0 / (self.length * self.length);
        let i = Jet::dot(0, 0, p, w) * scale;
        let rate = Jet::dot(0, 3, p, w) * (2.0 * scale);
        let power = i.sqrt() * i.squared();
        rate.squared() * power.recip() * (0.5 * self.moment)
    }
}
