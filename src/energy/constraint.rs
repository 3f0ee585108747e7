//! Constraints times their multipliers: λ·g, at most quadratic in directors, hence cubic.

use crate::energy::Energy;
use crate::math::Jet;
use nalgebra::SVector;

/// `λ (a·b − c)`, arguments: vectors a and b, multiplier λ. Orthonormal directors, perpendicular axes.
#[derive(Clone, Copy, Debug)]
pub struct Orthogonality {
    /// The value c of a·b.
    pub product: f64,
    /// Factor of the constraint: ½ for the length of one vector, else 1.
    pub factor: f64,
}

impl Energy<7> for Orthogonality {
    type Local<const ORDER: usize> = Jet<7, ORDER>;

    const DEGREE: usize = 3;
    const ISOTROPIC: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        i != j
    }

    #[inline]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 7>, w: &SVector<f64, 7>) -> Jet<7, ORDER> {
        let product = Jet::dot(0, 3, p, w) + -self.product;
        product * Jet::argument(6, p, w) * self.factor
    }
}

/// `λ·r`, arguments: the distance r of two points that coincide, multipliers λ₁ λ₂ λ₃.
#[derive(Clone, Copy, Debug)]
pub struct Coincidence;

impl Energy<6> for Coincidence {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    const DEGREE: usize = 2;

    fn couples(_i: usize, _j: usize) -> bool {
        false
    }

    #[inline]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        Jet::dot(0, 3, p, w)
    }
}
