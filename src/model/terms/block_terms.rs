//! Terms of elastic blocks: masses and weights, elements by kind, and Maxwell branches.

use crate::coordinates::Configuration;
use crate::element::{ElementGeometry, ElementLaw, MaxwellSpring, Viscosity, ViscousStrains};
use crate::energy::{KineticCoupling, MaxwellDamper, NeoHooke};
use crate::functional::{Element, FiniteElement, Mass, MaxwellElement, POINTS, ViscousElement};
use crate::kinematics::MaterialVector;
use crate::math::Matrix;
use crate::mesh::interpolation::{Element as Interpolated, Parent};
use crate::model::constants::constant::{Constant, MaterialConstant};
use crate::model::layout::internal::Internals;
use crate::model::layout::solid_block::{SolidBlock, of_shape};
use crate::model::layout::solids::Solids;
use crate::model::model::Model;
use crate::model::system::maxwell::{MaxwellBranch, Response};
use crate::model::terms::parametric_elements::ElementOf;
use crate::model::terms::{Call, Terms, UNRELAXED, mid, rate};
use std::collections::BTreeMap;

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

    /// The same with triangles of membranes.
    fn parts(&self) -> impl Iterator<Item = (&SolidBlock, usize)> + '_ {
        let elements = |block: &SolidBlock| 0..block.solid.mesh.element_count();
        self.moving()
            .flat_map(move |block| elements(block).map(move |e| (block, e)))
    }

    /// The same as [`elements`](Self::elements), with the number of the block.
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
        self.add_sheets(internals, terms);
        if !self.list.is_empty() {
            let [elasticity, electroelasticity] = NEO_HOOKEAN;
            let all = [INERTIA, elasticity, electroelasticity, VISCOSITY];
            terms.without_each(all, "no elastic block that moves");
        }
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
            let call = Call(VISCOSITY, "viscosity of", &c.solid.name);
            let constant = c.constant(e, MaterialConstant::Viscosity);
            of_shape!(&c.shapes[e], shape => {
                let element = |viscosity| ViscousElement {
                    shape: shape.clone(),
                    law: Viscosity { viscosity },
                    nodes: c.nodes(e),
                };
                call.add_linear(constant, viscosity, element, terms);
            });
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

/// A density in g/mm³ of an element of a block, where it counts.
type Density<'a> = &'a dyn Fn(&SolidBlock, usize) -> Option<f64>;

impl Solids {
    /// Consistent masses, and the weight at each node.
    pub(crate) fn add_inertia(&self, terms: &mut Terms<'_>) {
        let of = |block: &SolidBlock, e: usize| block.constant(e, MaterialConstant::Density);
        let read = terms.sought().clone();
        let given = |block: &SolidBlock, e: usize| {
            let density = block.material(e).density;
            density.filter(|_| !read.is_sought(of(block, e)))
        };
        for (vector, mass) in self.weights(&given) {
            terms.weigh_vector(vector, &mass.into(), read.read());
        }
        if self.moving().next().is_none() {
            return;
        }
        if !terms.is_of_motion() {
            terms.without(INERTIA, "a state of rest has no inertia");
        } else {
            for (vectors, mass) in self.masses(&given) {
                terms.push(INERTIA, Mass { vectors, mass });
            }
            for block in self.moving().filter(|block| block.is_heavy()) {
                terms.note(INERTIA, "density of", &block.solid.name);
            }
            terms.without(INERTIA, "no elastic block names a density");
        }
        let mut sought = Vec::new();
        for (block, e) in self.parts() {
            let is_new = sought.iter().all(|(_, known)| *known != of(block, e));
            if is_new && read.is_sought(of(block, e)) {
                sought.push((block, of(block, e)));
            }
        }
        for (block, constant) in sought {
            let its = |block: &SolidBlock, e: usize| (of(block, e) == constant).then_some(1.0);
            self.add_sought_inertia(&block.solid.name, constant, &its, terms);
        }
    }

    /// Masses and weights of the elements that have a sought density, from those of the density one.
    fn add_sought_inertia(
        &self,
        name: &str,
        constant: Constant,
        one: Density<'_>,
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let density = read.constant(constant, 0.0);
        for (vector, mass) in self.weights(one) {
            terms.weigh_vector(vector, &density.scaled(mass), read.clone());
        }
        if !terms.is_of_motion() {
            return;
        }
        for ([a, b], mass) in self.masses(one) {
            let (mass, why) = (density.scaled(mass), "density of");
            if a == b {
                terms.add_mass(Call(INERTIA, why, name), a, mass, read.clone());
            } else {
                let law = KineticCoupling { mass };
                let element = read.clone().element(law, [rate(a), rate(b)], []);
                terms.add_law(INERTIA, why, name, element);
            }
        }
    }

    fn moving(&self) -> impl Iterator<Item = &SolidBlock> {
        self.list.iter().filter(|block| !block.is_immobile)
    }

    /// Entries of the consistent mass matrix in g by pairs of vectors, of which the first is not the later one.
    fn masses(&self, density: Density<'_>) -> BTreeMap<[usize; 2], f64> {
        let mut sums = BTreeMap::new();
        for (c, e) in self.parts() {
            let Some(density) = density(c, e) else {
                continue;
            };
            if c.solid.is_membrane() {
                add_pairs(c.nodes(e), c.sheet_masses(e), density, &mut sums);
                continue;
            }
            of_shape!(&c.shapes[e], shape => add_masses(c, e, shape, density, &mut sums));
        }
        sums
    }

    /// Mass in g at each vector, as gravity sees it.
    fn weights(&self, density: Density<'_>) -> Vec<(usize, f64)> {
        let masses = |block: &SolidBlock| {
            let masses = block.integrals(|e| density(block, e)).into_iter();
            masses
                .map(|(node, mass)| (block.vectors[node], mass))
                .collect::<Vec<_>>()
        };
        self.moving().flat_map(masses).collect()
    }
}

/// Adds the consistent masses of an element with a density.
fn add_masses<const NODES: usize>(
    c: &SolidBlock,
    e: usize,
    _: &ElementGeometry<NODES>,
    density: f64,
    sums: &mut BTreeMap<[usize; 2], f64>,
) where
    Parent<NODES>: Interpolated<NODES>,
{
    let mass = ElementGeometry::mass(&c.unstretched::<NODES>(e), density);
    add_pairs(c.nodes(e), mass, 1.0, sums);
}

/// Adds the entries of a matrix by pairs of vectors times a factor.
fn add_pairs<const NODES: usize>(
    nodes: [usize; NODES],
    mass: [[f64; NODES]; NODES],
    factor: f64,
    sums: &mut BTreeMap<[usize; 2], f64>,
) {
    for (i, &a) in nodes.iter().enumerate() {
        for (j, &b) in nodes.iter().enumerate().filter(|&(_, &b)| a <= b) {
            *sums.entry([a, b]).or_default() += factor * mass[i][j];
        }
    }
}

const MAXWELL: [&str; 2] = ["block maxwell elasticity", "block maxwell viscosity"];

impl Solids {
    /// Springs and dampers of Maxwell branches.
    pub(crate) fn add_branches(&self, internals: &Internals, terms: &mut Terms<'_>) {
        for (b, c, e) in self.numbered() {
            for (branch, constants) in c.material(e).maxwell.list().iter().enumerate() {
                if let Some(strains) = internals.strains(b, e, branch, c) {
                    add_branch(c, e, branch, constants, strains, terms);
                } else if terms.is_instantaneous() {
                    let call = Call(MAXWELL[0], UNRELAXED, &c.solid.name);
                    let constant = c.constant(e, MaterialConstant::BranchModulus(branch));
                    of_shape!(c.reference_shape(e), shape => {
                        let element = |shear_modulus| FiniteElement {
                            shape: shape.clone(),
                            law: c.unrelaxed(shear_modulus),
                            nodes: c.nodes(e),
                            terminals: (),
                        };
                        call.add_linear(constant, constants.shear_modulus, element, terms);
                    });
                }
            }
        }
        terms.without_branches(MAXWELL);
    }
}

/// The damper of a branch at a point with the vectors of its viscous strain.
pub(super) fn damper(
    [stretches, shears]: [usize; 2],
    coefficient: f64,
) -> Element<MaxwellDamper, 18, 6, 0> {
    let (stretched, sheared) = (mid(stretches), mid(shears));
    let rates = [rate(stretches), rate(shears)];
    Element {
        energy: MaxwellDamper { coefficient },
        vectors: [stretched, sheared, stretched, sheared, rates[0], rates[1]],
        scalars: [],
    }
}

/// One branch of an element: its spring, and the damper of each Gauss point.
fn add_branch(
    c: &SolidBlock,
    e: usize,
    branch: usize,
    constants: &MaxwellBranch,
    strains: Vec<[MaterialVector; 2]>,
    terms: &mut Terms<'_>,
) {
    let MaxwellBranch {
        shear_modulus,
        relaxation_time,
    } = *constants;
    let [elasticity, viscosity] =
        MAXWELL.map(|term| Call(term, "Maxwell branches of", &c.solid.name));
    let [of_modulus, of_time] = [
        MaterialConstant::BranchModulus(branch),
        MaterialConstant::RelaxationTime(branch),
    ]
    .map(|constant| c.constant(e, constant));
    let mut read = terms.sought().read();
    let modulus = read.constant(of_modulus, shear_modulus);
    let both = &modulus * &read.constant(of_time, relaxation_time);
    let both = read.into_constant(both);
    let strains = strains
        .into_iter()
        .map(|parts| parts.map(|part| terms.new_vector(part)));
    let strains: Vec<[usize; 2]> = strains.collect();
    let strains: [[usize; 2]; POINTS] = std::array::from_fn(|point| strains[point]);
    for ([stretches, shears], volume) in strains.into_iter().zip(c.shapes[e].weights()) {
        let given = damper(
            [stretches, shears],
            relaxation_time * shear_modulus * volume,
        );
        let unit = damper([stretches, shears], *volume);
        viscosity.add_times(given, unit, both.clone(), terms);
    }
    of_shape!(&c.shapes[e], shape => {
        let element = |shear_modulus| MaxwellElement {
            shape: shape.clone(),
            law: MaxwellSpring { shear_modulus },
            nodes: c.nodes(e),
            strains,
        };
        elasticity.add_linear(of_modulus, shear_modulus, element, terms);
    });
}

impl Model {
    /// Cauchy stress in MPa of the Maxwell branches of an element of a block at a placed instant, its mean over the reference volume; `None`
    /// where it has none, or they have relaxed.
    pub fn branch_stress(
        &self,
        block: usize,
        element: usize,
        at: &Configuration,
    ) -> Option<Matrix> {
        let of = &self.solids[block];
        let branches = of.material(element).maxwell.list();
        if of.solid.is_membrane() {
            return self.sheet_branch_stress(block, element, at);
        }
        if let Some(first) = self.internals.of_elements.get(&(block, element)) {
            let first = self.action.map.internal().start + first;
            let stress = |(branch, shear_modulus): (usize, f64)| {
                let mut strains = ViscousStrains::default();
                let count = strains.len();
                for point in 0..POINTS {
                    for (m, strain) in strains.iter_mut().enumerate() {
                        strain[point] = at.z[first + count * (POINTS * branch + point) + m];
                    }
                }
                let law = MaxwellSpring { shear_modulus };
                of_shape!(&of.shapes[element], shape => {
                    law.stress(shape, &of.nodes(element).map(|v| at.x[v]), &strains)
                })
            };
            let moduli = branches.iter().map(|branch| branch.shear_modulus);
            return Some(moduli.enumerate().map(stress).sum());
        }
        let is_at_once = self.analysis.response == Response::Instantaneous;
        if self.analysis.of_motion || !is_at_once || branches.is_empty() {
            return None;
        }
        let sum = branches.iter().map(|branch| branch.shear_modulus).sum();
        let law = of.unrelaxed(sum);
        Some(of_shape!(of.reference_shape(element), shape => {
            law.fields(&shape, &of.nodes(element).map(|v| at.x[v]), &()).stress
        }))
    }
}
