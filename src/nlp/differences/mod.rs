//! Checks the derivatives of a nonlinear program against central differences.
//!
//! The gradient is compared with differences of f, the Jacobian with differences of g, and the Hessian with differences of
//! the gradient of the Lagrangian, σ ∇f + Σ yᵢ ∇gᵢ, for random σ and y away from one: a Hessian that ignores σ or the size
//! of y shows. Every pair of row and column is checked, so an entry missing in the structure shows too.
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
//!
//! An entry above the tolerance is compared with the difference of a second step, eight times shorter, before it is called
//! wrong. The part h² of a difference is then 64 times smaller and its rounding eight times larger, so that the two
//! differences are apart by about what each is off; a wrong entry is off by the same from both.

mod comparison;

use crate::math::Random;
use crate::nlp::{Entries, Nlp};

use comparison::Comparison;
pub use comparison::TOLERANCE;
pub use comparison::{EntryStatus, Matrix, Report, WrongEntry};

/// The first step of a difference over the second one.
const SHORTER: f64 = 8.0;

/// Wrong entries listed in a report.
const LISTED: usize = 20;

/// The variables along which differences are taken.
#[derive(Clone, Copy, Debug)]
pub struct DifferenceVariables<'a> {
    /// The variables, ascending.
    pub columns: &'a [usize],
    /// The size of every variable of the program: a change of that size matters.
    pub sizes: &'a [f64],
}

/// Compares all derivatives of `nlp` at `x` with central differences; `seed` picks σ and y.
///
/// The cost is two evaluations of f, ∇f, g and ∇g per variable.
///
/// # Panics
///
/// If `x` has the wrong length, or if an entry of a structure lies outside its matrix or above the diagonal of the Hessian.
pub fn check(nlp: &mut dyn Nlp, x: &[f64], seed: u64) -> Report {
    let (columns, sizes) = ((0..x.len()).collect::<Vec<_>>(), vec![1.0; x.len()]);
    let along = DifferenceVariables {
        columns: &columns,
        sizes: &sizes,
    };
    check_along(nlp, x, along, seed, || false)
}

/// Compares like [`check`] the derivatives by some variables, each with steps of its size; those left when `stop` says so
/// are counted.
///
/// # Panics
///
/// As [`check`], or if a size is missing.
pub fn check_along(
    nlp: &mut dyn Nlp,
    x: &[f64],
    DifferenceVariables { columns, sizes }: DifferenceVariables<'_>,
    seed: u64,
    mut stop: impl FnMut() -> bool,
) -> Report {
    let (n, m) = (nlp.variables().count(), nlp.constraints().count());
    assert_eq!(x.len(), n, "one value per variable");
    assert_eq!(sizes.len(), n, "one size per variable");
    let random = &mut Random::new(seed);
    let sigma = in_half_to_two(random);
    let costates: Vec<f64> = (0..m)
        .map(|_| in_half_to_two(random) * sign(random))
        .collect();

    let lagrangian = Lagrangian {
        sigma,
        costates,
        jacobian: nlp.jacobian_structure(),
    };
    let mut report = Report::default();
    let Some(mut derivatives) = Derivatives::at(nlp, &lagrangian, x, &mut stop) else {
        report.left = columns.len();
        return report;
    };
    let step = |j: usize| f64::EPSILON.cbrt() * sizes[j] * x[j].abs().max(1.0);
    for &j in columns {
        if stop() {
            report.left += 1;
            continue;
        }
        let Some(slope) = Slope::along(nlp, &lagrangian, x, j, step(j)) else {
            report.unchecked.push(nlp.variable_name(j));
            continue;
        };
        report.checked += 1;
        derivatives.compare(j, &slope);
    }
    for j in derivatives.doubted() {
        if let Some(slope) = Slope::along(nlp, &lagrangian, x, j, step(j) / SHORTER) {
            derivatives.compare_again(j, &slope);
        }
    }
    derivatives.judge(nlp, &mut report);
    report
}

/// The derivatives of a program at a point, compared with differences.
struct Derivatives([(Matrix, Comparison); 3]);

impl Derivatives {
    /// Evaluates them; `None` where `stop` says so before they are all there.
    fn at(
        nlp: &mut dyn Nlp,
        lagrangian: &Lagrangian,
        x: &[f64],
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let mut go_on = || (!stop()).then_some(());
        go_on()?;
        let here = DirectionSample::at(nlp, lagrangian, x);
        go_on()?;
        let mut hessian = vec![0.0; nlp.hessian_structure().count()];
        nlp.hessian(x, lagrangian.sigma, &lagrangian.costates, &mut hessian);
        go_on()?;
        let n = x.len();
        let row = Entries {
            rows: vec![0; n],
            cols: (0..).take(n).collect(),
        };
        let terms = vec![here.objective.abs()];
        let mut gradient = Comparison::new(&row, &here.gradient, terms, n);
        gradient.add_linear_terms(x);
        let terms = here.constraints.iter().map(|g| g.abs()).collect();
        let mut jacobian = Comparison::new(&lagrangian.jacobian, &here.jacobian, terms, n);
        jacobian.add_linear_terms(x);
        go_on()?;
        let terms = lagrangian.term_sizes(&here);
        let hessian = Comparison::new(&nlp.hessian_structure(), &hessian, terms, n);
        Some(Self([
            (Matrix::Gradient, gradient),
            (Matrix::Jacobian, jacobian),
            (Matrix::Hessian, hessian),
        ]))
    }

    /// Compares the entries of column j.
    fn compare(&mut self, j: usize, slope: &Slope) {
        for (matrix, of) in &mut self.0 {
            let first = if *matrix == Matrix::Hessian { j } else { 0 };
            of.compare(j, first, |i| slope.of(*matrix, i));
        }
    }

    /// Columns with an entry above the tolerance, ascending.
    fn doubted(&self) -> Vec<usize> {
        let mut doubted: Vec<usize> = self.0.iter().flat_map(|(_, of)| of.doubted()).collect();
        doubted.sort_unstable();
        doubted.dedup();
        doubted
    }

    /// Compares the doubted entries of column j with a shorter step.
    fn compare_again(&mut self, j: usize, slope: &Slope) {
        for (matrix, of) in &mut self.0 {
            of.compare_again(j, |i| slope.of(*matrix, i));
        }
    }

    /// Reports the greatest errors and the wrong entries.
    fn judge(&self, nlp: &dyn Nlp, report: &mut Report) {
        for (matrix, of) in &self.0 {
            let name = |i: usize| match matrix {
                Matrix::Gradient => "objective".to_owned(),
                Matrix::Jacobian => nlp.constraint_name(i),
                Matrix::Hessian => nlp.variable_name(i),
            };
            let greatest = of.judge(*matrix, name, nlp, &mut report.wrong);
            match matrix {
                Matrix::Gradient => report.gradient = greatest,
                Matrix::Jacobian => report.jacobian = greatest,
                Matrix::Hessian => report.hessian = greatest,
            }
        }
        let wrong = &mut report.wrong;
        wrong.sort_by(|a, b| b.error.total_cmp(&a.error));
        wrong.truncate(LISTED);
    }
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
        let y = &self.costates;
        self.jacobian.add_transposed(jacobian, y, &mut sum);
        sum
    }

    /// Sum of the sizes of the terms in each entry of its gradient.
    fn term_sizes(&self, here: &DirectionSample) -> Vec<f64> {
        let terms = here.gradient.iter();
        let mut sum: Vec<f64> = terms.map(|value| (self.sigma * value).abs()).collect();
        for (row, col, value) in self.jacobian.with(&here.jacobian) {
            sum[col] += (self.costates[row] * value).abs();
        }
        sum
    }
}

/// All values at one point.
struct DirectionSample {
    objective: f64,
    gradient: Vec<f64>,
    constraints: Vec<f64>,
    jacobian: Vec<f64>,
    lagrangian: Vec<f64>,
}

impl DirectionSample {
    fn at(nlp: &mut dyn Nlp, lagrangian: &Lagrangian, x: &[f64]) -> Self {
        let objective = nlp.objective(x);
        let mut gradient = vec![0.0; x.len()];
        nlp.gradient(x, &mut gradient);
        let mut constraints = vec![0.0; lagrangian.costates.len()];
        nlp.constraint(x, &mut constraints);
        let mut jacobian = vec![0.0; lagrangian.jacobian.count()];
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
        let mut values = self.constraints.iter().chain(&self.lagrangian);
        self.objective.is_finite() && values.all(|value| value.is_finite())
    }
}

/// Central differences along one variable.
struct Slope {
    ahead: DirectionSample,
    behind: DirectionSample,
    width: f64,
}

impl Slope {
    /// Over a step to both sides; `None` where a value does not exist there.
    fn along(
        nlp: &mut dyn Nlp,
        lagrangian: &Lagrangian,
        x: &[f64],
        j: usize,
        step: f64,
    ) -> Option<Self> {
        let mut moved = x.to_vec();
        moved[j] = x[j] + step;
        let (end, ahead) = (moved[j], DirectionSample::at(nlp, lagrangian, &moved));
        moved[j] = x[j] - step;
        let behind = DirectionSample::at(nlp, lagrangian, &moved);
        let width = end - moved[j];
        (ahead.exists() && behind.exists()).then_some(Self {
            ahead,
            behind,
            width,
        })
    }

    /// Of the value whose derivatives are in row i of a matrix.
    fn of(&self, matrix: Matrix, i: usize) -> f64 {
        let value = |of: &DirectionSample| match matrix {
            Matrix::Gradient => of.objective,
            Matrix::Jacobian => of.constraints[i],
            Matrix::Hessian => of.lagrangian[i],
        };
        (value(&self.ahead) - value(&self.behind)) / self.width
    }
}

/// A number in [½, 2), whose logarithm is even about zero, so that it is rarely close to one.
fn in_half_to_two(random: &mut Random) -> f64 {
    random.between(-1.0, 1.0).exp2()
}

fn sign(random: &mut Random) -> f64 {
    match random.between(0.0, 1.0) < 0.5 {
        true => 1.0,
        false => -1.0,
    }
}
