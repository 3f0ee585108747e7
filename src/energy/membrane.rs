//! An incompressible membrane in plane stress at a point, through which a voltage lies.
//!
//! With the tangents f₁, f₂ of orthonormal directions of the membrane without stress, C_αβ = f_α·f_β, I = C₁₁ + C₂₂ and D = det C, which is
//! the square of the area, the stretch across is `λ₃ = 1/√D`, so that
//!
//! ```text
//! I₁ = I + 1/D,    I₂ = D + I/D,    field V/(H λ₃) = √D V/H.
//! ```

use crate::energy::dot_products::{OfDotProducts, Product};
use crate::energy::{Elasticity, Energy, NeoHooke, OfPlane, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// I and D of tangents that begin at two places among the arguments.
fn plane<const M: usize, const ORDER: usize, T: Number>(
    p: &SVector<T, M>,
    w: &SVector<T, M>,
) -> [Jet<M, ORDER, T>; 2] {
    let [c11, c12, c22] = [(0, 0), (0, 3), (3, 3)].map(|(a, b)| Jet::dot(a, b, p, w));
    [c11 + c22, c11 * c22 - c12.squared()]
}

/// Elastic energy of a part of a membrane; arguments: tangents f₁, f₂.
#[derive(Clone, Copy, Debug)]
pub struct ElasticMembrane<L = NeoHooke, T = f64> {
    /// Volume in mm³.
    pub volume: T,
    /// Shear modulus μ of small strains in MPa.
    pub shear_modulus: T,
    /// Law of elasticity.
    pub law: L,
}

law!(ElasticMembrane<L> { volume, shear_modulus, law } of 6);

impl<L: Elasticity<T>, T: Number> ElasticMembrane<L, T> {
    fn energy<const ORDER: usize>(&self, [i, d]: [OfPlane<ORDER, T>; 2]) -> OfPlane<ORDER, T> {
        self.law.of_plane(self.shear_modulus, i, d) * self.volume
    }
}

impl<L: Elasticity<T>, T: Number> Energy<6, T> for ElasticMembrane<L, T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        Jet::compose(plane(p, w), |of| self.energy(of))
    }
}

/// Electric energy `V₀ (c₁ + c₂/D − ε D/2) (V/H)²` of a part of a membrane; arguments: tangents f₁, f₂ and the voltage V. The charge on its electrodes is
/// −∂W/∂V.
#[derive(Clone, Copy, Debug)]
pub struct DielectricMembrane<T = f64> {
    /// Volume V₀ in mm³.
    pub volume: T,
    /// c₁ in N/V².
    pub c1: T,
    /// c₂ in N/V².
    pub c2: T,
    /// ε in N/V².
    pub permittivity: T,
    /// Thickness H without stress in mm, by the factor of the scalar argument that is the voltage.
    pub thickness: T,
}

law!(DielectricMembrane { volume, c1, c2, permittivity, thickness } of 7);

impl<T: Number> DielectricMembrane<T> {
    /// The energy for one volt.
    fn of_unit<const ORDER: usize>(&self, d: OfPlane<ORDER, T>) -> OfPlane<ORDER, T> {
        let by_area = d.recip() * self.c2 - d * self.permittivity.scaled(0.5);
        (by_area + self.c1) * self.volume.over(self.thickness * self.thickness)
    }
}

impl<T: Number> Energy<7, T> for DielectricMembrane<T> {
    type Local<const ORDER: usize> = Jet<7, ORDER, T>;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 7>, w: &SVector<T, 7>) -> Jet<7, ORDER, T> {
        let unit = Jet::compose(plane(p, w), |[_, d]| self.of_unit(d));
        unit * Jet::argument(6, p, w).squared()
    }
}

/// The same energy under a voltage of one volt; arguments: tangents f₁, f₂.
#[derive(Clone, Copy, Debug)]
pub struct ChargedMembrane<T = f64> {
    /// The membrane, whose thickness is divided by the voltage.
    pub of: DielectricMembrane<T>,
}

law!(ChargedMembrane { of } of 6);

impl<T: Number> Energy<6, T> for ChargedMembrane<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        Jet::compose(plane(p, w), |[_, d]| self.of.of_unit(d))
    }
}

/// Energy `V₀ μ₁/2 (C:A + A₃₃/D − 3)` of the spring of a Maxwell branch; arguments: tangents f₁, f₂, then (z₁, z₂, ·) and (a, ·, ·) of the viscous strain.
///
/// A = C_i⁻¹ is UᵀDU with D = diag(e^z₁, e^z₂), U = (1, a; 0, 1), and A₃₃ = e^(−z₁−z₂): the strains of a
/// [`MaxwellDamper`](crate::energy::MaxwellDamper) with b = c = 0.
#[derive(Clone, Copy, Debug)]
pub struct MaxwellMembrane<T = f64> {
    /// Volume in mm³.
    pub volume: T,
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: T,
}

law!(MaxwellMembrane { volume, shear_modulus } of 12);

impl<T: Number> Energy<12, T> for MaxwellMembrane<T> {
    type Local<const ORDER: usize> = Jet<12, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 12>, w: &SVector<T, 12>) -> Jet<12, ORDER, T> {
        let inner = [
            Jet::dot(0, 0, p, w),
            Jet::dot(0, 3, p, w),
            Jet::dot(3, 3, p, w),
            Jet::argument(6, p, w),
            Jet::argument(7, p, w),
            Jet::argument(9, p, w),
        ];
        Jet::compose(inner, |[c11, c12, c22, z1, z2, a]| {
            let exp = |z: Jet<6, ORDER, T>| z.map([z.value.exp(); 4]);
            let across = exp(-(z1 + z2)) * (c11 * c22 - c12.squared()).recip();
            let first = c11 + a * c12.scaled(2.0) + a.squared() * c22;
            let strain = exp(z1) * first + exp(z2) * c22 + across;
            strain.shifted(-3.0) * self.shear_modulus.scaled(0.5) * self.volume
        })
    }
}

/// Virtual work `−η V₀ d:δd` of σ = η d; arguments: δf₁, δf₂, then midpoints, then rates.
///
/// `4 d:δd = tr(C⁻¹Ċ C⁻¹δC) + Ḋ δD/D²`, where the second part is that across. With T = C⁻¹Ċ C⁻¹ + (tr C⁻¹Ċ) C⁻¹ it is T:δC.
#[derive(Clone, Copy, Debug)]
pub struct ViscousMembrane {
    /// η V₀ in N mm ms.
    pub coefficient: f64,
}

/// δC₁₁/2, δC₁₂ and δC₂₂/2 by the vectors δf₁, δf₂, f₁, f₂, ḟ₁, ḟ₂.
const CHANGES: [Product<'static>; 3] = [&[[0, 2]], &[[0, 3], [1, 2]], &[[1, 3]]];
/// C₁₁/2, C₁₂, C₂₂/2, and their rates.
const METRIC: [Product<'static>; 6] = [
    &[[2, 2]],
    &[[2, 3]],
    &[[3, 3]],
    &[[4, 2]],
    &[[4, 3], [5, 2]],
    &[[5, 3]],
];

impl Energy<18> for ViscousMembrane {
    type Local<const ORDER: usize> = OfDotProducts<6>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 2;

    fn couples(i: usize, j: usize) -> bool {
        // It is linear in the rates, too.
        i / 2 != j / 2 || i / 2 == 1
    }

    fn at<const ORDER: usize>(
        &self,
        p: &SVector<f64, 18>,
        _: &SVector<f64, 18>,
    ) -> OfDotProducts<6> {
        let mut work = OfDotProducts::new(std::array::from_fn(|v| {
            p.fixed_rows::<3>(3 * v).into_owned()
        }));
        work.add(
            CHANGES,
            METRIC,
            |[half11, c12, half22, rate11, r12, rate22]| {
                let [c11, c22, r11, r22] =
                    [half11, half22, rate11, rate22].map(|half| half.scaled(2.0));
                let d = c11 * c22 - c12.squared();
                // adj(C) Ċ adj(C) and the change of D.
                let [x11, x12] = [c22 * r11 - c12 * r12, c22 * r12 - c12 * r22];
                let [x21, x22] = [c11 * r12 - c12 * r11, c11 * r22 - c12 * r12];
                let change = x11 + x22;
                let scale = d.squared().recip() * (-0.25 * self.coefficient);
                let t11 = x11 * c22 - x12 * c12 + change * c22;
                let t12 = x12 * c11 - x11 * c12 - change * c12;
                let t22 = x22 * c11 - x21 * c12 + change * c11;
                // Products of the diagonal are halves, and the shear is there twice.
                [t11, t12, t22].map(|t| t * scale * 2.0)
            },
        );
        work
    }
}
