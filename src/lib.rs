//! Simulation and optimal control of systems driven by dielectric elastomer muscles.
//!
//! ```
//! use proboscis::prelude::*;
//!
//! # fn main() -> Result<()> {
//! let mut system = System::new("oscillator");
//! let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
//! let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
//! let spring = Spring::between((GROUND, -X * mm(50.0)), (cart, X * mm(0.0)));
//! system.add(spring.stiffness(n_per_m(200.0)));
//! let start = State::Joints(vec![(slide, mm(5.0))]);
//! let motion = Simulation::over(ms(200.0)).start(start).run(&system)?;
//! let lowest = motion.joint(slide).into_iter().fold(0.0, f64::min);
//! assert!((lowest + 5.0).abs() < 0.1);
//! # Ok(())
//! # }
//! ```
//!
//! [`Simulation`] and [`Control`] are asked of a [`System`] of parts: [`Body`], [`Joint`], [`Muscle`], [`Solid`], [`Spring`], [`Tendon`],
//! [`Marker`], and whatever implements [`Component`]. [`units`] are written as functions; all else is in g, mm, ms, N, V. A [`Motion`] and an
//! [`Optimum`] are what comes back; an [`Identification`] fits constants to recordings; a [`receding::RecedingHorizon`] plans the motion of a
//! robot anew while it moves. [`Nlp`] is the transcription for a solver of one's own.
//!
//! # How it works
//!
//! Everything a problem is made of is a scalar, and everything the solvers need is a derivative of a sum of scalars.
//! The midpoint rule turns the action of a scene into a sum over intervals `[t_k, t_{k+1}]` and instants `t_k`,
//!
//! ```text
//! Ŝ = Σ_k h [ T(v_k) − V(x̄_k, s_k) ] − h₀ Σ_k λ_k·g(x_k),     x̄ = (x_k + x_{k+1})/2,   v = (x_{k+1} − x_k)/h,
//! δŜ + Σ_k h δx̄_k·f(x̄_k, v_k) = 0,
//! ```
//!
//! of material vectors x (points, directors and spans of bodies), voltages s and multipliers λ. There is one assembly of
//! it, and two readers:
//!
//! ```text
//! forward simulation           Newton on the rows of instant k of ∇Ŝ, tangent: those rows of ∇²Ŝ
//! constraints of the program   c = ∇Ŝ + virtual work          discrete Euler–Lagrange equations, g = 0
//! their Jacobian               ∇c = ∇²Ŝ
//! Hessian of the Lagrangian    ∇²(y·c) = ∇³Ŝ[y] + ∇²(objective)
//! ```
//!
//! Coordinates are chosen on top: x = F(u) with joint coordinates u of a kinematic tree, or directors with multipliers.
//!
//! The modules that do this are public for tests and tools and not part of the interface; `docs/architecture.md` describes them, and
//! `RUSTDOCFLAGS="--cfg internals" cargo doc` shows them.

#[cfg(feature = "cli")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod app;
#[cfg_attr(not(internals), doc(hidden))]
pub mod control;
#[cfg_attr(not(internals), doc(hidden))]
pub mod coordinates;
#[cfg_attr(not(internals), doc(hidden))]
pub mod dynamics;
#[cfg_attr(not(internals), doc(hidden))]
pub mod element;
#[cfg_attr(not(internals), doc(hidden))]
pub mod energy;
#[cfg_attr(not(internals), doc(hidden))]
pub mod feedback;
#[cfg(feature = "files")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod files;
#[cfg_attr(not(internals), doc(hidden))]
pub mod functional;
#[cfg_attr(not(internals), doc(hidden))]
pub mod identify;
#[cfg_attr(not(internals), doc(hidden))]
pub mod interface;
#[cfg_attr(not(internals), doc(hidden))]
pub mod ipopt;
#[cfg_attr(not(internals), doc(hidden))]
pub mod kinematics;
#[cfg_attr(not(internals), doc(hidden))]
pub mod kkt;
#[cfg_attr(not(internals), doc(hidden))]
pub mod math;
#[cfg_attr(not(internals), doc(hidden))]
pub mod mesh;
#[cfg_attr(not(internals), doc(hidden))]
pub mod model;
#[cfg_attr(not(internals), doc(hidden))]
pub mod nlp;
#[cfg(feature = "report")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod report;
#[cfg_attr(not(internals), doc(hidden))]
pub mod sensitivity;
#[cfg_attr(not(internals), doc(hidden))]
pub mod sparse;
#[cfg_attr(not(internals), doc(hidden))]
pub mod stop;
#[cfg(feature = "cli")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod study;
#[cfg(feature = "cli")]
#[cfg_attr(not(internals), doc(hidden))]
pub mod sweep;
#[cfg_attr(not(internals), doc(hidden))]
pub mod tasks;
pub mod units;
#[cfg_attr(not(internals), doc(hidden))]
pub mod workflow;

pub use control::problem::{OutcomeOf, Varied, VariedOf, WeightOf};
pub use control::{EarlierSolution, Orientation, Solution};
pub use dynamics::{Integrator, Vibration};
pub use energy::Energy;
pub use functional::Element;
pub use identify::{Identified, IdentifyError};
pub use interface::{
    Carrier, Control, Equilibrium, Error, GROUND, Handle, Identification, Input, Motion, Optimum,
    Part, Recording, Result, Simulation, State, Tension, Together,
};
pub use kinematics::Pose;
pub use math::{Fault, Jet, Signal};
pub use mesh::Mesh;
pub use mesh::grid::Grid;
pub use mesh::surface::Surface;
pub use model::components::{Contact, ContactShape, Load, Spring, Tendon};
pub use model::system::{
    Attachment, Body, ElasticLaw, Electrode, Glue, Joint, JointKind, Marker, Material, Muscle,
    Potential, Shape, Solid, Support, Tie,
};
pub use model::{
    Component, Constant, FoundParameter, MaterialConstant, Parameter, System, SystemError, Terms,
    mid,
};
pub use nlp::Nlp;
pub use sensitivity::{Gradients, Sensitivity};
pub use workflow::receding;
pub use workflow::{Remark, Severity, Tracked, TrackingError};

/// All that a program needs: `use proboscis::prelude::*;`.
pub mod prelude {
    pub use crate::units::*;
    pub use crate::{
        Attachment, Body, Carrier, Component, Contact, ContactShape, Control, ElasticLaw,
        Equilibrium, Error, GROUND, Grid, Handle, Identification, Input, Integrator, Joint,
        JointKind, Load, Marker, Material, Motion, Muscle, Optimum, Orientation, Parameter, Part,
        Potential, Recording, Result, Signal, Simulation, Solid, Spring, State, Surface, System,
        Tendon, Together, X, Y, Z,
    };
}

/// Direction x.
pub const X: nalgebra::Vector3<f64> = nalgebra::Vector3::new(1.0, 0.0, 0.0);
/// Direction y.
pub const Y: nalgebra::Vector3<f64> = nalgebra::Vector3::new(0.0, 1.0, 0.0);
/// Direction z.
pub const Z: nalgebra::Vector3<f64> = nalgebra::Vector3::new(0.0, 0.0, 1.0);

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
