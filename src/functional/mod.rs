//! Sums of terms over the intervals and instants of a horizon: indices and time, no physics.
//!
//! The discrete action of the midpoint rule is a sum over intervals `[t_k, t_{k+1}]` and instants `t_k`,
//!
//! ```text
//! Ŝ = Σ_k h [ T(v_k) − V(x̄_k, s_k) ] − h₀ Σ_k λ_k·g(x_k),     x̄ = (x_k + x_{k+1})/2,   v = (x_{k+1} − x_k)/h,
//! ```
//!
//! of material vectors x, interval scalars s (voltages) and multipliers λ. A [`Term`] answers for its
//! summands on one interval: forces ∂Ŝ/∂x, the blocks of ∂²Ŝ/∂x², and both contracted with a direction. How vectors follow from
//! coordinates is none of its business.
//!
//! All terms but [`Inertia`] are a [`Group`] of elements of one kind, each a [`Kernel`], whose [derivatives](crate::math::Derivatives) one loop adds up.

mod border;
mod couplings;
mod curved;
mod finite_elements;
mod formulas;
mod group;
mod impulse;
mod inertia;
mod kernel;
mod laws;
mod measured;
mod node_blocks;
mod paths;
mod pressure;
mod scaled;
mod scatter;
mod stencil;
mod term;
mod viscous_elements;

pub use couplings::{BlockMask, Blocks, Coupling, Couplings, ParameterOrder};
pub use curved::Curved;
pub use finite_elements::{Electrical, ElementField, FiniteElement, Variations, VariedElement};
pub use formulas::Element;
pub use group::Group;
pub use impulse::{Displacement, Impulse, Shortening, Turn};
pub use inertia::{Inertia, Mass};
pub use kernel::{Kernel, Scatter};
pub use laws::{LawElement, MOST_PARAMETERS, Move};
pub use node_blocks::{NodeBlocks, NodeVolume, Pressures, ScalarPlace, VectorPlace};
pub use paths::Path;
pub use pressure::{Areas, PressureFace, areas};
pub use scaled::{FreeConstant, ScaledElement};
pub use stencil::{ScalarArg, Stencil, VectorArg};
pub use term::{
    Functional, Horizon, Measure, Order, Outer, Output, Sample, SumDerivatives, Term, TermKind,
};
pub use viscous_elements::{MaxwellElement, POINTS, ViscousElement};
