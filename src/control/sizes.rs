//! Sizes of the inputs, which scale their unknowns. They follow from the problem alone, so that similar robots have similar programs.

use crate::control::problem::Control;
use crate::model::system::{ElectricConstants, InputKind, Material, Muscle, Solid};
use crate::model::{Model, Role, System, Variable};

impl Control {
    /// Size of an input in V, N or N mm: the largest value that its bounds allow. Of a load without bounds it is the one that moves the mass m of
    /// the system by its length L in the duration T, m L/T².
    pub fn size(&self, variable: &Variable, model: &Model) -> f64 {
        if variable.role != Role::Load {
            return self.voltage_size(&model.system);
        }
        let sizes = self.bounds(variable).map(f64::abs).into_iter();
        let bound = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        let length = model.length();
        let kinetic_energy = mass(&model.system, length) * (length / self.duration.first()).powi(2);
        let natural = || match model.input_kind(variable.source.expect("an input of a source")) {
            InputKind::Torque => kinetic_energy,
            InputKind::Force => kinetic_energy / length,
            InputKind::Traction => kinetic_energy / length.powi(3),
            InputKind::BodyForce => kinetic_energy / length.powi(4),
            InputKind::SurfaceCharge => {
                kinetic_energy / (self.voltage_size(&model.system) * length * length)
            }
            InputKind::Charge | InputKind::Voltage => {
                kinetic_energy / self.voltage_size(&model.system)
            }
        };
        positive(bound)
            .or_else(|| positive(natural()))
            .unwrap_or(1.0)
    }

    /// Size of the voltages in V: the largest one that their bounds allow, or what moves a muscle much, t √(μ/ε), where that is less. Without
    /// either it is what moves a block much.
    pub fn voltage_size(&self, system: &System) -> f64 {
        let [low, high] = self.voltage_bounds.map(f64::abs);
        let of_muscle = |muscle: &Muscle| natural(&muscle.material, muscle.layer_thickness);
        let of_muscles = system.muscles.iter().filter_map(of_muscle);
        let size = of_muscles.fold(low.max(high), f64::min);
        let of_block = |solid: &Solid| {
            let sizes = solid
                .materials
                .iter()
                .map(|m| natural(m, solid.mesh.size()));
            sizes.flatten().reduce(f64::min)
        };
        let of_blocks = || system.solids.iter().filter_map(of_block).reduce(f64::min);
        positive(size).or_else(of_blocks).unwrap_or(1.0)
    }
}

/// The voltage t √(μ/ε) across a layer.
fn natural(material: &Material, thickness: f64) -> Option<f64> {
    let ElectricConstants {
        c1,
        c2,
        permittivity,
    } = material.electric?;
    let permittivity = permittivity - 2.0 * (c1 + c2);
    Some(thickness * (material.shear_modulus / permittivity.abs()).sqrt())
}

/// Mass in g of the bodies, and of the blocks of a system of this length, about.
fn mass(system: &System, length: f64) -> f64 {
    let bodies: f64 = system.bodies.iter().map(|body| body.mass).sum();
    let materials = system.solids.iter().flat_map(|solid| &solid.materials);
    let densities = materials.filter_map(|material| material.density);
    bodies + densities.fold(0.0, f64::max) * length.powi(3)
}

fn positive(size: f64) -> Option<f64> {
    (size.is_finite() && size > 0.0).then_some(size)
}
