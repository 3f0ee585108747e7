//! Laws of elasticity of lumped muscles: derivatives of naive formulas in principal stretches, moduli of small strains, Gent's limit.

use crate::formulas::{DIELECTRIC, law};
use crate::gathered::jet_of;
use crate::naive_formulas::{Formula, squared_length, three};
use nalgebra::SVector;
use num_dual::DualNum;
use proboscis::energy::{DielectricCell, ElasticCell, ElasticLaw};
use proboscis::math::Jet;

/// One of each, with numbers of order one.
pub(crate) const LAWS: [(&str, ElasticLaw); 4] = [
    ("Gent", ElasticLaw::Gent { limit: 40.0 }),
    ("Mooney and Rivlin", ElasticLaw::MooneyRivlin { share: 0.3 }),
    ("Yeoh", ElasticLaw::Yeoh { c2: -0.2, c3: 0.1 }),
    (
        "Ogden",
        ElasticLaw::Ogden {
            exponents: [1.3, -4.2],
            share: 0.4,
        },
    ),
];

/// Energy per volume by the principal stretches.
pub(crate) fn density<D: DualNum<f64> + Copy>(law: ElasticLaw, mu: f64, stretches: [D; 3]) -> D {
    let powers = |exponent: f64| {
        let sum = stretches.iter().map(|l| l.powf(exponent));
        sum.fold(D::from(-3.0), |sum, power| sum + power)
    };
    let (i1, i2) = (powers(2.0), powers(-2.0));
    match law {
        ElasticLaw::Gent { limit } => (-i1 / limit + 1.0).ln() * (-0.5 * mu * limit),
        ElasticLaw::MooneyRivlin { share } => {
            i1 * (0.5 * mu * (1.0 - share)) + i2 * (0.5 * mu * share)
        }
        ElasticLaw::Yeoh { c2, c3 } => i1 * (0.5 * mu) + i1 * i1 * c2 + i1 * i1 * i1 * c3,
        ElasticLaw::Ogden { exponents, share } => {
            // μ_p α_p = 2 μ times the share of the term.
            let of = |a: f64, share: f64| powers(a) * (2.0 * mu * share / a / a);
            of(exponents[0], 1.0 - share) + of(exponents[1], share)
        }
    }
}

impl Formula<3> for ElasticCell<ElasticLaw> {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 3]) -> D {
        let s = squared_length(*p).sqrt() / self.length;
        let lateral = s.sqrt().recip();
        density(self.law, self.shear_modulus, [lateral, s, lateral]) * self.volume
    }
}

impl Formula<4> for DielectricCell<ElasticLaw> {
    fn naive<D: DualNum<f64> + Copy>(&self, p: &[D; 4]) -> D {
        let neo_hookean = of(DIELECTRIC.elastic.law);
        self.elastic.naive(&three(p, 0)) + neo_hookean.naive(p)
            - neo_hookean.elastic.naive(&three(p, 0))
    }
}

/// The muscle of the other formulas by a law.
fn of<L>(law: L) -> DielectricCell<L> {
    let (cell, elastic) = (DIELECTRIC, DIELECTRIC.elastic);
    DielectricCell {
        elastic: ElasticCell {
            length: elastic.length,
            volume: elastic.volume,
            shear_modulus: elastic.shear_modulus,
            law,
        },
        c1: cell.c1,
        c2: cell.c2,
        permittivity: cell.permittivity,
        layer: cell.layer,
    }
}

#[test]
fn laws_have_the_derivatives_of_naive_formulas() {
    for (name, elastic) in LAWS {
        law(name, &of(elastic).elastic, 0.3, 1.3);
        law(&format!("{name}, dielectric"), &of(elastic), 0.3, 1.3);
    }
}

/// Value, first, second and third derivative by the stretch.
fn by_stretch(cell: &ElasticCell<ElasticLaw>, stretch: f64) -> [f64; 3] {
    let along = SVector::from([1.0, 0.0, 0.0]);
    let jet: Jet<3, 3> = jet_of(cell, &(along * (stretch * cell.length)), &along);
    let [force, stiffness] = [jet.gradient.x, jet.hessian[(0, 0)]];
    [
        jet.value,
        force * cell.length,
        stiffness * cell.length.powi(2),
    ]
}

#[test]
fn every_law_has_the_modulus_of_small_strains() {
    for (name, elastic) in LAWS {
        let cell = of(elastic).elastic;
        let [energy, force, stiffness] = by_stretch(&cell, 1.0);
        let expected = 3.0 * cell.shear_modulus * cell.volume;
        assert!(
            energy.abs() < 1e-14 && force.abs() < 1e-14,
            "{name}: {energy} {force}"
        );
        assert!(
            (stiffness - expected).abs() < 1e-13 * expected,
            "{name}: {stiffness}"
        );
        // Stress of a finite strain is that of no other law.
        let [_, force, _] = by_stretch(&cell, 1.5);
        let neo_hooke = cell.shear_modulus * cell.volume * (1.5 - 1.5_f64.powi(-2));
        assert!(
            (force - neo_hooke).abs() > 1e-2 * neo_hooke,
            "{name}: {force}"
        );
    }
}

#[test]
fn gents_law_ends_at_its_limit() {
    for limit in [0.02, 3.0, 97.0] {
        let cell = of(ElasticLaw::Gent { limit }).elastic;
        let [low, high] = cell.law.stretches().unwrap();
        assert!(0.0 < low && low < 1.0 && 1.0 < high);
        for end in [low, high] {
            let strain = end * end + 2.0 / end - 3.0;
            assert!(
                (strain - limit).abs() < 1e-11 * limit,
                "{strain} for {limit}"
            );
            let [inside, outside] = [0.999, 1.001].map(|part| 1.0 + (end - 1.0) * part);
            assert!(by_stretch(&cell, inside).iter().all(|f| f.is_finite()));
            assert!(by_stretch(&cell, outside).iter().all(|f| f.is_nan()));
        }
    }
    assert!(LAWS[1..].iter().all(|(_, law)| law.stretches().is_none()));
}
