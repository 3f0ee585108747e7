//! Energies and virtual works: pure formulas, without index, mesh or time.

mod affine;
mod capacitance;
mod constraint;
mod damper;
mod gravity;
mod limit;
mod muscle;
mod sought_damper;
mod sought_muscle;
mod sought_spring;
mod spring;
mod tendon;
mod viscosity;

pub use affine::Affine;
pub use capacitance::Capacitance;
pub use constraint::{Coincidence, Orthogonality};
pub use damper::{AngularDamper, CoordinateDamper, LinearDamper};
pub use gravity::Gravity;
pub use limit::{Angle, OutsideBox, PositionComponent, Projection, SquaredDistance, SquaredField};
pub use muscle::{DielectricCell, ElasticCell, SectionInertia};
pub use sought_damper::SoughtDamper;
pub use sought_muscle::{SoughtCell, SoughtDielectric, SoughtShape, SoughtViscousCell};
pub use sought_spring::{SoughtSpanDamper, SoughtSpring};
pub use spring::{LinearSpring, SpanDamper};
pub use tendon::Cable;
pub use viscosity::ViscousCell;

use crate::math::Jet;
use nalgebra::SVector;

/// A scalar of `M` arguments, differentiated exactly: vectors first, three arguments each, then scalars.
pub trait Energy<const M: usize>: Send + Sync {
    /// Polynomial degree: derivatives above it vanish and are never emitted.
    const DEGREE: usize = usize::MAX;

    /// How many leading vectors are virtual displacements: 0 for a potential; otherwise the scalar is a virtual work
    /// δx·f, linear in them, whose scalar arguments are sought parameters.
    const VIRTUAL: usize = 0;

    /// Whether second derivatives between two vectors are multiples of the identity.
    const ISOTROPIC: bool = false;

    /// Whether the vector arguments `i` and `j` meet in second derivatives.
    fn couples(_i: usize, _j: usize) -> bool {
        true
    }

    /// The jet at `p`, with rates along `w` when `ORDER` is 3.
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Jet<M, ORDER>;
}
