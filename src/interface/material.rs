//! Elastomers, built with defaults.

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

    /// Law of elasticity in place of the neo-Hookean one, with the same shear modulus at small strains.
    pub fn law(self, law: ElasticLaw) -> Self {
        let law = Some(law);
        Self { law, ..self }
    }

    /// Smallest and largest stretch for which the constants hold: a lumped muscle beyond them is a warning.
    pub fn stretch_range(self, range: [f64; 2]) -> Self {
        let stretch_range = Some(range);
        Self {
            stretch_range,
            ..self
        }
    }

    /// Density in g/mm³.
    pub fn density(self, density: f64) -> Self {
        let density = Some(density);
        Self { density, ..self }
    }

    /// Relative permittivity of a dielectric whose polarisation is linear in the reference field (c₁ = −(ε_r − 1) ε₀,
    /// c₂ = (ε_r − 1) ε₀/2).
    pub fn relative_permittivity(self, ratio: f64) -> Self {
        let electric = Some(ElectricConstants::first_order(ratio));
        Self { electric, ..self }
    }

    /// Relative permittivity of an ideal dielectric.
    pub fn ideal_dielectric(self, ratio: f64) -> Self {
        let electric = Some(ElectricConstants::ideal(ratio));
        Self { electric, ..self }
    }

    /// Viscosity in MPa ms.
    pub fn viscosity(self, viscosity: f64) -> Self {
        let viscosity = Some(viscosity);
        Self { viscosity, ..self }
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
