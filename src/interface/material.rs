//! Elastomers, built with defaults.

use crate::interface::builder::builder;
use crate::model::system::{
    Circuit, ElasticLaw, ElectricConstants, Electrode, Material, MaxwellBranch, MaxwellBranches,
    Potential, Solid,
};

impl Material {
    /// A neo-Hookean elastomer with a shear modulus in MPa, without density, permittivity or viscosity so far.
    pub fn elastomer(shear_modulus: f64) -> Self {
        Self {
            density: None,
            shear_modulus,
            law: None,
            lame_lambda: None,
            electric: None,
            viscosity: None,
            maxwell: MaxwellBranches::default(),
            stretch_range: None,
        }
    }

    /// One more Maxwell branch: shear modulus μ₁ of its spring in MPa, relaxation time in ms.
    ///
    /// # Panics
    /// It has five.
    pub fn maxwell(self, shear_modulus: f64, relaxation_time: f64) -> Self {
        let mut branches = self.maxwell.list().to_vec();
        branches.push(MaxwellBranch {
            shear_modulus,
            relaxation_time,
        });
        let maxwell = MaxwellBranches::new(&branches).expect("five branches at most");
        Self { maxwell, ..self }
    }

    /// Poisson ratio, which finite elements need: λ = 2 μ ν/(1 − 2 ν).
    pub fn poisson_ratio(self, ratio: f64) -> Self {
        let lame_lambda = Some(Self::first_lame_constant(self.shear_modulus, ratio));
        Self {
            lame_lambda,
            ..self
        }
    }
}

builder! {
    impl Material;
    /// Law of elasticity in place of the neo-Hookean one, with the same shear modulus at small strains.
    law(law: ElasticLaw) |of| of.law = Some(law);
    /// Smallest and largest stretch for which the constants hold: a lumped muscle beyond them is a warning.
    stretch_range(range: [f64; 2]) |of| of.stretch_range = Some(range);
    /// Density in g/mm³.
    density(density: f64) |of| of.density = Some(density);
    /// Relative permittivity of a dielectric whose polarisation is linear in the reference field (c₁ = −(ε_r − 1) ε₀,
    /// c₂ = (ε_r − 1) ε₀/2).
    relative_permittivity(ratio: f64) |of| of.electric = Some(ElectricConstants::first_order(ratio));
    /// Relative permittivity of an ideal dielectric.
    ideal_dielectric(ratio: f64) |of| of.electric = Some(ElectricConstants::ideal(ratio));
    /// Viscosity in MPa ms.
    viscosity(viscosity: f64) |of| of.viscosity = Some(viscosity);
}

impl Solid {
    /// An electrode on the nodes of a set of the mesh.
    pub fn electrode(mut self, name: &str, set: &str, potential: Potential) -> Self {
        self.electrodes.push(Electrode {
            name: name.to_owned(),
            nodes: self.nodes(set),
            potential,
            circuit: None,
        });
        self
    }

    /// Puts a circuit between the electrode that was added last and its source. Nothing without an electrode.
    pub fn behind(mut self, circuit: Circuit) -> Self {
        if let Some(last) = self.electrodes.last_mut() {
            last.circuit = Some(circuit);
        }
        self
    }
}

impl Potential {
    /// Zero.
    pub const GROUNDED: Self = Self::Given(0.0);
    /// The voltage that is given or sought under the name of the electrode.
    pub const DRIVEN: Self = Self::Driven {
        source: 0,
        factor: 1.0,
    };
}
