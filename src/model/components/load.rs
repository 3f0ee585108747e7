//! Loads: forces at points and on joint coordinates whose size is an input, given in time or sought.

use crate::math::Vector;
use crate::model::attachment::Attachment;

/// A force or torque on the system.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Unique name, that of its input.
    pub name: String,
    /// Place where it acts.
    pub on: LoadPlace,
}

/// Place where a load acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadPlace {
    /// A force in N at a point of a body, along a direction that does not turn.
    Point {
        /// Point.
        at: Attachment,
        /// Unit vector in the ground frame.
        direction: Vector,
    },
    /// A torque in N mm about the axis of a revolute joint, or a force in N along that of a prismatic one, from the parent on the child:
    /// a motor.
    Joint(usize),
}
