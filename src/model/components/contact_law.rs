//! Constants of contacts: their elasticity and their restitution.

/// Elasticity of a contact.
#[derive(Clone, Debug, PartialEq)]
pub enum ContactElasticLaw {
    /// Force proportional to the overlap, stiffness in N/mm.
    Linear(f64),
    /// Law of Hertz for one elastic solid on a rigid one, or for two.
    Hertz(Vec<ElasticSolid>),
}

/// Elastic constants of a solid in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticSolid {
    /// Young's modulus in MPa.
    pub modulus: f64,
    /// Poisson ratio.
    pub poisson_ratio: f64,
}

/// Restitution of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restitution {
    /// Speed after the impact over the speed before it.
    pub coefficient: f64,
    /// The speed in mm/ms at which it is so.
    pub speed: f64,
}

/// Speed of slip in mm/ms up to which friction grows where none is given.
pub const SLIP_SPEED: f64 = 1e-4;

impl ContactElasticLaw {
    /// Stiffness in N/mmᵖ and exponent p for a radius of relative curvature in mm.
    pub(super) fn constants(&self, radius: f64) -> [f64; 2] {
        match self {
            Self::Linear(stiffness) => [*stiffness, 1.0],
            Self::Hertz(solids) => {
                let compliance = |solid: &ElasticSolid| {
                    (1.0 - solid.poisson_ratio * solid.poisson_ratio) / solid.modulus
                };
                let compliance: f64 = solids.iter().map(compliance).sum();
                [4.0 / 3.0 * radius.sqrt() / compliance, 1.5]
            }
        }
    }
}

impl Restitution {
    /// Damping times speed κ of the restitution e: `κ (1 + e) = ln[(1 + κ)/(1 − κ e)]`, zero of e = 1.
    pub(super) fn damping_number(&self) -> f64 {
        let e = self.coefficient;
        let excess = |k: f64| (k.ln_1p() - (-k * e).ln_1p()) - k * (1.0 + e);
        if e >= 1.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0 / e);
        // The excess falls from zero at zero, and is infinite at 1/e.
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            match excess(middle) > 0.0 {
                true => high = middle,
                false => low = middle,
            }
        }
    }
}
