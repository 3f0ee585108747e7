//! Validation of a material: the constants of its law, and what finite elements need of it.

use crate::model::system::{ElasticLaw, Material};
use crate::model::system_error::{SystemError, require};

impl Material {
    /// Checks the stretches for which its constants hold.
    pub(super) fn check_range(&self, name: &str) -> Result<(), SystemError> {
        require(
            self.stretch_range
                .is_none_or(|[low, high]| 0.0 < low && low < high && high < f64::INFINITY),
            name,
            || format!("the stretch range {:?}", self.stretch_range),
            "two positive stretches, the smaller one first",
        )
    }

    /// Checks the constants of a law of elasticity.
    pub(super) fn check_law(&self, name: &str) -> Result<(), SystemError> {
        match self.law.and_then(|law| law.fault()) {
            None => Ok(()),
            Some(fault) => {
                let found = || format!("{} {}", fault.constant, fault.found);
                require(false, name, found, fault.expected)
            }
        }
    }

    /// Checks that finite elements can be made of a material: it is compressible, and follows no law of principal
    /// stretches.
    pub(super) fn check_of_elements(&self, name: &str) -> Result<(), SystemError> {
        require(
            !matches!(self.law, Some(ElasticLaw::Ogden { .. })),
            name,
            || "Ogden's law of finite elements".to_owned(),
            "a law of the invariants of the strain: only lumped muscles follow Ogden's",
        )?;
        require(
            self.lame_lambda.is_some_and(f64::is_finite),
            name,
            || "a material without Poisson ratio".to_owned(),
            "one, as finite elements are compressible",
        )
    }
}
