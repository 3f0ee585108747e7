//! The spring of a Maxwell branch of an element, and viscous strains that have relaxed.

use super::branch::Branch;
use super::evaluation::{ElementEnergy, NodeState};
use super::geometry::ElementGeometry;
use super::local::{BranchLocal, COORDINATES, Output};
use super::number::Points;
use crate::math::{Matrix, Vector};

/// Coordinates (z₁, z₂, a, b, c) of the viscous strain at the Gauss points, `[coordinate][point]`.
///
/// C_i⁻¹ = UᵀDU with D = diag(e^z₁, e^z₂, e^(−z₁−z₂)) and the unit upper triangle U = (1, a, b; 0, 1, c; 0, 0, 1): every symmetric
/// positive matrix of determinant one has exactly one such list; zeros are C_i = 1.
pub type ViscousStrains = [[f64; 8]; COORDINATES];

/// The spring of a Maxwell branch: the isochoric neo-Hookean energy μ₁/2 (J^(−2/3) C:C_i⁻¹ − 3) of a reference volume with the viscous
/// strain C_i.
///
/// NaN where J ≤ 0 at a Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellSpring {
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: f64,
}

impl MaxwellSpring {
    /// Cauchy stress `μ₁/J^(5/3) (F A Fᵀ − ⅓ C:A 1)` in MPa with A = C_i⁻¹, its mean over the reference volume.
    #[expect(non_snake_case, reason = "notation of the law")]
    pub fn stress<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
    ) -> Matrix {
        let at = |(g, weight): (usize, &f64)| {
            let [z1, z2, a, b, c] = strains.map(|strain| strain[g]);
            let F = shape.gradient_of(x, g);
            let root = Vector::new(z1, z2, -z1 - z2).map(|z| (0.5 * z).exp());
            let U = Matrix::new(1.0, a, b, 0.0, 1.0, c, 0.0, 0.0, 1.0);
            let pushed = F * U.transpose() * Matrix::from_diagonal(&root);
            let left = pushed * pushed.transpose();
            let deviator = left - Matrix::identity() * (left.trace() / 3.0);
            deviator * (weight * self.shear_modulus * F.determinant().powf(-5.0 / 3.0))
        };
        let weights = shape.weights().iter().enumerate();
        weights.map(at).sum::<Matrix>() / shape.volume()
    }
}

impl<const NODES: usize> ElementEnergy<NODES> for MaxwellSpring {
    type Arguments = ViscousStrains;
    type Local = BranchLocal<NODES>;

    #[inline(always)]
    fn write<N: Points, const ORDER: usize>(
        &self,
        token: N::Token,
        at: &NodeState<'_, ViscousStrains, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let [strains, rates] = at.arguments;
        let mut q = [N::constant(token, 0.0); COORDINATES];
        for m in 0..COORDINATES {
            q[m] = N::moving(token, &strains[m], &rates[m]);
        }
        let x = at.places::<N>();
        Branch::write::<ORDER, NODES>(token, self.shear_modulus, at.shape, &x, q, out);
    }
}

/// Coordinates of the viscous strain to which a branch relaxes at a deformation gradient F, C_i = C/J^(2/3); NaN for J ≤ 0.
#[expect(non_snake_case, reason = "notation of the law")]
pub fn relaxed(F: &Matrix) -> [f64; COORDINATES] {
    let C = F.tr_mul(F);
    // C⁻¹ = UᵀDU, so that C = U⁻¹D⁻¹U⁻ᵀ: columns are eliminated from the last one on.
    let d3 = C[(2, 2)];
    let (i13, i23) = (C[(0, 2)] / d3, C[(1, 2)] / d3);
    let d2 = C[(1, 1)] - i23 * i23 * d3;
    let i12 = (C[(0, 1)] - i13 * i23 * d3) / d2;
    let d1 = C[(0, 0)] - i12 * i12 * d2 - i13 * i13 * d3;
    let mean = (2.0 / 3.0) * F.determinant().ln();
    // U of its inverse (1, i12, i13; 0, 1, i23; 0, 0, 1).
    [mean - d1.ln(), mean - d2.ln(), -i12, i12 * i23 - i13, -i23]
}
