//! The model: from a checked system to sums of terms over its coordinates, where physics meets indices.

mod analysis;
mod build;
pub mod components;
mod constants;
mod construction;
mod layout;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod model;
mod presolve;
mod quantities;
pub mod system;
pub mod term_order;
mod terms;

pub use analysis::{Analysis, Coordinates, InitiallyMoving, ModelError};
pub use components::Component;
pub use components::body::DAMPING as JOINT_DAMPING;
pub use constants::constant::{
    Constant, Follower, FoundParameter, MaterialConstant, MaterialOf, Parameter, SiUnit,
};
pub use constants::free_parameters::{Read, Sought};
pub use constants::parameter::{
    NotSought, check as check_parameters, unit as unit_of, with_parameters,
};
pub use construction::Freedom;
pub use layout::contact_reading::ContactReading;
pub use layout::joint_sections::JointSection;
pub(crate) use layout::node_grids::has_nodes_alone;
pub use layout::node_grids::{NoGrids, NodeGrids};
pub use layout::solid_block::SolidBlock;
pub use layout::states::MuscleReading;
pub use layout::variables::{Role, Size, Time, Variable, Variables};
pub use model::{Floating, Model};
pub use presolve::graph::Graph;
pub use presolve::immobile::Immobile;
pub(crate) use presolve::loops::independent_rows;
pub use presolve::loops::{Loops, OPEN};
pub use presolve::presolved::{BodyLocation, Presolved};
pub use quantities::quantity::{MILLIAMPERE, Quantity};
pub use quantities::what::{
    At, FieldPlace, Of, PartKind, Plane, Pulling, Reaction, Region, What, joint_unit,
};
pub use system::Amount;
pub use system::check::{MOST_ELEMENTS, SystemError, check_axes, check_elements};
pub use system::joints::{JointReading, Prescribed, Screw, nearest_turn};
pub use system::maxwell::{MOST_BRANCHES, MaxwellBranch, MaxwellBranches, NO_BRANCHES, Response};
pub use system::{System, VACUUM_PERMITTIVITY};
pub use terms::{LeftOut, Present, Terms, mid, rate};
