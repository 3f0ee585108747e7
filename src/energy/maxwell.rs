//! Maxwell branches: the spring of a lumped muscle, and the damper of a finite element.

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

/// Virtual work of the damper of a Maxwell branch at a point, `−½ c tr(A⁻¹Ȧ A⁻¹δA)` of A = C_i⁻¹ with the viscous strain C_i.
///
/// A = UᵀDU has the coordinates z₁, z₂ with D = diag(e^z₁, e^z₂, e^(−z₁−z₂)), and a, b, c of the unit upper triangle
/// U = (1, a, b; 0, 1, c; 0, 0, 1). With N = U̇U⁻¹ = (0, ȧ, ḃ − cȧ; 0, 0, ċ; 0, 0, 0) it is
/// `−c [½ Σ ż_k δz_k + Σ_{i<j} D_i/D_j N_ij δN_ij]`, z₃ = −z₁ − z₂. Arguments: δ(z₁, z₂, ·), δ(a, b, c), then midpoints, then rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellDamper {
    /// c = τ μ₁ V of the volume V of the point in mJ ms.
    pub coefficient: f64,
}

impl Energy<18> for MaxwellDamper {
    type Local<const ORDER: usize> = Jet<18, ORDER>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 2;

    /// It is linear in the rates.
    fn couples(i: usize, j: usize) -> bool {
        i / 2 != j / 2 || i / 2 == 1
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 18>, w: &SVector<f64, 18>) -> Jet<18, ORDER> {
        let argument = |i: usize| Jet::<18, ORDER>::argument(i, p, w);
        let exp = |jet: Jet<18, ORDER>| jet.map([jet.value.exp(); 4]);
        let [z1, z2, c] = [6, 7, 11].map(argument);
        // D₁/D₂ and D₂/D₃.
        let (upper, lower) = (exp(z1 - z2), exp(z1 + z2 * 2.0));
        // N₁₂, N₂₃ and N₁₃ of a rate.
        let gradient = |a: usize| {
            let [a, b, c_rate] = [a, a + 1, a + 2].map(argument);
            [a, c_rate, b - c * a]
        };
        let ([n12, n23, n13], [m12, m23, m13]) = (gradient(15), gradient(3));
        let stretches = [12, 0].map(|z| [argument(z), argument(z + 1)]);
        let [[v1, v2], [y1, y2]] = stretches;
        let diagonal = v1 * y1 + v2 * y2 + (v1 + v2) * (y1 + y2);
        let shears = upper * (n12 * m12) + lower * (n23 * m23) + upper * lower * (n13 * m13);
        (diagonal * 0.5 + shears) * -self.coefficient
    }
}
