//! Component of a scene: the parts that it connects, the terms of the action that it makes and their reasons, and its
//! observations.

use crate::math::Fault;
use crate::model::system::bodies::Attachment;
use crate::model::terms::Terms;
use nalgebra::Vector3;
use std::fmt::Debug;
use std::sync::Arc;

/// A part of a scene between material points of bodies.
///
/// [`Spring`](crate::model::components::Spring) and [`Tendon`](crate::model::components::Tendon) are two; other crates may add
/// their own to a system as [`Other`](crate::model::components::Other).
pub trait Component: Debug + Send + Sync {
    /// Name, unique among the components of a scene.
    fn name(&self) -> &str;

    /// The points that it ties together.
    fn points(&self) -> Vec<Attachment>;

    /// The nodes of elastic blocks that it ties, each with its block before it.
    fn nodes(&self) -> Vec<[usize; 2]> {
        Vec::new()
    }

    /// Checks its constants.
    ///
    /// # Errors
    /// The first constant that makes no sense.
    fn check(&self) -> Result<(), Fault> {
        Ok(())
    }

    /// Returns true if it exerts a force in the reference configuration: then it may move what it ties, otherwise nothing starts to
    /// move because of it.
    fn is_prestressed(&self) -> bool;

    /// Makes its terms, with reasons; or says why one is left out.
    fn build(&self, terms: &mut Terms<'_>);

    /// Names and units of its tabulated quantities at every instant: `[("length", "mm")]`.
    fn columns(&self) -> Vec<(&'static str, &'static str)> {
        Vec::new()
    }

    /// Values of these columns where its points are at the given places in mm.
    fn observe(&self, _places: &[Vector3<f64>]) -> Vec<f64> {
        Vec::new()
    }

    /// Lines that pictures draw, each through material points in their order: where not otherwise one through its points.
    fn outlines(&self) -> Vec<Vec<Attachment>> {
        vec![self.points()]
    }

    /// Returns true if pictures draw a coil between its two points, in place of a line.
    fn is_coiled(&self) -> bool {
        false
    }

    /// Energy in mJ that is typical of it, where it can store any.
    fn typical_energy(&self) -> f64 {
        0.0
    }
}

/// A component of another crate; equal to itself only.
#[derive(Clone, Debug)]
pub struct Other(pub Arc<dyn Component>);

impl PartialEq for Other {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
