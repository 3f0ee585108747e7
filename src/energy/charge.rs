//! Electric energy of a lumped muscle by its charge.
//!
//! `Q²/(2 C(I))` with I = |r|²/L₀² is the Legendre transform of the energy `−½ C V²` by the voltage V = Q/C.

use crate::energy::{Capacitance, Energy, OfSquare};
use crate::math::Jet;
use nalgebra::SVector;

impl Capacitance {
    /// `1/(2C)` as a function of I: value and three derivatives.
    #[inline(always)]
    pub(super) fn half_inverse(&self, i: f64) -> [f64; 4] {
        let [c, c1, c2, c3] = self.of_squared_stretch(i);
        let f = 1.0 / c;
        [
            0.5 * f,
            -0.5 * c1 * f * f,
            (c1 * c1 * f - 0.5 * c2) * f * f,
            (3.0 * c1 * (c2 - c1 * c1 * f) * f - 0.5 * c3) * f * f,
        ]
    }

    /// Charge in mC whose field balances the elasticity of the muscle, `√(μ V₀ C)` with C at rest.
    pub fn unit_of_charge(&self) -> f64 {
        let elastic = self.cell.elastic;
        let at_rest = self.at_length(elastic.length);
        (elastic.shear_modulus * elastic.volume * at_rest).sqrt()
    }

    /// Factor of |r|² in I.
    pub(super) fn scale(&self) -> f64 {
        let length = self.cell.elastic.length;
        1.0 / (length * length)
    }
}

/// Energy `Q²/(2C)` of a charge that is given, arguments: span r, charge Q in mC. Not finite for r = 0 and C = 0.
#[derive(Clone, Copy, Debug)]
pub struct GivenCharge {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance,
}

impl Energy<4> for GivenCharge {
    type Local<const ORDER: usize> = OfSquare;

    const OF_SQUARES: bool = true;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> OfSquare {
        let electric = |i| self.capacitance.half_inverse(i);
        OfSquare::new((p, w), self.capacitance.scale(), |_| [0.0; 4], electric)
    }
}

/// Energy `Q²/(2C)` of a charge that flows through a resistor, arguments: span r, and the charge in its unit in the first component of
/// a vector. Not finite for r = 0 and C = 0.
#[derive(Clone, Copy, Debug)]
pub struct FlowingCharge {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance,
    /// Unit of the charge in mC.
    pub unit: f64,
}

impl Energy<6> for FlowingCharge {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let squared = Jet::dot(0, 0, p, w) * self.capacitance.scale();
        let inverse = squared.map(self.capacitance.half_inverse(squared.value));
        inverse * (Jet::argument(3, p, w) * self.unit).squared()
    }
}
