//! Elastic blocks of finite elements.

#[path = "../common/mod.rs"]
mod common;

mod aggregation;
mod dynamics;
mod gmsh;
mod incompressible;
mod invariants;
mod kept_problems;
mod loads;
mod lowest_mode;
mod maxwell;
mod maxwell_limits;
mod membranes;
mod mesh;
mod multigrid;
mod physics;
mod prestretch;
mod random_blocks;
mod refusals;
mod slender;
mod statics;
mod stopped;
mod structure;
mod tetrahedra;
