//! A law and its state at the Gauss points, as the variations of the energy read them.

use super::geometry::ElementGeometry;
use super::isochoric::IsochoricLaw;
use super::law::{Dielectric, Volume};
use super::number::{Points, Three};

/// A law and the state at which it is evaluated.
pub(super) struct ElementState<'a, N: Points, const NODES: usize> {
    pub(super) token: N::Token,
    pub(super) shear_modulus: f64,
    pub(super) lame_lambda: f64,
    /// Absent at compile time for a neo-Hookean law.
    pub(super) isochoric: Option<(IsochoricLaw, f64)>,
    pub(super) volume: Volume,
    pub(super) shape: &'a ElementGeometry<NODES>,
    pub(super) x: &'a [[N::Uniform; 3]; NODES],
    /// Absent at compile time for a passive law.
    pub(super) electric: Option<(&'a Dielectric, &'a [N::Uniform; NODES])>,
}

/// The electric field at the Gauss points.
#[derive(Clone, Copy)]
pub(super) struct ElectricField<N> {
    /// E.
    pub(super) reference: Three<N>,
    /// e = F⁻ᵀE.
    pub(super) spatial: Three<N>,
    /// ω = F⁻¹e.
    pub(super) pulled: Three<N>,
    /// FE.
    pub(super) pushed: Three<N>,
    /// κ = εJ.
    pub(super) kappa: N,
    /// κ/2 e·e.
    pub(super) pressure: N,
}
