//! Parts of a material law: the evaluation of its volumetric energy, and its electric part.

use crate::math::Vector;
use std::fmt::Debug;

/// Points at which the volumetric energy λ/2 ln²J of a hexahedron is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Volume {
    /// At each Gauss point: the plain trilinear hexahedron. Stiff in volume as ν → ½.
    Pointwise,
    /// V λ/2 ln²J̄ of the mean dilatation J̄ = (1/V) Σ w J, V the reference volume: Q1P0, an energy as well.
    Mean,
}

/// An elastomer without electric field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passive;

/// Constants of the electric energy c₁ |E|² + c₂ |F E|² − ½ ε |cof(F) E|²/J, in N/V².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    /// c₁.
    pub c1: f64,
    /// c₂.
    pub c2: f64,
    /// Permittivity ε of the last term: vacuum's, or the whole of an ideal dielectric.
    pub permittivity: f64,
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::Passive {}
    impl Sealed for super::Dielectric {}
}

/// The electric part of a law: none of it ([`Passive`]), or [`Dielectric`].
pub trait Field: sealed::Sealed + Copy + Debug + Send + Sync + 'static {
    /// Electric potentials of the nodes in V: `()` or `[f64; NODES]`.
    type Potentials<const NODES: usize>: Copy + Debug + PartialEq + Send + Sync;
    /// Derivatives by potentials: `()` or [`ElectricDerivatives`].
    type Local<const NODES: usize>: Clone + Debug + Default + Send + Sync;

    /// The constants and potentials, where there are any.
    #[doc(hidden)]
    fn constants<const NODES: usize>(
        &self,
        potentials: &Self::Potentials<NODES>,
    ) -> Option<(Dielectric, [f64; NODES])>;

    /// The derivatives by potentials, where there are any.
    fn derivatives<const NODES: usize>(
        local: &Self::Local<NODES>,
    ) -> Option<&ElectricDerivatives<NODES>>;

    /// Returns the storage into which the derivatives by potentials are written.
    fn electric<const NODES: usize>(
        local: &mut Self::Local<NODES>,
    ) -> Option<&mut ElectricDerivatives<NODES>>;
}

impl Field for Passive {
    type Potentials<const NODES: usize> = ();
    type Local<const NODES: usize> = ();

    #[inline(always)]
    fn constants<const NODES: usize>(&self, (): &()) -> Option<(Dielectric, [f64; NODES])> {
        None
    }

    #[inline(always)]
    fn derivatives<const NODES: usize>((): &()) -> Option<&ElectricDerivatives<NODES>> {
        None
    }

    #[inline(always)]
    fn electric<const NODES: usize>((): &mut ()) -> Option<&mut ElectricDerivatives<NODES>> {
        None
    }
}

impl Field for Dielectric {
    type Potentials<const NODES: usize> = [f64; NODES];
    type Local<const NODES: usize> = ElectricDerivatives<NODES>;

    #[inline(always)]
    fn constants<const NODES: usize>(
        &self,
        potentials: &[f64; NODES],
    ) -> Option<(Dielectric, [f64; NODES])> {
        Some((*self, *potentials))
    }

    #[inline(always)]
    fn derivatives<const NODES: usize>(
        local: &ElectricDerivatives<NODES>,
    ) -> Option<&ElectricDerivatives<NODES>> {
        Some(local)
    }

    #[inline(always)]
    fn electric<const NODES: usize>(
        local: &mut ElectricDerivatives<NODES>,
    ) -> Option<&mut ElectricDerivatives<NODES>> {
        Some(local)
    }
}

/// Derivatives of the energy of one hexahedron by the potentials of its nodes.
#[derive(Clone, Debug)]
pub struct ElectricDerivatives<const NODES: usize = 8> {
    /// ∂W/∂φ_i in mJ/V.
    pub charges: [f64; NODES],
    /// ∂²W/∂x_i∂φ_j in N/V, `coupling[i][j]`: all 64 vectors differ.
    pub coupling: [[Vector; NODES]; NODES],
    /// ∂²W/∂φ_i∂φ_j in mJ/V²; both triangles are filled.
    pub permittivity: [[f64; NODES]; NODES],
}

impl<const NODES: usize> Default for ElectricDerivatives<NODES> {
    fn default() -> Self {
        Self {
            charges: [0.0; NODES],
            coupling: [[Vector::zeros(); NODES]; NODES],
            permittivity: [[0.0; NODES]; NODES],
        }
    }
}
