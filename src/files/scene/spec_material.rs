//! A material as it is written: the serde types of the `materials` of a scene file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::files::scene::law::LawSpec;
use crate::files::units::quantity::{Density, Permittivity, Quantity, Stress, Time, Viscosity};

/// A dielectric elastomer.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaterialSpec {
    /// Source of the constants, for readers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Conditions under which the constants were measured and fitted, for readers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<String>,
    /// Smallest and largest stretch for which the constants hold; a lumped muscle beyond them is a warning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stretch_range: Option<[f64; 2]>,
    /// Density, SI unit kg/m³; without it muscles are massless.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<Quantity<Density>>,
    /// Shear modulus μ of small strains, SI unit Pa.
    pub shear_modulus: Quantity<Stress>,
    /// Law of elasticity; the neo-Hookean one where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawSpec>,
    /// First Lamé constant λ, SI unit Pa; or give `poisson_ratio`. Finite elements need one of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lame_lambda: Option<Quantity<Stress>>,
    /// Poisson's ratio, between −1 and 0.5; or give `lame_lambda`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub poisson_ratio: Option<f64>,
    /// Relative permittivity, 1 or more; or give `c1` and `c2`; without either the material has no electric term.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_permittivity: Option<f64>,
    /// Law by which `relative_permittivity` enters the energy; `first_order` where not written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dielectric: Option<Dielectric>,
    /// Constant of the term c₁ E·E, SI unit F/m = N/V².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub c1: Option<Quantity<Permittivity>>,
    /// Constant of the term c₂ C:(E⊗E), SI unit F/m = N/V².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub c2: Option<Quantity<Permittivity>>,
    /// Viscosity η in σ = η d, SI unit Pa s; without it no viscous force.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<Quantity<Viscosity>>,
    /// Maxwell branches, five at most: springs in series with dampers, in which stress relaxes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub maxwell: Vec<MaxwellSpec>,
}

/// A Maxwell branch.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MaxwellSpec {
    /// Shear modulus μ₁ of its spring, SI unit Pa.
    pub shear_modulus: Quantity<Stress>,
    /// Relaxation time τ in which small stresses fall to 1/e, SI unit s.
    pub relaxation_time: Quantity<Time>,
}

/// Law by which the relative permittivity enters the energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Dielectric {
    /// To first order in the deformation: c₁ = −(ε_r − 1) ε₀, c₂ = (ε_r − 1) ε₀/2.
    #[default]
    FirstOrder,
    /// Exactly: c₁ = c₂ = 0 and ε_r ε₀ in place of ε₀.
    Ideal,
}
