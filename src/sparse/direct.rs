//! Solution of square systems whose pattern is laid down once.
//!
//! The matrix is scaled before the factorisation, so that equations and unknowns in different units meet one criterion of
//! singularity: the largest entries of rows and columns become near 1, and a symmetric matrix stays symmetric.
//!
//! A sparse factor is tried on a known solution before it is trusted: residuals of a singular or unstable factor may be small,
//! but the solution does not come back. Later solutions are refined once where their residual is poor.
//!
//! Scales of rows and columns: equations and unknowns in different units meet one criterion of singularity.

use crate::math::{IsOver, Stopped};
use crate::sparse::backend::Backend;
use crate::sparse::dissection::Places;
use crate::sparse::fronts::Fronts;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Precision, Singular, Symmetry};
use std::sync::Arc;
use std::time::Instant;

/// Above this size, factors for an iteration are in single precision, as `benches/block.rs` measures.
const SINGLE: usize = 5_000;
/// Most further matrices tried in single precision in a row; then double precision stays.
const RETRIES: usize = 2;
/// Number added to entries near 1 to make a singular matrix regular.
const NEARBY: f64 = 1e-10;
/// A residual above this, relative to the largest term of the equations, is refined.
const POOR: f64 = 1e-13;

/// A direct solver for one pattern.
#[derive(Debug)]
pub struct Direct {
    pub(super) pattern: Arc<Pattern>,
    pub(super) backend: Backend,
    pub(super) factorisation: Box<dyn Factorisation>,
    /// The scaled matrix, by slot.
    pub(super) values: Vec<f64>,
    /// Factors of rows, and of columns.
    pub(super) scales: [Vec<f64>; 2],
    /// Largest entry of each row, and of each column, of the scaled matrix.
    pub(super) largest: [Vec<f64>; 2],
    pub(super) rhs: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) factored: bool,
    /// Matrices in a row that needed double precision in place of single.
    pub(super) doubled: usize,
}

impl Direct {
    /// A solver for unsymmetric matrices of `size` rows with these entries; entries listed twice add up.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub fn new(size: usize, entries: &[(usize, usize)]) -> Self {
        Self::with(size, entries, Symmetry::Unsymmetric, None)
    }

    /// A solver by `backend`, or by the one that is fastest as a rule.
    ///
    /// A symmetric matrix lists the entries of both triangles too; those above the diagonal are not read. Whatever asks MUMPS
    /// waits until no other thread is in MUMPS or Ipopt.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub fn with(
        size: usize,
        entries: &[(usize, usize)],
        symmetry: Symmetry,
        backend: Option<Backend>,
    ) -> Self {
        Self::with_entries(size, entries.iter().copied(), symmetry, backend)
    }

    /// [`with`](Self::with), of entries that are listed in another way.
    pub(crate) fn with_entries(
        size: usize,
        entries: impl Iterator<Item = (usize, usize)> + Clone,
        symmetry: Symmetry,
        backend: Option<Backend>,
    ) -> Self {
        let pattern = Arc::new(Pattern::new(size, entries, symmetry));
        let backend = match pattern.rows.is_empty() {
            // There is nothing to analyse.
            true => Backend::Dense,
            false => backend.unwrap_or_else(|| Backend::of_size(size, symmetry)),
        };
        let factorisation = backend.factorisation(&pattern);
        Self::by(pattern, backend, factorisation)
    }

    /// A solver of symmetric matrices for an iteration that corrects what [`solve_roughly`](Self::solve_roughly) loses: the
    /// factors of large ones are in single precision, where those give the solution at all.
    ///
    /// Entries are those of [`with`](Self::with). Unknowns have places in space, from which the order of elimination follows;
    /// where too many have none, factors are in double precision.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub fn for_iteration(
        size: usize,
        entries: impl Iterator<Item = (usize, usize)> + Clone,
        places: &Places,
    ) -> Self {
        // Those without a place come last, in a dense block.
        let missing = places.iter().filter(|place| place.is_none()).count();
        if size <= SINGLE || missing.pow(2) > size {
            return Self::with_entries(size, entries, Symmetry::Symmetric, None);
        }
        let pattern = Arc::new(Pattern::new(size, entries, Symmetry::Symmetric));
        let factorisation = Box::new(Fronts::new(&pattern, places));
        // Scaled like matrices for faer: rows and columns at once.
        Self::by(pattern, Backend::Faer, factorisation)
    }

    fn by(pattern: Arc<Pattern>, backend: Backend, factorisation: Box<dyn Factorisation>) -> Self {
        let size = pattern.size;
        Self {
            backend,
            factorisation,
            values: vec![0.0; pattern.rows.len()],
            scales: [vec![1.0; size], vec![1.0; size]],
            largest: [vec![0.0; size], vec![0.0; size]],
            rhs: vec![0.0; size],
            residual: vec![0.0; size],
            factored: false,
            doubled: RETRIES,
            pattern,
        }
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.pattern.size
    }

    /// The method, as a table names it.
    pub fn method(&self) -> &'static str {
        self.factorisation.name()
    }

    /// Tries single precision again after a matrix that needed double precision.
    fn return_to_single(&mut self) {
        if self.precision() == Precision::Single {
            self.doubled = 0;
        } else if self.doubled < RETRIES
            && let Some(single) = self.factorisation.in_single_precision()
        {
            self.doubled += 1;
            self.factorisation = single;
        }
    }

    /// The precision of the factors.
    pub fn precision(&self) -> Precision {
        self.factorisation.precision()
    }

    /// Makes factors in double precision from now on; returns true if they were not before.
    pub fn make_double(&mut self) -> bool {
        let is_single = self.precision() == Precision::Single;
        if let (true, Some(other)) = (is_single, self.factorisation.more_robust()) {
            self.factorisation = other;
            self.factored = false;
            self.doubled = RETRIES;
        }
        is_single
    }

    /// Factorises the matrix with these values, one for each entry.
    ///
    /// # Errors
    /// The matrix is singular to working precision, or not finite.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let done = self.factor_unless(values, &|| false);
        done.expect("it is never time to stop")
    }

    /// The same, unless it is time to stop before it is done.
    ///
    /// # Errors
    /// It was time to stop: no matrix is factorised now.
    pub fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        self.factored = false;
        self.pattern.gather(values, &mut self.values);
        self.measure();
        let lost = |peak: &f64| *peak == 0.0 || !peak.is_finite();
        if let Some(column) = self.largest[1].iter().position(lost) {
            return Ok(Err(Singular { column }));
        }
        self.equilibrate();
        if self.backend == Backend::Dense {
            let outcome = self.factorisation.factor(&self.values);
            self.factored = outcome.is_ok();
            return Ok(outcome);
        }
        self.rehearse();
        self.return_to_single();
        let mut outcome = self.attempt(is_over);
        let mut first = None;
        while let Ok(Err(_)) = outcome
            && let Some(other) = self.factorisation.more_robust()
        {
            let failed = std::mem::replace(&mut self.factorisation, other);
            match failed.precision() {
                // Its memory is needed now.
                Precision::Single => drop(failed),
                Precision::Double => _ = first.get_or_insert(failed),
            }
            outcome = self.attempt(is_over);
        }
        if let Ok(Err(singular)) = outcome {
            outcome = Ok(Err(self.undetermined(singular)));
        }
        self.factored = outcome == Ok(Ok(()));
        // A singular matrix says nothing against the way in which the next one is factorised.
        if let (false, Some(first)) = (self.factored, first) {
            self.factorisation = first;
        }
        outcome
    }

    /// Solves with the last factorisation, in place.
    ///
    /// # Panics
    /// No matrix has been factorised, or the last one was singular.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_to(rhs, POOR);
    }

    /// Solves without checking the residual, for an iteration that corrects the error.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve_roughly(&mut self, rhs: &mut [f64]) {
        self.solve_to(rhs, f64::INFINITY);
    }

    fn solve_to(&mut self, rhs: &mut [f64], poor: f64) {
        assert!(self.factored, "factor before solving");
        if rhs.is_empty() {
            return;
        }
        for (value, scale) in rhs.iter_mut().zip(&self.scales[0]) {
            *value *= scale;
        }
        self.rhs.copy_from_slice(rhs);
        self.factorisation.solve(rhs);
        if self.backend != Backend::Dense && poor.is_finite() && self.leaves(rhs) > poor {
            self.factorisation.solve(&mut self.residual);
            for (value, correction) in rhs.iter_mut().zip(&self.residual) {
                *value += correction;
            }
        }
        for (value, scale) in rhs.iter_mut().zip(&self.scales[1]) {
            *value *= scale;
        }
    }

    /// The number of negative eigenvalues of the last matrix, which the sparse methods for symmetric matrices give without
    /// further work.
    pub fn negative_pivots(&self) -> Option<usize> {
        self.factored
            .then(|| self.factorisation.negative_pivots())
            .flatten()
    }

    /// The known solution at a column.
    fn known(&self, col: usize) -> f64 {
        (1.0 + col as f64 / self.pattern.size as f64) / self.largest[1][col]
    }

    /// Leaves the right-hand side of the known solution in `self.rhs`.
    pub(super) fn rehearse(&mut self) {
        for col in 0..self.pattern.size {
            self.residual[col] = self.known(col);
        }
        let (x, product) = (&self.residual, &mut self.rhs);
        product.fill(0.0);
        self.pattern.visit(&self.values, |row, col, value| {
            product[row] += value * x[col];
        });
    }

    /// Factorises, and tries the factor on the known solution.
    pub(super) fn attempt(&mut self, is_over: IsOver<'_>) -> Result<Result<(), Singular>, Stopped> {
        let began = Instant::now();
        if let Err(singular) = self.factorisation.factor_unless(&self.values, is_over)? {
            return Ok(Err(singular));
        }
        let (method, rows, seconds) = (self.method(), self.size(), began.elapsed().as_secs_f64());
        tracing::trace!(method, rows, seconds, "factorised");
        self.residual.copy_from_slice(&self.rhs);
        self.factorisation.solve(&mut self.residual);
        let error =
            |col: usize| ((self.residual[col] - self.known(col)) * self.largest[1][col]).abs();
        let tolerated = self.factorisation.precision().tolerated_loss();
        let lost = |col: &usize| error(*col).is_nan() || error(*col) > tolerated;
        let worst = (0..self.pattern.size)
            .filter(lost)
            .max_by(|&a, &b| error(a).total_cmp(&error(b)));
        Ok(worst.map_or(Ok(()), |column| {
            let (method, lost) = (self.method(), error(column));
            tracing::debug!(method, lost, "factors do not give a known solution");
            Err(Singular { column })
        }))
    }

    /// The unknown that nothing determines in a matrix whose factor failed, perhaps with infinite numbers.
    ///
    /// A matrix nearby is regular, and its solution differs from the known one along the undetermined unknowns.
    fn undetermined(&mut self, singular: Singular) -> Singular {
        for (slot, value) in self.values.iter_mut().enumerate() {
            *value += NEARBY * (1.0 + slot as f64).sin();
        }
        match self.attempt(&|| false) {
            Ok(Err(found)) => found,
            _ => singular,
        }
    }

    /// Leaves the residual of `x` in `self.residual`, and returns its size relative to the largest term of the equations.
    fn leaves(&mut self, x: &[f64]) -> f64 {
        let (residual, largest) = (&mut self.residual, &self.largest[1]);
        residual.copy_from_slice(&self.rhs);
        self.pattern.visit(&self.values, |row, col, value| {
            residual[row] -= value * x[col];
        });
        let norm = |values: &[f64]| values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let term = |m: f64, (x, peak): (&f64, &f64)| m.max((x * peak).abs());
        let scale = x.iter().zip(largest).fold(norm(&self.rhs), term);
        if scale > 0.0 {
            norm(residual) / scale
        } else {
            0.0
        }
    }
}

/// Scaling of rows and columns ends when their largest entries are between this and its inverse, or after this number of
/// rounds.
const BALANCED: (f64, usize) = (4.0, 12);

impl Direct {
    /// Finds the largest entry of each row and column.
    pub(super) fn measure(&mut self) {
        let [rows, cols] = &mut self.largest;
        rows.fill(0.0);
        cols.fill(0.0);
        // Unlike `f64::max`, this keeps NaN.
        let grow = |peak: &mut f64, value: f64| {
            if value.abs() > *peak || value.is_nan() {
                *peak = value.abs();
            }
        };
        self.pattern.visit(&self.values, |row, col, value| {
            grow(&mut rows[row], value);
            grow(&mut cols[col], value);
        });
    }

    /// Multiplies rows and columns by functions of their largest entries.
    fn scale(&mut self, functions: [fn(f64) -> f64; 2]) {
        let Self {
            pattern,
            values,
            scales,
            largest,
            rhs,
            residual,
            ..
        } = self;
        for (i, factors) in [&mut *residual, &mut *rhs].into_iter().enumerate() {
            let lists = factors.iter_mut().zip(&largest[i]).zip(&mut scales[i]);
            for ((factor, &peak), scale) in lists {
                *factor = if peak > 0.0 { functions[i](peak) } else { 1.0 };
                *scale *= *factor;
            }
        }
        pattern.scale(values, residual, rhs);
        self.measure();
    }

    /// Brings the largest entries near 1.
    pub(super) fn equilibrate(&mut self) {
        self.scales.iter_mut().for_each(|scale| scale.fill(1.0));
        if self.pattern.symmetry == Symmetry::Unsymmetric && self.backend != Backend::Mumps {
            // Exchanges of rows see the scales of rows alone; a power of two rounds nothing.
            self.scale([f64::recip, |_| 1.0]);
            self.scale([|_| 1.0, |peak| peak.log2().round().exp2().recip()]);
            return;
        }
        // Each round halves the orders of magnitude that are left.
        let (enough, rounds) = BALANCED;
        let far = |peak: &f64| *peak > enough || *peak < 1.0 / enough;
        for _ in 0..rounds {
            if !self.largest.iter().flatten().any(far) {
                break;
            }
            // Powers of two round nothing.
            self.scale([|peak| (0.5 * peak.log2()).round().exp2().recip(); 2]);
        }
    }
}

/// State of a solver that determines how it factorises the next matrix: what it has learnt from those before.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MethodState {
    /// The method, as a table names it.
    pub method: String,
    /// Matrices in a row that needed double precision in place of single.
    pub doubled: usize,
}

impl Direct {
    /// Returns the state that determines how the next matrix is factorised.
    pub fn state(&self) -> MethodState {
        MethodState {
            method: self.method().to_owned(),
            doubled: self.doubled,
        }
    }

    /// Factorises the next matrix as another solver of this pattern would; returns true if it can.
    pub fn take(&mut self, state: &MethodState) -> bool {
        while self.method() != state.method {
            match self.factorisation.more_robust() {
                Some(other) => self.factorisation = other,
                None => return false,
            }
        }
        self.doubled = state.doubled;
        self.factored = false;
        true
    }

    /// Factorises a matrix that was factorised before, by the method that did so at last.
    ///
    /// # Errors
    /// It was another matrix or method.
    pub fn factor_again(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.pattern.gather(values, &mut self.values);
        self.measure();
        self.equilibrate();
        self.rehearse();
        let outcome = match self.backend {
            Backend::Dense => self.factorisation.factor(&self.values),
            _ => self.attempt(&|| false).expect("it is never time to stop"),
        };
        self.factored = outcome.is_ok();
        outcome
    }
}
