//! Elements of elastic blocks: as they are given, or where constants of their energies are free, sums of products of constants and energies
//! that read none of them.

use crate::element::{ElementLaw, IsochoricLaw};
use crate::energy::NeoHooke;
use crate::functional::{FiniteElement, FreeConstant, Kernel, VariedElement};
use crate::model::constants::constant::MaterialConstant;
use crate::model::layout::solid_block::{SolidBlock, of_shape};
use crate::model::terms::{Call, Terms};

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
pub(crate) struct ElementOf<'a> {
    pub(crate) block: &'a SolidBlock,
    pub(crate) number: usize,
    pub(crate) names: [&'static str; 2],
}

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

    /// A constant of its material that has a value.
    fn factor(self, constant: MaterialConstant, value: f64, terms: &Terms<'_>) -> FreeConstant {
        let mut read = terms.sought().read();
        let constant = self.block.constant(self.number, constant);
        let of = read.constant(constant, value);
        read.into_constant(of)
    }

    /// Reason for the terms of its elasticity without a field.
    fn call(&self) -> Call<'_> {
        Call(self.names[0], ELASTIC, &self.block.solid.name)
    }

    /// Adds its energy by a law.
    pub(crate) fn build<L: ElementLaw>(self, law: L, terms: &mut Terms<'_>) {
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
            let factor = self.factor(LINEAR[i], rest[i], terms);
            rest[i] = 0.0;
            self.add(NeoHooke, unit, Some(factor), terms);
        }
        if is_elastic {
            self.add_law(law, rest[0], terms);
            rest[0] = 0.0;
        }
        match (is_elastic, rest == [0.0; 5]) {
            (false, _) => self.add(law, rest, None, terms),
            (true, false) => self.add(NeoHooke, rest, None, terms),
            (true, true) => {}
        }
    }

    /// Adds the energy of a law of elasticity without λ, of which constants are free.
    fn add_law<L: ElementLaw>(self, law: L, shear_modulus: f64, terms: &mut Terms<'_>) {
        let unit = [1.0, 0.0, 0.0, 0.0, 0.0];
        match law.isochoric() {
            None => {
                let factor = self.factor(LINEAR[0], shear_modulus, terms);
                self.add(law, unit, Some(factor), terms);
            }
            Some(IsochoricLaw::MooneyRivlin { share }) => {
                for (part, slope) in [(0.0, -1.0), (1.0, 1.0)] {
                    let mut read = terms.sought().read();
                    let values = [(LINEAR[0], shear_modulus), (OF_LAWS[1], share)];
                    let [modulus, share] = values.map(|(constant, value)| {
                        read.constant(self.block.constant(self.number, constant), value)
                    });
                    let share = &share.scaled(slope) + &(1.0 - part).into();
                    let factor = read.into_constant(&modulus * &share);
                    let law = IsochoricLaw::MooneyRivlin { share: part };
                    self.add(law, unit, Some(factor), terms);
                }
            }
            Some(IsochoricLaw::Yeoh { c2, c3 }) => {
                let parts = [
                    (LINEAR[0], shear_modulus, [1.0, 0.0, 0.0]),
                    (OF_LAWS[2], c2, [0.0, 1.0, 0.0]),
                    (OF_LAWS[3], c3, [0.0, 0.0, 1.0]),
                ];
                for (constant, value, [mu, c2, c3]) in parts {
                    let factor = self.factor(constant, value, terms);
                    let unit = [mu, 0.0, 0.0, 0.0, 0.0];
                    self.add(IsochoricLaw::Yeoh { c2, c3 }, unit, Some(factor), terms);
                }
            }
            Some(law @ IsochoricLaw::Gent { limit }) => {
                let factor = self.factor(LINEAR[0], shear_modulus, terms);
                let limit = self.factor(OF_LAWS[0], limit, terms);
                match limit.parameters.is_empty() {
                    true => self.add(law, unit, Some(factor), terms),
                    false => self.add_varied(law, limit, factor, terms),
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
        limit: FreeConstant,
        factor: FreeConstant,
        terms: &mut Terms<'_>,
    ) {
        let Self { block, number, .. } = self;
        let mut law = block.passive(number).by(law);
        (law.shear_modulus, law.lame_lambda) = (1.0, 0.0);
        of_shape!(&block.shapes[number], shape => {
            let element = VariedElement {
                shape: shape.clone(),
                law,
                nodes: block.nodes(number),
                limit,
            };
            self.call().add_scaled(element, factor, terms);
        });
    }

    /// Adds an element of these constants, times factors, if there are any.
    fn add<L: ElementLaw>(
        self,
        law: L,
        constants: [f64; 5],
        factor: Option<FreeConstant>,
        terms: &mut Terms<'_>,
    ) {
        let Self {
            block,
            number,
            names,
        } = self;
        let is_charged = self.is_charged() && (factor.is_none() || constants[2..] != [0.0; 3]);
        of_shape!(&block.shapes[number], shape => {
            let (shape, nodes) = (shape.clone(), block.nodes(number));
            if is_charged {
                let element = FiniteElement {
                    shape,
                    law: block.dielectric(number).with_constants(constants).by(law),
                    nodes,
                    terminals: block.terminals(number),
                };
                let call = Call(names[1], DIELECTRIC, &block.solid.name);
                return collect(call, element, factor, terms);
            }
            let mut law = block.passive(number).by(law);
            [law.shear_modulus, law.lame_lambda] = [constants[0], constants[1]];
            let element = FiniteElement {
                shape,
                law,
                nodes,
                terminals: (),
            };
            collect(self.call(), element, factor, terms);
        });
    }
}

/// Adds an element, or the product of it with a factor.
fn collect<K: Kernel>(
    call: Call<'_>,
    element: K,
    factor: Option<FreeConstant>,
    terms: &mut Terms<'_>,
) {
    match factor {
        None => call.add(element, terms),
        Some(factor) => call.add_scaled(element, factor, terms),
    }
}
