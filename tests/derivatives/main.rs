//! Derivatives: of every formula, of elements, of the action and of programs, against naive oracles and differences.

#[path = "../common/mod.rs"]
mod common;

mod action;
mod amounts;
mod arithmetic;
mod contacts;
mod cored_contacts;
mod costs;
mod differences;
mod elastic_laws;
mod energies;
mod formulas;
mod formulas_of_loads;
mod gathered;
mod hexahedron;
mod hexahedron_laws;
mod hexahedron_maxwell;
mod hexahedron_states;
mod hexahedron_viscosity;
mod horizon;
mod kernel;
mod linear_steps;
mod membrane;
mod naive_formulas;
mod naive_hexahedron;
mod naive_sources;
mod oracle;
mod sought;
mod sought_laws;
mod sought_limits;
mod tetrahedron;
