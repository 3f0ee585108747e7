//! Linear kinematics: vectors of space that are linear in the poses of bodies and the places of nodes.

mod vector;

pub use vector::{Carrier, MaterialVector, Pose, VectorTerm, Vectors};
