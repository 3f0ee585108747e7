//! Viscosity of the lumped muscle as virtual work.
//!
//! Joint dampers as virtual work: on the coordinate of the joint where it is one, on the vectors of its bodies otherwise.
//!
//! Both are d times the rate of the coordinate, which the midpoint rule samples once as a difference of angles and once as a
//! turn of vectors: the same force to O(h²).

use crate::energy::{AlongSpan, Energy, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴` of σ_vis = η d, arguments: δr, r̄, ṙ (docs/theory.md, 3.2).
///
/// At the midpoint r̄·ṙ is exactly the difference quotient of ½|r|², so the discrete force is objective.
#[derive(Clone, Copy, Debug)]
pub struct ViscousCell<T = f64> {
    /// (3/2) η V₀ in N mm ms.
    pub coefficient: T,
}

law!(ViscousCell { coefficient } of 9);

impl<T: Number> Energy<9, T> for ViscousCell<T> {
    type Local<const ORDER: usize> = AlongSpan<T>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 1;

    fn couples(i: usize, j: usize) -> bool {
        AlongSpan::<T>::couples(i, j)
    }

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 9>, _: &SVector<T, 9>) -> AlongSpan<T> {
        AlongSpan::new(p, |gamma| {
            let r = gamma.recip();
            let k = -self.coefficient * r * r;
            [k, k.scaled(-2.0) * r, k.scaled(6.0) * r * r]
        })
    }
}

/// Virtual work `−d u̇ δu` of a joint; arguments: δu, then its rate, each in the first component of a vector.
#[derive(Clone, Copy, Debug)]
pub struct CoordinateDamper<T = f64> {
    /// d in N mm ms or N ms/mm.
    pub coefficient: T,
}

law!(CoordinateDamper { coefficient } of 6);

impl<T: Number> Energy<6, T> for CoordinateDamper<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    const READINGS: usize = 2;
    const DEGREE: usize = 2;
    const VIRTUAL: usize = 1;
    const ISOTROPIC: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        i != j
    }

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        Jet::dot(0, 3, p, w) * -self.coefficient
    }
}

/// Virtual work `−d θ̇ δθ` of a revolute joint with `tan θ = s/c`, s = b·x, c = a·x, for vectors a, b of the parent and x
/// of the child; arguments: δa, δb, δx, then their midpoints, then their rates.
///
/// `θ̇ = (ṡ c − ċ s)/(s² + c²)`, and likewise δθ.
#[derive(Clone, Copy, Debug)]
pub struct AngularDamper<T = f64> {
    /// d in N mm ms.
    pub coefficient: T,
}

law!(AngularDamper { coefficient } of 27);

impl<T: Number> Energy<27, T> for AngularDamper<T> {
    type Local<const ORDER: usize> = Jet<27, ORDER, T>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 3;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 27>, w: &SVector<T, 27>) -> Jet<27, ORDER, T> {
        // Rate of a product of two vectors: one factor varies (at `shift`), the other stands.
        let rate =
            |a: usize, shift: usize| Jet::dot(a + shift, 15, p, w) + Jet::dot(a, 15 + shift, p, w);
        let virtual_rate = |a: usize| Jet::dot(a - 9, 15, p, w) + Jet::dot(a, 6, p, w);
        let products: [Jet<27, ORDER, T>; 6] = [
            Jet::dot(12, 15, p, w),
            Jet::dot(9, 15, p, w),
            rate(12, 9),
            rate(9, 9),
            virtual_rate(12),
            virtual_rate(9),
        ];
        // Of s, c, their rates and their variations.
        Jet::compose(products, |[s, c, ds, dc, vs, vc]| {
            let turning = ds * c - dc * s;
            let virtual_turning = vs * c - vc * s;
            let square = s.squared() + c.squared();
            turning * virtual_turning * square.squared().recip() * -self.coefficient
        })
    }
}

/// Virtual work `−d ẏ δy` of a prismatic joint with y = n·r; arguments: δn, δr, then midpoints, then rates.
#[derive(Clone, Copy, Debug)]
pub struct LinearDamper<T = f64> {
    /// d in N ms/mm.
    pub coefficient: T,
}

law!(LinearDamper { coefficient } of 18);

impl<T: Number> Energy<18, T> for LinearDamper<T> {
    type Local<const ORDER: usize> = Jet<18, ORDER, T>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 18>, w: &SVector<T, 18>) -> Jet<18, ORDER, T> {
        let virtual_rate = Jet::dot(0, 9, p, w) + Jet::dot(6, 3, p, w);
        let rate = Jet::dot(12, 9, p, w) + Jet::dot(6, 15, p, w);
        rate * virtual_rate * -self.coefficient
    }
}
