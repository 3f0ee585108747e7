//! Elastic blocks of finite elements.

#[path = "../common/mod.rs"]
mod common;

mod dynamics;
mod invariants;
mod mesh;
mod physics;
mod refusals;
mod statics;
mod structure;
