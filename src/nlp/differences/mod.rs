//! Checks the derivatives of a nonlinear program against central differences.
//!
//! The gradient is compared with differences of f, the Jacobian with differences of g, and the Hessian with differences of
//! the gradient of the Lagrangian, σ ∇f + Σ yᵢ ∇gᵢ, for random σ and y away from one: a Hessian that ignores σ or the size
//! of y shows. Every pair of row and column is checked, so an entry missing in the structure shows too. Variables of which no row
//! reads two are moved at once; those of a group that shows a doubtful entry are moved once more, one by one.
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
mod pattern;

use crate::math::Random;
use crate::nlp::{Entries, Nlp};

use comparison::Comparison;
pub use comparison::TOLERANCE;
pub use comparison::{EntryStatus, Matrix, Report, WrongEntry};
use pattern::Pattern;

/// The first step of a difference over the second one.
const SHORTER: f64 = 8.0;

/// Wrong entries listed in a report.
const LISTED: usize = 20;

/// Compares all derivatives of `nlp` at `x` with central differences; `seed` picks σ and y.
///
/// The cost is two evaluations of f per variable, and of ∇f, g and ∇g per group of variables of which no row reads two.
///
/// # Panics
///
/// If `x` has the wrong length, or if an entry of a structure lies outside its matrix or above the diagonal of the Hessian.
pub fn check(nlp: &mut dyn Nlp, x: &[f64], seed: u64) -> Report {
    check_with_sizes(nlp, x, &vec![1.0; x.len()], seed, || false)
}

/// Compares derivatives like [`check`], with steps of the size of each variable: a change of that size matters. Variables left when `stop`
/// says so are counted.
///
/// # Panics
///
/// As [`check`], or if a size is missing.
pub fn check_with_sizes(
    nlp: &mut dyn Nlp,
    x: &[f64],
    sizes: &[f64],
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
    let pattern = Pattern::new(&lagrangian.jacobian, &nlp.hessian_structure(), n);
    let mut report = Report::default();
    let Some(mut derivatives) = Derivatives::at(nlp, &lagrangian, x, &mut stop) else {
        report.left = n;
        return report;
    };
    let step = |j: usize| f64::EPSILON.cbrt() * sizes[j] * x[j].abs().max(1.0);
    let mut groups = pattern.groups(m);
    while !groups.is_empty() {
        let (mut compared, mut alone) = (Vec::new(), Vec::new());
        for group in groups {
            if stop() {
                report.left += group.len();
                continue;
            }
            let slopes = Slopes::along(nlp, &lagrangian, x, &group, step);
            match slopes.is_some_and(|slopes| derivatives.compare(&pattern, &group, &slopes)) {
                true => compared.push(group),
                false if group.len() == 1 => report.unchecked.push(nlp.variable_name(group[0])),
                false => alone.extend(group),
            }
        }
        let doubted = derivatives.doubted();
        let is_doubted = |j: &usize| doubted.binary_search(j).is_ok();
        compared.retain(|group: &Vec<usize>| group.len() > 1 && group.iter().any(is_doubted));
        alone.extend(compared.into_iter().flatten());
        alone.sort_unstable();
        derivatives.forget(&alone);
        groups = alone.into_iter().map(|j| vec![j]).collect();
    }
    report.checked = n - report.left - report.unchecked.len();
    for j in derivatives.doubted() {
        let shorter = |j: usize| step(j) / SHORTER;
        if let Some(slopes) = Slopes::along(nlp, &lagrangian, x, &[j], shorter) {
            derivatives.compare_again(j, &slopes);
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
        let mut whole = nlp.hessian_structure();
        pattern::mirror(&mut whole, &mut hessian);
        let hessian = Comparison::new(&whole, &hessian, terms, n);
        Some(Self([
            (Matrix::Gradient, gradient),
            (Matrix::Jacobian, jacobian),
            (Matrix::Hessian, hessian),
        ]))
    }

    /// Compares the entries of a group of columns; false, and none is compared, where a value changes that reads none of several.
    fn compare(&mut self, pattern: &Pattern, group: &[usize], slopes: &Slopes) -> bool {
        let is_alone = group.len() == 1;
        let mut rows = self.0[1..].iter();
        let is_unread = |(matrix, of): &(Matrix, Comparison)| {
            of.unread(group, |i| slopes.change(*matrix, 0, i) != 0.0)
        };
        if !is_alone && rows.any(is_unread) {
            return false;
        }
        for (member, &j) in group.iter().enumerate() {
            for (matrix, of) in &mut self.0 {
                let is_compared = |i| *matrix != Matrix::Hessian || pattern.is_along(j, i);
                let slope = |i| slopes.of(*matrix, member, i);
                of.compare(j, is_alone, is_compared, slope);
            }
        }
        true
    }

    /// Takes back the comparison of columns, ascending.
    fn forget(&mut self, columns: &[usize]) {
        self.0.iter_mut().for_each(|(_, of)| of.forget(columns));
    }

    /// Columns with an entry above the tolerance, ascending.
    fn doubted(&self) -> Vec<usize> {
        let mut doubted: Vec<usize> = self.0.iter().flat_map(|(_, of)| of.doubted()).collect();
        doubted.sort_unstable();
        doubted.dedup();
        doubted
    }

    /// Compares the doubted entries of column j with a shorter step.
    fn compare_again(&mut self, j: usize, slopes: &Slopes) {
        for (matrix, of) in &mut self.0 {
            of.compare_again(j, |i| slopes.of(*matrix, 0, i));
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

/// Central differences along the variables of a group.
struct Slopes {
    ahead: DirectionSample,
    behind: DirectionSample,
    /// Change of f along each variable by itself.
    objective: Vec<f64>,
    /// Width of the step along each variable.
    width: Vec<f64>,
}

impl Slopes {
    /// Over steps to both sides; `None` where a value does not exist there.
    fn along(
        nlp: &mut dyn Nlp,
        lagrangian: &Lagrangian,
        x: &[f64],
        group: &[usize],
        step: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let moved = |group: &[usize], sign: f64| {
            let mut moved = x.to_vec();
            group.iter().for_each(|&j| moved[j] += sign * step(j));
            moved
        };
        let ends = [1.0, -1.0].map(|sign| moved(group, sign));
        let width = group.iter().map(|&j| ends[0][j] - ends[1][j]).collect();
        let [ahead, behind] = ends.map(|end| DirectionSample::at(nlp, lagrangian, &end));
        let objective = match group {
            [_] => vec![ahead.objective - behind.objective],
            _ => {
                let mut at = |j: usize, sign| nlp.objective(&moved(&[j], sign));
                let change = |&j: &usize| at(j, 1.0) - at(j, -1.0);
                group.iter().map(change).collect()
            }
        };
        (ahead.exists() && behind.exists()).then_some(Self {
            ahead,
            behind,
            objective,
            width,
        })
    }

    /// Change of the value whose derivatives are in row i of a matrix, along a member of the group.
    fn change(&self, matrix: Matrix, member: usize, i: usize) -> f64 {
        match matrix {
            Matrix::Gradient => self.objective[member],
            Matrix::Jacobian => self.ahead.constraints[i] - self.behind.constraints[i],
            Matrix::Hessian => self.ahead.lagrangian[i] - self.behind.lagrangian[i],
        }
    }

    /// Difference quotient of that value.
    fn of(&self, matrix: Matrix, member: usize, i: usize) -> f64 {
        self.change(matrix, member, i) / self.width[member]
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
