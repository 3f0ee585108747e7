//! Energy of one element, and of a Maxwell branch of it, with their first and second derivatives by places and potentials of its nodes, and by
//! viscous strains.

use super::dual::{Dual, Rated};
use super::law::Field;
use crate::math::{Matrix, Vector};

/// Energy W of one element with its derivatives: forces, stiffness, and their electric counterparts.
///
/// A caller keeps one and has it filled again and again. `Local<Passive>` has no electric part.
#[derive(Clone, Debug)]
pub struct Local<F: Field, const NODES: usize = 8> {
    /// W in mJ.
    pub energy: f64,
    /// ∂W/∂x_i in N.
    pub forces: [Vector; NODES],
    /// ∂²W/∂x_i∂x_j in N/mm, rows belong to i; both triangles are filled.
    pub stiffness: [[Matrix; NODES]; NODES],
    /// Derivatives by potentials: [`ElectricDerivatives`](crate::element::ElectricDerivatives), or nothing.
    pub electric: F::Local<NODES>,
}

impl<F: Field, const NODES: usize> Default for Local<F, NODES> {
    fn default() -> Self {
        Self {
            energy: 0.0,
            forces: [Vector::zeros(); NODES],
            stiffness: [[Matrix::zeros(); NODES]; NODES],
            electric: Default::default(),
        }
    }
}

/// Receiver of the variations of an energy, as numbers `U`; it drops those that a reader does not ask for.
pub trait Output<U> {
    fn energy(&mut self, value: U);
    fn force(&mut self, _i: usize, _value: [U; 3]) {}
    /// The block (i, j) and, transposed, (j, i).
    fn stiffness(&mut self, _i: usize, _j: usize, _value: [[U; 3]; 3]) {}
    /// By potentials.
    fn charge(&mut self, _i: usize, _value: U) {}
    fn coupling(&mut self, _i: usize, _j: usize, _value: [U; 3]) {}
    /// The entries (i, j) and (j, i).
    fn permittivity(&mut self, _i: usize, _j: usize, _value: U) {}
    /// By viscous strains.
    fn strain(&mut self, _m: usize, _value: [U; 8]) {}
    fn strain_coupling(&mut self, _i: usize, _m: usize, _value: [[U; 8]; 3]) {}
    /// The entries (m, n) and (n, m).
    fn strains(&mut self, _m: usize, _n: usize, _value: [U; 8]) {}
}

/// An energy alone.
impl Output<Self> for f64 {
    #[inline(always)]
    fn energy(&mut self, value: Self) {
        *self = value;
    }
}

/// Writes the block (i, j) by its rows and, transposed, (j, i).
#[inline(always)]
pub(super) fn write_block<const NODES: usize>(
    blocks: &mut [[Matrix; NODES]; NODES],
    [i, j]: [usize; 2],
    [a, b, c]: [[f64; 3]; 3],
) {
    // Columns one after the other, as nalgebra stores them.
    blocks[j][i] = Matrix::new(a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]);
    blocks[i][j] = Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
}

impl<F: Field, const NODES: usize> Output<f64> for Local<F, NODES> {
    #[inline(always)]
    fn energy(&mut self, value: f64) {
        self.energy = value;
    }

    #[inline(always)]
    fn force(&mut self, i: usize, value: [f64; 3]) {
        self.forces[i] = Vector::new(value[0], value[1], value[2]);
    }

    #[inline(always)]
    fn charge(&mut self, i: usize, value: f64) {
        if let Some(electric) = F::electric(&mut self.electric) {
            electric.charges[i] = value;
        }
    }

    #[inline(always)]
    fn stiffness(&mut self, i: usize, j: usize, rows: [[f64; 3]; 3]) {
        write_block(&mut self.stiffness, [i, j], rows);
    }

    #[inline(always)]
    fn coupling(&mut self, i: usize, j: usize, value: [f64; 3]) {
        if let Some(electric) = F::electric(&mut self.electric) {
            electric.coupling[i][j] = Vector::new(value[0], value[1], value[2]);
        }
    }

    #[inline(always)]
    fn permittivity(&mut self, i: usize, j: usize, value: f64) {
        if let Some(electric) = F::electric(&mut self.electric) {
            electric.permittivity[i][j] = value;
            electric.permittivity[j][i] = value;
        }
    }
}

/// Variations, and their derivatives along a direction.
pub(super) struct Pair<'a, O> {
    pub(super) plain: &'a mut O,
    pub(super) along: &'a mut O,
}

impl<O> Pair<'_, O> {
    #[inline(always)]
    fn both<R: Rated>(&mut self, numbers: R, write: impl Fn(&mut O, R::Plain)) {
        write(self.plain, numbers.values());
        write(self.along, numbers.rates());
    }
}

/// Receives numbers and their rates alike.
macro_rules! both {
    ($($name:ident($($i:ident),*): $numbers:ty;)*) => {
        $(
            #[inline(always)]
            fn $name(&mut self, $($i: usize,)* d: $numbers) {
                self.both(d, |to, d| to.$name($($i,)* d));
            }
        )*
    };
}

impl<O: Output<f64>> Output<Dual<f64>> for Pair<'_, O> {
    both! {
        energy(): Dual<f64>;
        force(i): [Dual<f64>; 3];
        stiffness(i, j): [[Dual<f64>; 3]; 3];
        charge(i): Dual<f64>;
        coupling(i, j): [Dual<f64>; 3];
        permittivity(i, j): Dual<f64>;
        strain(m): [Dual<f64>; 8];
        strain_coupling(i, m): [[Dual<f64>; 8]; 3];
        strains(m, n): [Dual<f64>; 8];
    }
}

/// Number of coordinates of the viscous strain at a point.
pub const COORDINATES: usize = 5;

/// A number at each of the eight Gauss points.
pub(super) type Eight = [f64; 8];

/// Energy W of a branch of one element with its derivatives; those by viscous strains have a value at each Gauss point.
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
    fn strain(&mut self, m: usize, value: Eight) {
        self.rows[m] = value;
    }

    #[inline(always)]
    fn stiffness(&mut self, i: usize, j: usize, rows: [[f64; 3]; 3]) {
        write_block(&mut self.stiffness, [i, j], rows);
    }

    #[inline(always)]
    fn strain_coupling(&mut self, i: usize, m: usize, value: [Eight; 3]) {
        self.coupling[i][m] = value;
    }

    #[inline(always)]
    fn strains(&mut self, m: usize, n: usize, value: Eight) {
        self.inner[m][n] = value;
        self.inner[n][m] = value;
    }
}
