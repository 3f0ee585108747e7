//! Numbers of a formula at Gauss points: eight lanes of a vector unit, or those with a derivative.
//!
//! A formula of an element is written once over [`Points`]. Over [`Lanes`] it is evaluated at all Gauss points side by
//! side; over dual numbers of lanes, [`Dual`], its result carries the derivative along a direction of its arguments.
//! [`dispatch`] chooses the widest vector unit of the machine at run time.

use pulp::{Arch, Simd, WithSimd};
use std::ops::{Add, Mul, Neg, Sub};

/// A number of a field, with the functions that material laws need.
pub(super) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// self + a b.
    fn plus_product(self, a: Self, b: Self) -> Self;
    /// self − a b.
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// c self.
    fn scaled(self, c: f64) -> Self;
    /// self + c.
    fn shifted(self, c: f64) -> Self;
    /// 1/self.
    fn recip(self) -> Self;
    /// ln self; NaN for self ≤ 0.
    fn ln(self) -> Self;
}

/// A number at each of the eight Gauss points.
pub(super) trait Points: Real {
    /// The vector unit.
    type Token: Copy;
    /// Numbers of the reference configuration, without derivative.
    type Plain: Points<Token = Self::Token, Plain = Self::Plain>;
    /// The same number at all Gauss points, or a sum over them.
    type Uniform: Real;

    /// The same number at all points.
    fn splat(token: Self::Token, value: Self::Uniform) -> Self;
    /// A constant.
    fn constant(token: Self::Token, value: f64) -> Self;
    /// Numbers of the reference configuration.
    fn load(token: Self::Token, values: &[f64; 8]) -> Self::Plain;
    /// self + b.
    fn plus_plain(self, b: Self::Plain) -> Self;
    /// self b.
    fn times(self, b: Self::Plain) -> Self;
    /// self + a b.
    fn plus_times(self, a: Self, b: Self::Plain) -> Self;
    /// The number itself where it is positive, otherwise NaN.
    fn positive(self) -> Self;
    /// The sum over the points.
    fn sum(self) -> Self::Uniform;
}

impl Real for f64 {
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        c * self
    }

    #[inline(always)]
    fn shifted(self, c: f64) -> Self {
        self + c
    }

    #[inline(always)]
    fn recip(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn ln(self) -> Self {
        if self > 0.0 {
            Self::ln(self)
        } else {
            Self::NAN
        }
    }
}

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
}

/// A number `value` + ε `rate` with its derivative along a direction, ε² = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<T> {
    pub(super) value: T,
    pub(super) rate: T,
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self {
            value: self.value + b.value,
            rate: self.rate + b.rate,
        }
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self {
            value: self.value - b.value,
            rate: self.rate - b.rate,
        }
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self {
            value: self.value * b.value,
            rate: (self.value * b.rate).plus_product(self.rate, b.value),
        }
    }
}

impl<T: Real> Neg for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            rate: -self.rate,
        }
    }
}

impl<T: Real> Real for Dual<T> {
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self {
            value: self.value.plus_product(a.value, b.value),
            rate: self
                .rate
                .plus_product(a.value, b.rate)
                .plus_product(a.rate, b.value),
        }
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self {
            value: self.value.minus_product(a.value, b.value),
            rate: self
                .rate
                .minus_product(a.value, b.rate)
                .minus_product(a.rate, b.value),
        }
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        Self {
            value: self.value.scaled(c),
            rate: self.rate.scaled(c),
        }
    }

    #[inline(always)]
    fn shifted(self, c: f64) -> Self {
        Self {
            value: self.value.shifted(c),
            rate: self.rate,
        }
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let value = self.value.recip();
        Self {
            value,
            rate: -(self.rate * value * value),
        }
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self {
            value: self.value.ln(),
            rate: self.rate * self.value.recip(),
        }
    }
}

impl<P: Points<Plain = P>> Points for Dual<P> {
    type Token = P::Token;
    type Plain = P;
    type Uniform = Dual<P::Uniform>;

    #[inline(always)]
    fn splat(token: Self::Token, value: Self::Uniform) -> Self {
        Self {
            value: P::splat(token, value.value),
            rate: P::splat(token, value.rate),
        }
    }

    #[inline(always)]
    fn constant(token: Self::Token, value: f64) -> Self {
        Self {
            value: P::constant(token, value),
            rate: P::constant(token, 0.0),
        }
    }

    #[inline(always)]
    fn load(token: Self::Token, values: &[f64; 8]) -> P {
        P::load(token, values)
    }

    #[inline(always)]
    fn plus_plain(self, b: P) -> Self {
        Self {
            value: self.value + b,
            rate: self.rate,
        }
    }

    #[inline(always)]
    fn times(self, b: P) -> Self {
        Self {
            value: self.value * b,
            rate: self.rate * b,
        }
    }

    #[inline(always)]
    fn plus_times(self, a: Self, b: P) -> Self {
        Self {
            value: self.value.plus_product(a.value, b),
            rate: self.rate.plus_product(a.rate, b),
        }
    }

    #[inline(always)]
    fn positive(self) -> Self {
        Self {
            value: self.value.positive(),
            rate: self.rate,
        }
    }

    #[inline(always)]
    fn sum(self) -> Self::Uniform {
        Dual {
            value: self.value.sum(),
            rate: self.rate.sum(),
        }
    }
}

/// Work that is compiled for each vector unit.
pub(super) trait Task {
    /// What it returns.
    type Output;

    /// Does it with eight numbers in `K` registers.
    fn run<S: Simd, const K: usize>(self, unit: S) -> Self::Output;
}

struct Eight<T>(T);

impl<T: Task> WithSimd for Eight<T> {
    type Output = T::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) -> T::Output {
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
pub(super) fn dispatch<T: Task>(task: T) -> T::Output {
    Arch::new().dispatch(Eight(task))
}
