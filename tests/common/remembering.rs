//! Systems of rubber that creeps.

use super::systems::branched;
use super::trunk;
use proboscis::model::system::{
    Discretisation, ElementKind, Fidelity, MaxwellBranch, MaxwellBranches, System,
};

fn branch(shear_modulus: f64, relaxation_time: f64) -> MaxwellBranch {
    MaxwellBranch {
        shear_modulus,
        relaxation_time,
    }
}

/// The branched tree with muscles of one and two Maxwell branches.
pub fn remembering() -> System {
    let mut system = branched();
    let [one, two] = [branch(0.04, 30.0), branch(0.02, 400.0)];
    system.muscles[0].material.maxwell = MaxwellBranches::new(&[one]).unwrap();
    system.muscles[2].material.maxwell = MaxwellBranches::new(&[one, two]).unwrap();
    system
}

/// One segment with a lumped muscle and one of finite elements with a Maxwell branch.
pub fn remembering_blocks() -> System {
    let mut system = trunk(1);
    let muscle = &mut system.muscles[0];
    muscle.material.lame_lambda = Some(0.4);
    muscle.material.maxwell = MaxwellBranches::new(&[branch(0.04, 30.0)]).unwrap();
    muscle.fidelity = Fidelity::FiniteElements(Discretisation {
        first_side: None,
        elements: [1, 1, 2],
        layers: 2,
        element: ElementKind::Hex8,
    });
    system
}
