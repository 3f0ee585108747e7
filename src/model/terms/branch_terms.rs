//! Terms of the Maxwell branches of elastic blocks.

use crate::coordinates::Configuration;
use crate::element::{MaxwellSpring, ViscousStrains};
use crate::energy::MaxwellDamper;
use crate::functional::{Element, FiniteElement, MaxwellElement, POINTS};
use crate::kinematics::MaterialVector;
use crate::math::Matrix;
use crate::model::constants::constant::MaterialConstant;
use crate::model::layout::internal::Internals;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::solids::Solids;
use crate::model::model::Model;
use crate::model::system::maxwell::{MaxwellBranch, Response};
use crate::model::terms::{Call, Formula, Terms, UNRELAXED, mid, rate};
use std::sync::Arc;

const MAXWELL: [&str; 2] = ["block maxwell elasticity", "block maxwell viscosity"];

impl Solids {
    /// Springs and dampers of Maxwell branches.
    pub(crate) fn add_branches(&self, internals: &Internals, terms: &mut Terms<'_>) {
        for (b, c, e) in self.numbered() {
            for (branch, constants) in c.material(e).maxwell.list().iter().enumerate() {
                if let Some(strains) = internals.strains(b, e, branch) {
                    add_branch(c, e, branch, constants, strains, terms);
                } else if terms.is_instantaneous() {
                    let shape = Arc::new(c.reference_shape(e));
                    let element = |shear_modulus| FiniteElement {
                        shape: shape.clone(),
                        law: c.unrelaxed(shear_modulus),
                        nodes: c.nodes(e),
                        terminals: (),
                    };
                    let modulus = constants.shear_modulus;
                    let mut read = terms.sought().read();
                    let constant = c.constant(e, MaterialConstant::BranchModulus(branch));
                    let factor = read.constant(constant, modulus);
                    let (given, unit) = (element(modulus), element(1.0));
                    Call {
                        term: MAXWELL[0],
                        why: UNRELAXED,
                        of: &c.solid.name,
                    }
                    .add_times::<(), _>(given, unit, factor, read, terms);
                }
            }
        }
        terms.without_branches(
            MAXWELL,
            "no elastic block that moves names a Maxwell branch",
        );
    }
}

/// One branch of an element: its spring, and the damper of each Gauss point.
fn add_branch(
    c: &SolidBlock,
    e: usize,
    branch: usize,
    constants: &MaxwellBranch,
    strains: [[MaterialVector; 2]; POINTS],
    terms: &mut Terms<'_>,
) {
    let MaxwellBranch {
        shear_modulus,
        relaxation_time,
    } = *constants;
    let [elasticity, viscosity] = MAXWELL.map(|term| Call {
        term,
        why: "Maxwell branches of",
        of: &c.solid.name,
    });
    let [of_modulus, of_time] = [
        MaterialConstant::BranchModulus(branch),
        MaterialConstant::RelaxationTime(branch),
    ]
    .map(|constant| c.constant(e, constant));
    let mut read = terms.sought().read();
    let modulus = read.constant(of_modulus, shear_modulus);
    let of_spring = read.clone();
    let both = &modulus * &read.constant(of_time, relaxation_time);
    let strains = strains.map(|parts| parts.map(|part| terms.new_vector(part)));
    let shape = c.shapes[e].clone();
    for ([stretches, shears], volume) in strains.into_iter().zip(shape.weights()) {
        let (stretched, sheared) = (mid(stretches), mid(shears));
        let rates = [rate(stretches), rate(shears)];
        let element = |coefficient| Element {
            energy: MaxwellDamper { coefficient },
            vectors: [stretched, sheared, stretched, sheared, rates[0], rates[1]],
            scalars: [],
        };
        let given = element(relaxation_time * shear_modulus * volume);
        let (unit, read) = (element(*volume), read.clone());
        viscosity.add_times::<Formula<18, false>, _>(given, unit, both.clone(), read, terms);
    }
    let element = |shear_modulus| MaxwellElement {
        shape: shape.clone(),
        law: MaxwellSpring { shear_modulus },
        nodes: c.nodes(e),
        strains,
    };
    let (given, unit) = (element(shear_modulus), element(1.0));
    elasticity.add_times::<(), _>(given, unit, modulus, of_spring, terms);
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
        let x = of.nodes(element).map(|v| at.x[v]);
        if let Some(first) = self.of_elements.get(&(block, element)) {
            let first = self.action.map.internal().start + first;
            let stress = |(branch, shear_modulus): (usize, f64)| {
                let mut strains = ViscousStrains::default();
                let count = strains.len();
                for point in 0..POINTS {
                    for (m, strain) in strains.iter_mut().enumerate() {
                        strain[point] = at.z[first + count * (POINTS * branch + point) + m];
                    }
                }
                MaxwellSpring { shear_modulus }.stress(&of.shapes[element], &x, &strains)
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
        Some(law.fields(&of.reference_shape(element), &x, &()).stress)
    }
}
