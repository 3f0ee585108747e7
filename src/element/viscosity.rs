//! The virtual work of the viscous stress σ = η d of an element, and its contraction with virtual displacements.
//!
//! With g_i = F⁻ᵀG_i, l = Σ v_i ⊗ g_i, d = sym l, l_i = lᵀg_i and c = w η J, the virtual work of displacements y_i is
//!
//! ```text
//! s(x, v; y) = Σ y_i·f_i = Σ c d:z,      Y = Σ y_i ⊗ g_i,  z = sym Y,      f_i = Σ c d g_i
//! ∂f_i/∂v_j = Σ c/2 [ (g_i·g_j) 1 + g_j⊗g_i ]
//! ∂f_i/∂x_j = Σ c [ d g_i ⊗ g_j − d g_j ⊗ g_i − ½ (g_i·g_j) l − ½ g_j ⊗ l_i ].
//! ```
//!
//! Since d and z enter alike, ∂s/∂v_j is f_j of the velocities y, and ∂²s/∂v_j∂x_i is ∂f_j/∂x_i of them. With
//! q_i = (lᵀz + Yᵀd) g_i and Y_i = Yᵀg_i,
//!
//! ```text
//! ∂s/∂x_i = Σ c [ (d:z) g_i − q_i ]
//! ∂²s/∂x_i∂x_j = Σ c { (d:z)(g_i⊗g_j − g_j⊗g_i) − q_i⊗g_j + q_j⊗g_i − g_i⊗q_j + g_j⊗q_i
//!                      + ½ (g_i·g_j)(lᵀY + Yᵀl) + ½ l_j⊗Y_i + ½ Y_j⊗l_i }.
//! ```

use crate::element::geometry::{ElementGeometry, Kinematics, gradient_of, load};
use crate::element::lanes::{Lanes, Task, dispatch};
use crate::element::number::{
    Nine, Points, Three, apply, apply_plain, contracted, dot, product, scale, scale_all, sums,
    symmetric, transpose,
};
use crate::math::{Matrix, Vector};
use pulp::Simd;

/// The viscous Cauchy stress σ = η d of the rate of deformation d.
///
/// It is objective: with x at the midpoint of a step and v its difference quotient, a finite rotation has d = 0.
/// NaN where J ≤ 0 at a Gauss point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viscosity {
    /// η in MPa ms.
    pub viscosity: f64,
}

impl Viscosity {
    /// Dissipation Σ v_i·f_i = ∫ J η d:d dV ≥ 0 in mJ/ms of the element `shape` with nodes at `x` in mm and their
    /// velocities `v` in mm/ms.
    pub fn power<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        v: &[Vector; NODES],
    ) -> f64 {
        let mut power = 0.0;
        self.read(shape, [x, v], Power(&mut power));
        power
    }

    /// Fills the forces f_i.
    pub fn forces<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        v: &[Vector; NODES],
        forces: &mut [Vector; NODES],
    ) {
        self.read(shape, [x, v], Forces(forces));
    }

    /// Fills the forces and their derivatives.
    pub fn tangent<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        v: &[Vector; NODES],
        local: &mut ViscousLocal<NODES>,
    ) {
        self.read(shape, [x, v], Tangent(local));
    }

    /// Fills s = Σ y_i·f_i(x, v), its gradient and its Hessian.
    pub fn contraction<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        x: &[Vector; NODES],
        v: &[Vector; NODES],
        y: &[Vector; NODES],
        out: &mut ViscousContraction<NODES>,
    ) {
        self.read(shape, [x, v], Contraction { y, out });
    }

    fn read<const NODES: usize>(
        &self,
        shape: &ElementGeometry<NODES>,
        [x, v]: [&[Vector; NODES]; 2],
        reader: impl Reader<NODES>,
    ) {
        dispatch(Reading {
            viscosity: self.viscosity,
            shape,
            x,
            v,
            reader,
        });
    }
}

/// Writes what is asked for of an element in motion.
trait Reader<const NODES: usize> {
    fn read<N: Points<Uniform = f64>>(self, flow: &Flow<'_, N, NODES>);
}

/// An element in motion, of which something is asked for.
struct Reading<'a, R, const NODES: usize> {
    viscosity: f64,
    shape: &'a ElementGeometry<NODES>,
    x: &'a [Vector; NODES],
    v: &'a [Vector; NODES],
    reader: R,
}

impl<R: Reader<NODES>, const NODES: usize> Task for Reading<'_, R, NODES> {
    #[inline(always)]
    fn run<S: Simd, const K: usize>(self, unit: S) {
        let (shape, viscosity) = (self.shape, self.viscosity);
        let flow = Flow::<Lanes<S, K>, NODES>::new(unit, shape, viscosity, [self.x, self.v]);
        self.reader.read(&flow);
    }
}

/// Spatial gradients, and rates of deformation, at the Gauss points.
struct Flow<'a, N: Points, const NODES: usize> {
    token: N::Token,
    shape: &'a ElementGeometry<NODES>,
    /// F⁻ᵀ.
    inverse: Nine<N>,
    /// c = w η J.
    c: N,
    /// l.
    l: Nine<N>,
}

impl<'a, N: Points<Uniform = f64>, const NODES: usize> Flow<'a, N, NODES> {
    #[inline(always)]
    fn new(
        token: N::Token,
        shape: &'a ElementGeometry<NODES>,
        viscosity: f64,
        [x, v]: [&[Vector; NODES]; 2],
    ) -> Self {
        let k = Kinematics::<N>::new(token, shape, &coordinates(x));
        let mut flow = Self {
            token,
            shape,
            l: k.T,
            inverse: k.T,
            c: k.J.scaled(viscosity).times(k.w),
        };
        flow.l = flow.rate(v);
        flow
    }

    /// Σ v_i ⊗ g_i.
    #[inline(always)]
    fn rate(&self, v: &[Vector; NODES]) -> Nine<N> {
        let rate = gradient_of::<N, NODES>(self.token, self.shape, &coordinates(v));
        product(&rate, &transpose(&self.inverse))
    }

    /// g_i.
    #[inline(always)]
    fn gradients(&self) -> [Three<N>; NODES] {
        let mut g = [[N::constant(self.token, 0.0); 3]; NODES];
        for (g, gradient) in g.iter_mut().zip(self.shape.gradients()) {
            *g = apply_plain(&self.inverse, load::<N>(self.token, gradient));
        }
        g
    }

    /// Writes ∂f_i/∂x_j of the rate `l` for all i and j.
    #[inline(always)]
    fn by_place(
        &self,
        g: &[Three<N>; NODES],
        l: &Nine<N>,
        mut write: impl FnMut(usize, usize, &Nine<f64>),
    ) {
        let zero = N::constant(self.token, 0.0);
        let d = scale_all(&symmetric(l), self.c);
        let half = self.c.scaled(0.5);
        let half_l = scale_all(l, half);
        let transposed = transpose(&half_l);
        let mut stressed = [[zero; 3]; NODES];
        let mut carried = [[zero; 3]; NODES];
        for i in 0..NODES {
            stressed[i] = apply(&d, g[i]);
            carried[i] = apply(&transposed, g[i]);
        }
        for i in 0..NODES {
            for j in 0..=i {
                let inner = dot(g[i], g[j]);
                let mut ij = [[0.0; 3]; 3];
                let mut ji = [[0.0; 3]; 3];
                for a in 0..3 {
                    for b in 0..3 {
                        let odd = (stressed[i][a] * g[j][b]).minus_product(stressed[j][a], g[i][b]);
                        let even = -(inner * half_l[a][b]);
                        ij[a][b] = (even + odd).minus_product(g[j][a], carried[i][b]).sum();
                        ji[a][b] = (even - odd).minus_product(g[i][a], carried[j][b]).sum();
                    }
                }
                write(i, j, &ij);
                write(j, i, &ji);
            }
        }
    }
}

struct Power<'a>(&'a mut f64);

impl<const NODES: usize> Reader<NODES> for Power<'_> {
    #[inline(always)]
    fn read<N: Points<Uniform = f64>>(self, flow: &Flow<'_, N, NODES>) {
        let d = symmetric(&flow.l);
        *self.0 = (flow.c * contracted(&d, &d)).sum();
    }
}

struct Forces<'a, const NODES: usize>(&'a mut [Vector; NODES]);

impl<const NODES: usize> Reader<NODES> for Forces<'_, NODES> {
    #[inline(always)]
    fn read<N: Points<Uniform = f64>>(self, flow: &Flow<'_, N, NODES>) {
        let stress = product(&scale_all(&symmetric(&flow.l), flow.c), &flow.inverse);
        for (force, gradient) in self.0.iter_mut().zip(flow.shape.gradients()) {
            *force = vector(sums(apply_plain(&stress, load::<N>(flow.token, gradient))));
        }
    }
}

struct Tangent<'a, const NODES: usize>(&'a mut ViscousLocal<NODES>);

impl<const NODES: usize> Reader<NODES> for Tangent<'_, NODES> {
    #[inline(always)]
    fn read<N: Points<Uniform = f64>>(self, flow: &Flow<'_, N, NODES>) {
        let g = flow.gradients();
        let local = self.0;
        let d = scale_all(&symmetric(&flow.l), flow.c);
        let half = flow.c.scaled(0.5);
        for i in 0..NODES {
            local.forces[i] = vector(sums(apply(&d, g[i])));
            let scaled = scale(g[i], half);
            for j in 0..=i {
                let mut block = [[0.0; 3]; 3];
                for a in 0..3 {
                    block[a] = sums(scale(scaled, g[j][a]));
                }
                let trace = block[0][0] + block[1][1] + block[2][2];
                for a in 0..3 {
                    block[a][a] += trace;
                }
                let block = matrix(&block);
                local.by_velocity[j][i] = block.transpose();
                local.by_velocity[i][j] = block;
            }
        }
        flow.by_place(&g, &flow.l, |i, j, block| {
            local.by_place[i][j] = matrix(block);
        });
    }
}

struct Contraction<'a, const NODES: usize> {
    y: &'a [Vector; NODES],
    out: &'a mut ViscousContraction<NODES>,
}

impl<const NODES: usize> Reader<NODES> for Contraction<'_, NODES> {
    #[inline(always)]
    fn read<N: Points<Uniform = f64>>(self, flow: &Flow<'_, N, NODES>) {
        let zero = N::constant(flow.token, 0.0);
        let half = flow.c.scaled(0.5);
        let y = flow.rate(self.y);
        let g = flow.gradients();
        let (d, z) = (symmetric(&flow.l), symmetric(&y));
        let (lt, yt) = (transpose(&flow.l), transpose(&y));
        let out = self.out;

        let power = flow.c * contracted(&d, &z);
        out.value = power.sum();
        let (lz, yd, ly) = (product(&lt, &z), product(&yt, &d), product(&lt, &y));
        let mut carried = [[zero; 3]; 3];
        let mut mixed = [[zero; 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                carried[a][b] = flow.c * (lz[a][b] + yd[a][b]);
                mixed[a][b] = half * (ly[a][b] + ly[b][a]);
            }
        }
        let stress = scale_all(&z, flow.c);
        let mut q = [[zero; 3]; NODES];
        let mut half_l = [[zero; 3]; NODES];
        let mut pulled_y = [[zero; 3]; NODES];
        for i in 0..NODES {
            q[i] = apply(&carried, g[i]);
            half_l[i] = scale(apply(&lt, g[i]), half);
            pulled_y[i] = apply(&yt, g[i]);
            let mut slope = [zero; 3];
            for a in 0..3 {
                slope[a] = (power * g[i][a]) - q[i][a];
            }
            out.by_place[i] = vector(sums(slope));
            out.by_velocity[i] = vector(sums(apply(&stress, g[i])));
        }
        for i in 0..NODES {
            for j in 0..=i {
                let inner = dot(g[i], g[j]);
                let mut block = [[0.0; 3]; 3];
                for a in 0..3 {
                    for b in 0..3 {
                        let odd = (g[i][a] * g[j][b]).minus_product(g[j][a], g[i][b]);
                        block[a][b] = (inner * mixed[a][b])
                            .plus_product(power, odd)
                            .minus_product(q[i][a], g[j][b])
                            .plus_product(q[j][a], g[i][b])
                            .minus_product(g[i][a], q[j][b])
                            .plus_product(g[j][a], q[i][b])
                            .plus_product(half_l[j][a], pulled_y[i][b])
                            .plus_product(pulled_y[j][a], half_l[i][b])
                            .sum();
                    }
                }
                let block = matrix(&block);
                out.place_place[j][i] = block.transpose();
                out.place_place[i][j] = block;
            }
        }
        flow.by_place(&g, &y, |i, j, block| {
            out.place_velocity[j][i] = matrix(block).transpose();
        });
    }
}

#[inline(always)]
fn coordinates<const NODES: usize>(x: &[Vector; NODES]) -> [[f64; 3]; NODES] {
    let mut coordinates = [[0.0; 3]; NODES];
    for (c, x) in coordinates.iter_mut().zip(x) {
        *c = [x.x, x.y, x.z];
    }
    coordinates
}

#[inline(always)]
fn vector(a: [f64; 3]) -> Vector {
    Vector::new(a[0], a[1], a[2])
}

#[inline(always)]
fn matrix([a, b, c]: &Nine<f64>) -> Matrix {
    Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2])
}

/// Viscous forces of one element and their derivatives.
#[derive(Clone, Debug)]
pub struct ViscousLocal<const NODES: usize = 8> {
    /// f_i in N, which balance external forces as ∂W/∂x_i do: the virtual work on the nodes is −Σ δx_i·f_i.
    pub forces: [Vector; NODES],
    /// ∂f_i/∂x_j in N/mm, rows belong to i; not symmetric.
    pub by_place: [[Matrix; NODES]; NODES],
    /// ∂f_i/∂v_j in N ms/mm, rows belong to i; symmetric, both triangles are filled.
    pub by_velocity: [[Matrix; NODES]; NODES],
}

/// s = Σ y_i·f_i(x, v) of one element for given y_i, and its derivatives; ∂²s/∂v∂v is zero.
#[derive(Clone, Debug)]
pub struct ViscousContraction<const NODES: usize = 8> {
    /// s.
    pub value: f64,
    /// ∂s/∂x_i.
    pub by_place: [Vector; NODES],
    /// ∂s/∂v_i.
    pub by_velocity: [Vector; NODES],
    /// ∂²s/∂x_i∂x_j, rows belong to i; both triangles are filled.
    pub place_place: [[Matrix; NODES]; NODES],
    /// ∂²s/∂x_i∂v_j, rows belong to i; not symmetric.
    pub place_velocity: [[Matrix; NODES]; NODES],
}

impl<const NODES: usize> Default for ViscousLocal<NODES> {
    fn default() -> Self {
        Self {
            forces: [Vector::zeros(); NODES],
            by_place: [[Matrix::zeros(); NODES]; NODES],
            by_velocity: [[Matrix::zeros(); NODES]; NODES],
        }
    }
}

impl<const NODES: usize> Default for ViscousContraction<NODES> {
    fn default() -> Self {
        Self {
            value: 0.0,
            by_place: [Vector::zeros(); NODES],
            by_velocity: [Vector::zeros(); NODES],
            place_place: [[Matrix::zeros(); NODES]; NODES],
            place_velocity: [[Matrix::zeros(); NODES]; NODES],
        }
    }
}
