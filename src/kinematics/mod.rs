//! Linear kinematics: vectors of space that are linear in the poses of bodies.

mod vector;

pub use vector::{MaterialVector, Pose, Term, Vectors};
