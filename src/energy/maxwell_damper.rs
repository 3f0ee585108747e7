//! Damper of a Maxwell branch at a point of a finite element: derivatives by thirteen numbers.

use crate::energy::{Energy, WithDerivatives, law};
use crate::math::{Derivatives, Jet, Matrix, Number, Vector};
use nalgebra::SVector;

/// Virtual work of the damper of a Maxwell branch at a point, `−½ c tr(A⁻¹Ȧ A⁻¹δA)` of A = C_i⁻¹ with the viscous strain C_i.
///
/// A = UᵀDU has the coordinates z₁, z₂ with D = diag(e^z₁, e^z₂, e^(−z₁−z₂)), and a, b, c of the unit upper triangle
/// U = (1, a, b; 0, 1, c; 0, 0, 1). With N = U̇U⁻¹ = (0, ȧ, ḃ − cȧ; 0, 0, ċ; 0, 0, 0) it is
/// `−c [½ Σ ż_k δz_k + Σ_{i<j} D_i/D_j N_ij δN_ij]`, z₃ = −z₁ − z₂. Arguments: δ(z₁, z₂, ·), δ(a, b, c), then midpoints, then rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellDamper {
    /// c = τ μ₁ V of the volume V of the point in mJ ms.
    pub coefficient: f64,
}

/// Number of the arguments that count: a and b do not.
const COUNT: usize = 13;
// Places among them of δz, δ(a, b, c), z, c, ż and the rates of (a, b, c).
const VIRTUAL_Z: usize = 0;
const VIRTUAL_U: usize = 2;
const Z: usize = 5;
const C: usize = 7;
const RATE_Z: usize = 8;
const RATE_U: usize = 10;

/// Gradient and Hessian by the arguments that count.
#[derive(Clone, Copy, Debug)]
pub struct DamperDerivatives {
    value: f64,
    gradient: [f64; COUNT],
    hessian: [[f64; COUNT]; COUNT],
}

/// N_ij of a rate: its value, its derivatives by some arguments, and that by c and the rate of a.
#[derive(Clone, Copy)]
struct Shear {
    value: f64,
    slopes: [(usize, f64); 3],
    curvature: Option<usize>,
}

impl Shear {
    /// N₁₂, N₂₃, N₁₃ of rates of (a, b, c) from a place on.
    fn all(rates: [f64; 3], first: usize, c: f64) -> [Self; 3] {
        let [a, b, c_rate] = rates;
        let alone = |value, place| Self {
            value,
            slopes: [(place, 1.0), (place, 0.0), (place, 0.0)],
            curvature: None,
        };
        let last = Self {
            value: b - c * a,
            slopes: [(first + 1, 1.0), (first, -c), (C, -a)],
            curvature: Some(first),
        };
        [alone(a, first), alone(c_rate, first + 2), last]
    }
}

impl DamperDerivatives {
    /// Adds a symmetric pair of entries, or twice the entry of a diagonal.
    fn pair(&mut self, i: usize, j: usize, value: f64) {
        self.hessian[i][j] += value;
        self.hessian[j][i] += value;
    }

    /// Adds ½ c (ż₁ δz₁ + ż₂ δz₂ + ż₃ δz₃).
    fn add_stretches(&mut self, coefficient: f64, virtual_z: [f64; 2], rate: [f64; 2]) {
        for (i, virtual_z) in virtual_z.into_iter().enumerate() {
            for (j, rate) in rate.into_iter().enumerate() {
                let factor = if i == j {
                    coefficient
                } else {
                    0.5 * coefficient
                };
                self.value += factor * virtual_z * rate;
                self.gradient[VIRTUAL_Z + i] += factor * rate;
                self.gradient[RATE_Z + j] += factor * virtual_z;
                self.pair(VIRTUAL_Z + i, RATE_Z + j, factor);
            }
        }
    }

    /// Adds e N δN with e = c D_i/D_j, whose logarithm has the derivatives ω by z.
    fn add_shear(&mut self, e: f64, omega: [f64; 2], [n, m]: [&Shear; 2]) {
        let product = e * n.value * m.value;
        self.value += product;
        for i in 0..2 {
            self.gradient[Z + i] += omega[i] * product;
            for j in 0..2 {
                self.hessian[Z + i][Z + j] += omega[i] * omega[j] * product;
            }
        }
        for (one, other) in [(n, m), (m, n)] {
            for (place, slope) in one.slopes {
                let slope = e * other.value * slope;
                self.gradient[place] += slope;
                for (i, omega) in omega.iter().enumerate() {
                    self.pair(Z + i, place, omega * slope);
                }
            }
            if let Some(place) = one.curvature {
                self.pair(C, place, -e * other.value);
            }
        }
        for (row, slope) in n.slopes {
            for (column, other) in m.slopes {
                self.pair(row, column, e * slope * other);
            }
        }
    }
}

impl Energy<18> for MaxwellDamper {
    type Local<const ORDER: usize> = DamperDerivatives;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 2;

    /// It is linear in the rates.
    fn couples(i: usize, j: usize) -> bool {
        i / 2 != j / 2 || i / 2 == 1
    }

    fn at<const ORDER: usize>(
        &self,
        p: &SVector<f64, 18>,
        _: &SVector<f64, 18>,
    ) -> DamperDerivatives {
        let mut all = DamperDerivatives {
            value: 0.0,
            gradient: [0.0; COUNT],
            hessian: [[0.0; COUNT]; COUNT],
        };
        let (z1, z2, c) = (p[6], p[7], p[11]);
        all.add_stretches(-self.coefficient, [p[0], p[1]], [p[12], p[13]]);
        let rates = Shear::all([p[15], p[16], p[17]], RATE_U, c);
        let virtuals = Shear::all([p[3], p[4], p[5]], VIRTUAL_U, c);
        let omegas = [[1.0, -1.0], [1.0, 2.0], [2.0, 1.0]];
        for ((rate, virtual_rate), omega) in rates.iter().zip(&virtuals).zip(omegas) {
            let ratio = (omega[0] * z1 + omega[1] * z2).exp();
            all.add_shear(-self.coefficient * ratio, omega, [rate, virtual_rate]);
        }
        all
    }
}

/// Place of a component of a vector among the arguments that count.
#[inline(always)]
fn place(vector: usize, component: usize) -> Option<usize> {
    match (vector, component) {
        (0 | 2 | 4, 2) | (3, 0 | 1) => None,
        (0, _) => Some(VIRTUAL_Z + component),
        (1, _) => Some(VIRTUAL_U + component),
        (2, _) => Some(Z + component),
        (3, _) => Some(C),
        (4, _) => Some(RATE_Z + component),
        _ => Some(RATE_U + component),
    }
}

impl WithDerivatives for DamperDerivatives {
    #[inline(always)]
    fn scalar(&self) -> f64 {
        self.value
    }
}

impl Derivatives for DamperDerivatives {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        Vector::from_fn(|a, _| place(i, a).map_or(0.0, |row| self.gradient[row]))
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        Matrix::from_fn(|a, b| match (place(i, a), place(j, b)) {
            (Some(row), Some(column)) => self.hessian[row][column],
            _ => 0.0,
        })
    }
}

/// Elastic energy `V₀ μ₁/2 (Λₑ² + 2/Λₑ − 3)` of the elastic stretch `Λₑ = Λ e^(−z)`, arguments: span r with Λ = |r|/L₀, and the logarithm z of
/// the viscous stretch in the first component of a vector. Not finite for r = 0.
///
/// With the damper 3 τ μ₁ V₀ of z it is the branch `ċ = (Λ² − c/3 (Λ²/c + 2√c/Λ))/τ` of c = e^(2z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellCell<T = f64> {
    /// Rest length L₀ in mm.
    pub length: T,
    /// Rest volume V₀ in mm³.
    pub volume: T,
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: T,
}

law!(MaxwellCell { length, volume, shear_modulus } of 6);

impl<T: Number> Energy<6, T> for MaxwellCell<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let squared = Jet::dot(0, 0, p, w) * (self.length * self.length).recip();
        let (viscous, e) = (Jet::argument(3, p, w), p[3].exp());
        let f = (e * e).recip();
        let by_viscous = [f, f.scaled(-2.0), f.scaled(4.0), f.scaled(-8.0)];
        let elastic = squared * viscous.map(by_viscous);
        let rest = (squared.sqrt().recip() * viscous.map([e; 4])).scaled(2.0);
        let strain = (elastic + rest).shifted(-3.0);
        strain * (self.shear_modulus.scaled(0.5) * self.volume)
    }
}
