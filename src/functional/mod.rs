//! Sums of effects over the intervals and instants of a horizon: indices and time, no physics.
//!
//! The discrete action of the midpoint rule is a sum over intervals `[t_k, t_{k+1}]` and instants `t_k`,
//!
//! ```text
//! Ŝ = Σ_k h [ T(v_k) − V(x̄_k, s_k) ] − h₀ Σ_k λ_k·g(x_k),     x̄ = (x_k + x_{k+1})/2,   v = (x_{k+1} − x_k)/h,
//! ```
//!
//! of material vectors x, interval scalars s (voltages) and multipliers λ. An [`Effect`] answers for one term of the
//! sum on one interval: its forces ∂Ŝ/∂x, the blocks of ∂²Ŝ/∂x², and both contracted with a direction. How vectors
//! follow from coordinates is none of its business.

mod batches;
mod couplings;
mod element_field;
mod group;
mod group_term;
mod hexahedra;
mod inertia;
mod paths;
mod slots;
mod stencil;
mod term;
mod viscous_hexahedra;

pub use couplings::{BlockMask, Blocks, Couplings, Part};
pub use element_field::ElementField;
pub use group::{Element, Group};
pub use hexahedra::{Electrical, Hexahedra, Hexahedron, ScalarArg};
pub use inertia::{Inertia, Mass};
pub use paths::{Path, Paths};
pub use stencil::{Stencil, VectorArg};
pub use term::{Functional, Horizon, Kind, Measure, Order, Output, Sample, Term};
pub use viscous_hexahedra::{ViscousHexahedra, ViscousHexahedron};
