//! Fields of a hexahedron for display: means over its reference volume of deformation, fields and stress.

use super::elastomer::Elastomer;
use super::geometry::ElementGeometry;
use super::isochoric::{ElementLaw, IsochoricLaw};
use super::law::{Field, Volume};
use super::viscosity::Viscosity;
use crate::math::{Matrix, Vector};

/// Means over the reference volume of a hexahedron, by its Gauss points.
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
    /// Fields of the hexahedron `shape` with nodes at `x` in mm and their potentials in V; add
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
            if let Some(law) = self.isochoric() {
                stress += isochoric_stress(law, F);
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
fn isochoric_stress((law, mu): (IsochoricLaw, f64), F: &Matrix) -> Matrix {
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
