//! A formula that uses every operation of jets.

use crate::formulas::law;
use crate::naive_formulas::{Formula, polarised, squared_length, three};
use nalgebra::SVector;
use num_dual::DualNum;
use proboscis::energy::Energy;
use proboscis::math::Jet;

/// All that jets can do, as an energy: `ln(1+|a|²) √(4+a·b) − (a·b)⁵/8 + 1/(1+|b|²) + (a₀−b₁)² sin a₂ + ‖(a·b, |a|²)‖² a₁`.
#[derive(Clone)]
struct Arithmetic;

impl Energy<6> for Arithmetic {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let (aa, ab, bb) = (
            Jet::dot(0, 0, p, w),
            Jet::dot(0, 3, p, w),
            Jet::dot(3, 3, p, w),
        );
        let x = |i| Jet::<6, ORDER>::argument(i, p, w);
        let (sin, cos) = p[2].sin_cos();
        let sine = x(2).map([sin, cos, -sin, -cos]);
        let norm = Jet::compose([ab, aa], |[b, a]| b.squared() + a.squared());
        (aa + 1.0).ln() * (ab + 4.0).sqrt() - ab.powi(5) * 0.125
            + (bb + Jet::constant(1.0)).recip()
            + (x(0) - x(4)).squared() * sine
            + norm * -(-x(1))
    }
}

impl Formula<6> for Arithmetic {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        let (a, b) = (three(p, 0), three(p, 3));
        let (aa, ab, bb) = (squared_length(a), polarised(a, b), squared_length(b));
        (aa + 1.0).ln() * (ab + 4.0).sqrt() - ab.powi(5) / 8.0
            + (bb + 1.0).recip()
            + (p[0] - p[4]).powi(2) * p[2].sin()
            + (ab.powi(2) + aa.powi(2)) * p[1]
    }
}

#[test]
fn jet_arithmetic_is_the_chain_rule() {
    law("arithmetic", &Arithmetic, 0.1, 0.9);
    // What is not asked for stays zero.
    let (p, w) = (SVector::repeat(0.3), SVector::repeat(0.2));
    let (one, two): (Jet<6, 1>, Jet<6, 2>) = (Arithmetic.at(&p, &w), Arithmetic.at(&p, &w));
    assert!(one.gradient.amax() > 0.1 && two.hessian.amax() > 0.1);
    assert_eq!((one.hessian.amax(), two.hessian_w.amax()), (0.0, 0.0));
}
