//! Every energy: what it says is the derivatives of its naive formula, by nested dual numbers, and its flags are true.
//!
//! With the arguments p + w ε over dual numbers, and two infinitesimals more for a pair (i, j), one evaluation of the
//! naive formula gives f, ∂f/∂pᵢ, ∂²f/∂pᵢ∂pⱼ and their derivatives along w. Naive formulas go other ways than the code:
//! over the stretch Λ = |r|/L₀ in place of I = Λ², over polarisation in place of dot products, rates as dual numbers.

use crate::common::random::Random;
use crate::gathered::jet_of;
use crate::naive_formulas::Formula;
use nalgebra::{SMatrix, SVector};
use num_dual::{Dual64, HyperDual};
use proboscis::energy::{
    Angle, AngularDamper, Capacitance, Coincidence, CoordinateDamper, CoordinateSpring,
    CoordinateStops, DielectricCell, ElasticCell, Energy, Gravity, JointAngle, JointDisplacement,
    LinearDamper, LinearSpring, MaxwellCell, MaxwellDamper, NeoHooke, Orthogonality, OutsideBox,
    PositionComponent, Projection, SectionInertia, SpanDamper, SquaredDistance, SquaredField,
    ViscousCell,
};
use proboscis::math::{Jet, Vector};

/// Points at which each energy is looked at, fewer where there are more arguments.
const fn points(arguments: usize) -> usize {
    match arguments {
        ..=6 => 25,
        7..=12 => 15,
        _ => 6,
    }
}

/// Rounding of some tens of operations at values of order one: a thousand times ε, with a margin of five.
const TOLERANCE: f64 = 1e-12;

/// Derivatives of a naive formula: f, ∇f, ∇²f and their rates along w.
fn exact<E: Formula<M>, const M: usize>(
    energy: &E,
    p: &SVector<f64, M>,
    w: &SVector<f64, M>,
) -> Jet<M, 3> {
    let mut out = Jet::constant(0.0);
    for i in 0..M {
        for j in 0..=i {
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
            for place in [(i, j), (j, i)] {
                (out.hessian[place], out.hessian_w[place]) = (f.eps1eps2.re, f.eps1eps2.eps);
            }
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
    if E::OF_SQUARES {
        for s in 3 * E::VECTORS..M {
            let (once, twice) = (jet.gradient[s], p[s] * jet.hessian[(s, s)]);
            assert!(
                once != 0.0 && (once - twice).abs() <= TOLERANCE * once.abs(),
                "{name}: scalar {s} enters by its square to the first power"
            );
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
pub(crate) fn law<E: Formula<M>, const M: usize>(name: &str, energy: &E, low: f64, high: f64) {
    let mut random = Random(name.bytes().map(u64::from).sum());
    let mut largest = [0.0_f64; 4];
    for _ in 0..points(M) {
        // Each argument away from zero, in either sign.
        let p =
            SVector::<f64, M>::from_fn(|_, _| random.between(low, high) * random.unit().signum());
        let w = SVector::<f64, M>::from_fn(|_, _| random.unit());
        let mut jet: Jet<M, 3> = jet_of(energy, &p, &w);
        let want = exact(energy, &p, &w);
        if E::VIRTUAL > 0 || !E::HAS_RATES {
            (jet.gradient_w, jet.hessian_w) = (want.gradient_w, want.hessian_w);
        }
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
        let (one, two): (Jet<M, 1>, Jet<M, 2>) = (jet_of(energy, &p, &w), jet_of(energy, &p, &w));
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
    }
    for (order, size) in largest.into_iter().enumerate() {
        assert!(
            size > 1e-3 || order > E::DEGREE,
            "{name}: nothing to compare at order {order}"
        );
    }
}

/// A muscle, with numbers of order one.
pub(crate) const DIELECTRIC: DielectricCell = DielectricCell {
    elastic: ElasticCell {
        length: 1.3,
        volume: 0.9,
        shear_modulus: 1.7,
        law: NeoHooke,
    },
    c1: -0.8,
    c2: 0.45,
    permittivity: 0.3,
    layer: 0.9,
};

#[test]
fn energies_have_the_derivatives_of_naive_formulas() {
    let dielectric = DIELECTRIC;
    let elastic = dielectric.elastic;
    let ideal = DielectricCell {
        c1: 0.0,
        c2: 0.0,
        ..dielectric
    };
    law("elastic", &elastic, 0.3, 1.3);
    law("dielectric", &dielectric, 0.3, 1.3);
    law("ideal dielectric", &ideal, 0.3, 1.3);
    law("capacitance", &Capacitance { cell: dielectric }, 0.3, 1.3);
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
    let viscous = ViscousCell { coefficient: 1.4 };
    law("viscous", &viscous, 0.4, 1.2);
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
    let spring = CoordinateSpring {
        stiffness: 0.7,
        rest: 0.4,
    };
    law("coordinate spring", &spring, 0.2, 1.1);
    let stops = CoordinateStops {
        stiffness: 0.7,
        at: [-0.4, 0.3],
        smoothing: 0.9,
    };
    law("coordinate stops", &stops, 0.1, 0.65);
    let branch = MaxwellCell {
        length: 0.9,
        volume: 1.3,
        shear_modulus: 0.7,
    };
    law("maxwell", &branch, 0.4, 1.2);
    law(
        "maxwell damper",
        &MaxwellDamper { coefficient: 0.7 },
        0.2,
        1.1,
    );
    law("joint angle", &JointAngle, 0.3, 1.1);
    law("joint displacement", &JointDisplacement, 0.2, 1.1);
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
        &PositionComponent {
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
        let jet: Jet<9, 1> = Angle { near: angle - 1.0 }.at(&args(angle), &SVector::zeros());
        assert!((jet.value - angle).abs() < 1e-14 * (1.0 + angle.abs()));
    }
}

/// A muscle of no length has no energy, no force and no field: solvers see it and step back.
#[test]
fn nothing_exists_at_zero_length() {
    fn gone<E: Formula<M>, const M: usize>(name: &str, energy: &E, p: [f64; M]) {
        let jet: Jet<M, 3> = jet_of(energy, &p.into(), &SVector::repeat(1.0));
        assert!(!jet.value.is_finite(), "{name}: {}", jet.value);
        assert!(
            jet.gradient.iter().any(|g| !g.is_finite()),
            "{name}: {}",
            jet.gradient
        );
        assert!(jet.hessian.iter().any(|h| !h.is_finite()), "{name}");
        let third = jet.hessian_w.iter().any(|h| !h.is_finite());
        assert!(third || E::VIRTUAL > 0, "{name}");
    }
    let dielectric = DIELECTRIC;
    let elastic = dielectric.elastic;
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
