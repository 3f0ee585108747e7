//! Steps with several points or samples: the equations of every [`Rule`].
//!
//! `rule` defines the methods, with the points of `lobatto`; `state` and `equations` are those of a step, with their derivatives.
//!
//! Unknowns of point ν = 1 … s are its coordinates and the multipliers of its rows; then come the scalars of each sample that have
//! an equation, such as potentials with Gauss's law. Constraints hold at every point.

mod equations;
mod lobatto;
mod rule;
mod state;

pub use state::GalerkinEquations;
