//! Checks the derivatives of a nonlinear program against central differences.
//!
//! The gradient is compared with differences of f, the Jacobian with differences of g, and the Hessian with differences of
//! the gradient of the Lagrangian, σ ∇f + Σ yᵢ ∇gᵢ, for random σ and y away from one: a Hessian that ignores σ or the size
//! of y shows. Every pair of row and column is looked at, so an entry missing in the structure shows too.
//!
//! # What an error is relative to
//!
//! A difference a ≈ d at column j with step h = ε^⅓ max(1, |xⱼ|) carries a rounding error of about ε t/h ≈ 4e-11 t, where t is the
//! size of the terms that the differenced value is the sum of: |gᵢ| + Σⱼ |aᵢⱼ xⱼ| for a constraint, σ |∇fᵢ| + Σₖ |yₖ ∇gₖᵢ| for
//! the gradient of the Lagrangian. It also carries h²/6 times a third derivative, which is small if the problem is scaled.
//! So the error of an entry is
//!
//! ```text
//! |a − d| / max(|a|, |d|, (r + t)/1000),    r = largest entry of the row
//! ```
//!
//! Rounding alone then stays near 4e-8, a wrong entry counts fully if it is not a thousand times smaller than its
//! row, and one a million times smaller still counts 1e-3: [`TOLERANCE`] lies between.

mod comparison;
mod report;

use crate::nlp::{Entries, Nlp};

use comparison::Comparison;
pub use report::{Matrix, Place, Report, WrongEntry};

/// Relative error above which an entry is taken for wrong.
pub const TOLERANCE: f64 = 1e-5;

/// Wrong entries listed in a report.
const LISTED: usize = 20;

/// Compares all derivatives of `nlp` at `x` with central differences; `seed` picks σ and y.
///
/// The cost is two evaluations of f, ∇f, g and ∇g per variable.
///
/// # Panics
///
/// If `x` has the wrong length, or if an entry of a structure lies outside its matrix or above the diagonal of the Hessian.
pub fn check(nlp: &mut dyn Nlp, x: &[f64], seed: u64) -> Report {
    let (n, m) = (nlp.variables().lower.len(), nlp.constraints().lower.len());
    assert_eq!(x.len(), n, "one value per variable");
    let mut random = SplitMix64(seed);
    let sigma = random.in_half_to_two();
    let costates: Vec<f64> = (0..m)
        .map(|_| random.in_half_to_two() * random.sign())
        .collect();

    let lagrangian = Lagrangian {
        sigma,
        costates,
        jacobian: nlp.jacobian_structure(),
    };
    let here = Sample::at(nlp, &lagrangian, x);
    let mut hessian = vec![0.0; nlp.hessian_structure().rows.len()];
    nlp.hessian(x, lagrangian.sigma, &lagrangian.costates, &mut hessian);

    let gradient_places = Entries {
        rows: vec![0; n],
        cols: (0..).take(n).collect(),
    };
    let mut gradient = Comparison::new(
        &gradient_places,
        &here.gradient,
        vec![here.objective.abs()],
        n,
    );
    gradient.add_linear_terms(x);
    let sizes = here.constraints.iter().map(|g| g.abs()).collect();
    let mut jacobian = Comparison::new(&lagrangian.jacobian, &here.jacobian, sizes, n);
    jacobian.add_linear_terms(x);
    let sizes = lagrangian.term_sizes(&here);
    let mut hessian = Comparison::new(&nlp.hessian_structure(), &hessian, sizes, n);

    let mut report = Report::default();
    let mut moved = x.to_vec();
    for j in 0..n {
        let step = f64::EPSILON.cbrt() * x[j].abs().max(1.0);
        moved[j] = x[j] + step;
        let (ahead, at_ahead) = (moved[j], Sample::at(nlp, &lagrangian, &moved));
        moved[j] = x[j] - step;
        let (behind, at_behind) = (moved[j], Sample::at(nlp, &lagrangian, &moved));
        moved[j] = x[j];
        if !(at_ahead.exists() && at_behind.exists()) {
            report.unchecked.push(nlp.variable_name(j));
            continue;
        }
        let slope =
            |ahead_value: f64, behind_value: f64| (ahead_value - behind_value) / (ahead - behind);
        gradient.compare(j, 0, |_| slope(at_ahead.objective, at_behind.objective));
        jacobian.compare(j, 0, |i| {
            slope(at_ahead.constraints[i], at_behind.constraints[i])
        });
        hessian.compare(j, j, |i| {
            slope(at_ahead.lagrangian[i], at_behind.lagrangian[i])
        });
    }

    report.gradient = gradient.judge(
        Matrix::Gradient,
        |_| "objective".to_owned(),
        nlp,
        &mut report.wrong,
    );
    report.jacobian = jacobian.judge(
        Matrix::Jacobian,
        |i| nlp.constraint_name(i),
        nlp,
        &mut report.wrong,
    );
    report.hessian = hessian.judge(
        Matrix::Hessian,
        |i| nlp.variable_name(i),
        nlp,
        &mut report.wrong,
    );
    report.wrong.sort_by(|a, b| b.error.total_cmp(&a.error));
    report.wrong.truncate(LISTED);
    report
}

/// σ f + Σ yᵢ gᵢ.
struct Lagrangian {
    sigma: f64,
    costates: Vec<f64>,
    jacobian: Entries,
}

impl Lagrangian {
    /// Its gradient, from those of f and g.
    fn gradient(&self, gradient: &[f64], jacobian: &[f64]) -> Vec<f64> {
        let mut sum: Vec<f64> = gradient.iter().map(|value| self.sigma * value).collect();
        for ((&row, &col), value) in self
            .jacobian
            .rows
            .iter()
            .zip(&self.jacobian.cols)
            .zip(jacobian)
        {
            sum[col as usize] += self.costates[row as usize] * value;
        }
        sum
    }

    /// Sum of the sizes of the terms in each entry of its gradient.
    fn term_sizes(&self, here: &Sample) -> Vec<f64> {
        let mut sum: Vec<f64> = here
            .gradient
            .iter()
            .map(|value| (self.sigma * value).abs())
            .collect();
        for ((&row, &col), value) in self
            .jacobian
            .rows
            .iter()
            .zip(&self.jacobian.cols)
            .zip(&here.jacobian)
        {
            sum[col as usize] += (self.costates[row as usize] * value).abs();
        }
        sum
    }
}

/// All values at one point.
struct Sample {
    objective: f64,
    gradient: Vec<f64>,
    constraints: Vec<f64>,
    jacobian: Vec<f64>,
    lagrangian: Vec<f64>,
}

impl Sample {
    fn at(nlp: &mut dyn Nlp, lagrangian: &Lagrangian, x: &[f64]) -> Self {
        let objective = nlp.objective(x);
        let mut gradient = vec![0.0; x.len()];
        nlp.gradient(x, &mut gradient);
        let mut constraints = vec![0.0; lagrangian.costates.len()];
        nlp.constraint(x, &mut constraints);
        let mut jacobian = vec![0.0; lagrangian.jacobian.rows.len()];
        nlp.jacobian(x, &mut jacobian);
        let lagrangian = lagrangian.gradient(&gradient, &jacobian);
        Self {
            objective,
            gradient,
            constraints,
            jacobian,
            lagrangian,
        }
    }

    fn exists(&self) -> bool {
        let values = [self.objective];
        values
            .iter()
            .chain(&self.constraints)
            .chain(&self.lagrangian)
            .all(|value| value.is_finite())
    }
}

/// The generator `splitmix64` of S. Vigna (public domain).
struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [½, 2), whose logarithm is even about zero, so that it is rarely close to one.
    fn in_half_to_two(&mut self) -> f64 {
        let unit = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        (2.0 * unit - 1.0).exp2()
    }

    fn sign(&mut self) -> f64 {
        if self.next() >> 63 == 0 { 1.0 } else { -1.0 }
    }
}
