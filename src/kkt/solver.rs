//! Solver of KKT systems: it decides when to scale and how strictly to pivot, and checks the factors.
//!
//! * Cheap systems are factored as they are, with the weakest rule for pivots. If many pivots are delayed, or one seems to be zero,
//!   the matrix is equilibrated and factored again, and these scales are kept for a while. Expensive ones are equilibrated always.
//! * After each factorisation a system is solved and its backward error computed. Where that is great, signs of eigenvalues may be
//!   wrong, and the matrix is factored again under a stricter rule.
//! * Where equations determine unknowns cheaply the system is condensed; one whose equations depend on each other or have a diagonal that they do
//!   not bear, or that grows along the horizon, is factored as it is.
//! * Long work asks now and then whether it is to stop; there are no factors then.
//! * Zero pivots are counted in an equilibrated matrix under the strictest rule.
//!
//! Equilibration: factors of rows and columns that bring the largest entry of each near one (Ruiz, 2001).
//!
//! They are powers of two, so that scaling does not round.
//!
//! Accuracy check of factors: the backward error of a system that is solved with them.

use crate::kkt::condense::Plan;
use crate::kkt::condensed::Condensed;
use crate::kkt::graph::{Pattern, Progress};
use crate::kkt::numeric::{Factors, Outcome};
use crate::kkt::pivot::{Inertia, Rules};
use crate::kkt::substitute::solve;
use crate::math::{IsOver, Stopped};

/// Delays, as a part of the unknowns, that call for scales.
const MANY: usize = 20;
/// Factorisations for which scales are kept.
const KEPT: usize = 4;
/// Multiplications for each entry above which scales cost little.
const EXPENSIVE: f64 = 200.0;
/// Multiplications of a factorisation that a user waits for: some seconds.
const LONG: f64 = 1e10;
/// Requests for better factors than condensed ones beyond which no more matrices are factored as a whole: some thousands.
const MOST_REQUESTS: u32 = 12;
/// Backward error that calls for a stricter rule.
const ERROR: f64 = 1e-3;

/// Counts of the work of a solver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Matrices that were given.
    pub factorisations: usize,
    /// Right-hand sides solved for.
    pub solutions: usize,
    /// Columns that were no pivots where they were expected, in all factorisations.
    pub delays: usize,
    /// Factorisations of condensed systems.
    pub condensed: usize,
    /// Times the scales were found anew.
    pub equilibrations: usize,
    /// Factorisations that were repeated under a stricter rule because of their backward error.
    pub repeated: usize,
    /// Largest backward error of factors that were used.
    pub backward_error: f64,
}

/// Reason why a factorisation is repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Doubt {
    /// The system cannot be condensed: equations with a diagonal, dependent ones, growth along the horizon.
    Structure,
    /// Many delays or a great backward error.
    Growth,
    /// Zero pivots.
    Zeros,
}

/// Factors and solves matrices of one pattern.
#[derive(Debug)]
pub struct Solver {
    plan: Plan,
    condensed: Option<Condensed>,
    factors: Factors,
    scales: Scales,
    /// Of the factors.
    strategy: PivotStrategy,
    /// With which a factorisation begins.
    least: PivotStrategy,
    /// With which that of the last matrix begins when it is given again, and that of some matrices behind it.
    again: PivotStrategy,
    /// Number of these, and of requests for better factors than condensed ones.
    followers: usize,
    requests: u32,
    /// With which one that is not condensed begins for a while.
    lately: PivotStrategy,
    /// Factorisations that this while lasts.
    kept: usize,
    is_factored: bool,
    /// True if a message has said how long a factorisation takes, should that be long.
    is_told: bool,
    entries: Vec<f64>,
    scaled: Vec<f64>,
    work: Vec<f64>,
    trial: Trial,
    statistics: Statistics,
}

impl Solver {
    /// A solver for matrices of a plan.
    #[must_use]
    pub fn new(plan: Plan) -> Self {
        let trial = Trial::new(plan.order());
        let least = begin(&plan);
        Self {
            condensed: plan.condensation.clone().map(Condensed::new),
            plan,
            factors: Factors::default(),
            scales: Scales::default(),
            strategy: least,
            least,
            again: least,
            followers: 0,
            requests: 0,
            lately: least,
            kept: 0,
            is_factored: false,
            is_told: false,
            entries: Vec::new(),
            scaled: Vec::new(),
            work: Vec::new(),
            trial,
            statistics: Statistics::default(),
        }
    }

    /// The plan.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Returns the counts of the work so far.
    #[must_use]
    pub const fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Forgets what the matrices so far have taught, so that the next ones are factored as by a new solver.
    pub fn restart(&mut self) {
        self.least = begin(&self.plan);
        self.again = self.least;
        (self.followers, self.requests) = (0, 0);
        self.entries.clear();
        self.kept = 0;
        self.is_factored = false;
        self.is_told = false;
        self.statistics = Statistics::default();
    }

    /// Asks for a stricter rule: from now on where matrices are not condensed; where they are, for the last matrix and for twice as many
    /// behind it as at the request before, of which there are none at first.
    pub fn improve(&mut self) {
        self.again = self.strategy.max(self.again).stricter();
        if self.least == PivotStrategy::Condensed {
            self.followers = (1_usize << self.requests.min(MOST_REQUESTS)) - 1;
            self.requests += 1;
        } else {
            self.least = self.again;
        }
    }

    /// Factors the matrix with these entries, one for each of the pattern. A matrix with an entry that is no finite number counts as
    /// zero.
    ///
    /// # Panics
    ///
    /// If there are more or fewer entries than in the pattern.
    pub fn factor(&mut self, entries: &[f64]) -> Inertia {
        let factored = self.factor_unless(entries, &|| false);
        factored.expect("nothing stops it")
    }

    /// The same, unless it is stopped; it calls `is_over` at the beginning and then about every millisecond.
    ///
    /// # Errors
    ///
    /// If `is_over` returned true; the matrix is not factored then.
    ///
    /// # Panics
    ///
    /// If there are more or fewer entries than in the pattern.
    pub fn factor_unless(
        &mut self,
        entries: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Inertia, Stopped> {
        assert_eq!(
            entries.len(),
            self.plan.pattern().len(),
            "the entries of the pattern"
        );
        self.statistics.factorisations += 1;
        if self.entries != entries {
            self.entries.clear();
            self.entries.extend_from_slice(entries);
            match self.followers {
                0 => self.again = self.least,
                _ => self.followers -= 1,
            }
        }
        self.is_factored = false;
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Ok(Inertia {
                negative: 0,
                zero: self.plan.order(),
            });
        }
        let progress = &mut Progress::new(is_over);
        // Condensed factors cost so much less than others that they are tried whatever the matrices before needed.
        self.strategy = match self.again {
            PivotStrategy::Condensed => PivotStrategy::Condensed,
            again => again.max(self.lately()),
        };
        let mut why = None;
        let outcome = loop {
            self.tell_whole(why);
            let doubt = match self.attempt(progress)? {
                Ok(outcome) => break outcome,
                Err(doubt) => doubt,
            };
            let was = self.strategy;
            self.strategy = match doubt {
                // Growth hides zeros, so that no weak rule counts them all.
                Doubt::Zeros => PivotStrategy::Strict,
                Doubt::Structure | Doubt::Growth => was.stricter().max(self.lately()),
            };
            if doubt == Doubt::Growth && was != PivotStrategy::Condensed {
                (self.lately, self.kept) = (self.strategy, KEPT + 1);
            }
            why = Some(doubt);
        };
        self.kept = self.kept.saturating_sub(1);
        self.is_factored = true;
        self.statistics.delays += outcome.delays;
        Ok(outcome.inertia)
    }

    /// Strategy with which one that is not condensed begins at least, by the matrices before.
    const fn lately(&self) -> PivotStrategy {
        match self.kept {
            0 => PivotStrategy::Condensed,
            _ => self.lately,
        }
    }

    /// A factorisation with the strategy at hand, unless a stricter one may be better.
    fn attempt(&mut self, progress: &mut Progress<'_>) -> Result<Result<Outcome, Doubt>, Stopped> {
        let outcome = match self.strategy {
            PivotStrategy::Condensed => self.condensed(progress)?.ok_or(Doubt::Structure),
            PivotStrategy::Plain => self.plain(progress)?.ok_or(Doubt::Growth),
            _ => Ok(self.equilibrated(progress)?),
        };
        Ok(outcome.and_then(|outcome| self.judge(outcome)))
    }

    /// Returns the outcome, unless a stricter strategy may be better.
    fn judge(&mut self, outcome: Outcome) -> Result<Outcome, Doubt> {
        if outcome.inertia.zero > 0 {
            // The solution of a singular system tells nothing.
            return match self.strategy {
                PivotStrategy::Strict => Ok(outcome),
                _ => Err(Doubt::Zeros),
            };
        }
        let error = self.backward_error();
        if error > ERROR && self.strategy < PivotStrategy::Strict {
            self.statistics.repeated += 1;
            return Err(Doubt::Growth);
        }
        self.statistics.backward_error = self.statistics.backward_error.max(error);
        Ok(outcome)
    }

    /// The matrix condensed, if its equations allow it.
    fn condensed(&mut self, progress: &mut Progress<'_>) -> Result<Option<Outcome>, Stopped> {
        let Some(condensed) = &mut self.condensed else {
            return Ok(None);
        };
        let outcome = condensed.factor(&self.entries, progress)?;
        self.statistics.condensed += usize::from(outcome.is_some());
        Ok(outcome)
    }

    /// The matrix as it is, if there are few delays.
    fn plain(&mut self, progress: &mut Progress<'_>) -> Result<Option<Outcome>, Stopped> {
        let few = self.plan.order() / MANY;
        let rules = self.strategy.rules();
        self.factors
            .factor(&self.plan.fronts, &self.entries, rules, few, progress)
    }

    /// The matrix with its scales: those of an earlier one as long as they do.
    fn equilibrated(&mut self, progress: &mut Progress<'_>) -> Result<Outcome, Stopped> {
        let are_kept = self.kept > 0 && self.kept < KEPT && self.least == PivotStrategy::Plain;
        if are_kept {
            let outcome = self.scaled(self.plan.order() / MANY, progress)?;
            if let Some(outcome) = outcome.filter(|outcome| outcome.inertia.zero == 0) {
                return Ok(outcome);
            }
        }
        self.statistics.equilibrations += 1;
        let plan = &self.plan;
        self.scales
            .find(plan.order(), plan.pattern(), &self.entries);
        let outcome = self.scaled(usize::MAX, progress)?;
        Ok(outcome.expect("any number of delays"))
    }

    /// The matrix with the scales at hand.
    fn scaled(
        &mut self,
        most_delays: usize,
        progress: &mut Progress<'_>,
    ) -> Result<Option<Outcome>, Stopped> {
        self.scales
            .scale(self.plan.pattern(), &self.entries, &mut self.scaled);
        let rules = self.strategy.rules();
        let (factors, fronts) = (&mut self.factors, &self.plan.fronts);
        factors.factor(fronts, &self.scaled, rules, most_delays, progress)
    }

    /// Returns true if this matrix is factored as a whole although others of its pattern are condensed.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.condensed.is_some() && self.strategy != PivotStrategy::Condensed
    }

    /// Tells, once between two restarts, that the factorisation to come takes long, and why it is made.
    fn tell_whole(&mut self, why: Option<Doubt>) {
        if self.is_told || !self.is_whole() {
            return;
        }
        self.is_told = true;
        let multiplications = self.plan.multiplications();
        if multiplications > LONG {
            let why = match why {
                Some(Doubt::Structure) => {
                    "cannot be condensed, as in the restoration phase of Ipopt"
                }
                Some(Doubt::Zeros) => "seems to be singular",
                Some(Doubt::Growth) | None => {
                    "needs factors that are more exact than condensed ones"
                }
            };
            tracing::warn!(
                "a linear system {why}: it is factorised as a whole, which takes {multiplications:.0e} multiplications, and longer \
                 than most"
            );
        }
    }

    /// Replaces a right-hand side by the solution; by NaN if the matrix was not finite.
    ///
    /// # Panics
    ///
    /// If the lengths contradict each other.
    pub fn solve(&mut self, x: &mut [f64]) {
        assert_eq!(x.len(), self.plan.order(), "one number for each unknown");
        self.statistics.solutions += 1;
        if !self.is_factored {
            x.fill(f64::NAN);
            return;
        }
        self.substitute(x);
    }

    fn substitute(&mut self, x: &mut [f64]) {
        if let (PivotStrategy::Condensed, Some(condensed)) = (self.strategy, &mut self.condensed) {
            return condensed.solve(x);
        }
        let is_scaled = self.strategy != PivotStrategy::Plain;
        if is_scaled {
            self.scales.apply(x);
        }
        solve(&self.factors, x, &mut self.work);
        if is_scaled {
            self.scales.apply(x);
        }
    }

    /// The backward error of a solution with the factors.
    fn backward_error(&mut self) -> f64 {
        let mut trial = std::mem::take(&mut self.trial);
        self.substitute(trial.begin());
        let error = trial.backward_error(self.plan.pattern(), &self.entries);
        self.trial = trial;
        error
    }
}

/// Strategy with which a solver begins.
fn begin(plan: &Plan) -> PivotStrategy {
    let cost = plan.multiplications() / plan.pattern().len().max(1) as f64;
    match cost > EXPENSIVE {
        _ if plan.condensation.is_some() => PivotStrategy::Condensed,
        true => PivotStrategy::Scaled,
        false => PivotStrategy::Plain,
    }
}

/// Threshold of pivots for each [`PivotStrategy`].
const THRESHOLDS: [f64; 5] = [0.1, 1e-8, 1e-4, 1e-2, 0.1];
/// Largest entry of a column that counts as zero: of a matrix as it is, and of an equilibrated one.
const ZEROS: [f64; 2] = [1e-20, 1e-14];

/// Strategy of a factorisation: condensed, of the matrix as it is, or equilibrated and under stricter and stricter rules for pivots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PivotStrategy {
    Condensed,
    #[default]
    Plain,
    Scaled,
    Careful,
    Strict,
}

impl PivotStrategy {
    /// Returns the next stricter strategy.
    pub(super) const fn stricter(self) -> Self {
        match self {
            Self::Condensed | Self::Plain => Self::Scaled,
            Self::Scaled => Self::Careful,
            Self::Careful | Self::Strict => Self::Strict,
        }
    }

    /// Returns the rules by which pivots are accepted.
    pub(super) fn rules(self) -> Rules {
        Rules {
            threshold: THRESHOLDS[self as usize],
            zero: ZEROS[usize::from(self != Self::Plain)],
        }
    }
}

/// Sweeps; one is not enough for stiff systems, more hardly change anything.
const SWEEPS: usize = 3;

/// Factors of the unknowns.
#[derive(Clone, Debug, Default)]
pub(super) struct Scales {
    factors: Vec<f64>,
    largest: Vec<f64>,
}

impl Scales {
    /// Finds the factors of a matrix.
    pub(super) fn find(&mut self, order: usize, pattern: Pattern<'_>, entries: &[f64]) {
        self.factors.clear();
        self.factors.resize(order, 1.0);
        self.largest.resize(order, 0.0);
        for _ in 0..SWEEPS {
            self.largest.fill(0.0);
            for ((row, col), entry) in pattern.places().zip(entries) {
                let (row, col) = (row as usize, col as usize);
                let entry = (entry * self.factors[row] * self.factors[col]).abs();
                self.largest[row] = self.largest[row].max(entry);
                self.largest[col] = self.largest[col].max(entry);
            }
            for (factor, &largest) in self.factors.iter_mut().zip(&self.largest) {
                if largest > 0.0 {
                    *factor *= inverse_root(largest);
                }
            }
        }
    }

    /// The scaled entries.
    pub(super) fn scale(&self, pattern: Pattern<'_>, entries: &[f64], to: &mut Vec<f64>) {
        to.clear();
        let places = pattern.places().zip(entries);
        to.extend(places.map(|((row, col), entry)| {
            entry * self.factors[row as usize] * self.factors[col as usize]
        }));
    }

    /// Multiplies a right-hand side or a solution.
    pub(super) fn apply(&self, x: &mut [f64]) {
        for (x, factor) in x.iter_mut().zip(&self.factors) {
            *x *= factor;
        }
    }
}

/// The power of two next to `1/√x`, for x > 0.
fn inverse_root(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    let half = (exponent + (exponent & 1)) / 2;
    f64::from_bits(((1023 - half) as u64) << 52)
}

/// A system with the right-hand side b = (1, −1, 1, …).
#[derive(Clone, Debug, Default)]
pub(super) struct Trial {
    solution: Vec<f64>,
    /// Residual, and the sum of the magnitudes of its terms.
    sums: Vec<[f64; 2]>,
}

impl Trial {
    pub(super) fn new(order: usize) -> Self {
        Self {
            solution: vec![0.0; order],
            sums: vec![[0.0; 2]; order],
        }
    }

    /// The right-hand side, which the solution is to replace.
    pub(super) fn begin(&mut self) -> &mut [f64] {
        let places = self.solution.iter_mut().enumerate();
        places.for_each(|(i, x)| *x = right(i));
        &mut self.solution
    }

    /// The smallest relative change of entries with which the solution x is exact (Oettli and Prager, 1964): the greatest of
    /// `|b − A x| / (|A| |x| + |b|)`.
    pub(super) fn backward_error(&mut self, pattern: Pattern<'_>, entries: &[f64]) -> f64 {
        let (x, sums) = (&self.solution, &mut self.sums);
        let places = sums.iter_mut().enumerate();
        places.for_each(|(i, sum)| *sum = [right(i), 1.0]);
        let mut add = |row: u32, term: f64| {
            let [residual, magnitude] = &mut sums[row as usize];
            *residual -= term;
            *magnitude += term.abs();
        };
        for ((row, col), &entry) in pattern.places().zip(entries) {
            add(row, entry * x[col as usize]);
            if row != col {
                add(col, entry * x[row as usize]);
            }
        }
        let errors = self.sums.iter().map(|[r, m]| r.abs() / m);
        let is_known = errors.clone().all(f64::is_finite);
        let greatest = errors.fold(0.0, f64::max);
        if is_known { greatest } else { f64::INFINITY }
    }
}

fn right(i: usize) -> f64 {
    if i.is_multiple_of(2) { 1.0 } else { -1.0 }
}

#[cfg(test)]
#[path = "../../tests/units/kkt/backward_error.rs"]
mod tests;
