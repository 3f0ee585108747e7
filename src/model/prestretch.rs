//! Prestretch of a block: its mesh is that of the stretched block, x = diag(λ₁, λ₂, λ₃) X of the places X without stress.
//!
//! Elements have their shape functions, volume and mass at X, and all else at x: the deformation gradient of the reference configuration
//! is diag(λ₁, λ₂, λ₃).

use crate::energy::ElasticLaw;
use crate::math::Vector;
use crate::model::check::{SystemError, require};
use crate::model::system::Solid;

impl Solid {
    /// Place of a node in mm without stress.
    pub(super) fn unstretched(&self, node: usize) -> Vector {
        let place = self.mesh.nodes[node];
        match self.prestretch {
            None => place,
            Some(stretches) => place.component_div(&Vector::from(stretches)),
        }
    }

    /// Returns an error unless the stretches are positive and its materials have an energy there.
    pub(super) fn check_prestretch(&self) -> Result<(), SystemError> {
        let Some(stretches) = self.prestretch else {
            return Ok(());
        };
        let found = || format!("the prestretch {stretches:?}");
        require(
            stretches.iter().all(|s| *s > 0.0 && s.is_finite()),
            &self.name,
            found,
            "positive stretches",
        )?;
        let volume: f64 = stretches.iter().product();
        let squares = stretches.iter().map(|s| s * s).sum::<f64>();
        let invariant = squares * volume.powf(-2.0 / 3.0) - 3.0;
        for law in self.materials.iter().filter_map(|material| material.law) {
            if let ElasticLaw::Gent { limit } = law {
                let expected = format!("less than Gent's limit, I1 - 3 < {limit}");
                let found = || format!("{}, of I1 - 3 = {invariant:.4}", found());
                require(invariant < limit, &self.name, found, &expected)?;
            }
        }
        Ok(())
    }
}
