//! The same sums as functions of coordinates: x = F(u).
//!
//! Terms read material vectors x. Coordinates u of an instant are the joint coordinates of a kinematic tree
//! ([`Tree`]), or the directors of all bodies, in which every vector is linear; multipliers of constraints that the
//! coordinates leave open follow them in the same list z = (u, λ). With P = ∂x/∂u, forces R, blocks H of the sum, and
//! w = P l for a direction l (of costates) the pull-back of a sum reads
//!
//! ```text
//! gradient     Pᵀ R
//! Hessian      Pᵀ H P + R·P′
//! third        Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l + (Hᵀ w)·P′ + R·P″_l
//! ```
//!
//! where P′_l is the derivative of P along l. Over an interval P = diag(P_k, P_{k+1}), so the two-point structure in
//! time survives, and the rows are the rows P(q_k)ᵀ(…) = 0 of DMOCC.

mod configuration;
mod map;
mod pattern;
mod pull_back;
mod reduced;
mod tree;

pub use configuration::Configuration;
pub use map::{CoordinateMap, Dependence, NodePlace};
pub use pattern::{BlockPattern, StepPattern};
pub use pull_back::Destination;
pub use reduced::{Reduced, Scratch};
pub use tree::{CHART, LANES, Link, LinkKind, Tree};
