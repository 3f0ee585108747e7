//! Material points that parts of a scene are attached to.

use crate::kinematics::Pose;
use nalgebra::Vector3;

/// A material point of a body, or of the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// The body; `None` is the ground.
    pub body: Option<usize>,
    /// Place in the reference configuration in mm, in the ground frame.
    pub at: Vector3<f64>,
}

impl Attachment {
    /// Its place in mm at poses of the bodies, those of the reference configuration given too.
    pub fn place(&self, poses: &[Pose], reference: impl Fn(usize) -> Pose) -> Vector3<f64> {
        match self.body {
            None => self.at,
            Some(body) => poses[body].point(&reference(body).local(&self.at)),
        }
    }
}
