//! Every energy: its jet is the derivatives of its naive formula, by nested dual numbers, and its flags are true.
//!
//! With the arguments p + w ε over dual numbers, and two infinitesimals more for a pair (i, j), one evaluation of the
//! naive formula gives f, ∂f/∂pᵢ, ∂²f/∂pᵢ∂pⱼ and their derivatives along w. Naive formulas go other ways than the code:
//! over the stretch Λ = |r|/L₀ in place of I = Λ², over polarisation in place of dot products, rates as dual numbers.

use crate::common::random::Random;
use nalgebra::{SMatrix, SVector};
use num_dual::{Dual, Dual64, DualNum, HyperDual};
use proboscis::energy::{
    Angle, AngularDamper, Coincidence, CoordinateDamper, DielectricCell, ElasticCell, Energy,
    Gravity, LinearDamper, LinearSpring, Orthogonality, OutsideBox, Place, Projection,
    SectionInertia, SpanDamper, SquaredDistance, SquaredField, ViscousCell,
};
use proboscis::math::{Jet, Vector};

/// Points at which each energy is looked at.
const POINTS: usize = 25;
/// Rounding of some tens of operations at values of order one: a thousand times ε, with a margin of five.
const TOLERANCE: f64 = 1e-12;

/// The naive formula of an energy.
trait Formula<const M: usize>: Energy<M> {
    /// How many of its arguments are vectors.
    const VECTORS: usize = M / 3;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; M]) -> D;
}

fn three<D: Copy>(p: &[D], at: usize) -> [D; 3] {
    [p[at], p[at + 1], p[at + 2]]
}

fn squared_length<D: DualNum<f64> + Copy>(a: [D; 3]) -> D {
    a[0].powi(2) + a[1].powi(2) + a[2].powi(2)
}

/// a·b = (|a + b|² − |a − b|²)/4.
fn polarised<D: DualNum<f64> + Copy>(a: [D; 3], b: [D; 3]) -> D {
    let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let difference = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    (squared_length(sum) - squared_length(difference)) * 0.25
}

/// Λ = |r|/L₀.
fn stretch<D: DualNum<f64> + Copy>(r: [D; 3], length: f64) -> D {
    squared_length(r).sqrt() / length
}

/// The derivative along `rate`, as a number.
fn along<D: DualNum<f64> + Copy, const K: usize>(
    p: [D; K],
    rate: [D; K],
    f: impl Fn([Dual<D, f64>; K]) -> Dual<D, f64>,
) -> D {
    f(std::array::from_fn(|i| Dual::new(p[i], rate[i]))).eps
}

impl Formula<3> for ElasticCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let s = stretch(*p, self.length);
        (s.powi(2) + s.recip() * 2.0 - 3.0) * (0.5 * self.shear_modulus * self.volume)
    }
}

impl Formula<4> for DielectricCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        let s = stretch(three(p, 0), self.elastic.length);
        // The energy density at F = diag(Λ^(−1/2), Λ^(−1/2), Λ), E = (0, 0, V/t): C:(E⊗E) = Λ²E², C⁻¹:(E⊗E) = E²/Λ².
        let field = p[3] / self.layer;
        let density = (s.powi(2) + s.recip() * 2.0 - 3.0) * (0.5 * self.elastic.shear_modulus)
            + field.powi(2) * self.c1
            + (s * field).powi(2) * self.c2
            - (field / s).powi(2) * (0.5 * self.permittivity);
        density * self.elastic.volume
    }
}

impl Formula<6> for SectionInertia {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        let (r, v) = (three(p, 0), three(p, 3));
        let s = stretch(r, self.length);
        let rate = along(r, v, |r| stretch(r, self.length));
        // ½ ρV₀ (X̂² + Ŷ²)/48 Λ̇²/Λ³, where the moment holds the same over 192.
        rate.powi(2) / s.powi(3) * (0.5 * 4.0 * self.moment)
    }
}

impl Formula<9> for ViscousCell {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let (delta, r, v) = (three(p, 0), three(p, 3), three(p, 6));
        // −1.5 η V₀ Λ̇ δΛ/Λ²; no length at rest is left in it.
        let of = |direction| along(r, direction, |r| stretch(r, 0.7));
        -of(v) * of(delta) / stretch(r, 0.7).powi(2) * self.coefficient
    }
}

impl Formula<3> for LinearSpring {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        (squared_length(*p).sqrt() - self.length).powi(2) * (0.5 * self.stiffness)
    }
}

impl Formula<9> for SpanDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let (delta, r, v) = (three(p, 0), three(p, 3), three(p, 6));
        let of = |direction| along(r, direction, |r| squared_length(r).sqrt());
        -of(v) * of(delta) * self.coefficient
    }
}

/// The angle of the vector c in the plane (a, b), by half of it: tan(θ/2) = s/(r + c), r² = s² + c²; for c < 0 by half of π − θ.
fn half_angle<D: DualNum<f64> + Copy>(p: [D; 9]) -> D {
    let cosine = polarised(three(&p, 0), three(&p, 6));
    let sine = polarised(three(&p, 3), three(&p, 6));
    let radius = (sine.powi(2) + cosine.powi(2)).sqrt();
    if cosine.re() > 0.0 {
        (sine / (radius + cosine)).atan() * 2.0
    } else {
        (sine / (radius - cosine)).atan() * -2.0 + std::f64::consts::PI * sine.re().signum()
    }
}

impl Formula<9> for Angle {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 9]) -> D {
        let angle = half_angle(*p);
        let turns = ((self.near - angle.re()) / std::f64::consts::TAU).round();
        angle + turns * std::f64::consts::TAU
    }
}

impl Formula<27> for AngularDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 27]) -> D {
        let part = |at: usize| -> [D; 9] { std::array::from_fn(|i| p[at + i]) };
        let of = |direction| along(part(9), direction, half_angle);
        -of(part(18)) * of(part(0)) * self.coefficient
    }
}

impl Formula<6> for CoordinateDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        -polarised(three(p, 3), three(p, 0)) * self.coefficient
    }
}

impl Formula<18> for LinearDamper {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 18]) -> D {
        let part = |at: usize| -> [D; 6] { std::array::from_fn(|i| p[at + i]) };
        let of = |direction| {
            along(part(6), direction, |q| {
                polarised(three(&q, 0), three(&q, 3))
            })
        };
        -of(part(12)) * of(part(0)) * self.coefficient
    }
}

impl Formula<3> for Gravity {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        -polarised(
            *p,
            [self.weight.x, self.weight.y, self.weight.z].map(D::from),
        )
    }
}

impl Formula<7> for Orthogonality {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        (polarised(three(p, 0), three(p, 3)) - self.product) * p[6] * self.factor
    }
}

impl Formula<6> for Coincidence {
    const VECTORS: usize = 1;

    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        polarised(three(p, 3), three(p, 0))
    }
}

impl Formula<6> for Projection {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        polarised(three(p, 0), three(p, 3))
    }
}

impl Formula<3> for Place {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let normal = [self.normal.x, self.normal.y, self.normal.z].map(D::from);
        polarised(*p, normal) - self.origin.dot(&self.normal)
    }
}

impl Formula<3> for SquaredDistance {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let d = std::array::from_fn(|i| p[i] - self.centre[i]);
        (squared_length(d).sqrt() / self.scale).powi(2)
    }
}

impl Formula<3> for OutsideBox {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let power = |i: usize| {
            let square = ((p[i] - self.centre[i]) / self.half[i]).powi(2);
            let fourth = square * square;
            fourth * fourth * fourth * fourth
        };
        power(0) + power(1) + power(2)
    }
}

impl Formula<4> for SquaredField {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        (p[3] / (stretch(three(p, 0), self.length) * self.voltage)).powi(2)
    }
}

/// All that jets can do, as an energy: `ln(1+|a|²) √(4+a·b) − (a·b)⁵/8 + 1/(1+|b|²) + (a₀−b₁)² sin a₂ + ‖(a·b, |a|²)‖² a₁`.
struct Arithmetic;

impl Energy<6> for Arithmetic {
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let (aa, ab, bb) = (
            Jet::dot(0, 0, p, w),
            Jet::dot(0, 3, p, w),
            Jet::dot(3, 3, p, w),
        );
        let x = |i| Jet::<6, ORDER>::argument(i, p, w);
        let (sin, cos) = p[2].sin_cos();
        let sine = x(2).map([sin, cos, -sin, -cos]);
        let q = SVector::from([ab.value, aa.value]);
        let rates = SVector::from([ab.value_w, aa.value_w]);
        let outer = |i| Jet::<2, ORDER>::argument(i, &q, &rates);
        let norm = Jet::compose(&(outer(0).squared() + outer(1).squared()), &[ab, aa]);
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

/// Derivatives of a naive formula: f, ∇f, ∇²f and their rates along w.
fn exact<E: Formula<M>, const M: usize>(
    energy: &E,
    p: &SVector<f64, M>,
    w: &SVector<f64, M>,
) -> Jet<M, 3> {
    let mut out = Jet::constant(0.0);
    for i in 0..M {
        for j in 0..M {
            let unit = |here: bool| Dual64::from_re(f64::from(u8::from(here)));
            let args: [HyperDual<Dual64, f64>; M] = std::array::from_fn(|k| {
                HyperDual::new(
                    Dual64::new(p[k], w[k]),
                    unit(k == i),
                    unit(k == j),
                    unit(false),
                )
            });
            let f = energy.naive(&args);
            (out.value, out.value_w) = (f.re.re, f.re.eps);
            (out.gradient[i], out.gradient_w[i]) = (f.eps1.re, f.eps1.eps);
            (out.hessian[(i, j)], out.hessian_w[(i, j)]) = (f.eps1eps2.re, f.eps1eps2.eps);
        }
    }
    out
}

fn assert_close<const R: usize, const C: usize>(
    what: &str,
    a: &SMatrix<f64, R, C>,
    b: &SMatrix<f64, R, C>,
    size: f64,
) {
    let error = (a - b).amax();
    assert!(
        error <= TOLERANCE * size,
        "{what}: {error:.2e} relative to {size:.2e}"
    );
}

/// The flags of an energy describe its derivatives.
fn flags<E: Formula<M>, const M: usize>(name: &str, p: &SVector<f64, M>, jet: &Jet<M, 3>) {
    let degree = [
        jet.gradient.amax(),
        jet.hessian.amax(),
        jet.hessian_w.amax(),
    ];
    for (order, size) in (1..).zip(degree) {
        assert_eq!(
            size == 0.0,
            order > E::DEGREE,
            "{name}: derivative {order} of a polynomial of degree {}",
            E::DEGREE
        );
    }
    for i in 0..E::VECTORS {
        for j in 0..E::VECTORS {
            for hessian in [&jet.hessian, &jet.hessian_w] {
                let block = hessian.fixed_view::<3, 3>(3 * i, 3 * j).into_owned();
                if E::ISOTROPIC {
                    let identity = SMatrix::<f64, 3, 3>::identity() * block[(0, 0)];
                    assert_eq!(block, identity, "{name}: block {i} {j} is isotropic");
                }
                if !E::couples(i, j) || i.max(j) < E::VIRTUAL {
                    assert_eq!(block.amax(), 0.0, "{name}: block {i} {j} does not couple");
                }
            }
        }
    }
    if E::VIRTUAL > 0 {
        let work = (0..3 * E::VIRTUAL)
            .map(|i| p[i] * jet.gradient[i])
            .sum::<f64>();
        let size = (0..3 * E::VIRTUAL)
            .map(|i| (p[i] * jet.gradient[i]).abs())
            .sum::<f64>();
        assert!(
            (work - jet.value).abs() <= TOLERANCE * size,
            "{name} is linear in its virtual displacements"
        );
    }
}

/// The law for one energy at random points: `low..high` bounds each argument.
fn law<E: Formula<M>, const M: usize>(name: &str, energy: &E, low: f64, high: f64) {
    let mut random = Random(name.bytes().map(u64::from).sum());
    let mut largest = [0.0_f64; 4];
    for _ in 0..POINTS {
        // Each argument away from zero, in either sign.
        let p =
            SVector::<f64, M>::from_fn(|_, _| random.between(low, high) * random.unit().signum());
        let w = SVector::<f64, M>::from_fn(|_, _| random.unit());
        let jet: Jet<M, 3> = energy.jet(&p, &w);
        let want = exact(energy, &p, &w);
        largest[0] = largest[0].max(want.value.abs());
        largest[1] = largest[1].max(want.gradient.amax());
        largest[2] = largest[2].max(want.hessian.amax());
        largest[3] = largest[3].max(want.hessian_w.amax());
        // Arguments themselves are rounded, so each quantity is known to its derivative times ε|p|.
        let (g, h) = (want.gradient.amax(), want.hessian.amax());
        let (gw, hw) = (want.gradient_w.amax(), want.hessian_w.amax());
        let value = |v: f64| SMatrix::<f64, 1, 1>::new(v);
        assert_close(
            &format!("{name} value"),
            &value(jet.value),
            &value(want.value),
            want.value.abs() + high * g,
        );
        assert_close(
            &format!("{name} gradient"),
            &jet.gradient,
            &want.gradient,
            g + high * h,
        );
        assert_close(
            &format!("{name} Hessian"),
            &jet.hessian,
            &want.hessian,
            h + hw,
        );
        assert_close(
            &format!("{name} value along w"),
            &value(jet.value_w),
            &value(want.value_w),
            g + h + gw,
        );
        if E::DEGREE >= 2 {
            assert_close(
                &format!("{name} gradient along w"),
                &jet.gradient_w,
                &want.gradient_w,
                h + gw + hw,
            );
        }
        assert_close(
            &format!("{name} third"),
            &jet.hessian_w,
            &want.hessian_w,
            h + hw,
        );
        flags::<E, M>(name, &p, &jet);
        // Less far, the same: to the last bit or, where lower orders are written out, to rounding.
        let (one, two): (Jet<M, 1>, Jet<M, 2>) = (energy.jet(&p, &w), energy.jet(&p, &w));
        for (a, b) in [(one.value, jet.value), (two.value, jet.value)] {
            assert_close(
                &format!("{name} value less far"),
                &value(a),
                &value(b),
                want.value.abs() + g,
            );
        }
        for gradient in [&one.gradient, &two.gradient] {
            assert_close(
                &format!("{name} gradient less far"),
                gradient,
                &jet.gradient,
                g + h,
            );
        }
        assert_close(
            &format!("{name} Hessian less far"),
            &two.hessian,
            &jet.hessian,
            h + hw,
        );
        assert_eq!((one.hessian.amax(), two.hessian_w.amax()), (0.0, 0.0));
    }
    for (order, size) in largest.into_iter().enumerate() {
        assert!(
            size > 1e-3 || order > E::DEGREE,
            "{name}: nothing to compare at order {order}"
        );
    }
}

#[test]
fn jets_are_the_derivatives_of_naive_formulas() {
    let elastic = ElasticCell {
        length: 1.3,
        volume: 0.9,
        shear_modulus: 1.7,
    };
    let dielectric = DielectricCell {
        elastic,
        c1: -0.8,
        c2: 0.45,
        permittivity: 0.3,
        layer: 0.9,
    };
    let ideal = DielectricCell {
        c1: 0.0,
        c2: 0.0,
        ..dielectric
    };
    law("elastic", &elastic, 0.3, 1.3);
    law("dielectric", &dielectric, 0.3, 1.3);
    law("ideal dielectric", &ideal, 0.3, 1.3);
    law(
        "section",
        &SectionInertia {
            length: 1.1,
            moment: 0.6,
        },
        0.4,
        1.2,
    );
    let spring = LinearSpring {
        stiffness: 0.8,
        length: 0.9,
    };
    law("spring", &spring, 0.4, 1.2);
    law("damper", &SpanDamper { coefficient: 1.4 }, 0.4, 1.2);
    law("viscous", &ViscousCell { coefficient: 1.4 }, 0.4, 1.2);
    law(
        "angular damper",
        &AngularDamper { coefficient: 0.7 },
        0.3,
        1.1,
    );
    law(
        "coordinate damper",
        &CoordinateDamper { coefficient: 0.7 },
        0.2,
        1.1,
    );
    law(
        "linear damper",
        &LinearDamper { coefficient: 0.7 },
        0.2,
        1.1,
    );
    law(
        "gravity",
        &Gravity {
            weight: Vector::new(0.3, -1.2, 0.5),
        },
        0.1,
        1.0,
    );
    for (product, factor) in [(1.0, 0.5), (0.0, 1.0)] {
        law(
            "orthogonality",
            &Orthogonality { product, factor },
            0.2,
            1.0,
        );
    }
    law("coincidence", &Coincidence, 0.2, 1.0);
    law("projection", &Projection, 0.2, 1.0);
    law(
        "place",
        &Place {
            origin: Vector::new(0.1, 0.7, -0.3),
            normal: Vector::new(0.6, 0.0, 0.8),
        },
        0.1,
        1.0,
    );
    law(
        "squared distance",
        &SquaredDistance {
            centre: Vector::new(0.1, 0.7, -0.3),
            scale: 0.8,
        },
        0.1,
        1.0,
    );
    law(
        "outside box",
        &OutsideBox {
            centre: Vector::new(0.1, 0.2, -0.1),
            half: Vector::new(0.9, 1.1, 1.0),
        },
        0.6,
        1.1,
    );
    law(
        "squared field",
        &SquaredField {
            length: 1.1,
            voltage: 0.8,
        },
        0.4,
        1.1,
    );
}

#[test]
fn jet_arithmetic_is_the_chain_rule() {
    law("arithmetic", &Arithmetic, 0.1, 0.9);
}

#[test]
fn angles_keep_their_branch() {
    // One and a half turns away, and on both sides of the cut of atan2.
    for near in [-9.0, -3.2, 0.0, 3.1, 9.5] {
        law("angle", &Angle { near }, 0.3, 1.0);
    }
    let args = |angle: f64| {
        SVector::<f64, 9>::from([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, angle.cos(), angle.sin(), 0.0])
    };
    for turn in [-3.0_f64, -1.0, 0.0, 0.5, 1.5, 4.0] {
        let angle = turn * std::f64::consts::PI + 0.1;
        let jet: Jet<9, 1> = Angle { near: angle - 1.0 }.jet(&args(angle), &SVector::zeros());
        assert!((jet.value - angle).abs() < 1e-14 * (1.0 + angle.abs()));
    }
}

/// A muscle of no length has no energy, no force and no field: solvers see it and step back.
#[test]
fn nothing_exists_at_zero_length() {
    fn gone<E: Energy<M>, const M: usize>(name: &str, energy: &E, p: [f64; M]) {
        let jet: Jet<M, 3> = energy.jet(&p.into(), &SVector::repeat(1.0));
        assert!(!jet.value.is_finite(), "{name}: {}", jet.value);
        assert!(
            jet.gradient.iter().any(|g| !g.is_finite()),
            "{name}: {}",
            jet.gradient
        );
        assert!(jet.hessian.iter().any(|h| !h.is_finite()), "{name}");
        assert!(jet.hessian_w.iter().any(|h| !h.is_finite()), "{name}");
    }
    let elastic = ElasticCell {
        length: 1.3,
        volume: 0.9,
        shear_modulus: 1.7,
    };
    let dielectric = DielectricCell {
        elastic,
        c1: -0.8,
        c2: 0.45,
        permittivity: 0.3,
        layer: 0.9,
    };
    gone("elastic", &elastic, [0.0; 3]);
    gone("dielectric", &dielectric, [0.0, 0.0, 0.0, 1.0]);
    let section = SectionInertia {
        length: 1.0,
        moment: 1.0,
    };
    gone("section", &section, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    gone(
        "viscous",
        &ViscousCell { coefficient: 1.0 },
        [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    );
    let field = SquaredField {
        length: 1.0,
        voltage: 1.0,
    };
    gone("field", &field, [0.0, 0.0, 0.0, 1.0]);
}
