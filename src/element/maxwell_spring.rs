//! The spring of a Maxwell branch of an element, and viscous strains that have relaxed.

use super::branch::Branch;
use super::dual::{Dual, moving};
use super::geometry::ElementGeometry;
use super::lanes::{Lanes, Task, dispatch};
use super::local::{BranchLocal, COORDINATES, Output, Pair};
use super::number::Points;
use crate::math::{Matrix, Vector};
use pulp::Simd;

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
    /// Energy W in mJ of the element `shape` with nodes at `x` in mm.
    pub fn energy<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
    ) -> f64 {
        let mut energy = 0.0;
        self.write::<0, NODES>(shape, x, strains, &mut energy);
        energy
    }

    /// Fills energy and first derivatives.
    pub fn gradient<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
        local: &mut BranchLocal<NODES>,
    ) {
        self.write::<1, NODES>(shape, x, strains, local);
    }

    /// Fills everything.
    pub fn tangent<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
        local: &mut BranchLocal<NODES>,
    ) {
        self.write::<2, NODES>(shape, x, strains, local);
    }

    /// Fills `plain` as [`tangent`](Self::tangent) does, and `along` with the derivatives of all of it along the rates of places and strains,
    /// which follow these.
    pub fn third<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        places: [&[Vector; NODES]; 2],
        strains: [&ViscousStrains; 2],
        plain: &mut BranchLocal<NODES>,
        along: &mut BranchLocal<NODES>,
    ) {
        dispatch(Along {
            law: self,
            shape,
            places,
            strains,
            out: Pair { plain, along },
        });
    }

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

    fn write<const ORDER: usize, const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
        out: &mut impl Output<f64>,
    ) {
        dispatch(Plain::<_, ORDER, NODES> {
            law: self,
            shape,
            x,
            strains,
            out,
        });
    }
}

/// Derivatives to the order `ORDER` at a state.
struct Plain<'a, O, const ORDER: usize, const NODES: usize> {
    law: &'a MaxwellSpring,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    strains: &'a ViscousStrains,
    out: &'a mut O,
}

impl<O: Output<f64>, const ORDER: usize, const NODES: usize> Task for Plain<'_, O, ORDER, NODES> {
    #[inline(always)]
    fn run<S: Simd, const K: usize>(self, unit: S) {
        let mut x = [[0.0; 3]; NODES];
        for i in 0..NODES {
            x[i] = [self.x[i].x, self.x[i].y, self.x[i].z];
        }
        let mut q = [Lanes::<S, K>::constant(unit, 0.0); COORDINATES];
        for m in 0..COORDINATES {
            q[m] = Lanes::<S, K>::load(unit, &self.strains[m]);
        }
        let mu = self.law.shear_modulus;
        Branch::write::<ORDER, NODES>(unit, mu, self.shape, &x, q, self.out);
    }
}

/// Second derivatives at a state, and their rates along a direction.
struct Along<'a, const NODES: usize> {
    law: &'a MaxwellSpring,
    shape: &'a ElementGeometry<NODES>,
    /// Places, and their rates; strains, and theirs.
    places: [&'a [Vector; NODES]; 2],
    strains: [&'a ViscousStrains; 2],
    out: Pair<'a, BranchLocal<NODES>>,
}

impl<const NODES: usize> Task for Along<'_, NODES> {
    #[inline(always)]
    fn run<S: Simd, const K: usize>(mut self, unit: S) {
        let [x, w] = self.places;
        let x = moving(x, w);
        let mut q = [Dual::<Lanes<S, K>>::constant(unit, 0.0); COORDINATES];
        for m in 0..COORDINATES {
            q[m] = Dual {
                value: Lanes::<S, K>::load(unit, &self.strains[0][m]),
                rate: Lanes::<S, K>::load(unit, &self.strains[1][m]),
            };
        }
        let mu = self.law.shear_modulus;
        Branch::write::<2, NODES>(unit, mu, self.shape, &x, q, &mut self.out);
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
