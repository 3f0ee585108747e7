//! Terms of elastic blocks: elements by kind, masses, weights.

use crate::element::{Elastomer, ElementLaw, MaxwellSpring, Viscosity};
use crate::energy::{MaxwellDamper, NeoHooke, Polynomial};
use crate::functional::{Element, FiniteElement, Mass, MaxwellElement, POINTS, ViscousElement};
use crate::kinematics::MaterialVector;
use crate::model::constant::MaterialConstant;
use crate::model::internal::Internals;
use crate::model::maxwell::MaxwellBranch;
use crate::model::solid_block::SolidBlock;
use crate::model::solids::Solids;
use crate::model::sought::Read;
use crate::model::terms::{Terms, UNRELAXED, mid, rate};
use std::collections::BTreeMap;

const INERTIA: &str = "block inertia";
const ELASTICITY: &str = "block elasticity";
const ELECTROELASTICITY: &str = "block electroelasticity";
/// Elasticity and electroelasticity by a law other than the neo-Hookean one.
const GENERAL: [&str; 2] = [
    "general block elasticity",
    "general block electroelasticity",
];
const VISCOSITY: &str = "block viscosity";
const MAXWELL: [&str; 2] = ["block maxwell elasticity", "block maxwell viscosity"];

impl Solids {
    /// Elements of all blocks of which anything is unknown, as pairs of block and element.
    fn elements(&self) -> impl Iterator<Item = (&SolidBlock, usize)> + '_ {
        self.numbered().map(|(_, block, e)| (block, e))
    }

    /// The same, with the number of the block.
    fn numbered(&self) -> impl Iterator<Item = (usize, &SolidBlock, usize)> + '_ {
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

    /// Consistent masses, and the weight at each node.
    fn add_inertia(&self, terms: &mut Terms<'_>) {
        let moving = || self.list.iter().filter(|block| !block.is_immobile);
        let is_heavy = |c: &&SolidBlock| c.solid.materials.iter().any(|m| m.density.is_some());
        for (vector, mass) in self.loads() {
            terms.weigh_vector(vector, mass);
        }
        if moving().next().is_none() {
            return;
        }
        if !terms.is_of_motion() {
            return terms.without(INERTIA, "a state of rest has no inertia");
        }
        for mass in self.masses() {
            terms.push(INERTIA, mass);
        }
        match moving().any(|c| is_heavy(&c)) {
            true => {
                for block in moving().filter(is_heavy) {
                    terms.note(INERTIA, "density of", &block.solid.name);
                }
            }
            false => terms.without(INERTIA, "no elastic block names a density"),
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
            let (why, name) = ("viscosity of", &c.solid.name);
            match read.is_empty() {
                true => terms.collect(VISCOSITY, why, name, element(viscosity)),
                false => terms.add_scaled(VISCOSITY, why, name, (element(1.0), factor, read)),
            }
        }
    }

    /// Springs and dampers of Maxwell branches.
    fn add_branches(&self, internals: &Internals, terms: &mut Terms<'_>) {
        for (b, c, e) in self.numbered() {
            for (branch, constants) in c.material(e).maxwell.list().iter().enumerate() {
                if let Some(strains) = internals.strains(b, e, branch) {
                    add_branch((c, e), constants, strains, terms);
                } else if terms.is_instantaneous() {
                    let element = FiniteElement {
                        shape: c.reference_shape(e),
                        law: c.unrelaxed(constants.shear_modulus),
                        nodes: c.nodes(e),
                        terminals: (),
                    };
                    terms.collect(MAXWELL[0], UNRELAXED, &c.solid.name, element);
                }
            }
        }
        terms.without_branches(
            MAXWELL,
            "no elastic block that moves names a Maxwell branch",
        );
    }

    /// The consistent mass matrix of all blocks.
    fn masses(&self) -> Vec<Mass> {
        let mut sums: BTreeMap<[usize; 2], f64> = BTreeMap::new();
        for (c, e) in self.elements() {
            let Some(density) = c.material(e).density else {
                continue;
            };
            let (nodes, mass) = (c.nodes(e), c.shapes[e].mass(density));
            for (i, &a) in nodes.iter().enumerate() {
                for (j, &b) in nodes.iter().enumerate().filter(|&(_, &b)| a <= b) {
                    *sums.entry([a, b]).or_default() += mass[i][j];
                }
            }
        }
        sums.into_iter()
            .map(|(vectors, mass)| Mass { vectors, mass })
            .collect()
    }

    /// Mass at each vector, as gravity sees it.
    fn loads(&self) -> Vec<(usize, f64)> {
        let moving = self.list.iter().filter(|block| !block.is_immobile);
        let masses = |block: &SolidBlock| {
            let masses = block.integrals(|material| material.density).into_iter();
            masses
                .map(|(node, mass)| (block.vectors[node], mass))
                .collect::<Vec<_>>()
        };
        moving.flat_map(masses).collect()
    }
}

/// One branch of an element: its spring, and the damper of each Gauss point.
fn add_branch(
    (c, e): (&SolidBlock, usize),
    &MaxwellBranch {
        shear_modulus,
        relaxation_time,
    }: &MaxwellBranch,
    strains: [[MaterialVector; 2]; POINTS],
    terms: &mut Terms<'_>,
) {
    let ([elasticity, viscosity], why) = (MAXWELL, "Maxwell branches of");
    let strains = strains.map(|parts| parts.map(|part| terms.new_vector(part)));
    let shape = c.shapes[e].clone();
    for ([stretches, shears], volume) in strains.into_iter().zip(shape.weights()) {
        let damper = MaxwellDamper {
            coefficient: relaxation_time * shear_modulus * volume,
        };
        let (stretched, sheared) = (mid(stretches), mid(shears));
        let rates = [rate(stretches), rate(shears)];
        let element = Element {
            energy: damper,
            vectors: [stretched, sheared, stretched, sheared, rates[0], rates[1]],
            scalars: [],
        };
        terms.add::<_, 18, 6, 0>(viscosity, why, &c.solid.name, element);
    }
    let element = MaxwellElement {
        shape,
        law: MaxwellSpring { shear_modulus },
        nodes: c.nodes(e),
        strains,
    };
    terms.collect(elasticity, why, &c.solid.name, element);
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
        add_part(c, e, (unit, Some((factor, read))), terms);
    }
    if rest != [0.0; 5] {
        add_part(c, e, (rest, None), terms);
    }
}

/// An element of these constants, times one that is sought.
fn add_part(
    c: &SolidBlock,
    e: usize,
    (constants, sought): ([f64; 5], Option<(Polynomial, Read)>),
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
        let why = "elements in a field of";
        match sought {
            None => terms.collect(ELECTROELASTICITY, why, name, element),
            Some((factor, read)) => {
                terms.add_scaled(ELECTROELASTICITY, why, name, (element, factor, read));
            }
        }
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
    let why = "elements without a field of";
    match sought {
        None => terms.collect(ELASTICITY, why, name, element),
        Some((factor, read)) => terms.add_scaled(ELASTICITY, why, name, (element, factor, read)),
    }
}
