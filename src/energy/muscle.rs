//! The lumped muscle: a stack of equal cells that keep their volume, with one stretch.
//!
//! All through the polynomial invariant I = Λ² = |r|²/L₀² of the span r (docs/theory.md, 3.1 to 3.3).

use crate::energy::{Elasticity, Energy, NeoHooke, OfSquare, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Elastic energy of a muscle, of the neo-Hookean law `V₀ μ/2 (2/√I + I − 3)`, arguments: span r. Not finite for r = 0.
#[derive(Clone, Copy, Debug)]
pub struct ElasticCell<L = NeoHooke, T = f64> {
    /// Rest length L₀ in mm.
    pub length: T,
    /// Rest volume V₀ in mm³.
    pub volume: T,
    /// Shear modulus μ of small strains in MPa.
    pub shear_modulus: T,
    /// Law of elasticity.
    pub law: L,
}

law!(ElasticCell<L> { length, volume, shear_modulus, law } of 3);

impl<L: Elasticity<T>, T: Number> ElasticCell<L, T> {
    /// The energy as a function of I: value and three derivatives.
    #[inline(always)]
    fn of_squared_stretch(&self, i: T) -> [T; 4] {
        let law = &self.law;
        law.of_squared_stretch(self.shear_modulus, self.volume, i)
    }
}

impl<L: Elasticity<T>, T: Number> Energy<3, T> for ElasticCell<L, T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let scale = (self.length * self.length).recip();
        let none = |_| [T::zero(); 4];
        OfSquare::new(p, w, scale, |i| self.of_squared_stretch(i), none)
    }
}

/// Electro-elastic energy of a muscle, arguments: span r and voltage V. Not finite for r = 0.
///
/// `W = V₀ { μ/2 (2/√I + I − 3) + [c₁ + c₂ I − ε/(2I)] (V/t)² }`, or the energy of another law of elasticity; the charge on the electrodes
/// is −∂W/∂V.
#[derive(Clone, Copy, Debug)]
pub struct DielectricCell<L = NeoHooke, T = f64> {
    /// The elastic part.
    pub elastic: ElasticCell<L, T>,
    /// c₁ in N/V².
    pub c1: T,
    /// c₂ in N/V².
    pub c2: T,
    /// ε in N/V².
    pub permittivity: T,
    /// Layer thickness t in mm.
    pub layer: T,
}

law!(DielectricCell<L> { elastic, c1, c2, permittivity, layer } of 4);

impl<L, T: Number> DielectricCell<L, T> {
    /// Factor of (V/t)² V₀ as a function of I: value and three derivatives.
    #[inline(always)]
    pub(super) fn electric_of_squared_stretch(&self, i: T) -> [T; 4] {
        let k = self.elastic.volume.over(self.layer * self.layer);
        let r = i.recip();
        let e = self.permittivity * r;
        [
            k * (self.c1 + self.c2 * i - e.scaled(0.5)),
            k * (self.c2 + e.scaled(0.5) * r),
            -k * e * r * r,
            k.scaled(3.0) * e * r * r * r,
        ]
    }
}

impl<L: Elasticity<T>, T: Number> Energy<4, T> for DielectricCell<L, T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const OF_SQUARES: bool = true;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> OfSquare<T> {
        let elastic = |i| self.elastic.of_squared_stretch(i);
        let electric = |i| self.electric_of_squared_stretch(i);
        let scale = (self.elastic.length * self.elastic.length).recip();
        OfSquare::new(p, w, scale, elastic, electric)
    }
}

/// Kinetic energy of the changing cross-section, `½ ρ V₀ (X̂² + Ŷ²)/192 · İ² I^(−5/2)`, arguments: r̄ and ṙ.
#[derive(Clone, Copy, Debug)]
pub struct SectionInertia<T = f64> {
    /// Rest length L₀ in mm.
    pub length: T,
    /// ρ V₀ (X̂² + Ŷ²)/192 in g mm².
    pub moment: T,
}

law!(SectionInertia { length, moment } of 6);

impl<T: Number> Energy<6, T> for SectionInertia<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    const KINETIC: bool = true;
    const READINGS: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let scale = (self.length * self.length).recip();
        let i = Jet::dot(0, 0, p, w) * scale;
        let rate = Jet::dot(0, 3, p, w) * scale.scaled(2.0);
        let power = i.sqrt() * i.squared();
        rate.squared() * power.recip() * self.moment.scaled(0.5)
    }
}
