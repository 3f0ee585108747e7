//! Elastic blocks of finite elements.

#[path = "../common/mod.rs"]
mod common;

mod dynamics;
mod gmsh;
mod invariants;
mod loads;
mod maxwell;
mod maxwell_limits;
mod mesh;
mod multigrid;
mod physics;
mod prestretch;
mod refusals;
mod slender;
mod statics;
mod structure;
