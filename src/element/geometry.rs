//! The trilinear hexahedron in its reference configuration: gradients of the shape functions and weights.

use crate::element::number::{Nine, Points, Three, cofactor, dot, scale_all};
use crate::math::{Matrix, Vector};
use crate::mesh::CORNERS;
use thiserror::Error;

/// 1/√3, the place of the Gauss points; their weights are 1.
const POINT: f64 = 0.577_350_269_189_625_8;

/// N_i = ⅛ (1 ± ξ)(1 ± η)(1 ± ζ) at the Gauss points, `VALUES[i][g]`.
const VALUES: [[f64; 8]; 8] = {
    let mut values = [[0.0; 8]; 8];
    let mut i = 0;
    while i < 8 {
        let mut g = 0;
        while g < 8 {
            values[i][g] = 0.125 * factor(i, g, 0) * factor(i, g, 1) * factor(i, g, 2);
            g += 1;
        }
        i += 1;
    }
    values
};

/// 1 + ξ_i ξ_g in direction `m`.
const fn factor(i: usize, g: usize, m: usize) -> f64 {
    1.0 + CORNERS[i][m] * CORNERS[g][m] * POINT
}

/// ∂N_i/∂ξ_m at the Gauss point `g`.
const fn slope(i: usize, g: usize, m: usize) -> f64 {
    0.125 * CORNERS[i][m] * factor(i, g, (m + 1) % 3) * factor(i, g, (m + 2) % 3)
}

/// A hexahedron that is inverted at a Gauss point.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("a hexahedron has the Jacobian determinant {determinant} at its Gauss point {point}")]
pub struct Inverted {
    /// Number of the Gauss point; it lies towards the node of the same number.
    pub point: usize,
    /// det ∂X/∂ξ there in mm³.
    pub determinant: f64,
}

/// Gradients G_i = ∂N_i/∂X and weights w at the eight Gauss points of an element; of a hexahedron with 2 × 2 × 2 points
/// w = det ∂X/∂ξ.
///
/// Nodes of a hexahedron in the order of VTK: the lower face counter-clockwise seen from above, then the upper face above it.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementGeometry<const NODES: usize = 8> {
    /// `gradients[i][m][g]`: component `m` of G_i at point `g`, in 1/mm.
    gradients: [[[f64; 8]; 3]; NODES],
    /// w in mm³.
    weights: [f64; 8],
}

impl ElementGeometry<8> {
    /// The hexahedron with these nodes, in mm.
    ///
    /// # Errors
    ///
    /// [`Inverted`] where det ∂X/∂ξ is not positive at a Gauss point.
    pub fn new(nodes: &[Vector; 8]) -> Result<Self, Inverted> {
        let mut shape = Self {
            gradients: [[[0.0; 8]; 3]; 8],
            weights: [0.0; 8],
        };
        for g in 0..8 {
            let slopes: [Vector; 8] =
                std::array::from_fn(|i| Vector::from_fn(|m, _| slope(i, g, m)));
            let jacobian: Matrix = nodes
                .iter()
                .zip(&slopes)
                .map(|(x, s)| x * s.transpose())
                .sum();
            let determinant = jacobian.determinant();
            let inverse = jacobian.try_inverse().filter(|_| determinant > 0.0);
            let Some(inverse) = inverse else {
                return Err(Inverted {
                    point: g,
                    determinant,
                });
            };
            shape.weights[g] = determinant;
            for (gradient, slope) in shape.gradients.iter_mut().zip(&slopes) {
                let value = inverse.tr_mul(slope);
                for m in 0..3 {
                    gradient[m][g] = value[m];
                }
            }
        }
        Ok(shape)
    }

    /// Consistent mass ∫ ρ N_i N_j dV in g by the same Gauss points, exact for parallelepipeds; ρ in g/mm³.
    pub fn mass(&self, density: f64) -> [[f64; 8]; 8] {
        let product = |i: usize, j: usize, g: usize| VALUES[i][g] * VALUES[j][g] * self.weights[g];
        std::array::from_fn(|i| {
            std::array::from_fn(|j| density * (0..8).map(|g| product(i, j, g)).sum::<f64>())
        })
    }

    /// ∫ N_i dV in mm³: the share of each node in a body force.
    pub fn loads(&self) -> [f64; 8] {
        VALUES.map(|value| value.iter().zip(&self.weights).map(|(n, w)| n * w).sum())
    }

    /// Gradients of all N_i at the centre of a hexahedron with these nodes; `None` where it is inverted there.
    pub fn central_gradients(nodes: &[Vector; 8]) -> Option<[Vector; 8]> {
        let slopes = CORNERS.map(|corner| Vector::from(corner) * 0.125);
        let both = nodes.iter().zip(&slopes);
        let jacobian: Matrix = both.map(|(x, s)| x * s.transpose()).sum();
        let inverse = jacobian.try_inverse()?;
        let is_right = jacobian.determinant() > 0.0;
        is_right.then(|| slopes.map(|slope| inverse.tr_mul(&slope)))
    }
}

impl<const NODES: usize> ElementGeometry<NODES> {
    /// Reference volume V in mm³.
    pub fn volume(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Gradient of N_i at the Gauss point `g`, in 1/mm.
    pub fn gradient(&self, i: usize, g: usize) -> Vector {
        Vector::from_fn(|m, _| self.gradients[i][m][g])
    }

    /// Gradients of all N_i at the Gauss point `g`, in 1/mm.
    pub fn gradients_at(&self, g: usize) -> [Vector; NODES] {
        std::array::from_fn(|i| self.gradient(i, g))
    }

    /// Gradients, `[i][m][g]`.
    #[inline(always)]
    pub(super) fn gradients(&self) -> &[[[f64; 8]; 3]; NODES] {
        &self.gradients
    }

    /// Weights of the Gauss points, w = det ∂X/∂ξ in mm³.
    #[inline(always)]
    pub fn weights(&self) -> &[f64; 8] {
        &self.weights
    }
}

/// Deformation gradient, its inverse transpose and its determinant, with the weights of the points.
#[expect(non_snake_case, reason = "notation of the law")]
#[derive(Clone, Copy)]
pub(super) struct Kinematics<N: Points> {
    pub(super) w: N::Plain,
    /// F = Σ x_i ⊗ G_i.
    pub(super) F: Nine<N>,
    /// F⁻ᵀ.
    pub(super) T: Nine<N>,
    /// det F, or NaN where it is not positive.
    pub(super) J: N,
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<N: Points> Kinematics<N> {
    #[inline(always)]
    pub(super) fn new<const NODES: usize>(
        token: N::Token,
        shape: &ElementGeometry<NODES>,
        x: &[Three<N::Uniform>; NODES],
    ) -> Self {
        let F = gradient_of::<N, NODES>(token, shape, x);
        let H = cofactor(&F);
        let J = dot(F[0], H[0]).positive();
        let inverse = J.recip();
        Self {
            w: N::load(token, shape.weights()),
            F,
            T: scale_all(&H, inverse),
            J,
        }
    }
}

/// Σ x_i ⊗ G_i.
#[inline(always)]
pub(super) fn gradient_of<N: Points, const NODES: usize>(
    token: N::Token,
    shape: &ElementGeometry<NODES>,
    x: &[Three<N::Uniform>; NODES],
) -> Nine<N> {
    let mut sum = [[N::constant(token, 0.0); 3]; 3];
    for (x, gradient) in x.iter().zip(shape.gradients()) {
        let gradient = load::<N>(token, gradient);
        for a in 0..3 {
            let x = N::splat(token, x[a]);
            for m in 0..3 {
                sum[a][m] = sum[a][m].plus_times(x, gradient[m]);
            }
        }
    }
    sum
}

/// A gradient G_i at the Gauss points.
#[inline(always)]
pub(super) fn load<N: Points>(token: N::Token, gradient: &[[f64; 8]; 3]) -> Three<N::Plain> {
    [
        N::load(token, &gradient[0]),
        N::load(token, &gradient[1]),
        N::load(token, &gradient[2]),
    ]
}

/// −Σ φ_i G_i.
#[inline(always)]
pub(super) fn minus_gradient_of<N: Points, const NODES: usize>(
    token: N::Token,
    shape: &ElementGeometry<NODES>,
    phi: &[N::Uniform; NODES],
) -> Three<N> {
    let mut sum = [N::constant(token, 0.0); 3];
    for (phi, gradient) in phi.iter().zip(shape.gradients()) {
        let minus_phi = N::splat(token, -*phi);
        let gradient = load::<N>(token, gradient);
        for m in 0..3 {
            sum[m] = sum[m].plus_times(minus_phi, gradient[m]);
        }
    }
    sum
}
