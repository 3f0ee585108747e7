//! Simulation and optimal control of systems driven by dielectric elastomer muscles.

pub mod control;
pub mod dynamics;
pub mod energy;
pub mod functional;
pub mod ipopt;
pub mod kinematics;
pub mod math;
pub mod model;
pub mod nlp;
pub mod reduction;
pub mod report;
pub mod run;
pub mod scene;
pub mod sparse;
