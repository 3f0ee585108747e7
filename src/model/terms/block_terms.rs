//! Terms of elastic blocks: elements by kind.

use crate::element::{ElementLaw, Viscosity};
use crate::energy::NeoHooke;
use crate::functional::ViscousElement;
use crate::model::constants::constant::MaterialConstant;
use crate::model::layout::internal::Internals;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::solids::Solids;
use crate::model::terms::parametric_elements::ElementOf;
use crate::model::terms::{Call, Terms};

const INERTIA: &str = "block inertia";
/// Elasticity and electroelasticity.
const NEO_HOOKEAN: [&str; 2] = ["block elasticity", "block electroelasticity"];
/// Both by a law other than the neo-Hookean one.
const GENERAL: [&str; 2] = [
    "general block elasticity",
    "general block electroelasticity",
];
const VISCOSITY: &str = "block viscosity";

impl Solids {
    /// Elements of all blocks of which anything is unknown, as pairs of block and element.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (&SolidBlock, usize)> + '_ {
        self.numbered().map(|(_, block, e)| (block, e))
    }

    /// The same, with the number of the block.
    pub(crate) fn numbered(&self) -> impl Iterator<Item = (usize, &SolidBlock, usize)> + '_ {
        let blocks = self.list.iter().enumerate();
        blocks
            .filter(|(_, block)| !block.is_immobile)
            .flat_map(|(b, block)| (0..block.shapes.len()).map(move |e| (b, block, e)))
    }

    /// Terms of all blocks.
    pub(crate) fn build(&self, internals: &Internals, terms: &mut Terms<'_>) {
        self.add_inertia(terms);
        self.add_elements(terms);
        self.add_viscosity(terms);
        self.add_branches(internals, terms);
        let [elasticity, electroelasticity] = NEO_HOOKEAN;
        let none = match self.list.is_empty() {
            true => "no elastic block",
            false => "no elastic block that moves",
        };
        terms.without_each([INERTIA, elasticity, electroelasticity, VISCOSITY], none);
    }

    /// Elastic and dielectric elements.
    fn add_elements(&self, terms: &mut Terms<'_>) {
        for (c, e) in self.elements() {
            match c.isochoric(e) {
                None => add_element(c, e, NeoHooke, NEO_HOOKEAN, terms),
                Some(law) => {
                    add_element(c, e, law, GENERAL, terms);
                    terms
                        .without_each(NEO_HOOKEAN, "every elastic block names a law of elasticity");
                }
            }
        }
        terms.without_each(
            GENERAL,
            "no elastic block that moves names a law of elasticity",
        );
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
            let (given, unit) = (element(viscosity), element(1.0));
            Call {
                term: VISCOSITY,
                why: "viscosity of",
                of: &c.solid.name,
            }
            .add_times::<(), _>(given, unit, factor, read, terms);
        }
    }
}

/// One elastic or dielectric element, in one of two terms.
fn add_element<L: ElementLaw>(
    c: &SolidBlock,
    e: usize,
    law: L,
    names: [&'static str; 2],
    terms: &mut Terms<'_>,
) {
    match (c.is_dielectric[e], c.material(e).electric) {
        (true, _) => terms.without(names[0], "a field reaches every element"),
        (false, None) => terms.without(
            names[1],
            "no elastic block that moves names electric constants there",
        ),
        (false, Some(_)) => terms.without(
            names[1],
            "no field between electrodes of different voltages reaches an element",
        ),
    }
    let element = ElementOf {
        block: c,
        number: e,
        names,
    };
    element.build(law, terms);
}
