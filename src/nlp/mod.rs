//! A nonlinear program: minimise f(x) subject to g_L ≤ g(x) ≤ g_U and x_L ≤ x ≤ x_U.

pub mod differences;
pub mod joined;
pub(crate) mod squares;
mod status;

pub use status::Multipliers;
pub use status::Status;

/// Lower and upper bounds, one of each per entry; ±∞ where there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

impl Bounds {
    /// No bounds of a number of entries.
    pub fn none(count: usize) -> Self {
        Self {
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
        }
    }

    /// Number of entries.
    pub const fn count(&self) -> usize {
        self.lower.len()
    }

    /// Returns true if both bounds of entry `i` are equal.
    pub fn are_equal(&self, i: usize) -> bool {
        self.lower[i] == self.upper[i]
    }

    /// Adds the bounds of one more entry.
    pub fn push(&mut self, lower: f64, upper: f64) {
        self.lower.push(lower);
        self.upper.push(upper);
    }

    /// Moves values that are outside to the nearest bound.
    pub fn keep(&self, values: &mut [f64]) {
        for ((x, lower), upper) in values.iter_mut().zip(&self.lower).zip(&self.upper) {
            if *x < *lower {
                *x = *lower;
            } else if *x > *upper {
                *x = *upper;
            }
        }
    }

    /// Distance of entry `i` from its bounds with a value; infinite of a value that is no finite number.
    pub fn excess(&self, i: usize, value: f64) -> f64 {
        match value.is_finite() {
            true => (self.lower[i] - value).max(value - self.upper[i]).max(0.0),
            false => f64::INFINITY,
        }
    }

    /// Greatest distance of values from their bounds; infinite where one of them is no finite number.
    pub fn violation(&self, values: &[f64]) -> f64 {
        let excesses = values.iter().enumerate().map(|(i, &v)| self.excess(i, v));
        excesses.fold(0.0, f64::max)
    }
}

/// Places of the stored entries of a sparse matrix, zero-based; a place listed twice counts as a sum.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entries {
    /// Row of each entry.
    pub rows: Vec<u32>,
    /// Column of each entry.
    pub cols: Vec<u32>,
}

impl Entries {
    /// Number of entries.
    pub const fn count(&self) -> usize {
        self.rows.len()
    }

    /// Adds an entry.
    pub fn push(&mut self, row: usize, col: usize) {
        self.rows.push(row as u32);
        self.cols.push(col as u32);
    }

    /// Row and column of each entry.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let places = self.rows.iter().zip(&self.cols);
        places.map(|(&row, &col)| (row as usize, col as usize))
    }

    /// Row, column and value of each entry.
    pub fn with<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = (usize, usize, f64)> {
        let entries = self.places().zip(values);
        entries.map(|((row, col), &value)| (row, col, value))
    }

    /// Adds Aᵀ v to a list.
    pub fn add_transposed(&self, values: &[f64], v: &[f64], to: &mut [f64]) {
        for (row, col, value) in self.with(values) {
            to[col] += value * v[row];
        }
    }
}

/// Position of a variable along a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// In a stage; equations couple neighbouring ones.
    Of(u32),
    /// In a stage, as the multiplier of a constraint: it enters its equations linearly.
    Multiplier(u32),
    /// In none: it couples all of them.
    Border,
}

/// Minimise f(x) subject to g_L ≤ g(x) ≤ g_U and x_L ≤ x ≤ x_U.
///
/// Structures never change during the life of the object; bounds may change between solves. A quantity that does not exist at `x`
/// (an inverted element, a muscle of no length) is written as NaN; solvers then step back.
pub trait Nlp {
    /// Bounds of the variables.
    fn variables(&self) -> &Bounds;
    /// Bounds of the constraints; an equality has equal bounds.
    fn constraints(&self) -> &Bounds;
    /// Places of the constraint Jacobian ∇g.
    fn jacobian_structure(&self) -> Entries;
    /// Places of the Lagrangian Hessian, lower triangle.
    fn hessian_structure(&self) -> Entries;
    /// f(x).
    fn objective(&mut self, x: &[f64]) -> f64;
    /// ∇f(x).
    fn gradient(&mut self, x: &[f64], grad: &mut [f64]);
    /// g(x).
    fn constraint(&mut self, x: &[f64], g: &mut [f64]);
    /// Values of ∇g(x) at the places of `jacobian_structure`.
    fn jacobian(&mut self, x: &[f64], values: &mut [f64]);
    /// Values of σ ∇²f(x) + Σ yᵢ ∇²gᵢ(x) at the places of `hessian_structure`.
    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]);
    /// Factor that brings f near 1, so that a tolerance means the same whatever f is measured in.
    fn objective_scale(&self) -> f64 {
        1.0
    }
    /// Stage of each variable, where there is a horizon: linear systems are solved along it.
    fn stages(&self) -> Option<Vec<Stage>> {
        None
    }
    /// Variables x ≥ 0 that enter f and g by their squares alone, to the first power: a solver may take the squares as unknowns. A bound that x
    /// reaches at zero, where no function has a slope by x, is then one like any other.
    fn squares(&self) -> Vec<usize> {
        Vec::new()
    }
    /// Returns the name of variable `i`, for messages.
    fn variable_name(&self, i: usize) -> String {
        format!("x[{i}]")
    }
    /// Returns the name of constraint `i`, for messages.
    fn constraint_name(&self, i: usize) -> String {
        format!("g[{i}]")
    }
}

/// ∂/∂x of s f + Σ yᵢ gᵢ with a factor s of the objective.
pub(crate) fn slopes(
    program: &mut dyn Nlp,
    jacobian: &Entries,
    scale: f64,
    x: &[f64],
    y: &[f64],
) -> Vec<f64> {
    let mut slopes = vec![0.0; x.len()];
    program.gradient(x, &mut slopes);
    slopes.iter_mut().for_each(|slope| *slope *= scale);
    let mut values = vec![0.0; jacobian.count()];
    program.jacobian(x, &mut values);
    jacobian.add_transposed(&values, y, &mut slopes);
    slopes
}

impl<N: Nlp + ?Sized> Nlp for &mut N {
    fn variables(&self) -> &Bounds {
        (**self).variables()
    }

    fn constraints(&self) -> &Bounds {
        (**self).constraints()
    }

    fn jacobian_structure(&self) -> Entries {
        (**self).jacobian_structure()
    }

    fn hessian_structure(&self) -> Entries {
        (**self).hessian_structure()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        (**self).objective(x)
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        (**self).gradient(x, grad);
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        (**self).constraint(x, g);
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        (**self).jacobian(x, values);
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        (**self).hessian(x, sigma, costates, values);
    }

    fn objective_scale(&self) -> f64 {
        (**self).objective_scale()
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        (**self).stages()
    }

    fn squares(&self) -> Vec<usize> {
        (**self).squares()
    }

    fn variable_name(&self, i: usize) -> String {
        (**self).variable_name(i)
    }

    fn constraint_name(&self, i: usize) -> String {
        (**self).constraint_name(i)
    }
}
