//! Elements of elastic blocks: as they are given, or where constants of their energies are free, sums of products of constants and energies
//! that read none of them.

use crate::element::{ElementLaw, IsochoricLaw};
use crate::energy::{NeoHooke, Polynomial};
use crate::functional::{FiniteElement, VariedElement};
use crate::model::constant::MaterialConstant;
use crate::model::free_parameters::Read;
use crate::model::solid_block::SolidBlock;
use crate::model::terms::{Member, OfKind, Terms};

/// Constants of an energy beside those of its law of elasticity, in all of which it is linear: μ, λ, c₁, c₂ and ε.
const LINEAR: [MaterialConstant; 5] = [
    MaterialConstant::ShearModulus,
    MaterialConstant::LameLambda,
    MaterialConstant::C1,
    MaterialConstant::C2,
    MaterialConstant::Permittivity,
];

/// Constants of laws of elasticity of elements.
const OF_LAWS: [MaterialConstant; 4] = [
    MaterialConstant::Law("limit"),
    MaterialConstant::Law("share"),
    MaterialConstant::Law("c2"),
    MaterialConstant::Law("c3"),
];

const ELASTIC: &str = "elements without a field of";
const DIELECTRIC: &str = "elements in a field of";

/// An element of a block, and the names of the terms of elasticity and of electroelasticity.
#[derive(Clone, Copy)]
pub(super) struct ElementOf<'a> {
    pub(super) block: &'a SolidBlock,
    pub(super) number: usize,
    pub(super) names: [&'static str; 2],
}

/// Constants, some of which are free, and what is read of them; no constants of an element that is itself.
type Factors = (Vec<Polynomial>, Read);

impl ElementOf<'_> {
    fn is_charged(self) -> bool {
        self.block.is_dielectric[self.number]
    }

    /// Its constants μ, λ, c₁, c₂ and ε as they are given.
    fn constants(self) -> [f64; 5] {
        if self.is_charged() {
            return self.block.dielectric(self.number).constants();
        }
        let law = self.block.passive(self.number);
        [law.shear_modulus, law.lame_lambda, 0.0, 0.0, 0.0]
    }

    /// The product of constants of its material that have these values.
    fn product(self, of: &[(MaterialConstant, f64)], terms: &Terms<'_>) -> Factors {
        let mut read = terms.sought().read();
        let factor = |&(constant, value): &(MaterialConstant, f64)| {
            read.constant(self.block.constant(self.number, constant), value)
        };
        let factors = of.iter().map(factor).collect();
        (factors, read)
    }

    /// Adds its energy by a law.
    pub(super) fn build<L: ElementLaw>(self, law: L, terms: &mut Terms<'_>) {
        let mut rest = self.constants();
        let is_sought = |constant: &MaterialConstant| {
            let constant = self.block.constant(self.number, *constant);
            terms.sought().is_sought(constant)
        };
        let linear = LINEAR.each_ref().map(is_sought);
        let is_elastic = linear[0] || OF_LAWS.iter().any(is_sought);
        let last = if self.is_charged() { 5 } else { 2 };
        for i in (1..last).filter(|&i| linear[i]) {
            let mut unit = [0.0; 5];
            unit[i] = 1.0;
            let factor = self.product(&[(LINEAR[i], rest[i])], terms);
            rest[i] = 0.0;
            self.add(NeoHooke, unit, factor, terms);
        }
        if is_elastic {
            self.add_law(law, rest[0], terms);
            rest[0] = 0.0;
        }
        let nothing = (Vec::new(), terms.sought().read());
        match (is_elastic, rest == [0.0; 5]) {
            (false, _) => self.add(law, rest, nothing, terms),
            (true, false) => self.add(NeoHooke, rest, nothing, terms),
            (true, true) => {}
        }
    }

    /// Adds the energy of a law of elasticity without λ, of which constants are free.
    fn add_law<L: ElementLaw>(self, law: L, shear_modulus: f64, terms: &mut Terms<'_>) {
        let modulus = (LINEAR[0], shear_modulus);
        let unit = [1.0, 0.0, 0.0, 0.0, 0.0];
        match law.isochoric() {
            None => {
                let factor = self.product(&[modulus], terms);
                self.add(law, unit, factor, terms);
            }
            Some(IsochoricLaw::MooneyRivlin { share }) => {
                for (part, slope) in [(0.0, -1.0), (1.0, 1.0)] {
                    let (mut factors, read) = self.product(&[modulus, (OF_LAWS[1], share)], terms);
                    factors[1] = factors[1].scaled(slope, 1.0 - part);
                    let law = IsochoricLaw::MooneyRivlin { share: part };
                    self.add(law, unit, (factors, read), terms);
                }
            }
            Some(IsochoricLaw::Yeoh { c2, c3 }) => {
                let parts = [
                    (modulus, [1.0, 0.0, 0.0]),
                    ((OF_LAWS[2], c2), [0.0, 1.0, 0.0]),
                    ((OF_LAWS[3], c3), [0.0, 0.0, 1.0]),
                ];
                for (constant, [mu, c2, c3]) in parts {
                    let factor = self.product(&[constant], terms);
                    let unit = [mu, 0.0, 0.0, 0.0, 0.0];
                    self.add(IsochoricLaw::Yeoh { c2, c3 }, unit, factor, terms);
                }
            }
            Some(law @ IsochoricLaw::Gent { limit }) => {
                let factor = self.product(&[modulus], terms);
                let (limits, read) = self.product(&[(OF_LAWS[0], limit)], terms);
                match (read.scalars().first(), limits.into_iter().next()) {
                    (Some(&parameter), Some(limit)) => {
                        self.add_varied(law, limit, parameter, factor, terms);
                    }
                    _ => self.add(law, unit, factor, terms),
                }
            }
            Some(IsochoricLaw::GentSlope { .. } | IsochoricLaw::GentCurvature { .. }) => {
                unreachable!("a material names no derivative of a law")
            }
        }
    }

    /// Adds an element by Gent's law whose limit follows a parameter.
    fn add_varied(
        self,
        law: IsochoricLaw,
        limit: Polynomial,
        parameter: usize,
        factor: Factors,
        terms: &mut Terms<'_>,
    ) {
        let Self {
            block,
            number,
            names,
        } = self;
        let mut law = block.passive(number).by(law);
        (law.shear_modulus, law.lame_lambda) = (1.0, 0.0);
        let element = VariedElement {
            shape: block.shapes[number].clone(),
            law,
            nodes: block.nodes(number),
            limit,
            parameter,
        };
        let of = (names[0], ELASTIC, block.solid.name.as_str());
        collect(of, element, factor, terms);
    }

    /// Adds an element of these constants, times factors, if there are any.
    fn add<L: ElementLaw>(
        self,
        law: L,
        constants: [f64; 5],
        factors: Factors,
        terms: &mut Terms<'_>,
    ) {
        let Self {
            block,
            number,
            names,
        } = self;
        let (shape, nodes) = (block.shapes[number].clone(), block.nodes(number));
        let of = block.solid.name.as_str();
        if self.is_charged() && (factors.0.is_empty() || constants[2..] != [0.0; 3]) {
            let law = block.dielectric(number).with_constants(constants).by(law);
            let terminals = block.terminals(number);
            let element = FiniteElement {
                shape,
                law,
                nodes,
                terminals,
            };
            return collect((names[1], DIELECTRIC, of), element, factors, terms);
        }
        let mut law = block.passive(number).by(law);
        [law.shear_modulus, law.lame_lambda] = [constants[0], constants[1]];
        let element = FiniteElement {
            shape,
            law,
            nodes,
            terminals: (),
        };
        collect((names[0], ELASTIC, of), element, factors, terms);
    }
}

/// Adds an element, or the product of it with its factors.
fn collect<E: OfKind + Member>(
    (term, why, of): (&'static str, &'static str, &str),
    element: E,
    (factors, read): Factors,
    terms: &mut Terms<'_>,
) {
    match factors.is_empty() {
        true => terms.collect::<(), _>(term, why, of, element),
        false => terms.add_scaled(term, why, of, (element, factors, read)),
    }
}
