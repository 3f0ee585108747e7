//! Numbers with their derivative along a direction.

use super::number::{Points, Real};
use std::ops::{Add, Mul, Neg, Sub};

/// A number `value` + ε `rate` with its derivative along a direction, ε² = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<T> {
    pub(super) value: T,
    pub(super) rate: T,
}

impl<T> Dual<T> {
    #[inline(always)]
    pub(super) const fn new(value: T, rate: T) -> Self {
        Self { value, rate }
    }
}

/// Numbers with their rates, taken apart.
pub(super) trait Rated: Copy {
    /// The same list of plain numbers.
    type Plain: Copy + Default;

    fn values(self) -> Self::Plain;
    fn rates(self) -> Self::Plain;
}

impl Rated for Dual<f64> {
    type Plain = f64;

    #[inline(always)]
    fn values(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn rates(self) -> f64 {
        self.rate
    }
}

impl<R: Rated, const N: usize> Rated for [R; N]
where
    [R::Plain; N]: Default,
{
    type Plain = [R::Plain; N];

    #[inline(always)]
    fn values(self) -> Self::Plain {
        let mut values = Self::Plain::default();
        for i in 0..N {
            values[i] = self[i].values();
        }
        values
    }

    #[inline(always)]
    fn rates(self) -> Self::Plain {
        let mut rates = Self::Plain::default();
        for i in 0..N {
            rates[i] = self[i].rates();
        }
        rates
    }
}

impl<T: Real> Add for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.rate + b.rate)
    }
}

impl<T: Real> Sub for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.rate - b.rate)
    }
}

impl<T: Real> Mul for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self::new(
            self.value * b.value,
            (self.value * b.rate).plus_product(self.rate, b.value),
        )
    }
}

impl<T: Real> Neg for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.rate)
    }
}

impl<T: Real> Real for Dual<T> {
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Self::new(
            self.value.plus_product(a.value, b.value),
            self.rate
                .plus_product(a.value, b.rate)
                .plus_product(a.rate, b.value),
        )
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Self::new(
            self.value.minus_product(a.value, b.value),
            self.rate
                .minus_product(a.value, b.rate)
                .minus_product(a.rate, b.value),
        )
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        Self::new(self.value.scaled(c), self.rate.scaled(c))
    }

    #[inline(always)]
    fn shifted(self, c: f64) -> Self {
        Self::new(self.value.shifted(c), self.rate)
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let value = self.value.recip();
        Self::new(value, -(self.rate * value * value))
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Self::new(value, self.rate * value)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.rate * self.value.recip())
    }
}

impl<P: Points<Plain = P>> Points for Dual<P> {
    type Token = P::Token;
    type Plain = P;
    type Uniform = Dual<P::Uniform>;

    #[inline(always)]
    fn splat(token: Self::Token, value: Self::Uniform) -> Self {
        Self::new(P::splat(token, value.value), P::splat(token, value.rate))
    }

    #[inline(always)]
    fn constant(token: Self::Token, value: f64) -> Self {
        Self::new(P::constant(token, value), P::constant(token, 0.0))
    }

    #[inline(always)]
    fn load(token: Self::Token, values: &[f64; 8]) -> P {
        P::load(token, values)
    }

    #[inline(always)]
    fn uniform(value: f64, rate: f64) -> Self::Uniform {
        Dual::new(P::uniform(value, 0.0), P::uniform(rate, 0.0))
    }

    #[inline(always)]
    fn moving(token: Self::Token, values: &[f64; 8], rates: &[f64; 8]) -> Self {
        Self::new(P::load(token, values), P::load(token, rates))
    }

    #[inline(always)]
    fn plus_plain(self, b: P) -> Self {
        Self::new(self.value + b, self.rate)
    }

    #[inline(always)]
    fn times(self, b: P) -> Self {
        Self::new(self.value * b, self.rate * b)
    }

    #[inline(always)]
    fn plus_times(self, a: Self, b: P) -> Self {
        Self::new(
            self.value.plus_product(a.value, b),
            self.rate.plus_product(a.rate, b),
        )
    }

    #[inline(always)]
    fn positive(self) -> Self {
        Self::new(self.value.positive(), self.rate)
    }

    #[inline(always)]
    fn sum(self) -> Self::Uniform {
        Dual::new(self.value.sum(), self.rate.sum())
    }

    #[inline(always)]
    fn each(self) -> [Self::Uniform; 8] {
        let (values, rates) = (self.value.each(), self.rate.each());
        std::array::from_fn(|point| Dual::new(values[point], rates[point]))
    }
}
