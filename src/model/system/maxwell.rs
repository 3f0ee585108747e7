//! Maxwell branches of a material: springs in series with dampers, next to its elasticity.

/// Greatest number of branches of a material.
pub const MOST_BRANCHES: usize = 5;

/// Expectation of a response, for messages.
pub const NO_BRANCHES: &str = "a scene with Maxwell branches";

/// A spring in series with a damper.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaxwellBranch {
    /// Shear modulus μ₁ of the spring in MPa.
    pub shear_modulus: f64,
    /// Relaxation time τ in ms: the time in which small stresses of the branch fall to 1/e.
    pub relaxation_time: f64,
}

/// The branches of a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaxwellBranches {
    count: usize,
    list: [MaxwellBranch; MOST_BRANCHES],
}

impl MaxwellBranches {
    /// These branches; `None` if they are more than [`MOST_BRANCHES`].
    pub fn new(branches: &[MaxwellBranch]) -> Option<Self> {
        let mut all = Self {
            count: branches.len(),
            ..Self::default()
        };
        all.list
            .get_mut(..branches.len())?
            .copy_from_slice(branches);
        Some(all)
    }

    /// A branch, to change it.
    pub fn get_mut(&mut self, branch: usize) -> Option<&mut MaxwellBranch> {
        self.list[..self.count].get_mut(branch)
    }

    /// All of them.
    pub fn list(&self) -> &[MaxwellBranch] {
        &self.list[..self.count]
    }
}

/// Response of Maxwell branches to loads under which a system rests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Response {
    /// After a long time: branches carry nothing.
    #[default]
    Relaxed,
    /// At once: branches are springs without stress in the reference configuration.
    Instantaneous,
}
