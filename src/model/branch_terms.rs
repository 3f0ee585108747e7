//! Terms of the Maxwell branches of elastic blocks.

use crate::element::MaxwellSpring;
use crate::energy::MaxwellDamper;
use crate::functional::{Element, FiniteElement, MaxwellElement, POINTS};
use crate::kinematics::MaterialVector;
use crate::model::block_terms::add_times;
use crate::model::constant::MaterialConstant;
use crate::model::internal::Internals;
use crate::model::maxwell::MaxwellBranch;
use crate::model::members::Formula;
use crate::model::solid_block::SolidBlock;
use crate::model::solids::Solids;
use crate::model::terms::{Terms, UNRELAXED, mid, rate};
use std::sync::Arc;

const MAXWELL: [&str; 2] = ["block maxwell elasticity", "block maxwell viscosity"];

impl Solids {
    /// Springs and dampers of Maxwell branches.
    pub(super) fn add_branches(&self, internals: &Internals, terms: &mut Terms<'_>) {
        for (b, c, e) in self.numbered() {
            for (branch, constants) in c.material(e).maxwell.list().iter().enumerate() {
                if let Some(strains) = internals.strains(b, e, branch) {
                    add_branch((c, e, branch), constants, strains, terms);
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
                    let factors = vec![read.constant(constant, modulus)];
                    let of = (MAXWELL[0], UNRELAXED, c.solid.name.as_str());
                    add_times::<(), _>(
                        of,
                        (element(modulus), element(1.0)),
                        (factors, read),
                        terms,
                    );
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
    (c, e, branch): (&SolidBlock, usize, usize),
    &MaxwellBranch {
        shear_modulus,
        relaxation_time,
    }: &MaxwellBranch,
    strains: [[MaterialVector; 2]; POINTS],
    terms: &mut Terms<'_>,
) {
    let ([elasticity, viscosity], why) = (MAXWELL, "Maxwell branches of");
    let name = c.solid.name.as_str();
    let [of_modulus, of_time] = [
        MaterialConstant::BranchModulus(branch),
        MaterialConstant::RelaxationTime(branch),
    ]
    .map(|constant| c.constant(e, constant));
    let mut read = terms.sought().read();
    let modulus = vec![read.constant(of_modulus, shear_modulus)];
    let of_spring = (modulus.clone(), read.clone());
    let time = read.constant(of_time, relaxation_time);
    let of_damper = ([modulus, vec![time]].concat(), read);
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
        add_times::<Formula<18, false>, _>(
            (viscosity, why, name),
            (given, element(*volume)),
            of_damper.clone(),
            terms,
        );
    }
    let element = |shear_modulus| MaxwellElement {
        shape: shape.clone(),
        law: MaxwellSpring { shear_modulus },
        nodes: c.nodes(e),
        strains,
    };
    add_times::<(), _>(
        (elasticity, why, name),
        (element(shear_modulus), element(1.0)),
        of_spring,
        terms,
    );
}
