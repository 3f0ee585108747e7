//! Derivatives: of every formula, of elements, of the action and of programs, against naive oracles and differences.

#[path = "../common/mod.rs"]
mod common;

mod action;
mod differences;
mod formulas;
mod hexahedron;
mod horizon;
