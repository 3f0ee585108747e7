//! Eight numbers in the registers of a vector unit.

use super::number::{Points, Real};
use pulp::{Arch, Simd, WithSimd};
use std::ops::{Add, Mul, Neg, Sub};

/// Eight numbers in `K` registers of the vector unit `S`.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd, const K: usize> {
    unit: S,
    registers: [S::f64s; K],
}

impl<S: Simd, const K: usize> Lanes<S, K> {
    #[inline(always)]
    fn map(mut self, f: impl Fn(S, S::f64s) -> S::f64s) -> Self {
        for k in 0..K {
            self.registers[k] = f(self.unit, self.registers[k]);
        }
        self
    }

    #[inline(always)]
    fn zip(mut self, b: Self, f: impl Fn(S, S::f64s, S::f64s) -> S::f64s) -> Self {
        for k in 0..K {
            self.registers[k] = f(self.unit, self.registers[k], b.registers[k]);
        }
        self
    }
}

impl<S: Simd, const K: usize> Add for Lanes<S, K> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.zip(b, |unit, a, b| unit.add_f64s(a, b))
    }
}

impl<S: Simd, const K: usize> Sub for Lanes<S, K> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.zip(b, |unit, a, b| unit.sub_f64s(a, b))
    }
}

impl<S: Simd, const K: usize> Mul for Lanes<S, K> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.zip(b, |unit, a, b| unit.mul_f64s(a, b))
    }
}

impl<S: Simd, const K: usize> Neg for Lanes<S, K> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|unit, a| unit.neg_f64s(a))
    }
}

impl<S: Simd, const K: usize> Real for Lanes<S, K> {
    #[inline(always)]
    fn plus_product(mut self, a: Self, b: Self) -> Self {
        for k in 0..K {
            self.registers[k] =
                self.unit
                    .mul_add_e_f64s(a.registers[k], b.registers[k], self.registers[k]);
        }
        self
    }

    #[inline(always)]
    fn minus_product(mut self, a: Self, b: Self) -> Self {
        for k in 0..K {
            self.registers[k] =
                self.unit
                    .negate_mul_add_e_f64s(a.registers[k], b.registers[k], self.registers[k]);
        }
        self
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        let c = self.unit.splat_f64s(c);
        self.map(|unit, a| unit.mul_f64s(a, c))
    }

    #[inline(always)]
    fn shifted(self, c: f64) -> Self {
        let c = self.unit.splat_f64s(c);
        self.map(|unit, a| unit.add_f64s(a, c))
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let one = self.unit.splat_f64s(1.0);
        self.map(|unit, a| unit.div_f64s(one, a))
    }

    #[inline(always)]
    fn exp(mut self) -> Self {
        for lane in pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(&mut self.registers) {
            *lane = Real::exp(*lane);
        }
        self
    }

    #[inline(always)]
    fn ln(mut self) -> Self {
        for lane in pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(&mut self.registers) {
            *lane = Real::ln(*lane);
        }
        self
    }
}

impl<S: Simd, const K: usize> Points for Lanes<S, K> {
    type Token = S;
    type Plain = Self;
    type Uniform = f64;

    #[inline(always)]
    fn splat(unit: S, value: f64) -> Self {
        let registers = [unit.splat_f64s(value); K];
        Self { unit, registers }
    }

    #[inline(always)]
    fn constant(unit: S, value: f64) -> Self {
        Self::splat(unit, value)
    }

    #[inline(always)]
    fn load(unit: S, values: &[f64; 8]) -> Self {
        let mut lanes = Self::splat(unit, 0.0);
        let (registers, _) = S::as_simd_f64s(values);
        lanes.registers.copy_from_slice(registers);
        lanes
    }

    #[inline(always)]
    fn uniform(value: f64, _: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn moving(unit: S, values: &[f64; 8], _: &[f64; 8]) -> Self {
        Self::load(unit, values)
    }

    #[inline(always)]
    fn plus_plain(self, b: Self) -> Self {
        self + b
    }

    #[inline(always)]
    fn times(self, b: Self) -> Self {
        self * b
    }

    #[inline(always)]
    fn plus_times(self, a: Self, b: Self) -> Self {
        self.plus_product(a, b)
    }

    #[inline(always)]
    fn positive(self) -> Self {
        let (zero, nan) = (self.unit.splat_f64s(0.0), self.unit.splat_f64s(f64::NAN));
        self.map(|unit, a| unit.select_f64s(unit.greater_than_f64s(a, zero), a, nan))
    }

    #[inline(always)]
    fn sum(self) -> f64 {
        let mut total = self.registers[0];
        for k in 1..K {
            total = self.unit.add_f64s(total, self.registers[k]);
        }
        self.unit.reduce_sum_f64s(total)
    }

    #[inline(always)]
    fn each(self) -> [f64; 8] {
        let mut values = [0.0; 8];
        let (registers, _) = S::as_mut_simd_f64s(&mut values);
        registers.copy_from_slice(&self.registers);
        values
    }
}

/// Work that is compiled for each vector unit.
pub(super) trait Task {
    /// Does it with eight numbers in `K` registers.
    fn run<S: Simd, const K: usize>(self, unit: S);
}

struct Eight<T>(T);

impl<T: Task> WithSimd for Eight<T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        match S::F64_LANES {
            8 => self.0.run::<S, 1>(unit),
            4 => self.0.run::<S, 2>(unit),
            2 => self.0.run::<S, 4>(unit),
            1 => self.0.run::<S, 8>(unit),
            lanes => unreachable!("vector units have 1, 2, 4 or 8 lanes of 64 bits, not {lanes}"),
        }
    }
}

/// Does a task with the widest vector unit of this machine.
#[inline]
pub(super) fn dispatch<T: Task>(task: T) {
    Arch::new().dispatch(Eight(task));
}
