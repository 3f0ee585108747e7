//! Joint dampers as virtual work: on the coordinate of the joint where it is one, on the vectors of its bodies otherwise.
//!
//! Both are d times the rate of the coordinate, which the midpoint rule samples once as a difference of angles and once as a
//! turn of vectors: the same force to O(h²).

use crate::energy::Energy;
use crate::math::Jet;
use nalgebra::SVector;

/// Virtual work `−d u̇ δu` of a joint; arguments: δu, then its rate, each in the first component of a vector.
#[derive(Clone, Copy, Debug)]
pub struct CoordinateDamper {
    /// d in N mm ms or N ms/mm.
    pub coefficient: f64,
}

impl Energy<6> for CoordinateDamper {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    const READINGS: usize = 2;
    const DEGREE: usize = 2;
    const VIRTUAL: usize = 1;
    const ISOTROPIC: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        i != j
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        Jet::dot(0, 3, p, w) * -self.coefficient
    }
}

/// Virtual work `−d θ̇ δθ` of a revolute joint with `tan θ = s/c`, s = b·x, c = a·x, for vectors a, b of the parent and x
/// of the child; arguments: δa, δb, δx, then their midpoints, then their rates.
///
/// `θ̇ = (ṡ c − ċ s)/(s² + c²)`, and likewise δθ.
#[derive(Clone, Copy, Debug)]
pub struct AngularDamper {
    /// d in N mm ms.
    pub coefficient: f64,
}

impl Energy<27> for AngularDamper {
    type Local<const ORDER: usize> = Jet<27, ORDER>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 3;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 27>, w: &SVector<f64, 27>) -> Jet<27, ORDER> {
        // Rate of a product of two vectors: one factor varies (at `shift`), the other stands.
        let rate =
            |a: usize, shift: usize| Jet::dot(a + shift, 15, p, w) + Jet::dot(a, 15 + shift, p, w);
        let virtual_rate = |a: usize| Jet::dot(a - 9, 15, p, w) + Jet::dot(a, 6, p, w);
        let products: [Jet<27, ORDER>; 6] = [
            Jet::dot(12, 15, p, w),
            Jet::dot(9, 15, p, w),
            rate(12, 9),
            rate(9, 9),
            virtual_rate(12),
            virtual_rate(9),
        ];
        // Of s, c, their rates and their variations, far fewer than the arguments.
        let values = SVector::from_fn(|i, _| products[i].value);
        let along = SVector::from_fn(|i, _| products[i].value_w);
        let [s, c, ds, dc, vs, vc] =
            std::array::from_fn(|i| Jet::<6, ORDER>::argument(i, &values, &along));
        let turning = ds * c - dc * s;
        let virtual_turning = vs * c - vc * s;
        let square = s.squared() + c.squared();
        let work = turning * virtual_turning * square.squared().recip() * -self.coefficient;
        Jet::compose(&work, &products)
    }
}

/// Virtual work `−d ẏ δy` of a prismatic joint with y = n·r; arguments: δn, δr, then midpoints, then rates.
#[derive(Clone, Copy, Debug)]
pub struct LinearDamper {
    /// d in N ms/mm.
    pub coefficient: f64,
}

impl Energy<18> for LinearDamper {
    type Local<const ORDER: usize> = Jet<18, ORDER>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 18>, w: &SVector<f64, 18>) -> Jet<18, ORDER> {
        let virtual_rate = Jet::dot(0, 9, p, w) + Jet::dot(6, 3, p, w);
        let rate = Jet::dot(12, 9, p, w) + Jet::dot(6, 15, p, w);
        rate * virtual_rate * -self.coefficient
    }
}
