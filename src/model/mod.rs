//! The model: from a checked system to sums of terms over its coordinates, where physics meets indices.

mod analysis;
mod attachment;
mod block_terms;
mod blocks;
mod bodies;
mod build;
mod check;
mod component;
pub mod components;
mod constant;
mod constraints;
mod dampers;
mod error;
mod field_extent;
mod floating;
mod graph;
mod immobile;
mod internal;
mod joint_elasticity;
mod joint_springs;
mod joints;
mod loads;
mod material;
mod maxwell;
mod measures;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod model;
mod named;
mod parameter;
pub mod plan;
mod presolved;
mod quantity;
mod redundancy;
mod solid_block;
mod solids;
mod sought;
mod source;
mod states;
pub mod system;
mod terms;
mod unknown_positions;
mod variables;

pub use analysis::{Analysis, Coordinates, InitiallyMoving};
pub use check::{NO_CHARGE, SystemError};
pub use component::Component;
pub use constant::{
    Constant, DielectricLaw, Follower, FoundParameter, MOST_MOVES, Parameter, SiUnit,
};
pub use error::ModelError;
pub use floating::Floating;
pub use graph::Graph;
pub use immobile::Immobile;
pub use joints::{JointReading, Screw};
pub use maxwell::{MOST_BRANCHES, MaxwellBranch, MaxwellBranches};
pub use model::Model;
pub use named::Freedom;
pub use parameter::{NotSought, check as check_parameters, with_parameters};
pub use plan::{LeftOut, Present};
pub use presolved::{BodyLocation, Presolved};
pub use quantity::{FieldPlace, Quantity, Region, joint_unit};
pub use solid_block::SolidBlock;
pub use sought::{Arguments, Sought};
pub use system::{System, VACUUM_PERMITTIVITY};
pub use terms::{Terms, mid, rate};
pub use variables::{Role, Size, Time, Variable, Variables};
