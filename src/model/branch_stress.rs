//! Stress of the Maxwell branches of a block, as shown.

use crate::coordinates::Configuration;
use crate::element::{MaxwellSpring, ViscousStrains};
use crate::functional::POINTS;
use crate::math::Matrix;
use crate::model::maxwell::Response;
use crate::model::model::Model;

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
