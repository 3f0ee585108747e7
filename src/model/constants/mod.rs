//! Constants of components that may be free, and the parameters that they follow.

pub(super) mod constant;
pub(super) mod constant_places;
pub(super) mod free_parameters;
pub(super) mod parameter;
