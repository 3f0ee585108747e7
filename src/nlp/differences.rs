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

use std::fmt;

use crate::nlp::{Entries, Nlp};

/// Relative error above which an entry is taken for wrong.
pub const TOLERANCE: f64 = 1e-6;

/// Part of the row's size below which an entry is not measured by its own size.
const FLOOR: f64 = 1e-3;

/// Wrong entries listed in a report.
const LISTED: usize = 20;

/// A matrix of first or second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matrix {
    /// ∇f, one row.
    Gradient,
    /// ∇g.
    Jacobian,
    /// Hessian of the Lagrangian, lower triangle.
    Hessian,
}

/// Whether an entry has a place in the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// It has.
    Stored,
    /// It has none, so that its analytic value is zero.
    Missing,
}

/// An entry whose analytic value and difference disagree.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongEntry {
    /// The matrix.
    pub matrix: Matrix,
    /// What the row belongs to.
    pub row: String,
    /// The variable of the column.
    pub column: String,
    /// Whether the structure has this entry.
    pub place: Place,
    /// Value given by the program.
    pub analytic: f64,
    /// Value from differences.
    pub difference: f64,
    /// Relative error.
    pub error: f64,
}

/// What a check found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Greatest relative error of the gradient.
    pub gradient: f64,
    /// Greatest relative error of the Jacobian.
    pub jacobian: f64,
    /// Greatest relative error of the Hessian.
    pub hessian: f64,
    /// Entries in error by more than [`TOLERANCE`], the worst first; at most twenty.
    pub wrong: Vec<WrongEntry>,
    /// Variables along which a value is NaN or ±∞ a small step away, so that nothing was checked there.
    pub unchecked: Vec<String>,
}

impl Report {
    /// True if every derivative was checked and none is wrong.
    #[must_use]
    pub const fn is_consistent(&self) -> bool {
        self.wrong.is_empty() && self.unchecked.is_empty()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            gradient,
            jacobian,
            hessian,
            ..
        } = self;
        writeln!(
            f,
            "greatest relative errors: gradient {gradient:.1e}, Jacobian {jacobian:.1e}, Hessian {hessian:.1e}"
        )?;
        for WrongEntry {
            matrix,
            row,
            column,
            place,
            analytic,
            difference,
            error,
        } in &self.wrong
        {
            let value = match place {
                Place::Stored => format!("{analytic:.9e}"),
                Place::Missing => "no entry".to_owned(),
            };
            writeln!(
                f,
                "{matrix:?} ({row}, {column}): {value}, differences {difference:.9e}, error {error:.1e}"
            )?;
        }
        for column in &self.unchecked {
            writeln!(f, "{column}: not checked, a value does not exist nearby")?;
        }
        Ok(())
    }
}

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

/// A sparse matrix beside its differences.
struct Comparison {
    /// Analytic entries by column, duplicates summed, sorted by row.
    columns: Vec<Vec<(usize, f64)>>,
    /// t: size of the terms of the differenced value of each row.
    terms: Vec<f64>,
    /// r: greatest entry of each row.
    largest: Vec<f64>,
    /// Entries seen so far: those stored and those whose difference is not zero.
    pairs: Vec<Pair>,
}

struct Pair {
    row: usize,
    column: usize,
    place: Place,
    analytic: f64,
    difference: f64,
}

impl Comparison {
    fn new(places: &Entries, values: &[f64], terms: Vec<f64>, columns: usize) -> Self {
        let mut by_column = vec![Vec::<(usize, f64)>::new(); columns];
        for ((&row, &col), &value) in places.rows.iter().zip(&places.cols).zip(values) {
            assert!(
                (row as usize) < terms.len(),
                "row {row} of the structure lies outside the matrix"
            );
            by_column[col as usize].push((row as usize, value));
        }
        for column in &mut by_column {
            column.sort_by_key(|&(row, _)| row);
            column.dedup_by(|duplicate, first| {
                let same = duplicate.0 == first.0;
                if same {
                    first.1 += duplicate.1;
                }
                same
            });
        }
        Self {
            columns: by_column,
            largest: vec![0.0; terms.len()],
            terms,
            pairs: Vec::new(),
        }
    }

    /// Adds |aᵢⱼ xⱼ| to the size of the terms of row i.
    fn add_linear_terms(&mut self, x: &[f64]) {
        for (column, x) in self.columns.iter().zip(x) {
            for &(row, value) in column {
                self.terms[row] += (value * x).abs();
            }
        }
    }

    /// Puts the rows from `first` on of a column beside their differences.
    fn compare(&mut self, column: usize, first: usize, difference: impl Fn(usize) -> f64) {
        let mut stored = self.columns[column].iter().copied().peekable();
        assert!(
            stored.peek().is_none_or(|&(row, _)| row >= first),
            "column {column} has an entry above the diagonal"
        );
        for row in first..self.terms.len() {
            let (place, analytic) = match stored.next_if(|&(stored_row, _)| stored_row == row) {
                Some((_, value)) => (Place::Stored, value),
                None => (Place::Missing, 0.0),
            };
            let difference = difference(row);
            if place == Place::Stored || difference != 0.0 {
                self.largest[row] = self.largest[row].max(analytic.abs()).max(difference.abs());
                self.pairs.push(Pair {
                    row,
                    column,
                    place,
                    analytic,
                    difference,
                });
            }
        }
    }

    /// The greatest error; entries whose error is above the tolerance are added to `wrong`.
    fn judge(
        &self,
        matrix: Matrix,
        row_name: impl Fn(usize) -> String,
        nlp: &dyn Nlp,
        wrong: &mut Vec<WrongEntry>,
    ) -> f64 {
        let mut greatest = 0.0_f64;
        for &Pair {
            row,
            column,
            place,
            analytic,
            difference,
        } in &self.pairs
        {
            let error = relative_error(analytic, difference, self.largest[row] + self.terms[row]);
            greatest = greatest.max(error);
            if error > TOLERANCE {
                let (row, column) = (row_name(row), nlp.variable_name(column));
                wrong.push(WrongEntry {
                    matrix,
                    row,
                    column,
                    place,
                    analytic,
                    difference,
                    error,
                });
            }
        }
        greatest
    }
}

/// |a − d| / max(|a|, |d|, `row`/1000); infinite if `a` is not a number.
fn relative_error(analytic: f64, difference: f64, row: f64) -> f64 {
    if analytic == difference {
        return 0.0;
    }
    let error =
        (analytic - difference).abs() / analytic.abs().max(difference.abs()).max(FLOOR * row);
    if error.is_nan() { f64::INFINITY } else { error }
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
