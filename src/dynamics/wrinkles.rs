//! Membranes that are compressed: they would wrinkle, which triangles without stiffness against bending do not show.

use crate::dynamics::DiscreteTrajectory;
use crate::math::Vector;
use crate::model::Model;
use crate::model::SolidBlock;
use nalgebra::SymmetricEigen;

/// Part of the shear modulus that a compressive stress is at least.
const LEAST: f64 = 1e-6;

/// Instants of a motion that are looked at.
const INSTANTS: usize = 50;

/// The greatest compressive stress of a membrane.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrinkle {
    /// Name of the membrane.
    pub name: String,
    /// The stress in MPa, the mean over a triangle, elastic and electric.
    pub stress: f64,
    /// Middle of the triangle in the reference configuration in mm.
    pub place: Vector,
    /// Time in ms.
    pub time: f64,
}

/// The greatest compressive stress of each membrane that has one, over up to fifty instants of a motion.
pub fn wrinkles(model: &Model, discrete: &DiscreteTrajectory) -> Vec<Wrinkle> {
    let is_membrane = |block: &&SolidBlock| block.solid.is_membrane();
    let membranes: Vec<_> = model.solids.iter().filter(is_membrane).collect();
    let mut worst: Vec<Option<Wrinkle>> = vec![None; membranes.len()];
    let last = discrete.z.len() - 1;
    let stride = last.div_ceil(INSTANTS).max(1);
    let instants = (0..last).step_by(stride).chain([last]);
    for k in instants.filter(|_| !membranes.is_empty()) {
        let x = model.action.map.placed(&discrete.z[k]).x;
        let scalars = discrete.scalars.get(k.saturating_sub(1));
        let scalars = scalars.map_or(&[][..], |scalars| scalars);
        for (block, worst) in membranes.iter().zip(&mut worst) {
            let (places, potentials) = (block.places(&x), block.potentials(scalars));
            for (element, nodes) in block.solid.mesh.elements().enumerate() {
                let stress = block.fields(element, &places, &potentials).stress;
                // Across the membrane there is none, which is the least where both others are positive.
                let stress = SymmetricEigen::new(stress).eigenvalues.min();
                let least = -LEAST * block.material(element).shear_modulus;
                let known = worst.as_ref().map_or(least, |known| known.stress);
                if stress < known {
                    let places = nodes.iter().map(|&node| block.solid.mesh.nodes[node]);
                    *worst = Some(Wrinkle {
                        name: block.solid.name.clone(),
                        stress,
                        place: places.sum::<Vector>() / nodes.len() as f64,
                        time: discrete.times[k],
                    });
                }
            }
        }
    }
    worst.into_iter().flatten().collect()
}
