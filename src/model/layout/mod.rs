//! Variables of a model and their places: coordinates, internal ones, nodes of blocks, states read from instants.

pub(super) mod contact_reading;
pub(super) mod internal;
pub(super) mod joint_sections;
pub(super) mod node_grids;
pub(super) mod sheet;
pub(super) mod solid_block;
pub(super) mod solids;
pub(super) mod states;
pub(super) mod variables;
