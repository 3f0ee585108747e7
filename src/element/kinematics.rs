//! Deformation at the Gauss points.

use super::algebra::{Nine, Three, cofactor, dot, scale_all};
use super::geometry::ElementGeometry;
use super::number::Points;

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
