//! Laws of elasticity of a material other than the neo-Hookean one: as they are written, and their constants.

use crate::energy::ElasticLaw;
use crate::files::json::error::Result;
use crate::files::json::objects::objects;
use crate::files::json::scope::{Scope, the_one};
use crate::files::units::quantity::{Quantity, Stress};

objects! {
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
