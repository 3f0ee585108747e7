//! Small nonlinear programs written out by hand, and one made of closures.

#![allow(dead_code, reason = "each test file uses some of them")]

use proboscis::nlp::{Bounds, Entries, Nlp};

type Objective = Box<dyn FnMut(&[f64]) -> f64 + Send>;
type Values = Box<dyn FnMut(&[f64], &mut [f64]) + Send>;
type HessianValues = Box<dyn FnMut(&[f64], f64, &[f64], &mut [f64]) + Send>;

/// A program given by its parts.
pub(crate) struct Program {
    pub(crate) variables: Bounds,
    pub(crate) constraints: Bounds,
    pub(crate) jacobian_places: Vec<(u32, u32)>,
    pub(crate) hessian_places: Vec<(u32, u32)>,
    pub(crate) f: Objective,
    pub(crate) grad: Values,
    pub(crate) g: Values,
    pub(crate) jac: Values,
    pub(crate) hess: HessianValues,
}

fn entries(places: &[(u32, u32)]) -> Entries {
    let (rows, cols) = places.iter().copied().unzip();
    Entries { rows, cols }
}

impl Nlp for Program {
    fn variables(&self) -> &Bounds {
        &self.variables
    }
    fn constraints(&self) -> &Bounds {
        &self.constraints
    }
    fn jacobian_structure(&self) -> Entries {
        entries(&self.jacobian_places)
    }
    fn hessian_structure(&self) -> Entries {
        entries(&self.hessian_places)
    }
    fn objective(&mut self, x: &[f64]) -> f64 {
        (self.f)(x)
    }
    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        (self.grad)(x, grad);
    }
    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        (self.g)(x, g);
    }
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        (self.jac)(x, values);
    }
    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        (self.hess)(x, sigma, costates, values);
    }
}

/// Bounds from pairs.
pub(crate) fn bounds(pairs: &[(f64, f64)]) -> Bounds {
    let (lower, upper) = pairs.iter().copied().unzip();
    Bounds { lower, upper }
}

/// Problem 71 of Hock and Schittkowski (1981): minimise x₁x₄(x₁+x₂+x₃)+x₃ with x₁x₂x₃x₄ ≥ 25, Σxᵢ² = 40, 1 ≤ xᵢ ≤ 5.
pub(crate) fn hs071() -> Program {
    Program {
        variables: bounds(&[(1.0, 5.0); 4]),
        constraints: bounds(&[(25.0, f64::INFINITY), (40.0, 40.0)]),
        jacobian_places: (0..2).flat_map(|i| (0..4).map(move |j| (i, j))).collect(),
        hessian_places: (0..4).flat_map(|i| (0..=i).map(move |j| (i, j))).collect(),
        f: Box::new(|x| x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]),
        grad: Box::new(|x, grad| {
            grad[0] = x[3] * (2.0 * x[0] + x[1] + x[2]);
            grad[1] = x[0] * x[3];
            grad[2] = x[0] * x[3] + 1.0;
            grad[3] = x[0] * (x[0] + x[1] + x[2]);
        }),
        g: Box::new(|x, g| {
            g[0] = x[0] * x[1] * x[2] * x[3];
            g[1] = x.iter().map(|x| x * x).sum();
        }),
        jac: Box::new(|x, values| {
            for j in 0..4 {
                values[j] = (0..4).filter(|&k| k != j).map(|k| x[k]).product();
                values[4 + j] = 2.0 * x[j];
            }
        }),
        hess: Box::new(|x, sigma, y, values| {
            let objective = [
                2.0 * x[3],
                x[3],
                0.0,
                x[3],
                0.0,
                0.0,
                2.0 * x[0] + x[1] + x[2],
                x[0],
                x[0],
                0.0,
            ];
            let mut place = 0;
            for i in 0..4 {
                for j in 0..=i {
                    let product: f64 = (0..4).filter(|&k| k != i && k != j).map(|k| x[k]).product();
                    let curvature = if i == j { 2.0 * y[1] } else { y[0] * product };
                    values[place] = sigma * objective[place] + curvature;
                    place += 1;
                }
            }
        }),
    }
}

/// Starting point of [`hs071`].
pub(crate) const HS071_START: [f64; 4] = [1.0, 5.0, 5.0, 1.0];
/// Optimal value of [`hs071`], as published.
pub(crate) const HS071_OPTIMUM: f64 = 17.014_017_3;

/// Minimise the Rosenbrock function (1−x)² + 100 (y−x²)² where x + y = 2 (its own minimiser (1, 1)).
pub(crate) fn rosenbrock() -> Program {
    Program {
        variables: bounds(&[(f64::NEG_INFINITY, f64::INFINITY); 2]),
        constraints: bounds(&[(2.0, 2.0)]),
        jacobian_places: vec![(0, 0), (0, 1)],
        // The diagonal is listed in two parts: duplicates count as a sum.
        hessian_places: vec![(0, 0), (0, 0), (1, 0), (1, 1)],
        f: Box::new(|x| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2)),
        grad: Box::new(|x, grad| {
            let r = x[1] - x[0] * x[0];
            grad[0] = -2.0 * (1.0 - x[0]) - 400.0 * x[0] * r;
            grad[1] = 200.0 * r;
        }),
        g: Box::new(|x, g| g[0] = x[0] + x[1]),
        jac: Box::new(|_, values| values.fill(1.0)),
        hess: Box::new(|x, sigma, _, values| {
            values[0] = 2.0 * sigma;
            values[1] = sigma * (1200.0 * x[0] * x[0] - 400.0 * x[1]);
            values[2] = -400.0 * sigma * x[0];
            values[3] = 200.0 * sigma;
        }),
    }
}

/// A program in one variable without constraints, from f, f′ and f″.
pub(crate) fn one_variable(
    bound: (f64, f64),
    f: fn(f64) -> f64,
    slope: fn(f64) -> f64,
    curvature: fn(f64) -> f64,
) -> Program {
    Program {
        variables: bounds(&[bound]),
        constraints: Bounds::default(),
        jacobian_places: vec![],
        hessian_places: vec![(0, 0)],
        f: Box::new(move |x| f(x[0])),
        grad: Box::new(move |x, grad| grad[0] = slope(x[0])),
        g: Box::new(|_, _| ()),
        jac: Box::new(|_, _| ()),
        hess: Box::new(move |x, sigma, _, values| values[0] = sigma * curvature(x[0])),
    }
}
