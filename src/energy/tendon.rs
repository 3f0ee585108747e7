//! A tendon: an elastic cable that slides without friction through any number of points, and takes no compression.

/// Elastic energy `½ k max(L − ℓ, 0)²` of the length L of a path of spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cable {
    /// Stiffness k in N/mm.
    pub stiffness: f64,
    /// Length ℓ without force in mm.
    pub length: f64,
}

impl Cable {
    /// Energy W, tension W′ and stiffness W″ at a length; W‴ is zero where it exists. Slack is the left of ℓ, ℓ included.
    pub fn of_length(&self, length: f64) -> [f64; 3] {
        let beyond = length - self.length;
        // A length that is no number stays none.
        if beyond <= 0.0 {
            return [0.0; 3];
        }
        let k = self.stiffness;
        [0.5 * k * beyond * beyond, k * beyond, k]
    }
}
