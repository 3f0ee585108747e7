//! Kinds of joints, with their axes in the ground frame of the reference configuration.

use nalgebra::Vector3;

/// Motion that a joint permits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum JointKind {
    /// Rotation about a unit axis.
    Revolute {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Translation along a unit axis.
    Prismatic {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Rotation about a unit axis of the parent, then about a unit axis of the child perpendicular to it.
    Universal {
        /// Both axes in the ground frame.
        axes: [Vector3<f64>; 2],
    },
    /// Translation along a unit axis and rotation about it.
    Cylindrical {
        /// Unit axis in the ground frame.
        axis: Vector3<f64>,
    },
    /// Translation in a plane and rotation about its unit normal.
    Planar {
        /// Unit normal in the ground frame.
        normal: Vector3<f64>,
    },
    /// Rotation about a point.
    Spherical,
    /// Anything: the child is as free as without the joint.
    Floating,
    /// Nothing.
    #[default]
    Fixed,
}
