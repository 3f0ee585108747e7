//! Laws of elasticity of a material other than the neo-Hookean one: as they are written, and their constants.

use crate::energy::ElasticLaw;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::units::quantity::{Quantity, Stress};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Law of elasticity: exactly one of the four. The `shear_modulus` of the material is that of small strains in each of them.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LawSpec {
    /// Gent's law, −μ/2 Jm ln(1 − (I₁ − 3)/Jm): it stiffens without bound towards a greatest stretch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gent: Option<GentSpec>,
    /// Mooney and Rivlin's law, μ/2 [(1 − s)(I₁ − 3) + s (I₂ − 3)].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mooney_rivlin: Option<MooneyRivlinSpec>,
    /// Yeoh's law, μ/2 (I₁ − 3) + c₂ (I₁ − 3)² + c₃ (I₁ − 3)³.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yeoh: Option<YeohSpec>,
    /// Ogden's law with two terms, of lumped muscles only, 2μ [(1 − s)/α₁² Σ(λ^α₁ − 1) + s/α₂² Σ(λ^α₂ − 1)].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ogden: Option<OgdenSpec>,
}

/// Gent's law.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GentSpec {
    /// Limit Jm of I₁ − 3, a positive ratio.
    pub limit: f64,
}

/// Mooney and Rivlin's law.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MooneyRivlinSpec {
    /// Part s of the shear modulus that belongs to I₂, from 0 to 1: C₀₁ = s μ/2, C₁₀ = (1 − s) μ/2.
    pub share: f64,
}

/// Yeoh's law.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YeohSpec {
    /// Constant c₂ = C₂₀, SI unit Pa.
    pub c2: Quantity<Stress>,
    /// Constant c₃ = C₃₀, SI unit Pa.
    pub c3: Quantity<Stress>,
}

/// Ogden's law with two terms.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OgdenSpec {
    /// Exponents α₁ and α₂, not zero.
    pub exponents: [f64; 2],
    /// Part s of the shear modulus that belongs to the second term, from 0 to 1: μ₂ α₂ = 2 s μ, μ₁ α₁ = 2 (1 − s) μ.
    pub share: f64,
}

/// The law that is written.
pub(crate) fn law(spec: &LawSpec, scope: &Scope<'_>) -> Result<ElasticLaw, SceneError> {
    let gent = spec
        .gent
        .as_ref()
        .map(|gent| ElasticLaw::Gent { limit: gent.limit });
    let mooney_rivlin = spec.mooney_rivlin.as_ref();
    let mooney_rivlin = mooney_rivlin.map(|law| ElasticLaw::MooneyRivlin { share: law.share });
    let yeoh = spec.yeoh.as_ref().map(|yeoh| ElasticLaw::Yeoh {
        c2: yeoh.c2.value(),
        c3: yeoh.c3.value(),
    });
    let ogden = spec.ogden.as_ref().map(|ogden| ElasticLaw::Ogden {
        exponents: ogden.exponents,
        share: ogden.share,
    });
    let (key, law) = scope.exactly_one([
        ("gent", gent.map(|law| ("gent", law))),
        (
            "mooney_rivlin",
            mooney_rivlin.map(|law| ("mooney_rivlin", law)),
        ),
        ("yeoh", yeoh.map(|law| ("yeoh", law))),
        ("ogden", ogden.map(|law| ("ogden", law))),
    ])?;
    match law.fault() {
        None => Ok(law),
        Some(fault) => Err(scope
            .key(key)
            .key(fault.constant)
            .wrong(fault.found, fault.expected)),
    }
}
