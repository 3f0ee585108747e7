//! Energy of one hexahedron with its first and second derivatives by the arguments of its nodes.

use super::dual::{Dual, rates, values};
use super::law::Field;
use crate::math::{Matrix, Vector};

/// Energy W of one hexahedron with its derivatives: forces, stiffness, and their electric counterparts.
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
pub(super) trait Output<U> {
    fn energy(&mut self, value: U);
    fn force(&mut self, _i: usize, _value: [U; 3]) {}
    fn charge(&mut self, _i: usize, _value: U) {}
    /// The block (i, j) and, transposed, (j, i).
    fn stiffness(&mut self, _i: usize, _j: usize, _value: [[U; 3]; 3]) {}
    fn coupling(&mut self, _i: usize, _j: usize, _value: [U; 3]) {}
    /// The entries (i, j) and (j, i).
    fn permittivity(&mut self, _i: usize, _j: usize, _value: U) {}
}

/// An energy alone.
impl Output<Self> for f64 {
    #[inline(always)]
    fn energy(&mut self, value: Self) {
        *self = value;
    }
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
    fn stiffness(&mut self, i: usize, j: usize, [a, b, c]: [[f64; 3]; 3]) {
        // Columns one after the other, as nalgebra stores them.
        self.stiffness[j][i] = Matrix::new(a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]);
        self.stiffness[i][j] = Matrix::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
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
pub(super) struct Pair<'a, F: Field, const NODES: usize> {
    pub(super) plain: &'a mut Local<F, NODES>,
    pub(super) along: &'a mut Local<F, NODES>,
}

impl<F: Field, const NODES: usize> Output<Dual<f64>> for Pair<'_, F, NODES> {
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
    fn charge(&mut self, i: usize, d: Dual<f64>) {
        self.plain.charge(i, d.value);
        self.along.charge(i, d.rate);
    }

    #[inline(always)]
    fn stiffness(&mut self, i: usize, j: usize, d: [[Dual<f64>; 3]; 3]) {
        self.plain
            .stiffness(i, j, [values(d[0]), values(d[1]), values(d[2])]);
        self.along
            .stiffness(i, j, [rates(d[0]), rates(d[1]), rates(d[2])]);
    }

    #[inline(always)]
    fn coupling(&mut self, i: usize, j: usize, d: [Dual<f64>; 3]) {
        self.plain.coupling(i, j, values(d));
        self.along.coupling(i, j, rates(d));
    }

    #[inline(always)]
    fn permittivity(&mut self, i: usize, j: usize, d: Dual<f64>) {
        self.plain.permittivity(i, j, d.value);
        self.along.permittivity(i, j, d.rate);
    }
}
