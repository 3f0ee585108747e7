//! The lumped muscle with constants that are arguments: the formulas of `muscle` and `viscosity`, written once for all of them.
//!
//! Arguments: vectors, three each, then scalars; each constant says on which of them it depends.

use crate::energy::along_span::of_invariants;
use crate::energy::{Affine, SoughtEnergy};
use crate::math::Jet;
use nalgebra::SVector;

/// Geometry at rest: span L in mm and both sides of the cross-section in mm.
#[derive(Clone, Debug)]
pub struct SoughtShape {
    /// Components of the span at rest.
    pub span: [Affine; 3],
    /// Sides of the cross-section.
    pub sides: [Affine; 2],
}

impl SoughtShape {
    /// L₀² = |L|², and the volume V₀ = X̂ Ŷ L₀.
    fn length_and_volume<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<f64, M>,
        w: &SVector<f64, M>,
    ) -> [Jet<M, ORDER>; 2] {
        let [x, y, z] = self.span.each_ref().map(|l| l.jet(p, w).squared());
        let square = x + y + z;
        let [a, b] = self.sides.each_ref().map(|side| side.jet(p, w));
        [square, a * b * square.sqrt()]
    }
}

/// Electric constants in N/V², and the thickness of a layer in mm.
#[derive(Clone, Debug)]
pub struct SoughtDielectric {
    /// c₁.
    pub c1: Affine,
    /// c₂.
    pub c2: Affine,
    /// ε.
    pub permittivity: Affine,
    /// t.
    pub layer: Affine,
}

/// Energy `V₀ { μ/2 (2/√I + I − 3) + [c₁ + c₂ I − ε/(2I)] (V/t)² }` with I = |r|²/L₀²; arguments: span r, voltage V, parameters.
#[derive(Clone, Debug)]
pub struct SoughtCell {
    /// Geometry.
    pub shape: SoughtShape,
    /// Shear modulus μ in MPa.
    pub shear_modulus: Affine,
    /// Electric constants, where a voltage acts.
    pub electric: Option<SoughtDielectric>,
}

impl<const M: usize> SoughtEnergy<M> for SoughtCell {
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Jet<M, ORDER> {
        let [square, volume] = self.shape.length_and_volume::<M, ORDER>(p, w);
        let i = Jet::dot(0, 0, p, w) * square.recip();
        let elastic = i.sqrt().recip() * 2.0 + i + -3.0;
        let mut density = elastic * self.shear_modulus.jet(p, w) * 0.5;
        if let Some(electric) = &self.electric {
            let field = Jet::argument(3, p, w) * electric.layer.jet(p, w).recip();
            let [c1, c2, permittivity]: [Jet<M, ORDER>; 3] =
                [&electric.c1, &electric.c2, &electric.permittivity].map(|c| c.jet(p, w));
            let factor = c1 + c2 * i - permittivity * i.recip() * 0.5;
            density = density + factor * field.squared();
        }
        volume * density
    }
}

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴`, arguments: δr, r̄, ṙ, parameters.
#[derive(Clone, Debug)]
pub struct SoughtViscousCell {
    /// Geometry.
    pub shape: SoughtShape,
    /// Viscosity η in MPa ms.
    pub viscosity: Affine,
}

impl<const M: usize> SoughtEnergy<M> for SoughtViscousCell {
    const VIRTUAL: usize = 1;

    fn jet<const ORDER: usize>(&self, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Jet<M, ORDER> {
        let [_, volume] = self.shape.length_and_volume::<M, ORDER>(p, w);
        let work = of_invariants(p, w, |[alpha, beta, gamma]| {
            alpha * beta * gamma.squared().recip()
        });
        work * volume * self.viscosity.jet(p, w) * -1.5
    }
}
