//! Simulation and optimal control of systems driven by dielectric elastomer muscles.

pub mod control;
pub mod ipopt;
pub mod model;
pub mod nlp;
pub mod scene;
