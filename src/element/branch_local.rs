//! Energy of a Maxwell branch of one hexahedron with its first and second derivatives by places of nodes and viscous strains.

use super::dual::{Dual, rates, values};
use crate::math::{Matrix, Vector};

/// Number of coordinates of the viscous strain at a point.
pub const COORDINATES: usize = 5;

/// A number at each of the eight Gauss points.
pub(super) type Eight = [f64; 8];

/// Energy W of a branch of one hexahedron with its derivatives; those by viscous strains have a value at each Gauss point.
///
/// A caller keeps one and has it filled again and again.
#[derive(Clone, Debug)]
pub struct BranchLocal<const NODES: usize = 8> {
    /// W in mJ.
    pub energy: f64,
    /// ∂W/∂x_i in N.
    pub forces: [Vector; NODES],
    /// ∂W/∂q_m in mJ, `[m][point]`.
    pub rows: [Eight; COORDINATES],
    /// ∂²W/∂x_i∂x_j in N/mm, rows belong to i; both triangles are filled.
    pub stiffness: [[Matrix; NODES]; NODES],
    /// ∂²W/∂x_i∂q_m in N, `[i][m][component][point]`.
    pub coupling: [[[Eight; 3]; COORDINATES]; NODES],
    /// ∂²W/∂q_m∂q_n in mJ, `[m][n][point]`; both triangles are filled.
    pub inner: [[Eight; COORDINATES]; COORDINATES],
}

impl<const NODES: usize> Default for BranchLocal<NODES> {
    fn default() -> Self {
        let none = [0.0; 8];
        Self {
            energy: 0.0,
            forces: [Vector::zeros(); NODES],
            rows: [none; COORDINATES],
            stiffness: [[Matrix::zeros(); NODES]; NODES],
            coupling: [[[none; 3]; COORDINATES]; NODES],
            inner: [[none; COORDINATES]; COORDINATES],
        }
    }
}

/// Receiver of the variations of the energy of a branch, as numbers `U`; it drops those that a reader does not ask for.
pub(super) trait Output<U> {
    fn energy(&mut self, value: U);
    fn force(&mut self, _i: usize, _value: [U; 3]) {}
    fn row(&mut self, _m: usize, _value: [U; 8]) {}
    /// The block (i, j) and, transposed, (j, i).
    fn stiffness(&mut self, _i: usize, _j: usize, _value: [[U; 3]; 3]) {}
    fn coupling(&mut self, _i: usize, _m: usize, _value: [[U; 8]; 3]) {}
    /// The entries (m, n) and (n, m).
    fn inner(&mut self, _m: usize, _n: usize, _value: [U; 8]) {}
}

/// An energy alone.
impl Output<Self> for f64 {
    #[inline(always)]
    fn energy(&mut self, value: Self) {
        *self = value;
    }
}

impl<const NODES: usize> Output<f64> for BranchLocal<NODES> {
    #[inline(always)]
    fn energy(&mut self, value: f64) {
        self.energy = value;
    }

    #[inline(always)]
    fn force(&mut self, i: usize, value: [f64; 3]) {
        self.forces[i] = Vector::from(value);
    }

    #[inline(always)]
    fn row(&mut self, m: usize, value: Eight) {
        self.rows[m] = value;
    }

    #[inline(always)]
    fn stiffness(&mut self, i: usize, j: usize, [a, b, c]: [[f64; 3]; 3]) {
        // Columns one after the other, as nalgebra stores them.
        self.stiffness[j][i] = Matrix::new(a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]);
        self.stiffness[i][j] = Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    }

    #[inline(always)]
    fn coupling(&mut self, i: usize, m: usize, value: [Eight; 3]) {
        self.coupling[i][m] = value;
    }

    #[inline(always)]
    fn inner(&mut self, m: usize, n: usize, value: Eight) {
        self.inner[m][n] = value;
        self.inner[n][m] = value;
    }
}

/// Variations, and their derivatives along a direction.
pub(super) struct Pair<'a, const NODES: usize> {
    pub(super) plain: &'a mut BranchLocal<NODES>,
    pub(super) along: &'a mut BranchLocal<NODES>,
}

impl<const NODES: usize> Output<Dual<f64>> for Pair<'_, NODES> {
    #[inline(always)]
    fn energy(&mut self, d: Dual<f64>) {
        self.plain.energy(d.value);
        self.along.energy(d.rate);
    }

    #[inline(always)]
    fn force(&mut self, i: usize, d: [Dual<f64>; 3]) {
        self.plain.force(i, values(d));
        self.along.force(i, rates(d));
    }

    #[inline(always)]
    fn row(&mut self, m: usize, d: [Dual<f64>; 8]) {
        self.plain.row(m, values(d));
        self.along.row(m, rates(d));
    }

    #[inline(always)]
    fn stiffness(&mut self, i: usize, j: usize, d: [[Dual<f64>; 3]; 3]) {
        self.plain
            .stiffness(i, j, [values(d[0]), values(d[1]), values(d[2])]);
        self.along
            .stiffness(i, j, [rates(d[0]), rates(d[1]), rates(d[2])]);
    }

    #[inline(always)]
    fn coupling(&mut self, i: usize, m: usize, d: [[Dual<f64>; 8]; 3]) {
        self.plain
            .coupling(i, m, [values(d[0]), values(d[1]), values(d[2])]);
        self.along
            .coupling(i, m, [rates(d[0]), rates(d[1]), rates(d[2])]);
    }

    #[inline(always)]
    fn inner(&mut self, m: usize, n: usize, d: [Dual<f64>; 8]) {
        self.plain.inner(m, n, values(d));
        self.along.inner(m, n, rates(d));
    }
}
