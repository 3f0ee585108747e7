//! The spring of a Maxwell branch of an element: its energy, gradient and tangent, over any number, and viscous strains that have relaxed.
//!
//! A = C_i⁻¹ is the inverse of the viscous strain, det A = 1, by five coordinates q = (z₁, z₂, a, b, c) of each Gauss point,
//!
//! ```text
//! A = Σ_k D_k u_k⊗u_k,    D = (e^z₁, e^z₂, e^(−z₁−z₂)),    u₁ = (1, a, b),  u₂ = (0, 1, c),  u₃ = (0, 0, 1).
//! ```
//!
//! With g_i = F⁻ᵀG_i, p_k = F u_k, r_i = F A G_i, θ = C:A = Σ D_k |p_k|² and s = w μ₁ J^(−2/3), and q_m, q_n for coordinates,
//!
//! ```text
//! W = Σ ½ (s θ − 3 w μ₁)
//! ∂W/∂x_i = Σ s (r_i − ⅓ θ g_i)                             ∂W/∂q_m = ½ s ∂θ/∂q_m
//! ∂²W/∂x_i∂x_j = Σ s { (G_i·A G_j) 1 − ⅔ (r_i⊗g_j + g_i⊗r_j) + θ (2/9 g_i⊗g_j + ⅓ g_j⊗g_i) }
//! ∂²W/∂x_i∂q_m = s { ∂r_i/∂q_m − ⅓ ∂θ/∂q_m g_i }            ∂²W/∂q_m∂q_n = ½ s ∂²θ/∂q_m∂q_n.
//! ```

use super::evaluation::{ElementEnergy, NodeState};
use super::geometry::{ElementGeometry, Kinematics, load};
use super::local::{BranchLocal, COORDINATES, Output};
use super::number::{Nine, Points, Three, apply, apply_plain, dot, scale, sums, transpose};
use crate::math::{Matrix, Vector};

/// Coordinates (z₁, z₂, a, b, c) of the viscous strain at the Gauss points, `[coordinate][point]`.
///
/// C_i⁻¹ = UᵀDU with D = diag(e^z₁, e^z₂, e^(−z₁−z₂)) and the unit upper triangle U = (1, a, b; 0, 1, c; 0, 0, 1): every symmetric
/// positive matrix of determinant one has exactly one such list; zeros are C_i = 1.
pub type ViscousStrains = [[f64; 8]; COORDINATES];

/// The spring of a Maxwell branch: the isochoric neo-Hookean energy μ₁/2 (J^(−2/3) C:C_i⁻¹ − 3) of a reference volume with the viscous
/// strain C_i.
///
/// NaN where J ≤ 0 at a Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellSpring {
    /// Shear modulus μ₁ in MPa.
    pub shear_modulus: f64,
}

impl MaxwellSpring {
    /// Cauchy stress `μ₁/J^(5/3) (F A Fᵀ − ⅓ C:A 1)` in MPa with A = C_i⁻¹, its mean over the reference volume.
    #[expect(non_snake_case, reason = "notation of the law")]
    pub fn stress<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        strains: &ViscousStrains,
    ) -> Matrix {
        let at = |(g, weight): (usize, &f64)| {
            let [z1, z2, a, b, c] = strains.map(|strain| strain[g]);
            let F = shape.gradient_of(x, g);
            let root = Vector::new(z1, z2, -z1 - z2).map(|z| (0.5 * z).exp());
            let U = Matrix::new(1.0, a, b, 0.0, 1.0, c, 0.0, 0.0, 1.0);
            let pushed = F * U.transpose() * Matrix::from_diagonal(&root);
            let left = pushed * pushed.transpose();
            let deviator = left - Matrix::identity() * (left.trace() / 3.0);
            deviator * (weight * self.shear_modulus * F.determinant().powf(-5.0 / 3.0))
        };
        let weights = shape.weights().iter().enumerate();
        weights.map(at).sum::<Matrix>() / shape.volume()
    }
}

impl<const NODES: usize> ElementEnergy<NODES> for MaxwellSpring {
    type Arguments = ViscousStrains;
    type Local = BranchLocal<NODES>;

    #[inline(always)]
    fn write<N: Points, const ORDER: usize>(
        &self,
        token: N::Token,
        at: &NodeState<'_, ViscousStrains, NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let [strains, rates] = at.arguments;
        let mut q = [N::constant(token, 0.0); COORDINATES];
        for m in 0..COORDINATES {
            q[m] = N::moving(token, &strains[m], &rates[m]);
        }
        let x = at.places::<N>();
        Branch::write::<ORDER, NODES>(token, self.shear_modulus, at.shape, &x, q, out);
    }
}

/// Coordinates of the viscous strain to which a branch relaxes at a deformation gradient F, C_i = C/J^(2/3); NaN for J ≤ 0.
#[expect(non_snake_case, reason = "notation of the law")]
pub fn relaxed(F: &Matrix) -> [f64; COORDINATES] {
    let C = F.tr_mul(F);
    // C⁻¹ = UᵀDU, so that C = U⁻¹D⁻¹U⁻ᵀ: columns are eliminated from the last one on.
    let d3 = C[(2, 2)];
    let (i13, i23) = (C[(0, 2)] / d3, C[(1, 2)] / d3);
    let d2 = C[(1, 1)] - i23 * i23 * d3;
    let i12 = (C[(0, 1)] - i13 * i23 * d3) / d2;
    let d1 = C[(0, 0)] - i12 * i12 * d2 - i13 * i13 * d3;
    let mean = (2.0 / 3.0) * F.determinant().ln();
    // U of its inverse (1, i12, i13; 0, 1, i23; 0, 0, 1).
    [mean - d1.ln(), mean - d2.ln(), -i12, i12 * i23 - i13, -i23]
}

/// Quantities at the Gauss points that energy, gradient and tangent share.
#[expect(non_snake_case, reason = "notation of the law")]
pub(super) struct Branch<N: Points> {
    token: N::Token,
    /// w μ₁.
    w_mu: N,
    /// s.
    s: N,
    /// F⁻ᵀ.
    T: Nine<N>,
    /// Columns of F.
    f: [Three<N>; 3],
    /// D_k p_k.
    scaled: [Three<N>; 3],
    D: [N; 3],
    /// D_k |p_k|².
    parts: [N; 3],
    theta: N,
    /// a, b, c.
    u: [N; 3],
}

/// Vectors of a node.
#[derive(Clone, Copy)]
struct Node<N> {
    g: Three<N>,
    r: Three<N>,
    /// u_k·G_i.
    along: [N; 3],
}

#[expect(non_snake_case, reason = "notation of the law")]
impl<N: Points> Branch<N> {
    /// Writes the energy; its gradient if `ORDER` ≥ 1; its tangent if `ORDER` ≥ 2.
    #[inline(always)]
    pub(super) fn write<const ORDER: usize, const NODES: usize>(
        token: N::Token,
        mu: f64,
        shape: &ElementGeometry<NODES>,
        x: &[Three<N::Uniform>; NODES],
        q: [N; COORDINATES],
        out: &mut impl Output<N::Uniform>,
    ) {
        let branch = Self::new(token, mu, shape, x, q);
        let density = (branch.s * branch.theta) - branch.w_mu.scaled(3.0);
        out.energy(density.scaled(0.5).sum());
        if ORDER >= 1 {
            branch.gradient(shape, out);
        }
        if ORDER >= 2 {
            branch.tangent(shape, out);
        }
    }

    #[inline(always)]
    fn new<const NODES: usize>(
        token: N::Token,
        mu: f64,
        shape: &ElementGeometry<NODES>,
        x: &[Three<N::Uniform>; NODES],
        [z1, z2, a, b, c]: [N; COORDINATES],
    ) -> Self {
        let Kinematics { w, F, T, J } = Kinematics::<N>::new(token, shape, x);
        let w_mu = N::constant(token, mu).times(w);
        let D = [z1.exp(), z2.exp(), (-(z1 + z2)).exp()];
        let f = transpose(&F);
        let mut p = f;
        for i in 0..3 {
            p[0][i] = f[0][i].plus_product(a, f[1][i]).plus_product(b, f[2][i]);
            p[1][i] = f[1][i].plus_product(c, f[2][i]);
        }
        let scaled = [scale(p[0], D[0]), scale(p[1], D[1]), scale(p[2], D[2])];
        let parts = [
            dot(scaled[0], p[0]),
            dot(scaled[1], p[1]),
            dot(scaled[2], p[2]),
        ];
        Self {
            token,
            w_mu,
            s: J.ln().scaled(-2.0 / 3.0).exp() * w_mu,
            T,
            f,
            scaled,
            D,
            parts,
            theta: parts[0] + parts[1] + parts[2],
            u: [a, b, c],
        }
    }

    /// ∂θ/∂q.
    #[inline(always)]
    fn slopes(&self) -> [N; COORDINATES] {
        let [first, second, third] = self.parts;
        let [one, two, _] = self.scaled;
        [
            first - third,
            second - third,
            dot(one, self.f[1]).scaled(2.0),
            dot(one, self.f[2]).scaled(2.0),
            dot(two, self.f[2]).scaled(2.0),
        ]
    }

    #[inline(always)]
    fn node(&self, gradient: &[[f64; 8]; 3]) -> Node<N> {
        let G = load::<N>(self.token, gradient);
        let zero = N::constant(self.token, 0.0);
        let [x, y, z] = [
            zero.plus_plain(G[0]),
            zero.plus_plain(G[1]),
            zero.plus_plain(G[2]),
        ];
        let [a, b, c] = self.u;
        let along = [
            x.plus_product(a, y).plus_product(b, z),
            y.plus_product(c, z),
            z,
        ];
        Node {
            g: apply_plain(&self.T, G),
            r: apply(&transpose(&self.scaled), along),
            along,
        }
    }

    #[inline(always)]
    fn gradient<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let third = self.theta.scaled(1.0 / 3.0);
        for (i, gradient) in shape.gradients().iter().enumerate() {
            let Node { g, r, .. } = self.node(gradient);
            let mut force = r;
            for a in 0..3 {
                force[a] = r[a].minus_product(third, g[a]) * self.s;
            }
            out.force(i, sums(force));
        }
        let half = self.s.scaled(0.5);
        for (m, slope) in self.slopes().into_iter().enumerate() {
            out.strain(m, (slope * half).each());
        }
    }

    #[inline(always)]
    fn tangent<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        out: &mut impl Output<N::Uniform>,
    ) {
        let mut nodes = [self.node(&shape.gradients()[0]); NODES];
        for i in 1..NODES {
            nodes[i] = self.node(&shape.gradients()[i]);
        }
        let slopes = self.slopes();
        for i in 0..NODES {
            for j in 0..=i {
                out.stiffness(i, j, self.block([&nodes[i], &nodes[j]]));
            }
            self.couple(i, &nodes[i], &slopes, out);
        }
        self.curvature(out);
    }

    /// Sums of ∂²W/∂x_i∂x_j.
    #[inline(always)]
    fn block(&self, [i, j]: [&Node<N>; 2]) -> Nine<N::Uniform> {
        let mut weighted = i.along;
        for k in 0..3 {
            weighted[k] = i.along[k] * self.D[k];
        }
        let diagonal = self.s * dot(weighted, j.along);
        let mixed = self.s.scaled(-2.0 / 3.0);
        let volume = self.s * self.theta;
        let (even, swapped) = (volume.scaled(2.0 / 9.0), volume.scaled(1.0 / 3.0));
        let mut block = [sums(i.g); 3];
        for a in 0..3 {
            for b in 0..3 {
                let both = (i.r[a] * j.g[b]).plus_product(i.g[a], j.r[b]);
                let mut entry = (mixed * both)
                    .plus_product(even, i.g[a] * j.g[b])
                    .plus_product(swapped, j.g[a] * i.g[b]);
                if a == b {
                    entry = entry + diagonal;
                }
                block[a][b] = entry.sum();
            }
        }
        block
    }

    /// Hands over ∂²W/∂x_i∂q.
    #[inline(always)]
    fn couple(
        &self,
        i: usize,
        node: &Node<N>,
        slopes: &[N; COORDINATES],
        out: &mut impl Output<N::Uniform>,
    ) {
        let [one, two, three] = node.along;
        let (y, z) = (node.along[1].minus_product(self.u[2], three), three);
        let last = scale(self.scaled[2], three);
        let of_shear = |(k, m): (usize, usize), component: N, along: N| {
            let with = scale(self.scaled[k], component);
            let other = scale(self.f[m], along * self.D[k]);
            [with[0] + other[0], with[1] + other[1], with[2] + other[2]]
        };
        let of_stretch = |k: usize, along: N| {
            let own = scale(self.scaled[k], along);
            [own[0] - last[0], own[1] - last[1], own[2] - last[2]]
        };
        let by = [
            of_stretch(0, one),
            of_stretch(1, two),
            of_shear((0, 1), y, one),
            of_shear((0, 2), z, one),
            of_shear((1, 2), z, two),
        ];
        for (m, r) in by.into_iter().enumerate() {
            let third = slopes[m].scaled(1.0 / 3.0);
            let mut column = r;
            for a in 0..3 {
                column[a] = r[a].minus_product(third, node.g[a]) * self.s;
            }
            out.strain_coupling(i, m, [column[0].each(), column[1].each(), column[2].each()]);
        }
    }

    /// Hands over ∂²W/∂q∂q, the lower triangle where it is other than zero.
    #[inline(always)]
    fn curvature(&self, out: &mut impl Output<N::Uniform>) {
        let [first, second, third] = self.parts;
        let half = self.s.scaled(0.5);
        let [_, y, z] = self.f;
        let (one, two) = (self.s * self.D[0], self.s * self.D[1]);
        for (m, n, value) in [
            (0, 0, (first + third) * half),
            (1, 0, third * half),
            (1, 1, (second + third) * half),
            (2, 0, dot(self.scaled[0], y) * self.s),
            (3, 0, dot(self.scaled[0], z) * self.s),
            (4, 1, dot(self.scaled[1], z) * self.s),
            (2, 2, dot(y, y) * one),
            (3, 2, dot(y, z) * one),
            (3, 3, dot(z, z) * one),
            (4, 4, dot(z, z) * two),
        ] {
            out.strains(m, n, value.each());
        }
    }
}
