//! Loads: forces at points, on joint coordinates, on faces and in blocks, and charges on faces, whose size is an input, given in time or
//! sought.

use crate::math::Vector;
pub use crate::mesh::geometry::Faces;
use crate::model::system::bodies::Attachment;

/// A load on the system.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Unique name, that of its input.
    pub name: String,
    /// Place where it acts.
    pub on: LoadPlace,
}

/// Place where a load acts.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadPlace {
    /// A force in N at a point of a body.
    Point {
        /// Point.
        at: Attachment,
        /// Unit vector in the ground frame, in the reference configuration where it turns.
        direction: Vector,
        /// True if the direction turns with the body.
        follows: bool,
    },
    /// A torque in N mm about the axis of a revolute joint, or a force in N along that of a prismatic one, from the parent on the child:
    /// a motor.
    Joint(usize),
    /// A charge in mC on the electrodes of a lumped muscle, in place of a voltage.
    Muscle(usize),
    /// A load of an elastic block.
    Block {
        /// Index of the block.
        block: usize,
        /// Its load.
        load: BlockLoad,
    },
}

/// A load of an elastic block. Areas and volumes are those of the reference configuration but for a pressure that follows.
#[derive(Clone, Debug, PartialEq)]
pub enum BlockLoad {
    /// A traction in MPa on faces, along a unit vector of the ground frame.
    Traction(Faces, Vector),
    /// A pressure in MPa on faces, against their outward normals, positive where it presses.
    Pressure {
        /// Faces.
        faces: Faces,
        /// True if it acts on the deformed faces, along their normals; otherwise on those of the reference configuration.
        follows: bool,
    },
    /// A charge in mC/mm² on faces.
    Charge(Faces),
    /// A force in N/mm³ along a unit vector of the ground frame.
    BodyForce(Vector),
}

impl BlockLoad {
    /// Faces on which it acts; none of a body force.
    pub fn faces(&self) -> &[Vec<usize>] {
        match self {
            Self::Traction(faces, _) | Self::Pressure { faces, .. } | Self::Charge(faces) => faces,
            Self::BodyForce(_) => &[],
        }
    }
}
