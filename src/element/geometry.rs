//! An element in its reference configuration: gradients of the shape functions, weights and masses.

use crate::element::number::{Nine, Points, Three, cofactor, dot, scale_all};
use crate::math::{Matrix, Vector};
use crate::mesh::interpolation::{Element, Interpolation, Parent};
use thiserror::Error;

/// An element that is inverted at a Gauss point.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error("an element has the Jacobian determinant {determinant} at its Gauss point {point}")]
pub struct Inverted {
    /// Number of the Gauss point; in a hexahedron it lies towards the node of the same number.
    pub point: usize,
    /// det ∂X/∂ξ there in mm³.
    pub determinant: f64,
}

/// Gradients G_i = ∂N_i/∂X at the eight Gauss points of an element, and det ∂X/∂ξ times the weights of the points.
///
/// Nodes are in the order of VTK, as those of a [`Mesh`](crate::mesh::Mesh).
#[derive(Clone, Debug, PartialEq)]
pub struct ElementGeometry<const NODES: usize = 8> {
    /// `gradients[i][m][g]`: component `m` of G_i at point `g`, in 1/mm.
    gradients: [[[f64; 8]; 3]; NODES],
    /// w in mm³.
    weights: [f64; 8],
}

/// ∂X/∂ξ with nodes at X, and its determinant.
fn jacobian<const NODES: usize>(
    nodes: &[Vector; NODES],
    slopes: &[Vector; NODES],
) -> (Matrix, f64) {
    let both = nodes.iter().zip(slopes);
    let jacobian: Matrix = both.map(|(x, s)| x * s.transpose()).sum();
    (jacobian, jacobian.determinant())
}

impl<const NODES: usize> ElementGeometry<NODES>
where
    Parent<NODES>: Element<NODES>,
{
    /// The element with these nodes, in mm.
    ///
    /// # Errors
    ///
    /// [`Inverted`] where det ∂X/∂ξ is not positive at a Gauss point.
    pub fn new(nodes: &[Vector; NODES]) -> Result<Self, Inverted> {
        let mut shape = Self {
            gradients: [[[0.0; 8]; 3]; NODES],
            weights: [0.0; 8],
        };
        for (g, (at, weight)) in Parent::<NODES>::POINTS.iter().enumerate() {
            let slopes = Parent::<NODES>::slopes(at).map(Vector::from);
            let (jacobian, determinant) = jacobian(nodes, &slopes);
            let inverse = jacobian.try_inverse().filter(|_| determinant > 0.0);
            let Some(inverse) = inverse else {
                return Err(Inverted {
                    point: g,
                    determinant,
                });
            };
            shape.weights[g] = determinant * weight;
            for (gradient, slope) in shape.gradients.iter_mut().zip(&slopes) {
                let value = inverse.tr_mul(slope);
                for m in 0..3 {
                    gradient[m][g] = value[m];
                }
            }
        }
        Ok(shape)
    }

    /// Shape functions and weights in mm³ at the points by which masses and loads are integrated.
    fn integrated(nodes: &[Vector; NODES]) -> Vec<([f64; NODES], f64)> {
        let point = |(at, weight): ([f64; 3], f64)| {
            let slopes = Parent::<NODES>::slopes(&at).map(Vector::from);
            let (_, determinant) = jacobian(nodes, &slopes);
            (Parent::<NODES>::values(&at), determinant * weight)
        };
        Parent::<NODES>::quadrature()
            .into_iter()
            .map(point)
            .collect()
    }

    /// Consistent mass ∫ ρ N_i N_j dV in g of the element with these nodes; ρ in g/mm³. That of a hexahedron is exact for parallelepipeds.
    pub fn mass(nodes: &[Vector; NODES], density: f64) -> [[f64; NODES]; NODES] {
        let points = Self::integrated(nodes);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let product = |(n, w): &([f64; NODES], f64)| n[i] * n[j] * w;
                density * points.iter().map(product).sum::<f64>()
            })
        })
    }

    /// ∫ N_i dV in mm³ of the element with these nodes: the share of each node in a body force.
    pub fn loads(nodes: &[Vector; NODES]) -> [f64; NODES] {
        let points = Self::integrated(nodes);
        std::array::from_fn(|i| points.iter().map(|(n, w)| n[i] * w).sum())
    }

    /// Gradients of all N_i at the centre of an element with these nodes; `None` where it is inverted there.
    pub fn central_gradients(nodes: &[Vector; NODES]) -> Option<[Vector; NODES]> {
        let slopes = Parent::<NODES>::slopes(&Parent::<NODES>::CENTRE).map(Vector::from);
        let (jacobian, determinant) = jacobian(nodes, &slopes);
        let inverse = jacobian.try_inverse()?;
        (determinant > 0.0).then(|| slopes.map(|slope| inverse.tr_mul(&slope)))
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

    /// Weights of the Gauss points in mm³.
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
