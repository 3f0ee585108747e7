//! The true electric field at a point of an element, squared and relative to a limit, with its derivatives.
//!
//! With the spatial gradients a_i = F⁻ᵀG_i the field is e = F⁻ᵀE = −Σ φ_i a_i, and
//!
//! ```text
//! δa_i = −Σ_j a_j (a_i·δx_j),     δe = −Σ_j a_j (e·δx_j + δφ_j).
//! ```
//!
//! Both s = e·e and its gradient ∂s/∂x_i = −2 (e·a_i) e, ∂s/∂φ_i = −2 e·a_i follow, and from them
//!
//! ```text
//! ∂²s/∂x_i∂x_j = 2 [A_ij e⊗e + g_j e⊗a_i + g_i a_j⊗e],   ∂²s/∂x_i∂φ_j = 2 [A_ij e + g_i a_j],   ∂²s/∂φ_i∂φ_j = 2 A_ij
//! ```
//!
//! with A_ij = a_i·a_j and g_i = e·a_i.

use super::fields::{gradient_of, inverse};
use crate::math::{Matrix, Vector};

/// s = |e|²/E² at a point of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldPoint<const NODES: usize = 8> {
    /// G_i = ∂N_i/∂X there, in 1/mm.
    pub gradients: [Vector; NODES],
    /// E in V/mm.
    pub limit: f64,
}

/// Field and gradients at a state: all that derivatives are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialField<const NODES: usize = 8> {
    /// a_i in 1/mm.
    gradients: [Vector; NODES],
    /// e/E.
    field: Vector,
    /// g_i = (e/E)·a_i in 1/mm.
    along: [f64; NODES],
    /// 1/E.
    scale: f64,
}

impl<const NODES: usize> FieldPoint<NODES> {
    /// Field and gradients with nodes at `x` in mm and their potentials in V; NaN where the element is flat.
    pub fn at(&self, x: &[Vector; NODES], potentials: &[f64; NODES]) -> SpatialField<NODES> {
        let inverse = inverse(&gradient_of(x, &self.gradients));
        let gradients = self.gradients.map(|gradient| inverse.tr_mul(&gradient));
        let scale = 1.0 / self.limit;
        let both = gradients.iter().zip(potentials);
        let field: Vector = both.map(|(a, phi)| a * (-phi * scale)).sum();
        SpatialField {
            gradients,
            field,
            along: gradients.map(|a| field.dot(&a)),
            scale,
        }
    }
}

impl<const NODES: usize> SpatialField<NODES> {
    /// s.
    pub fn value(&self) -> f64 {
        self.field.norm_squared()
    }

    /// ∂s/∂x_i.
    pub fn by_place(&self, i: usize) -> Vector {
        self.field * (-2.0 * self.along[i])
    }

    /// ∂s/∂φ_i.
    pub fn by_potential(&self, i: usize) -> f64 {
        -2.0 * self.along[i] * self.scale
    }

    /// ∂²s/∂x_i∂x_j.
    pub fn by_places(&self, i: usize, j: usize) -> Matrix {
        let (e, [a, b]) = (self.field, [self.gradients[i], self.gradients[j]]);
        let row = e * a.dot(&b) + b * self.along[i];
        (row * e.transpose() + e * (a * self.along[j]).transpose()) * 2.0
    }

    /// ∂²s/∂x_i∂φ_j.
    pub fn by_place_and_potential(&self, i: usize, j: usize) -> Vector {
        let [a, b] = [self.gradients[i], self.gradients[j]];
        (self.field * a.dot(&b) + b * self.along[i]) * (2.0 * self.scale)
    }

    /// ∂²s/∂φ_i∂φ_j.
    pub fn by_potentials(&self, i: usize, j: usize) -> f64 {
        2.0 * self.gradients[i].dot(&self.gradients[j]) * self.scale * self.scale
    }
}
