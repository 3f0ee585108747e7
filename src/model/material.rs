//! Materials of dielectric elastomers and their electric constants.

use crate::energy::ElasticLaw;
use crate::model::maxwell::MaxwellBranches;

/// A dielectric elastomer. What is `None` leaves no trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Material {
    /// Density in g/mm³.
    pub density: Option<f64>,
    /// Shear modulus μ of small strains in MPa.
    pub shear_modulus: f64,
    /// Law of elasticity other than the neo-Hookean one.
    pub law: Option<ElasticLaw>,
    /// First Lamé constant λ in MPa; finite elements need it, lumped muscles keep their volume and do not read it.
    pub lame_lambda: Option<f64>,
    /// Electric constants.
    pub electric: Option<ElectricConstants>,
    /// Viscosity η in MPa ms, σ_vis = η d.
    pub viscosity: Option<f64>,
    /// Maxwell branches.
    pub maxwell: MaxwellBranches,
    /// Smallest and largest stretch for which the constants hold, for warnings.
    pub stretch_range: Option<[f64; 2]>,
}

/// Constants of the electric energy c₁ E·E + c₂ C:(E⊗E) − ½ ε J C⁻¹:(E⊗E), in N/V².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElectricConstants {
    /// c₁.
    pub c1: f64,
    /// c₂.
    pub c2: f64,
    /// Permittivity ε of the last term: vacuum's, or the whole of an ideal dielectric.
    pub permittivity: f64,
}

/// Permittivity of vacuum in N/V² (F/m), CODATA value in the decimals of the reference solutions.
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_817e-12;

impl Material {
    /// λ = 2 μ ν/(1 − 2 ν) of a shear modulus and a Poisson ratio.
    pub fn first_lame_constant(shear_modulus: f64, poisson_ratio: f64) -> f64 {
        2.0 * shear_modulus * poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    }
}

impl ElectricConstants {
    /// A dielectric of this relative permittivity whose polarisation is linear in the reference field.
    pub fn first_order(ratio: f64) -> Self {
        Self {
            c1: -(ratio - 1.0) * VACUUM_PERMITTIVITY,
            c2: (ratio - 1.0) * VACUUM_PERMITTIVITY / 2.0,
            permittivity: VACUUM_PERMITTIVITY,
        }
    }

    /// An ideal dielectric of this relative permittivity.
    pub fn ideal(ratio: f64) -> Self {
        Self {
            c1: 0.0,
            c2: 0.0,
            permittivity: ratio * VACUUM_PERMITTIVITY,
        }
    }
}
