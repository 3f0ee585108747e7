//! Terms of membranes: each point of a triangle is a formula of two tangents, which are sums of the places of its nodes.

use crate::coordinates::Configuration;
use crate::element::SheetPoint;
use crate::energy::{
    ChargedMembrane, Coefficient, DielectricMembrane, ElasticConstants, ElasticMembrane,
    MaxwellMembrane, NeoHooke, ViscousMembrane,
};
use crate::functional::Element;
use crate::kinematics::MaterialVector;
use crate::math::Matrix;
use crate::model::constants::constant::MaterialConstant;
use crate::model::layout::internal::Internals;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::solids::Solids;
use crate::model::model::Model;
use crate::model::system::maxwell::MaxwellBranch;
use crate::model::terms::block_terms::damper;
use crate::model::terms::{Call, Terms, UNRELAXED, mid, rate};

const ELASTICITY: &str = "membrane elasticity";
const ELECTROSTATICS: &str = "membrane electrostatics";
const VISCOSITY: &str = "membrane viscosity";
const MAXWELL: [&str; 2] = ["membrane maxwell elasticity", "membrane maxwell viscosity"];

/// A point of a triangle.
#[derive(Clone, Copy)]
struct At<'a> {
    of: &'a SolidBlock,
    element: usize,
    /// Vectors f₁, f₂.
    tangents: [usize; 2],
    /// Volume in mm³.
    volume: f64,
}

impl Solids {
    /// Terms of all membranes.
    pub(super) fn add_sheets(&self, internals: &Internals, terms: &mut Terms<'_>) {
        let membranes = self.list.iter().enumerate();
        let membranes = membranes.filter(|(_, of)| of.solid.is_membrane() && !of.is_immobile);
        for (number, of) in membranes {
            for (element, points) in of.sheets.iter().enumerate() {
                let branches = of.material(element).maxwell.list().iter().enumerate();
                let strains: Vec<_> = branches
                    .map(|(branch, by)| {
                        (branch, by, internals.strains(number, element, branch, of))
                    })
                    .collect();
                for (g, point) in points.iter().enumerate() {
                    let at = At::new(of, element, point, terms);
                    at.add_elasticity(terms);
                    at.add_field(terms);
                    at.add_viscosity(terms);
                    for (branch, by, strains) in &strains {
                        if let Some(strains) = strains {
                            at.add_branch(*branch, by, &strains[g], terms);
                        }
                    }
                }
                if terms.is_instantaneous() {
                    add_unrelaxed(of, element, terms);
                }
            }
            let all = [ELASTICITY, ELECTROSTATICS, VISCOSITY];
            terms.without_each(all, "no membrane that calls for it");
            terms.without_branches(MAXWELL);
        }
    }
}

/// Springs of branches that have no stress in the reference configuration.
fn add_unrelaxed(of: &SolidBlock, element: usize, terms: &mut Terms<'_>) {
    let branches = of.material(element).maxwell.list().iter().enumerate();
    for (branch, by) in branches {
        let nodes = of.solid.mesh.element(element);
        let places = std::array::from_fn(|i| of.solid.mesh.nodes[nodes[i]]);
        let points = SheetPoint::all(&places).expect("a checked triangle has an area");
        for (point, whole) in points.iter().zip(&of.sheets[element]) {
            let volume = whole.area * of.thickness();
            let at = At {
                volume,
                ..At::new(of, element, point, terms)
            };
            at.elastic(
                MAXWELL[0],
                UNRELAXED,
                MaterialConstant::BranchModulus(branch),
                by.shear_modulus,
                |_| NeoHooke,
                terms,
            );
        }
    }
}

impl Model {
    /// Stress in MPa of the Maxwell branches of a triangle at a placed instant; `None` where it has none, or they have relaxed.
    pub(super) fn sheet_branch_stress(
        &self,
        block: usize,
        element: usize,
        at: &Configuration,
    ) -> Option<Matrix> {
        let of = &self.solids[block];
        let branches = of.material(element).maxwell.list().iter().enumerate();
        let first = self.internals.of_elements.get(&(block, element))?;
        let first = self.action.map.internal().start + first;
        let [points, coordinates] = of.strains();
        let stress = |branch: usize, by: &MaxwellBranch, point: usize| {
            let strain = &at.z[first + coordinates * (points * branch + point)..];
            let strain = [strain[0], strain[1], strain[2]];
            of.sheet_branch_stress(element, point, &at.x, by.shear_modulus, strain)
        };
        let all = branches.flat_map(|(branch, by)| (0..points).map(move |p| (branch, by, p)));
        Some(
            all.map(|(branch, by, point)| stress(branch, by, point))
                .sum(),
        )
    }
}

impl<'a> At<'a> {
    fn new(of: &'a SolidBlock, element: usize, point: &SheetPoint, terms: &mut Terms<'_>) -> Self {
        let nodes: [usize; 6] = of.nodes(element);
        let tangents = point.sums(|node| &terms.vectors.list()[nodes[node]]);
        Self {
            of,
            element,
            tangents: tangents.map(|tangent| terms.new_vector(tangent)),
            volume: point.area * of.thickness(),
        }
    }

    fn name(&self) -> &'a str {
        &self.of.solid.name
    }

    /// A neo-Hookean or another elasticity with a shear modulus.
    fn elastic<L: ElasticConstants>(
        &self,
        term: &'static str,
        why: &'static str,
        modulus: MaterialConstant,
        value: f64,
        law: impl FnOnce(&mut dyn FnMut(&'static str, &f64) -> Coefficient) -> L,
        terms: &mut Terms<'_>,
    ) {
        let mut read = terms.sought().read();
        let shear_modulus = read.constant(self.of.constant(self.element, modulus), value);
        let law = law(&mut |name, &value| {
            let constant = MaterialConstant::Law(name);
            read.constant(self.of.constant(self.element, constant), value)
        });
        let cell = ElasticMembrane {
            volume: self.volume.into(),
            shear_modulus,
            law,
        };
        let element = read.element(cell, self.tangents.map(mid), []);
        terms.add_law::<_, 6, 2, 0>(term, why, self.name(), element);
    }

    fn add_elasticity(&self, terms: &mut Terms<'_>) {
        let material = self.of.material(self.element);
        let modulus = MaterialConstant::ShearModulus;
        let (why, value) = ("triangles of", material.shear_modulus);
        match material.law {
            None => self.elastic(ELASTICITY, why, modulus, value, |_| NeoHooke, terms),
            Some(law) => self.elastic(ELASTICITY, why, modulus, value, |of| law.map(of), terms),
        }
    }

    /// The energy of a voltage: that of a source, or a given one.
    fn add_field(&self, terms: &mut Terms<'_>) {
        let electric = self.of.material(self.element).electric;
        let Some(electric) = electric.filter(|_| self.of.is_dielectric[self.element]) else {
            return;
        };
        let mut read = terms.sought().read();
        let mut constant = |of, value| read.constant(self.of.constant(self.element, of), value);
        let (c1, c2, permittivity) = (
            constant(MaterialConstant::C1, electric.c1),
            constant(MaterialConstant::C2, electric.c2),
            constant(MaterialConstant::Permittivity, electric.permittivity),
        );
        let [terminal, ..] = self.of.terminals::<6>(self.element);
        let factor = terminal
            .scalar
            .map_or(terminal.constant, |(_, factor)| factor);
        let cell = DielectricMembrane {
            volume: self.volume.into(),
            c1,
            c2,
            permittivity,
            thickness: (self.of.thickness() / factor).into(),
        };
        let (why, tangents) = ("a voltage across triangles of", self.tangents.map(mid));
        match terminal.scalar {
            Some((scalar, _)) => {
                let element = read.element(cell, tangents, [scalar]);
                terms.add_law::<_, 7, 2, 1>(ELECTROSTATICS, why, self.name(), element);
            }
            None if terminal.constant != 0.0 => {
                let element = read.element(ChargedMembrane { of: cell }, tangents, []);
                terms.add_law::<_, 6, 2, 0>(ELECTROSTATICS, why, self.name(), element);
            }
            None => {}
        }
    }

    fn add_viscosity(&self, terms: &mut Terms<'_>) {
        let viscosity = self.of.material(self.element).viscosity;
        let Some(viscosity) = viscosity.filter(|_| terms.is_of_motion()) else {
            return;
        };
        let [a, b] = self.tangents;
        let element = |viscosity| Element {
            energy: ViscousMembrane {
                coefficient: viscosity * self.volume,
            },
            vectors: [mid(a), mid(b), mid(a), mid(b), rate(a), rate(b)],
            scalars: [],
        };
        let constant = self.of.constant(self.element, MaterialConstant::Viscosity);
        let call = Call(VISCOSITY, "viscosity of", self.name());
        call.add_linear(constant, viscosity, element, terms);
    }

    /// The spring and the damper of a Maxwell branch with the vectors of its viscous strain.
    fn add_branch(
        &self,
        branch: usize,
        by: &MaxwellBranch,
        strains: &[MaterialVector; 2],
        terms: &mut Terms<'_>,
    ) {
        let [of_modulus, of_time] = [
            MaterialConstant::BranchModulus(branch),
            MaterialConstant::RelaxationTime(branch),
        ]
        .map(|constant| self.of.constant(self.element, constant));
        let why = "Maxwell branches of";
        let [stretches, shears] = strains
            .each_ref()
            .map(|part| terms.new_vector(part.clone()));
        let mut read = terms.sought().read();
        let cell = MaxwellMembrane {
            volume: self.volume.into(),
            shear_modulus: read.constant(of_modulus, by.shear_modulus),
        };
        let [a, b] = self.tangents;
        let element = read.element(cell, [a, b, stretches, shears].map(mid), []);
        terms.add_law::<_, 12, 4, 0>(MAXWELL[0], why, self.name(), element);
        let mut read = terms.sought().read();
        let modulus = read.constant(of_modulus, by.shear_modulus);
        let both = &modulus * &read.constant(of_time, by.relaxation_time);
        let given = by.shear_modulus * by.relaxation_time * self.volume;
        let [given, unit] = [given, self.volume].map(|of| damper([stretches, shears], of));
        Call(MAXWELL[1], why, self.name()).add_times(given, unit, read.into_constant(both), terms);
    }
}
