//! Formulas of membranes: derivatives of naive ones by the whole deformation gradient and by principal stretches.

use crate::elastic_laws::{LAWS, density};
use crate::formulas::law;
use crate::gathered::jet_of;
use crate::naive_formulas::{Formula, along, squared_length, three};
use crate::naive_hexahedron::{contracted, inverse, inverse_strain, product, transposed};
use nalgebra::SVector;
use num_dual::DualNum;
use proboscis::energy::{
    ChargedMembrane, DielectricMembrane, ElasticLaw, ElasticMembrane, MaxwellMembrane, NeoHooke,
    ViscousMembrane,
};
use proboscis::math::Jet;

/// The tangents, and the normal by the area: det F = 1.
fn columns<D: DualNum<f64> + Copy>(p: [D; 6]) -> [[D; 3]; 3] {
    let (a, b) = (three(&p, 0), three(&p, 3));
    let n = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    [a, b, n.map(|x| x / squared_length(n))]
}

/// C = FᵀF.
fn metric<D: DualNum<f64> + Copy>(p: [D; 6]) -> [[D; 3]; 3] {
    let f = columns(p);
    let entry = |i: usize, j: usize| (0..3).fold(D::from(0.0), |sum, k| sum + f[i][k] * f[j][k]);
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn stretches<D: DualNum<f64> + Copy>(p: [D; 6]) -> [D; 3] {
    let c = metric(p);
    let middle = (c[0][0] + c[1][1]) * 0.5;
    let radius = (((c[0][0] - c[1][1]) * 0.5).powi(2) + c[0][1].powi(2)).sqrt();
    [middle + radius, middle - radius, c[2][2]].map(|square| square.sqrt())
}

fn six<D: Copy>(p: &[D], at: usize) -> [D; 6] {
    std::array::from_fn(|i| p[at + i])
}

impl Formula<6> for ElasticMembrane<ElasticLaw> {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        density(self.law, self.shear_modulus, stretches(*p)) * self.volume
    }
}

impl Formula<6> for ElasticMembrane {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        let squares = stretches(*p).map(|stretch| stretch.powi(2));
        (squares[0] + squares[1] + squares[2] - 3.0) * (0.5 * self.shear_modulus * self.volume)
    }
}

/// c₁ E·E + c₂ |F E|² − ε/2 |F⁻ᵀE|² of the field along the normal of a voltage.
fn electric<D: DualNum<f64> + Copy>(of: &DielectricMembrane, p: [D; 6], voltage: D) -> D {
    let field = voltage / of.thickness;
    let [_, _, d] = columns(p);
    let across = squared_length(d);
    let by_shape = across * of.c2 - across.recip() * (0.5 * of.permittivity) + of.c1;
    by_shape * field.powi(2) * of.volume
}

impl Formula<7> for DielectricMembrane {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 7]) -> D {
        electric(self, six(p, 0), p[6])
    }
}

impl Formula<6> for ChargedMembrane {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 6]) -> D {
        electric(&self.of, *p, D::from(1.0))
    }
}

impl Formula<12> for MaxwellMembrane {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 12]) -> D {
        let none = D::from(0.0);
        let inverse = inverse_strain([p[6], p[7], p[9], none, none]);
        let strain = contracted(metric(six(p, 0)), inverse) - 3.0;
        strain * (0.5 * self.shear_modulus * self.volume)
    }
}

impl Formula<18> for ViscousMembrane {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 18]) -> D {
        let middle = six(p, 6);
        let rate = |at: usize| -> [[D; 3]; 3] {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| along(middle, six(p, at), |q| metric(q)[i][j]))
            })
        };
        let left = inverse(metric(middle));
        let [real, imagined] = [rate(12), rate(0)].map(|rate| product(left, rate));
        -contracted(real, transposed(imagined)) * (0.25 * self.coefficient)
    }
}

/// A membrane with numbers of order one.
fn membrane<L>(law: L) -> ElasticMembrane<L> {
    ElasticMembrane {
        volume: 1.3,
        shear_modulus: 0.7,
        law,
    }
}

const DIELECTRIC: DielectricMembrane = DielectricMembrane {
    volume: 1.3,
    c1: -0.4,
    c2: 0.3,
    permittivity: 0.9,
    thickness: 1.7,
};

#[test]
fn formulas_of_membranes_have_the_derivatives_of_naive_ones() {
    law("neo-Hookean membrane", &membrane(NeoHooke), 0.4, 1.3);
    for (name, elastic) in LAWS {
        law(&format!("membrane, {name}"), &membrane(elastic), 0.6, 1.1);
    }
    law("dielectric membrane", &DIELECTRIC, 0.4, 1.3);
    law(
        "charged membrane",
        &ChargedMembrane { of: DIELECTRIC },
        0.4,
        1.3,
    );
    let maxwell = MaxwellMembrane {
        volume: 1.3,
        shear_modulus: 0.7,
    };
    law("membrane, Maxwell", &maxwell, 0.4, 1.3);
    law(
        "viscous membrane",
        &ViscousMembrane { coefficient: 0.8 },
        0.4,
        1.3,
    );
}

/// Where both stretches are one, sums of their powers are smooth: of fourth powers it is `tr C² + 1/D²`, of sixth ones `tr C³ + 1/D³`. The series ends
/// between the places.
#[test]
fn powers_of_stretches_are_smooth_where_these_are_equal() {
    for (exponent, stretch) in [4.0, 6.0]
        .into_iter()
        .flat_map(|a| [1.0, 1.001, 1.6, 2.0, 3.0].map(|s| (a, s)))
    {
        let powers = membrane(ElasticLaw::Ogden {
            exponents: [exponent; 2],
            share: 0.5,
        });
        let p = SVector::from([1.2, 0.0, 0.0, 0.0, 1.2 * stretch, 0.0]);
        let w = SVector::from([0.3, -0.2, 0.5, 0.1, 0.7, -0.4]);
        let jet: Jet<6, 3> = jet_of(&powers, &p, &w);
        let dot = |a: usize, b: usize| Jet::<6, 3>::dot(a, b, &p, &w);
        let trace = dot(0, 0) + dot(3, 3);
        let area = dot(0, 0) * dot(3, 3) - dot(0, 3).squared();
        let sum = match exponent {
            4.0 => trace.squared() - area.scaled(2.0) + area.squared().recip(),
            _ => trace.powi(3) - (trace * area).scaled(3.0) + area.powi(3).recip(),
        };
        let factor = 2.0 / exponent.powi(2) * powers.shear_modulus * powers.volume;
        let expected = sum.shifted(-3.0).scaled(factor);
        let errors = [
            (jet.value - expected.value).abs() / expected.value,
            (jet.gradient - expected.gradient).amax() / expected.gradient.amax(),
            (jet.hessian - expected.hessian).amax() / expected.hessian.amax(),
            (jet.hessian_w - expected.hessian_w).amax() / expected.hessian_w.amax(),
        ];
        assert!(
            errors.iter().all(|error| *error < 1e-12),
            "{exponent}, {stretch}: {errors:?}"
        );
    }
}
