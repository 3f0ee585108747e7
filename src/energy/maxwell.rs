//! Spring of a Maxwell branch of the lumped muscle.

use crate::energy::Energy;
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Elastic energy `V₀ μ₁/2 (Λₑ² + 2/Λₑ − 3)` of the elastic stretch `Λₑ = Λ e^(−z)`, arguments: span r with Λ = |r|/L₀, and the logarithm z of
/// the viscous stretch in the first component of a vector. Not finite for r = 0.
///
/// With the damper 3 τ μ₁ V₀ of z it is the branch `ċ = (Λ² − c/3 (Λ²/c + 2√c/Λ))/τ` of c = e^(2z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellCell<T = f64> {
    /// Rest length L₀ in mm.
    pub length: T,
    /// Rest volume V₀ in mm³.
    pub volume: T,
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: T,
}

impl<T: Number> Energy<6, T> for MaxwellCell<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let squared = Jet::dot(0, 0, p, w) * (self.length * self.length).recip();
        let (viscous, e) = (Jet::argument(3, p, w), p[3].exp());
        let f = (e * e).recip();
        let by_viscous = [f, f.scaled(-2.0), f.scaled(4.0), f.scaled(-8.0)];
        let elastic = squared * viscous.map(by_viscous);
        let rest = (squared.sqrt().recip() * viscous.map([e; 4])).scaled(2.0);
        let strain = (elastic + rest).shifted(-3.0);
        strain * (self.shear_modulus.scaled(0.5) * self.volume)
    }
}
