//! Sparse symmetric indefinite systems with the structure of a horizon: `A = L D Lᵀ` with exact inertia.
//!
//! An interior-point method solves in each iteration
//!
//! ```text
//! ⎡ H + Σ + δ_w   Jᵀ  ⎤ ⎡ Δx ⎤     ⎡ ∇ₓL ⎤
//! ⎣ J            −δ_c ⎦ ⎣ Δy ⎦ = − ⎣ c   ⎦
//! ```
//!
//! and asks for the number of negative eigenvalues, which must be that of the equations. H is indefinite on the way and δ_c mostly zero, so
//! that neither static regularisation nor an order alone makes the factors stable: pivots are chosen by threshold, in a front of all
//! that one stage reaches, and what is no pivot there is left to the next one (the multifrontal method of Duff and Reid, 1983).
//!
//! | file | owns |
//! |---|---|
//! | `graph`, `order`, `tree`, `fronts` | once for a pattern: order of elimination, fronts, where each entry goes |
//! | `pivot`, `dense`, `update`, `eliminate` | one dense front |
//! | `numeric`, `pivot` | factors, solutions, equilibration, signs of eigenvalues |
//! | `condense`, `eliminable_groups`, `condensed`, `reduce`, `substitute` | unknowns that equations determine, eliminated before all others |
//! | `bandwidth_order`, `block_lu`, `block_solve` | the equations of one group |
//! | `solver` | when to scale, how strictly to pivot, whether the factors are good, by a system solved with them |
//!
//! After the first matrix nothing is allocated, unless more pivots are delayed than ever before.

mod bandwidth_order;
mod block_lu;
mod block_solve;
mod condense;
mod condensed;
mod dense;
mod eliminable_groups;
mod eliminate;
mod fronts;
mod graph;
mod numeric;
mod order;
mod pivot;
mod reduce;
mod solver;
mod substitute;
mod tree;
mod update;

pub use crate::math::Stopped;
pub use condense::Plan;
pub use graph::Pattern;
pub use order::Unknown;
pub use pivot::Inertia;
pub use solver::{Solver, Statistics};
