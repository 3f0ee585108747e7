//! A scalar with its derivatives to second order, and their rates along a direction.
//!
//! A jet along w is the object that the Hessian of a nonlinear program needs: value, gradient ∇f and Hessian ∇²f of
//! a scalar at a point, with their rates ∇f·w, ∇²f w and ∇³f[w]. Jets are closed under sum, product and composition
//! with functions of one variable or of several jets, so a formula written once yields all of them.

use nalgebra::{SMatrix, SVector};
use std::ops::{Add, Mul, Neg, Sub};

/// The 2-jet of a scalar of `M` arguments, and its rate along a direction w.
///
/// `ORDER` says how far it is filled: 1 gradient, 2 Hessian, 3 the rates along w. Unfilled parts stay zero and cost no
/// arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Jet<const M: usize, const ORDER: usize> {
    /// f.
    pub value: f64,
    /// ∇f.
    pub gradient: SVector<f64, M>,
    /// ∇²f.
    pub hessian: SMatrix<f64, M, M>,
    /// ∇f·w.
    pub value_w: f64,
    /// ∇²f w.
    pub gradient_w: SVector<f64, M>,
    /// ∇³f[w].
    pub hessian_w: SMatrix<f64, M, M>,
}

impl<const M: usize, const ORDER: usize> Jet<M, ORDER> {
    /// A constant.
    #[inline]
    pub fn constant(value: f64) -> Self {
        Self {
            value,
            gradient: SVector::zeros(),
            hessian: SMatrix::zeros(),
            value_w: 0.0,
            gradient_w: SVector::zeros(),
            hessian_w: SMatrix::zeros(),
        }
    }

    /// The argument `i` itself.
    #[inline]
    pub fn argument(i: usize, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Self {
        let mut jet = Self::constant(p[i]);
        jet.gradient[i] = 1.0;
        jet.value_w = w[i];
        jet
    }

    /// a·b of two triples of arguments that start at `i` and `j`; `|a|²` for `i == j`.
    #[inline]
    pub fn dot(i: usize, j: usize, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Self {
        let mut jet = Self::constant(0.0);
        for c in 0..3 {
            let (a, b) = (i + c, j + c);
            jet.value += p[a] * p[b];
            jet.gradient[a] += p[b];
            jet.gradient[b] += p[a];
            if ORDER >= 2 {
                jet.hessian[(a, b)] += 1.0;
                jet.hessian[(b, a)] += 1.0;
            }
            if ORDER >= 3 {
                jet.value_w += w[a] * p[b] + p[a] * w[b];
                jet.gradient_w[a] += w[b];
                jet.gradient_w[b] += w[a];
            }
        }
        jet
    }

    /// f∘g of this jet g, from the derivatives `[f, f′, f″, f‴]` at its value.
    #[inline]
    pub fn map(&self, f: [f64; 4]) -> Self {
        let g = &self.gradient;
        let mut jet = Self::constant(f[0]);
        jet.gradient = g * f[1];
        if ORDER >= 2 {
            jet.hessian = self.hessian * f[1] + g * (g * f[2]).transpose();
        }
        if ORDER >= 3 {
            let cross = (g * f[2]) * self.gradient_w.transpose();
            jet.value_w = f[1] * self.value_w;
            jet.gradient_w = self.gradient_w * f[1] + g * (f[2] * self.value_w);
            jet.hessian_w = self.hessian_w * f[1]
                + self.hessian * (f[2] * self.value_w)
                + g * (g * (f[3] * self.value_w)).transpose()
                + cross
                + cross.transpose();
        }
        jet
    }

    /// 1/f.
    #[inline]
    pub fn recip(&self) -> Self {
        let r = 1.0 / self.value;
        self.map([r, -r * r, 2.0 * r * r * r, -6.0 * r * r * r * r])
    }

    /// √f; NaN for f < 0.
    #[inline]
    pub fn sqrt(&self) -> Self {
        let s = self.value.sqrt();
        let r = 1.0 / self.value;
        self.map([s, 0.5 * s * r, -0.25 * s * r * r, 0.375 * s * r * r * r])
    }

    /// ln f; NaN for f ≤ 0.
    #[inline]
    pub fn ln(&self) -> Self {
        let r = 1.0 / self.value;
        self.map([self.value.ln(), r, -r * r, 2.0 * r * r * r])
    }

    /// f².
    #[inline]
    pub fn squared(&self) -> Self {
        self.map([self.value * self.value, 2.0 * self.value, 2.0, 0.0])
    }

    /// fⁿ for a whole n ≥ 3.
    #[inline]
    pub fn powi(&self, n: i32) -> Self {
        let f = self.value;
        let m = f64::from(n);
        self.map([
            f.powi(n),
            m * f.powi(n - 1),
            m * (m - 1.0) * f.powi(n - 2),
            m * (m - 1.0) * (m - 2.0) * f.powi(n - 3),
        ])
    }

    /// f∘(g₁ … g_K): the jet `outer` of a function of K values at the values of the jets `inner`.
    ///
    /// `outer` has to be taken along the rates of the inner values.
    #[inline]
    pub fn compose<const K: usize>(outer: &Jet<K, ORDER>, inner: &[Self; K]) -> Self {
        let mut jet = Self::constant(outer.value);
        for (a, g) in inner.iter().enumerate() {
            jet.gradient += g.gradient * outer.gradient[a];
            if ORDER >= 2 {
                jet.hessian += g.hessian * outer.gradient[a];
            }
            if ORDER >= 3 {
                jet.gradient_w +=
                    g.gradient_w * outer.gradient[a] + g.gradient * outer.gradient_w[a];
                jet.hessian_w += g.hessian_w * outer.gradient[a] + g.hessian * outer.gradient_w[a];
            }
        }
        if ORDER >= 3 {
            jet.value_w = outer.value_w;
        }
        if ORDER >= 2 {
            for a in 0..K {
                let mut row = SVector::<f64, M>::zeros();
                let mut row_w = SVector::<f64, M>::zeros();
                for (b, g) in inner.iter().enumerate() {
                    row += g.gradient * outer.hessian[(a, b)];
                    if ORDER >= 3 {
                        row_w += g.gradient * outer.hessian_w[(a, b)]
                            + g.gradient_w * outer.hessian[(a, b)];
                    }
                }
                jet.hessian += inner[a].gradient * row.transpose();
                if ORDER >= 3 {
                    jet.hessian_w += inner[a].gradient * row_w.transpose()
                        + inner[a].gradient_w * row.transpose();
                }
            }
        }
        jet
    }
}

impl<const M: usize, const ORDER: usize> Add for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn add(mut self, other: Self) -> Self {
        self.value += other.value;
        self.gradient += other.gradient;
        if ORDER >= 2 {
            self.hessian += other.hessian;
        }
        if ORDER >= 3 {
            self.value_w += other.value_w;
            self.gradient_w += other.gradient_w;
            self.hessian_w += other.hessian_w;
        }
        self
    }
}

impl<const M: usize, const ORDER: usize> Add<f64> for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn add(mut self, constant: f64) -> Self {
        self.value += constant;
        self
    }
}

impl<const M: usize, const ORDER: usize> Sub for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const M: usize, const ORDER: usize> Neg for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl<const M: usize, const ORDER: usize> Mul<f64> for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn mul(mut self, factor: f64) -> Self {
        self.value *= factor;
        self.gradient *= factor;
        if ORDER >= 2 {
            self.hessian *= factor;
        }
        if ORDER >= 3 {
            self.value_w *= factor;
            self.gradient_w *= factor;
            self.hessian_w *= factor;
        }
        self
    }
}

impl<const M: usize, const ORDER: usize> Mul for Jet<M, ORDER> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let (f, g) = (&self, &other);
        let mut jet = Self::constant(f.value * g.value);
        jet.gradient = f.gradient * g.value + g.gradient * f.value;
        if ORDER >= 2 {
            let cross = f.gradient * g.gradient.transpose();
            jet.hessian = f.hessian * g.value + g.hessian * f.value + cross + cross.transpose();
        }
        if ORDER >= 3 {
            let cross =
                f.gradient_w * g.gradient.transpose() + f.gradient * g.gradient_w.transpose();
            jet.value_w = f.value_w * g.value + f.value * g.value_w;
            jet.gradient_w = f.gradient_w * g.value
                + f.gradient * g.value_w
                + g.gradient_w * f.value
                + g.gradient * f.value_w;
            jet.hessian_w = f.hessian_w * g.value
                + f.hessian * g.value_w
                + g.hessian_w * f.value
                + g.hessian * f.value_w
                + cross
                + cross.transpose();
        }
        jet
    }
}
