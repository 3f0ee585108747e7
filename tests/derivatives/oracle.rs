//! Derivatives of naive formulas by nested dual numbers; of sums over the points of an element by the chain rule.

use num_dual::{Dual, Dual64, HyperDual};

/// Number of which one evaluation of a formula knows f, ∂f/∂pᵢ, ∂²f/∂pᵢ∂pⱼ and their rates.
pub(crate) type Number = HyperDual<Dual64, f64>;

/// A flat copy of what an element writes: value, gradient, Hessian of its arguments.
pub(crate) struct Flat {
    pub(crate) value: f64,
    pub(crate) gradient: Vec<f64>,
    pub(crate) hessian: Vec<Vec<f64>>,
}

impl Flat {
    pub(crate) fn zeros(n: usize) -> Self {
        Self {
            value: 0.0,
            gradient: vec![0.0; n],
            hessian: vec![vec![0.0; n]; n],
        }
    }

    /// Adds a multiple.
    fn add(&mut self, factor: f64, other: &Self) {
        self.value += factor * other.value;
        let rows = self.hessian.iter_mut().zip(&other.hessian);
        let gradients = (&mut self.gradient, &other.gradient);
        for (row, other) in rows.chain([gradients]) {
            for (entry, other) in row.iter_mut().zip(other) {
                *entry += factor * other;
            }
        }
    }

    /// Adds a multiple of the symmetric part of the product of two gradients to the Hessian.
    fn add_product(&mut self, factor: f64, a: &[f64], b: &[f64]) {
        for (r, row) in self.hessian.iter_mut().enumerate() {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry += 0.5 * factor * (a[r] * b[c] + a[c] * b[r]);
            }
        }
    }
}

/// Value, gradient and Hessian of a formula, and their rates along `w`.
pub(crate) fn oracle(p: &[f64], w: &[f64], f: impl Fn(&[Number]) -> Number) -> (Flat, Flat) {
    let n = p.len();
    let (mut plain, mut along) = (Flat::zeros(n), Flat::zeros(n));
    let number = |on: bool| Dual::new(f64::from(on), 0.0);
    for r in 0..n {
        for c in 0..=r {
            let arguments: Vec<_> = (0..n)
                .map(|k| {
                    let value = Dual64::new(p[k], w[k]);
                    HyperDual::new(value, number(k == r), number(k == c), number(false))
                })
                .collect();
            let result = f(&arguments);
            for (out, part) in [
                (&mut plain, (|d: Dual64| d.re) as fn(Dual64) -> f64),
                (&mut along, |d: Dual64| d.eps),
            ] {
                out.value = part(result.re);
                out.gradient[r] = part(result.eps1);
                out.hessian[r][c] = part(result.eps1eps2);
                out.hessian[c][r] = part(result.eps1eps2);
            }
        }
    }
    (plain, along)
}

/// A linear combination of arguments: their places and factors.
pub(crate) type Combination = Vec<(usize, f64)>;

/// The same of a sum of functions, each of a few linear combinations of all arguments.
pub(crate) fn oracle_of_sum(
    p: &[f64],
    w: &[f64],
    combinations: &[Vec<Combination>],
    f: impl Fn(usize, &[Number]) -> Number,
) -> (Flat, Flat) {
    let mut sums = [Flat::zeros(p.len()), Flat::zeros(p.len())];
    for (k, own) in combinations.iter().enumerate() {
        let read = |all: &[f64]| -> Vec<f64> {
            let value = |one: &Combination| one.iter().map(|&(i, factor)| factor * all[i]).sum();
            own.iter().map(value).collect()
        };
        let (plain, along) = oracle(&read(p), &read(w), |q| f(k, q));
        for (sum, part) in sums.iter_mut().zip([plain, along]) {
            sum.value += part.value;
            for (a, row) in own.iter().enumerate() {
                for &(r, factor) in row {
                    sum.gradient[r] += factor * part.gradient[a];
                    for (b, column) in own.iter().enumerate() {
                        let entry = factor * part.hessian[a][b];
                        for &(c, factor) in column {
                            sum.hessian[r][c] += factor * entry;
                        }
                    }
                }
            }
        }
    }
    let [plain, along] = sums;
    (plain, along)
}

/// The same of a function of a sum.
pub(crate) fn oracle_of_outer(
    (plain, along): &(Flat, Flat),
    f: impl Fn(Number) -> Number,
) -> (Flat, Flat) {
    let n = plain.gradient.len();
    let (outer, rate) = oracle(&[plain.value], &[along.value], |p| f(p[0]));
    let [first, second] = [outer.gradient[0], outer.hessian[0][0]];
    let [first_rate, second_rate] = [rate.gradient[0], rate.hessian[0][0]];
    let (mut own, mut own_rate) = (Flat::zeros(n), Flat::zeros(n));
    own.add(first, plain);
    own.add_product(second, &plain.gradient, &plain.gradient);
    own_rate.add(first, along);
    own_rate.add(first_rate, plain);
    own_rate.add_product(2.0 * second, &plain.gradient, &along.gradient);
    own_rate.add_product(second_rate, &plain.gradient, &plain.gradient);
    (own.value, own_rate.value) = (outer.value, rate.value);
    (own, own_rate)
}

/// The sum of two functions.
pub(crate) fn added(mut a: (Flat, Flat), b: &(Flat, Flat)) -> (Flat, Flat) {
    a.0.add(1.0, &b.0);
    a.1.add(1.0, &b.1);
    a
}
