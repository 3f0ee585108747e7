//! Fields of an element for display: means over its reference volume of deformation, fields and stress.
//!
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

use crate::element::elastomer::Elastomer;
use crate::element::geometry::ElementGeometry;
use crate::element::isochoric::{ElementLaw, IsochoricLaw};
use crate::element::law::{Field, Volume};
use crate::element::viscosity::Viscosity;
use crate::math::{Matrix, Vector};

/// Means over the reference volume of an element, by its Gauss points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fields {
    /// F.
    pub deformation_gradient: Matrix,
    /// J = det F.
    pub jacobian_determinant: f64,
    /// Cauchy stress in MPa, elastic and electric: σ = P Fᵀ/J.
    pub stress: Matrix,
    /// E = −∂φ/∂X in V/mm; zero in a passive elastomer.
    pub reference_electric_field: Vector,
    /// e = −∂φ/∂x = F⁻ᵀE in V/mm.
    pub electric_field: Vector,
    /// True displacement F D/J in N/(V mm), D = −∂Ω/∂E.
    pub electric_displacement: Vector,
}

impl Fields {
    /// Equivalent stress √(3/2 s:s) in MPa of the stress deviator s.
    pub fn von_mises(&self) -> f64 {
        let deviator = self.stress - Matrix::identity() * (self.stress.trace() / 3.0);
        (1.5 * deviator.norm_squared()).sqrt()
    }
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<F: Field, L: ElementLaw> Elastomer<F, L> {
    /// Fields of the element `shape` with nodes at `x` in mm and their potentials in V; add
    /// [`Viscosity::stress`] to the stress of a moving one.
    pub fn fields<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        potentials: &F::Potentials<NODES>,
    ) -> Fields {
        let one = Matrix::identity();
        let [mu, lambda] = self.moduli();
        let electric = self.field.constants(potentials);
        let volume = shape.volume();
        let gradients: [Matrix; 8] = std::array::from_fn(|g| shape.gradient_of(x, g));
        let weighted = gradients.iter().zip(shape.weights());
        let mean: f64 = weighted.map(|(F, w)| w * F.determinant()).sum::<f64>() / volume;
        let mut fields = Fields {
            deformation_gradient: Matrix::zeros(),
            jacobian_determinant: mean,
            stress: Matrix::zeros(),
            reference_electric_field: Vector::zeros(),
            electric_field: Vector::zeros(),
            electric_displacement: Vector::zeros(),
        };
        for (g, (F, w)) in gradients.iter().zip(shape.weights()).enumerate() {
            let w = w / volume;
            let J = F.determinant();
            let pressure = match self.volume {
                Volume::Pointwise => lambda * J.ln() / J,
                Volume::Mean => lambda * mean.ln() / mean,
            };
            let mut stress = (F * F.transpose() - one) * (mu / J) + one * pressure;
            if let Some((law, mu)) = self.isochoric() {
                stress += isochoric_stress(law, mu, F);
            }
            if let Some((k, phi)) = &electric {
                let E: Vector = (0..NODES).map(|i| shape.gradient(i, g) * -phi[i]).sum();
                let e = spatial(F, &E);
                let pushed = F * E;
                let D = E * (-2.0 * k.c1) - F.tr_mul(&pushed) * (2.0 * k.c2);
                stress += pushed * pushed.transpose() * (2.0 * k.c2 / J)
                    + (e * e.transpose() - one * (0.5 * e.norm_squared())) * k.permittivity;
                fields.reference_electric_field += E * w;
                fields.electric_field += e * w;
                fields.electric_displacement += (F * D / J + e * k.permittivity) * w;
            }
            fields.deformation_gradient += F * w;
            fields.stress += stress * w;
        }
        fields
    }
}

/// Cauchy stress of an isochoric law.
#[expect(non_snake_case, reason = "notation of the law")]
fn isochoric_stress(law: IsochoricLaw, mu: f64, F: &Matrix) -> Matrix {
    let (J, b) = (F.determinant(), F * F.transpose());
    let (s, I1) = (J.powf(-2.0 / 3.0), b.trace());
    let deviator = |m: Matrix| m - Matrix::identity() * (m.trace() / 3.0);
    let [_, first, _] = law.of_strain(mu, s * I1 - 3.0);
    let c = law.of_second_invariant(mu).unwrap_or(0.0);
    let of_second = deviator(b * I1 - b * b) * (2.0 * c * s * s / J);
    deviator(b) * (2.0 * first * s / J) + of_second
}

impl Viscosity {
    /// Mean of σ = η d over the reference volume, in MPa.
    pub fn stress<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        v: &[Vector; NODES],
    ) -> Matrix {
        let at = |g: usize| {
            // lᵀ = F⁻ᵀ Ḟᵀ.
            let deformation = shape.gradient_of(x, g);
            let rate = shape.gradient_of(v, g);
            let transposed = inverse(&deformation).transpose() * rate.transpose();
            (transposed + transposed.transpose()) * (0.5 * self.viscosity)
        };
        let weighted = |(g, w): (usize, &f64)| at(g) * *w;
        let sum: Matrix = shape.weights().iter().enumerate().map(weighted).sum();
        sum / shape.volume()
    }
}

impl<const NODES: usize> ElementGeometry<NODES> {
    /// Σ x_i ⊗ G_i at the Gauss point `g`.
    pub fn gradient_of(&self, x: &[Vector; NODES], g: usize) -> Matrix {
        gradient_of(x, &self.gradients_at(g))
    }
}

/// Σ x_i ⊗ G_i.
pub(super) fn gradient_of<const NODES: usize>(
    x: &[Vector; NODES],
    gradients: &[Vector; NODES],
) -> Matrix {
    let both = x.iter().zip(gradients);
    both.map(|(x, gradient)| x * gradient.transpose()).sum()
}

/// F⁻ᵀE.
fn spatial(deformation: &Matrix, field: &Vector) -> Vector {
    inverse(deformation).tr_mul(field)
}

/// F⁻¹; NaN for a singular map.
pub(super) fn inverse(map: &Matrix) -> Matrix {
    let inverse = map.try_inverse();
    inverse.unwrap_or_else(|| Matrix::repeat(f64::NAN))
}

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
