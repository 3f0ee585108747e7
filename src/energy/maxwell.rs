//! Spring of a Maxwell branch of the lumped muscle.

use crate::energy::Energy;
use crate::math::Jet;
use nalgebra::SVector;

/// Elastic energy `V₀ μ₁/2 (Λₑ² + 2/Λₑ − 3)` of the elastic stretch `Λₑ = Λ e^(−z)`, arguments: span r with Λ = |r|/L₀, and the logarithm z of
/// the viscous stretch in the first component of a vector. Not finite for r = 0.
///
/// With the damper 3 τ μ₁ V₀ of z it is the branch `ċ = (Λ² − c/3 (Λ²/c + 2√c/Λ))/τ` of c = e^(2z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellCell {
    /// Rest length L₀ in mm.
    pub length: f64,
    /// Rest volume V₀ in mm³.
    pub volume: f64,
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: f64,
}

impl Energy<6> for MaxwellCell {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let squared = Jet::dot(0, 0, p, w) * (1.0 / (self.length * self.length));
        let (viscous, e) = (Jet::argument(3, p, w), p[3].exp());
        let f = (e * e).recip();
        let elastic = squared * viscous.map([f, -2.0 * f, 4.0 * f, -8.0 * f]);
        let rest = squared.sqrt().recip() * viscous.map([e; 4]) * 2.0;
        (elastic + rest + -3.0) * (0.5 * self.shear_modulus * self.volume)
    }
}
