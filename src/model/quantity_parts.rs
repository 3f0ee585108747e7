//! Parts of a scene and of space of which a quantity is one.

use crate::math::Vector;

/// A region of space in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// Box between two corners.
    Box {
        /// Lower corner.
        min: Vector,
        /// Upper corner.
        max: Vector,
    },
    /// Ball.
    Sphere {
        /// Centre.
        centre: Vector,
        /// Radius.
        radius: f64,
    },
}

/// Place where a true electric field is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldPlace {
    /// In a lumped muscle.
    Muscle(usize),
    /// At a point of a finite element.
    Element {
        /// Block: those of the scene, then those of the muscles of finite elements.
        block: usize,
        /// Element of its mesh.
        element: usize,
        /// Gauss point; the centre where there is none.
        point: Option<usize>,
    },
}

/// Force or torque that a joint transmits along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Force in N.
    Force,
    /// Torque in N mm about the point of the joint.
    Torque,
}

/// A part between points that pulls its ends together; a lumped muscle has a quantity of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pulling {
    /// A spring with its damper.
    Spring(usize),
    /// A tendon.
    Tendon(usize),
}
