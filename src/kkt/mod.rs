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
//! | `numeric`, `inertia` | factors, solutions, equilibration, signs of eigenvalues |
//! | `eliminable_groups`, `bandwidth_order`, `condense`, `condensed`, `reduce`, `substitute` | unknowns that equations determine, eliminated before all others |
//! | `envelope`, `block_lu`, `block_solve` | the equations of one group |
//! | `solver` | when to scale, how strictly to pivot, whether the factors are good |
//! | `accuracy_check` | how exact factors are, by a system solved with them |
//!
//! After the first matrix nothing is allocated, unless more pivots are delayed than ever before.

mod accuracy_check;
mod bandwidth_order;
mod block_lu;
mod block_solve;
mod condense;
mod condensed;
mod dense;
mod eliminable_groups;
mod eliminate;
mod envelope;
mod fronts;
mod graph;
mod inertia;
mod lanes;
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
pub use inertia::Inertia;
pub use order::Unknown;
pub use solver::{Solver, Statistics};
