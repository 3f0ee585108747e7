//! Finite elements of a dielectric elastomer, of any [interpolation](crate::mesh::interpolation): pure formulas, without index or time.
//!
//! N nodes at x_i, N in the type, with electric potentials φ_i span, with the shape functions N_i and G_i = ∂N_i/∂X,
//!
//! ```text
//! F = Σ x_i ⊗ G_i,      E = −Σ φ_i G_i,      W(x, φ) = Σ_g w_g Ω(F, E),
//! ```
//!
//! summed over eight Gauss points with weights w_g. [`ElementGeometry`] holds G_i and w_g, [`Elastomer`] the law Ω with
//! the derivatives of W to third order, [`Viscosity`] the virtual work of σ = η d, [`MaxwellSpring`] the energy of a Maxwell branch, [`Fields`] what is shown of a state,
//! [`FieldPoint`] the true field that limits bound.
//!
//! The formulas are written in the spatial gradients g_i = F⁻ᵀG_i and evaluated at all Gauss points side by side.

#![expect(
    clippy::needless_range_loop,
    reason = "nodes and components are the indices of the formulas"
)]

mod branch;
mod dilatation;
mod dual;
mod elastomer;
mod evaluation;
mod fields;
mod geometry;
mod isochoric;
mod lanes;
mod law;
mod local;
mod number;
mod sheet;
mod variations;
mod viscosity;

pub use branch::{MaxwellSpring, ViscousStrains, relaxed};
pub use dilatation::{Dilatation, second_derivatives_of_volume};
pub use elastomer::Elastomer;
pub use evaluation::{ElementEnergy, NodeState};
pub use fields::{FieldPoint, Fields, SpatialField};
pub use geometry::{ElementGeometry, Inverted};
pub use isochoric::{ElementLaw, IsochoricLaw};
pub use law::{Dielectric, ElectricDerivatives, Field, Passive, Volume};
pub use local::{BranchLocal, COORDINATES, Local};
pub use sheet::{SHEET_POINTS, SheetPoint, sheet_masses};
pub use viscosity::{Viscosity, ViscousContraction, ViscousLocal};
