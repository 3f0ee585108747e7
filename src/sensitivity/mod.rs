//! Sensitivities of optima: exact first derivatives of an optimum by constants, goals, starts and bounds that are held in it.
//!
//! An optimum x with multipliers y of its equations meets `F(x, y; p) = (∇ₓL, c) = 0` with the bounds that it has reached as equations. Its
//! derivatives by p follow from the matrix of Newton's method for F at the optimum,
//!
//! ```text
//! ⎡ ∇²L  Jᵀ ⎤ ⎡ dx/dp ⎤     ⎡ ∂∇ₓL/∂p ⎤
//! ⎣ J    0  ⎦ ⎣ dy/dp ⎦ = − ⎣ ∂c/∂p   ⎦,      df/dp = ∂L/∂p,
//! ```
//!
//! factorised once, with one back-substitution for each p. The matrix has to have as many negative eigenvalues as equations and none that is zero:
//! then the optimum is strict, and its derivatives exist (Fiacco, 1983). They hold as long as the same bounds are reached: `margins` tells how far,
//! to first order.
//!
//! `kernel` knows any [`Nlp`](crate::nlp::Nlp), `conditions` the bounds that its optimum reaches and its linear system. `optimum` is the front for
//! control problems: `with_parameters` has their program, in which constants, start and goal are columns that are held, and `directions` the changes
//! with each number.

mod conditions;
mod directions;
mod kernel;
mod margins;
mod optimum;
mod with_parameters;

pub(crate) use conditions::Saddle;
pub use conditions::{Direction, Held, NoSensitivity, Side};
pub use kernel::{Adjoint, Derivative, Kernel, Outcome};
pub use margins::{End, Range};
pub use optimum::{Gradients, Refusal, Sensitivity, gradients, sensitivities};
pub use with_parameters::check;
