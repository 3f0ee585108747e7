//! Systems of rubber that creeps.

use super::systems::{blocks, branched};
use proboscis::model::system::{MaxwellBranch, MaxwellBranches, System};

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

/// The blocks with a Maxwell branch of the muscle of finite elements.
pub fn remembering_blocks() -> System {
    let mut system = blocks();
    let branch = branch(0.04, 30.0);
    system.muscles[0].material.maxwell = MaxwellBranches::new(&[branch]).unwrap();
    system
}
