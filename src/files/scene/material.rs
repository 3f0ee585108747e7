//! Conversion of materials of a scene file to their constants.

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::law::{LawSpec, law};
use crate::files::units::quantity::{Density, Permittivity, Quantity, Stress, Time, Viscosity};
use crate::model::MOST_BRANCHES;
use crate::model::system::{
    ElectricConstants, Material, MaxwellBranch, MaxwellBranches, VACUUM_PERMITTIVITY,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// All materials with their names.
pub(crate) fn materials(
    specs: &BTreeMap<String, MaterialSpec>,
    scope: &Scope<'_>,
) -> Result<Vec<(String, Material)>, SceneError> {
    let material = |(name, spec): (&String, &MaterialSpec)| {
        let material = material(spec, &scope.key(name))?;
        Ok((name.clone(), material))
    };
    specs.iter().map(material).collect()
}

fn material(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Material, SceneError> {
    let shear_modulus = scope.key("shear_modulus").positive(&spec.shear_modulus)?;
    Ok(Material {
        density: density(spec, scope)?,
        shear_modulus,
        law: match &spec.law {
            None => None,
            Some(written) => Some(law(written, &scope.key("law"))?),
        },
        lame_lambda: lame_lambda(spec, shear_modulus, scope)?,
        electric: electric(spec, scope)?,
        viscosity: scope
            .key("viscosity")
            .absent_or_positive(spec.viscosity.as_ref())?,
        maxwell: maxwell(&spec.maxwell, &scope.key("maxwell"))?,
        stretch_range: stretch_range(spec, scope)?,
    })
}

fn stretch_range(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Option<[f64; 2]>, SceneError> {
    match spec.stretch_range {
        Some([low, high]) if !(low > 0.0 && low <= 1.0 && high >= 1.0) => {
            let expected = "two stretches with 1 between them, such as [0.6, 2]";
            let place = scope.key("stretch_range");
            Err(place.wrong(format!("[{low}, {high}]"), expected))
        }
        range => Ok(range),
    }
}

fn maxwell(specs: &[MaxwellSpec], scope: &Scope<'_>) -> Result<MaxwellBranches, SceneError> {
    let branch = |(index, spec): (usize, &MaxwellSpec)| -> Result<_, SceneError> {
        let place = scope.index(index);
        Ok(MaxwellBranch {
            shear_modulus: place.key("shear_modulus").positive(&spec.shear_modulus)?,
            relaxation_time: place
                .key("relaxation_time")
                .positive(&spec.relaxation_time)?,
        })
    };
    let branches: Vec<_> = specs
        .iter()
        .enumerate()
        .map(branch)
        .collect::<Result<_, _>>()?;
    MaxwellBranches::new(&branches).ok_or_else(|| {
        let found = format!("{} branches", branches.len());
        scope.wrong(found, format!("{MOST_BRANCHES} branches at most"))
    })
}

/// Density in g/mm³ beyond that of any matter on earth: osmium has 0.02259.
const DENSEST: f64 = 0.1;

/// The density in g/mm³, where there is one.
fn density(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Option<f64>, SceneError> {
    let place = scope.key("density");
    match (
        &spec.density,
        place.absent_or_positive(spec.density.as_ref())?,
    ) {
        (Some(written), Some(density)) if density > DENSEST => {
            let expected =
                "a density below 1e5 kg/m^3: that of silicone is \"1000 kg/m^3\", or \"1 g/cm^3\"";
            Err(place.wrong(written.to_string(), expected))
        }
        (_, density) => Ok(density),
    }
}

/// λ, or 2 μ ν/(1 − 2 ν), in MPa.
fn lame_lambda(
    spec: &MaterialSpec,
    shear_modulus: f64,
    scope: &Scope<'_>,
) -> Result<Option<f64>, SceneError> {
    match (&spec.lame_lambda, spec.poisson_ratio) {
        (None, None) => Ok(None),
        (Some(lambda), None) => {
            // The bulk modulus λ + 2 μ/3 is positive.
            if lambda.value() > -2.0 / 3.0 * shear_modulus {
                return Ok(Some(lambda.value()));
            }
            let expected = "a stress larger than -2/3 of the shear modulus";
            Err(scope.key("lame_lambda").wrong(lambda.to_string(), expected))
        }
        (None, Some(ratio)) if ratio > -1.0 && ratio < 0.5 => {
            Ok(Some(Material::first_lame_constant(shear_modulus, ratio)))
        }
        (None, Some(ratio)) => {
            let expected = "a number larger than -1 and smaller than 0.5";
            Err(scope
                .key("poisson_ratio")
                .wrong(ratio.to_string(), expected))
        }
        (Some(_), Some(_)) => {
            let found = "\"lame_lambda\" and \"poisson_ratio\"";
            Err(scope.wrong(found, "one of the two"))
        }
    }
}

/// Constants of the electric energy, where the material has one.
fn electric(
    spec: &MaterialSpec,
    scope: &Scope<'_>,
) -> Result<Option<ElectricConstants>, SceneError> {
    let ratio = spec.relative_permittivity;
    if let (None, Some(_)) = (ratio, spec.dielectric) {
        let expected = "\"relative_permittivity\" beside it";
        return Err(scope
            .key("dielectric")
            .wrong("\"dielectric\" alone", expected));
    }
    let (c1, c2) = (spec.c1.as_ref(), spec.c2.as_ref());
    match (ratio, c1, c2) {
        (None, None, None) => Ok(None),
        (None, Some(c1), Some(c2)) => Ok(Some(ElectricConstants {
            c1: c1.value(),
            c2: c2.value(),
            permittivity: VACUUM_PERMITTIVITY,
        })),
        (Some(ratio), None, None) if ratio >= 1.0 => {
            Ok(Some(match spec.dielectric.unwrap_or_default() {
                Dielectric::FirstOrder => ElectricConstants::first_order(ratio),
                Dielectric::Ideal => ElectricConstants::ideal(ratio),
            }))
        }
        (Some(ratio), None, None) => {
            let place = scope.key("relative_permittivity");
            Err(place.wrong(ratio.to_string(), "a number that is 1 or more"))
        }
        _ => {
            let there = |quantity: Option<&Quantity<_>>, key| quantity.map(|_| key);
            let found: Vec<&str> = [
                ratio.map(|_| "\"relative_permittivity\""),
                there(c1, "\"c1\""),
                there(c2, "\"c2\""),
            ]
            .into_iter()
            .flatten()
            .collect();
            let expected = "either \"relative_permittivity\" or both \"c1\" and \"c2\"";
            Err(scope.wrong(found.join(" and "), expected))
        }
    }
}

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

macro_rules! kept {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../materials/", $name, ".json")))),*]
    };
}

/// Names and texts.
const KEPT: [(&str, &str); 8] = kept![
    "dragon_skin_10",
    "dragon_skin_20",
    "dragon_skin_30",
    "ecoflex_00_30",
    "ecoflex_00_50",
    "rtv_615",
    "sylgard_184",
    "vhb_4910",
];

/// Names of the materials, and their JSON texts with source, test conditions and range.
pub fn named_materials() -> impl Iterator<Item = (&'static str, &'static str)> {
    KEPT.into_iter()
}

/// A material by its name.
pub(crate) fn named_material(name: &str) -> Option<MaterialSpec> {
    let (_, text) = KEPT.into_iter().find(|(other, _)| *other == name)?;
    Some(serde_json::from_str(text).expect("a kept material is one"))
}
