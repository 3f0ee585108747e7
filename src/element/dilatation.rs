//! Derivatives of the volume of an element whose volumetric energy is that of its mean dilatation.
//!
//! With the volume v = V J̄ = Σ w J, the second derivatives of V λ/2 ln²J̄ are
//!
//! ```text
//! k ∂v/∂x_i ⊗ ∂v/∂x_j + p ∂²v/∂x_i∂x_j,      k = λ (1 − ln J̄)/(J̄² V),      p = λ ln J̄/J̄,
//! ∂v/∂x_i = Σ w cof(F) G_i,                   ∂²v/∂x_i∂x_j = −[Σ w F (G_i × G_j)]×.
//! ```

use super::elastomer::Elastomer;
use super::fields::gradient_of;
use super::geometry::ElementGeometry;
use super::isochoric::ElementLaw;
use super::law::{Field, Volume};
use crate::math::{Matrix, Vector};

/// The volume of an element, and how the element resists its change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dilatation<const NODES: usize = 8> {
    /// ∂v/∂x_i in mm².
    pub slopes: [Vector; NODES],
    /// k in mJ/mm⁶.
    pub stiffness: f64,
    /// p in MPa.
    pub pressure: f64,
    /// Shear modulus μ in MPa.
    pub shear_modulus: f64,
}

impl<F: Field, L: ElementLaw> Elastomer<F, L> {
    /// The volume of an element with nodes at `x` in mm; `None` where the volumetric energy is that of the points.
    pub fn dilatation<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
    ) -> Option<Dilatation<NODES>> {
        if self.volume == Volume::Pointwise {
            return None;
        }
        let (mut slopes, mut volume) = ([Vector::zeros(); NODES], 0.0);
        for (g, w) in shape.weights().iter().enumerate() {
            let gradients = shape.gradients_at(g);
            let of_point = gradient_of(x, &gradients);
            let [a, b, c] = [0, 1, 2].map(|m| of_point.column(m).into_owned());
            let cofactor = Matrix::from_columns(&[b.cross(&c), c.cross(&a), a.cross(&b)]);
            volume += w * a.dot(&b.cross(&c));
            for (slope, gradient) in slopes.iter_mut().zip(&gradients) {
                *slope += cofactor * gradient * *w;
            }
        }
        let (before, [_, lambda]) = (shape.volume(), self.moduli());
        let mean = volume / before;
        Some(Dilatation {
            slopes,
            stiffness: lambda * (1.0 - mean.ln()) / (mean * mean * before),
            pressure: lambda * mean.ln() / mean,
            shear_modulus: self.shear_modulus,
        })
    }
}

/// ∂²v/∂x_i∂x_j in mm of an element with nodes at `x` in mm.
pub fn second_derivatives_of_volume<const NODES: usize>(
    shape: &ElementGeometry<NODES>,
    x: &[Vector; NODES],
) -> [[Matrix; NODES]; NODES] {
    let mut axial = [[Vector::zeros(); NODES]; NODES];
    for (g, w) in shape.weights().iter().enumerate() {
        let gradients = shape.gradients_at(g);
        let of_point = gradient_of(x, &gradients) * *w;
        for i in 0..NODES {
            for j in 0..i {
                axial[i][j] += of_point * gradients[i].cross(&gradients[j]);
            }
        }
    }
    std::array::from_fn(|i| {
        std::array::from_fn(|j| match i > j {
            true => -axial[i][j].cross_matrix(),
            false => axial[j][i].cross_matrix(),
        })
    })
}
