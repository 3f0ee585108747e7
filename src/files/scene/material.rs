//! Conversion of materials of a scene file to their constants.

use crate::energy::ElasticLaw;
use crate::files::json::objects::objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::units::quantity::{Density, Permittivity, Quantity, Stress, Time, Viscosity};
use crate::model::MOST_BRANCHES;
use crate::model::system::{
    ElectricConstants, Material, MaxwellBranch, MaxwellBranches, VACUUM_PERMITTIVITY,
};
use std::collections::BTreeMap;

/// All materials with their names.
pub(crate) fn materials(
    specs: &BTreeMap<String, MaterialSpec>,
    scope: &Scope<'_>,
) -> Result<Vec<(String, Material)>> {
    scope.each_named(specs, |name, spec, scope| {
        Ok((name.to_owned(), material(spec, scope)?))
    })
}

fn material(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Material> {
    let material = Material {
        density: Quantity::present(&spec.density),
        shear_modulus: spec.shear_modulus.value(),
        law: scope.optional("law", &spec.law, |at, law| law.law(at))?,
        lame_lambda: lame_lambda(spec, scope)?,
        electric: electric(spec, scope)?,
        viscosity: Quantity::present(&spec.viscosity),
        maxwell: maxwell(&spec.maxwell, &scope.key("maxwell"))?,
        stretch_range: spec.stretch_range,
    };
    let checked = material.check();
    checked.map_err(|fault| scope.refuse(spec, &fault))?;
    Ok(material)
}

fn maxwell(specs: &[MaxwellSpec], scope: &Scope<'_>) -> Result<MaxwellBranches> {
    let branch = |spec: &MaxwellSpec| MaxwellBranch {
        shear_modulus: spec.shear_modulus.value(),
        relaxation_time: spec.relaxation_time.value(),
    };
    let branches: Vec<_> = specs.iter().map(branch).collect();
    MaxwellBranches::new(&branches).ok_or_else(|| {
        let found = format!("{} branches", branches.len());
        scope.wrong(found, format!("{MOST_BRANCHES} branches at most"))
    })
}

/// λ, or 2 μ ν/(1 − 2 ν), in MPa.
fn lame_lambda(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Option<f64>> {
    let shear_modulus = spec.shear_modulus.value();
    match (&spec.lame_lambda, spec.poisson_ratio) {
        (lambda, None) => Ok(lambda.as_ref().map(Quantity::value)),
        (None, Some(ratio)) => {
            refuse!(unless ratio > -1.0 && ratio < 0.5, scope.key("poisson_ratio");
                found ratio, expected "a number larger than -1 and smaller than 0.5");
            Ok(Some(Material::first_lame_constant(shear_modulus, ratio)))
        }
        (Some(_), Some(_)) => {
            let found = "\"lame_lambda\" and \"poisson_ratio\"";
            Err(scope.wrong(found, "one of the two"))
        }
    }
}

/// Constants of the electric energy, where the material has one.
fn electric(spec: &MaterialSpec, scope: &Scope<'_>) -> Result<Option<ElectricConstants>> {
    let ratio = spec.relative_permittivity;
    refuse!(if ratio.is_none() && spec.dielectric.is_some(), scope.key("dielectric");
        found "\"dielectric\" alone", expected "\"relative_permittivity\" beside it");
    let (c1, c2) = (spec.c1.as_ref(), spec.c2.as_ref());
    match (ratio, c1, c2) {
        (None, None, None) => Ok(None),
        (None, Some(c1), Some(c2)) => Ok(Some(ElectricConstants {
            c1: c1.value(),
            c2: c2.value(),
            permittivity: VACUUM_PERMITTIVITY,
        })),
        (Some(ratio), None, None) => {
            refuse!(unless ratio >= 1.0, scope.key("relative_permittivity");
                found ratio, expected "a number that is 1 or more");
            Ok(Some(match spec.dielectric.unwrap_or_default() {
                Dielectric::FirstOrder => ElectricConstants::first_order(ratio),
                Dielectric::Ideal => ElectricConstants::ideal(ratio),
            }))
        }
        _ => {
            let keys = ["relative_permittivity", "c1", "c2"];
            let there = [ratio.is_some(), c1.is_some(), c2.is_some()];
            let found = keys.iter().zip(there).filter(|(_, there)| *there);
            let found: Vec<_> = found.map(|(key, _)| format!("{key:?}")).collect();
            let expected = "either \"relative_permittivity\" or both \"c1\" and \"c2\"";
            Err(scope.wrong(found.join(" and "), expected))
        }
    }
}

objects! {
    /// A dielectric elastomer.
    pub struct MaterialSpec {
        /// Source of the constants, for readers.
        pub source: Option<String>,
        /// Conditions under which the constants were measured and fitted, for readers.
        pub conditions: Option<String>,
        /// Smallest and largest stretch for which the constants hold; a lumped muscle beyond them is a warning.
        pub stretch_range: Option<[f64; 2]>,
        /// Density, SI unit kg/m³; without it muscles are massless.
        pub density: Option<Quantity<Density>>,
        /// Shear modulus μ of small strains, SI unit Pa.
        pub shear_modulus: Quantity<Stress>,
        /// Law of elasticity; the neo-Hookean one where not written.
        pub law: Option<LawSpec>,
        /// First Lamé constant λ, SI unit Pa; or give `poisson_ratio`. Finite elements need one of them.
        pub lame_lambda: Option<Quantity<Stress>>,
        /// Poisson's ratio, between −1 and 0.5; or give `lame_lambda`.
        pub poisson_ratio: Option<f64>,
        /// Relative permittivity, 1 or more; or give `c1` and `c2`; without either the material has no electric term.
        pub relative_permittivity: Option<f64>,
        /// Law by which `relative_permittivity` enters the energy; `first_order` where not written.
        pub dielectric: Option<Dielectric>,
        /// Constant of the term c₁ E·E, SI unit F/m = N/V².
        pub c1: Option<Quantity<Permittivity>>,
        /// Constant of the term c₂ C:(E⊗E), SI unit F/m = N/V².
        pub c2: Option<Quantity<Permittivity>>,
        /// Viscosity η in σ = η d, SI unit Pa s; without it no viscous force.
        pub viscosity: Option<Quantity<Viscosity>>,
        /// Maxwell branches, five at most: springs in series with dampers, in which stress relaxes.
        pub maxwell?: Vec<MaxwellSpec>,
    }

    /// Law of elasticity: exactly one of the four. The `shear_modulus` of the material is that of small strains in each of them.
    pub struct LawSpec {
        /// Gent's law, −μ/2 Jm ln(1 − (I₁ − 3)/Jm): it stiffens without bound towards a greatest stretch.
        pub gent: Option<GentSpec>,
        /// Mooney and Rivlin's law, μ/2 [(1 − s)(I₁ − 3) + s (I₂ − 3)].
        pub mooney_rivlin: Option<MooneyRivlinSpec>,
        /// Yeoh's law, μ/2 (I₁ − 3) + c₂ (I₁ − 3)² + c₃ (I₁ − 3)³.
        pub yeoh: Option<YeohSpec>,
        /// Ogden's law with two terms, of lumped muscles only, 2μ [(1 − s)/α₁² Σ(λ^α₁ − 1) + s/α₂² Σ(λ^α₂ − 1)].
        pub ogden: Option<OgdenSpec>,
    }

    /// Gent's law.
    pub struct GentSpec {
        /// Limit Jm of I₁ − 3, a positive ratio.
        pub limit: f64,
    }

    /// Mooney and Rivlin's law.
    pub struct MooneyRivlinSpec {
        /// Part s of the shear modulus that belongs to I₂, from 0 to 1: C₀₁ = s μ/2, C₁₀ = (1 − s) μ/2.
        pub share: f64,
    }

    /// Yeoh's law.
    pub struct YeohSpec {
        /// Constant c₂ = C₂₀, SI unit Pa.
        pub c2: Quantity<Stress>,
        /// Constant c₃ = C₃₀, SI unit Pa.
        pub c3: Quantity<Stress>,
    }

    /// Ogden's law with two terms.
    pub struct OgdenSpec {
        /// Exponents α₁ and α₂, not zero.
        pub exponents: [f64; 2],
        /// Part s of the shear modulus that belongs to the second term, from 0 to 1: μ₂ α₂ = 2 s μ, μ₁ α₁ = 2 (1 − s) μ.
        pub share: f64,
    }

    /// A Maxwell branch.
    pub struct MaxwellSpec {
        /// Shear modulus μ₁ of its spring, SI unit Pa.
        pub shear_modulus: Quantity<Stress>,
        /// Relaxation time τ in which small stresses fall to 1/e, SI unit s.
        pub relaxation_time: Quantity<Time>,
    }

    /// Law by which the relative permittivity enters the energy.
    #[derive(Default)]
    pub enum Dielectric {
        /// To first order in the deformation: c₁ = −(ε_r − 1) ε₀, c₂ = (ε_r − 1) ε₀/2.
        #[default]
        FirstOrder,
        /// Exactly: c₁ = c₂ = 0 and ε_r ε₀ in place of ε₀.
        Ideal,
    }
}

impl LawSpec {
    /// The law.
    pub(crate) fn law(&self, scope: &Scope<'_>) -> Result<ElasticLaw> {
        Ok(the_one!(scope, self;
            "gent" gent |_, law| ElasticLaw::Gent { limit: law.limit };
            "mooney_rivlin" mooney_rivlin |_, law| ElasticLaw::MooneyRivlin { share: law.share };
            "yeoh" yeoh |_, law| ElasticLaw::Yeoh { c2: law.c2.value(), c3: law.c3.value() };
            "ogden" ogden |_, law| ElasticLaw::Ogden { exponents: law.exponents, share: law.share };
        ))
    }
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
