//! Terms of elastic blocks: elements by kind.

use crate::element::{Elastomer, ElementLaw, Viscosity};
use crate::energy::{NeoHooke, Polynomial};
use crate::functional::{FiniteElement, ViscousElement};
use crate::model::constant::MaterialConstant;
use crate::model::internal::Internals;
use crate::model::members::{Member, OfKind};
use crate::model::solid_block::SolidBlock;
use crate::model::solids::Solids;
use crate::model::sought::Read;
use crate::model::terms::Terms;

const INERTIA: &str = "block inertia";
const ELASTICITY: &str = "block elasticity";
const ELECTROELASTICITY: &str = "block electroelasticity";
/// Elasticity and electroelasticity by a law other than the neo-Hookean one.
const GENERAL: [&str; 2] = [
    "general block elasticity",
    "general block electroelasticity",
];
const VISCOSITY: &str = "block viscosity";

impl Solids {
    /// Elements of all blocks of which anything is unknown, as pairs of block and element.
    pub(super) fn elements(&self) -> impl Iterator<Item = (&SolidBlock, usize)> + '_ {
        self.numbered().map(|(_, block, e)| (block, e))
    }

    /// The same, with the number of the block.
    pub(super) fn numbered(&self) -> impl Iterator<Item = (usize, &SolidBlock, usize)> + '_ {
        let blocks = self.list.iter().enumerate();
        blocks
            .filter(|(_, block)| !block.is_immobile)
            .flat_map(|(b, block)| (0..block.shapes.len()).map(move |e| (b, block, e)))
    }

    /// Terms of all blocks.
    pub(super) fn build(&self, internals: &Internals, terms: &mut Terms<'_>) {
        let all = [INERTIA, ELASTICITY, ELECTROELASTICITY, VISCOSITY];
        self.add_inertia(terms);
        self.add_elements(terms);
        self.add_viscosity(terms);
        self.add_branches(internals, terms);
        for term in all {
            terms.without(
                term,
                match self.list.is_empty() {
                    true => "no elastic block",
                    false => "no elastic block that moves",
                },
            );
        }
    }

    /// Elastic and dielectric elements.
    fn add_elements(&self, terms: &mut Terms<'_>) {
        for (c, e) in self.elements() {
            match c.isochoric(e) {
                None if is_sought(c, e, terms) => add_sought_element(c, e, terms),
                None => add_element(c, e, (NeoHooke, [ELASTICITY, ELECTROELASTICITY]), terms),
                Some(law) => {
                    add_element(c, e, (law, GENERAL), terms);
                    for term in [ELASTICITY, ELECTROELASTICITY] {
                        terms.without(term, "every elastic block names a law of elasticity");
                    }
                }
            }
        }
        for term in GENERAL {
            terms.without(
                term,
                "no elastic block that moves names a law of elasticity",
            );
        }
    }

    /// Viscous elements.
    fn add_viscosity(&self, terms: &mut Terms<'_>) {
        for (c, e) in self.elements() {
            let Some(viscosity) = c.material(e).viscosity else {
                terms.without(VISCOSITY, "no elastic block names a viscosity");
                continue;
            };
            if !terms.is_of_motion() {
                terms.without(VISCOSITY, "a state of rest dissipates nothing");
                continue;
            }
            let element = |viscosity| ViscousElement {
                shape: c.shapes[e].clone(),
                law: Viscosity { viscosity },
                nodes: c.nodes(e),
            };
            let mut read = terms.sought().read();
            let factor = read.constant(c.constant(e, MaterialConstant::Viscosity), viscosity);
            let of = (VISCOSITY, "viscosity of", c.solid.name.as_str());
            let pair = (element(viscosity), element(1.0));
            add_times::<(), _>(of, pair, (vec![factor], read), terms);
        }
    }
}

/// An element as it is given, or that of the constant one times constants some of which are sought.
pub(super) fn add_times<Kind, E: OfKind + Member<Kind>>(
    (term, why, of): (&'static str, &'static str, &str),
    (given, unit): (E, E),
    (factors, read): (Vec<Polynomial>, Read),
    terms: &mut Terms<'_>,
) {
    match read.is_empty() {
        true => terms.collect::<Kind, _>(term, why, of, given),
        false => terms.add_scaled(term, why, of, (unit, factors, read)),
    }
}

/// One elastic or dielectric element, in one of two terms.
fn add_element<L: ElementLaw>(
    c: &SolidBlock,
    e: usize,
    (law, [elasticity, electroelasticity]): (L, [&'static str; 2]),
    terms: &mut Terms<'_>,
) {
    let (shape, nodes) = (c.shapes[e].clone(), c.nodes(e));
    let name = &c.solid.name;
    match c.is_dielectric[e] {
        false => {
            let element = FiniteElement {
                shape,
                law: c.passive(e).by(law),
                nodes,
                terminals: (),
            };
            terms.collect(elasticity, "elements without a field of", name, element);
            let why = match c.material(e).electric {
                None => "no elastic block that moves names electric constants there",
                Some(_) => "no field between electrodes of different voltages reaches an element",
            };
            terms.without(electroelasticity, why);
        }
        true => {
            let element = FiniteElement {
                shape,
                law: c.dielectric(e).by(law),
                nodes,
                terminals: c.terminals(e),
            };
            terms.collect(electroelasticity, "elements in a field of", name, element);
            terms.without(elasticity, "a field reaches every element");
        }
    }
}

/// Returns true if a constant of the elastic or electric energy of an element is sought.
fn is_sought(c: &SolidBlock, e: usize, terms: &Terms<'_>) -> bool {
    let sought = |constant: &MaterialConstant| terms.sought().is_sought(c.constant(e, *constant));
    OF_ENERGY.iter().any(sought)
}

/// Constants of the energy of a neo-Hookean element, in all of which it is linear.
const OF_ENERGY: [MaterialConstant; 5] = [
    MaterialConstant::ShearModulus,
    MaterialConstant::LameLambda,
    MaterialConstant::C1,
    MaterialConstant::C2,
    MaterialConstant::Permittivity,
];

/// A neo-Hookean element some of whose constants are sought: the elements of one of these each times the constant, and one of the others.
fn add_sought_element(c: &SolidBlock, e: usize, terms: &mut Terms<'_>) {
    let is_charged = c.is_dielectric[e];
    let given = match is_charged {
        true => c.dielectric(e).constants(),
        false => {
            let law = c.passive(e);
            [law.shear_modulus, law.lame_lambda, 0.0, 0.0, 0.0]
        }
    };
    let mut rest = given;
    for (i, constant) in OF_ENERGY.into_iter().enumerate() {
        let mut read = terms.sought().read();
        let factor = read.constant(c.constant(e, constant), given[i]);
        if read.is_empty() || (i >= 2 && !is_charged) {
            continue;
        }
        rest[i] = 0.0;
        let mut unit = [0.0; 5];
        unit[i] = 1.0;
        add_part(c, e, (unit, (vec![factor], read)), terms);
    }
    if rest != [0.0; 5] {
        add_part(c, e, (rest, (Vec::new(), terms.sought().read())), terms);
    }
}

/// An element of these constants, times others that are sought, if there are any.
fn add_part(
    c: &SolidBlock,
    e: usize,
    (constants, sought): ([f64; 5], (Vec<Polynomial>, Read)),
    terms: &mut Terms<'_>,
) {
    let (shape, nodes) = (c.shapes[e].clone(), c.nodes(e));
    let name = &c.solid.name;
    if c.is_dielectric[e] {
        let element = FiniteElement {
            shape,
            law: c.dielectric(e).with_constants(constants),
            nodes,
            terminals: c.terminals(e),
        };
        let of = (ELECTROELASTICITY, "elements in a field of", name.as_str());
        add_times::<(), _>(of, (element.clone(), element), sought, terms);
        return;
    }
    let law = Elastomer {
        shear_modulus: constants[0],
        lame_lambda: constants[1],
        ..c.passive(e)
    };
    let element = FiniteElement {
        shape,
        law,
        nodes,
        terminals: (),
    };
    let of = (ELASTICITY, "elements without a field of", name.as_str());
    add_times::<(), _>(of, (element.clone(), element), sought, terms);
}
