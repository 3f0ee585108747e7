//! What a material law is made of: where volume counts, and its electric part.

use crate::math::Vector;
use std::fmt::Debug;

/// Where the volumetric energy λ/2 ln²J of a hexahedron is evaluated.
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
    /// Electric potentials of the nodes in V: `()` or `[f64; 8]`.
    type Potentials: Copy + Debug + Default + PartialEq + Send + Sync;
    /// Derivatives by potentials: `()` or [`Electric`].
    type Local: Clone + Debug + Default + Send + Sync;

    /// The constants and potentials, where there are any.
    #[doc(hidden)]
    fn constants(&self, potentials: &Self::Potentials) -> Option<(Dielectric, [f64; 8])>;

    /// The derivatives by potentials, where there are any.
    fn derivatives(local: &Self::Local) -> Option<&ElectricDerivatives>;

    /// Where the derivatives by potentials are written.
    fn electric(local: &mut Self::Local) -> Option<&mut ElectricDerivatives>;
}

impl Field for Passive {
    type Potentials = ();
    type Local = ();

    #[inline(always)]
    fn constants(&self, (): &()) -> Option<(Dielectric, [f64; 8])> {
        None
    }

    #[inline(always)]
    fn derivatives((): &()) -> Option<&ElectricDerivatives> {
        None
    }

    #[inline(always)]
    fn electric((): &mut ()) -> Option<&mut ElectricDerivatives> {
        None
    }
}

impl Field for Dielectric {
    type Potentials = [f64; 8];
    type Local = ElectricDerivatives;

    #[inline(always)]
    fn constants(&self, potentials: &[f64; 8]) -> Option<(Dielectric, [f64; 8])> {
        Some((*self, *potentials))
    }

    #[inline(always)]
    fn derivatives(local: &ElectricDerivatives) -> Option<&ElectricDerivatives> {
        Some(local)
    }

    #[inline(always)]
    fn electric(local: &mut ElectricDerivatives) -> Option<&mut ElectricDerivatives> {
        Some(local)
    }
}

/// Derivatives of the energy of one hexahedron by the potentials of its nodes.
#[derive(Clone, Debug)]
pub struct ElectricDerivatives {
    /// ∂W/∂φ_i in mJ/V.
    pub charges: [f64; 8],
    /// ∂²W/∂x_i∂φ_j in N/V, `coupling[i][j]`: all 64 vectors differ.
    pub coupling: [[Vector; 8]; 8],
    /// ∂²W/∂φ_i∂φ_j in mJ/V²; both triangles are filled.
    pub permittivity: [[f64; 8]; 8],
}

impl Default for ElectricDerivatives {
    fn default() -> Self {
        Self {
            charges: [0.0; 8],
            coupling: [[Vector::zeros(); 8]; 8],
            permittivity: [[0.0; 8]; 8],
        }
    }
}
