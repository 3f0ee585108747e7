//! Solves of one program, one after the other.
//!
//! The bounds that Ipopt knows.
//!
//! An equation g = b is passed to it as g − b = 0, so that b may move while Ipopt keeps what it knows. Given b, Ipopt would subtract it itself,
//! with the same bits.
//!
//! A start from another grid, moved to the path that the solver follows.
//!
//! At the barrier parameter μ the multiplier of a bound at distance s is μ/s. An optimum of another grid lies on bounds that are
//! others here, and a variable on a bound leaves it slowly. So every bounded variable is
//! moved by itself, with all others and the multipliers of the constraints held. Its Lagrangian has the slope r and the
//! curvature c; on the path
//!
//! ```text
//! (r + c (s − s₀)) s = μ   towards the nearer bound, where r pushes,
//! ```
//!
//! whose positive root is the new distance. The parameter is the mean complementarity r (x − bound) of the point as it came, within
//! a range.

use crate::ipopt::evaluation::{Asked, Evaluator, Reached, Record, Structures};
use crate::ipopt::ffi::Problem;
use crate::ipopt::options;
use crate::ipopt::options::{Options, Start};
use crate::ipopt::session::Session;
use crate::ipopt::solution::{Iteration, NoStages, OptionValue, SolverResult, StartingPoint};
use crate::nlp::squares::{InSquares, Squares};
use crate::nlp::{Bounds, Entries, Multipliers, Nlp, Status, slopes};
use crate::sparse::mumps;
use crate::stop;
use std::ops::ControlFlow;
use std::{fmt, mem};
use thiserror::Error;

/// A program that is solved again and again.
///
/// Kept are the plan of the linear systems, the problem that Ipopt knows, the last result, and room for all numbers. Where the same program is
/// solved from another point, or with other right-hand sides of its equations, nothing is built and nothing allocated but by Ipopt; a
/// [`Start::Centred`] allocates too. Where other bounds or options change, Ipopt begins with a new problem. With MUMPS, which a process has
/// once, a problem lasts for one solve.
pub struct Solver<N> {
    program: InSquares<N>,
    squares: Squares,
    options: Options,
    structures: Structures,
    bounds: KnownBounds,
    problem: Option<Problem>,
    session: Option<Session>,
    record: Record,
    /// g at the latest iterate.
    latest: Vec<f64>,
    result: SolverResult,
}

impl<N: Nlp> Solver<N> {
    /// For a program, under options.
    ///
    /// # Panics
    ///
    /// If the lengths of bounds and structures contradict each other.
    pub fn new(program: N, options: Options) -> Self {
        let structures = Structures {
            jacobian: program.jacobian_structure(),
            hessian: program.hessian_structure(),
        };
        let Structures { jacobian, hessian } = &structures;
        let (n, m) = (program.variables().count(), program.constraints().count());
        check_structure(jacobian, m, n, "Jacobian");
        check_structure(hessian, n, n, "Hessian");
        assert!(
            hessian.places().all(|(row, col)| row >= col),
            "lower triangle of the Hessian"
        );
        let squares = Squares::of(&program, program.squares());
        Self {
            program: InSquares::new(program, squares.clone(), jacobian, hessian),
            squares,
            options,
            structures,
            bounds: KnownBounds::default(),
            problem: None,
            session: None,
            record: Record::default(),
            latest: vec![0.0; m],
            result: SolverResult::of_zeros(n, m),
        }
    }

    /// The program.
    pub const fn program(&self) -> &N {
        &self.program.program
    }

    /// The program, whose bounds and values may be changed between solves.
    pub const fn program_mut(&mut self) -> &mut N {
        &mut self.program.program
    }

    /// Other options for the solves from now on.
    pub fn set_options(&mut self, options: Options) {
        let lasting = |options: &Options| Options {
            max_seconds: None,
            ..options.clone()
        };
        if lasting(&self.options) != lasting(&options) {
            self.problem = None;
        }
        self.options = options;
    }

    /// The program.
    pub fn into_program(self) -> N {
        self.program.program
    }

    /// The result of the last solve.
    pub fn into_result(self) -> SolverResult {
        self.result
    }

    /// Solves the program from `start`.
    ///
    /// `observer` is called with every iterate, and may ask to stop; so may Ctrl-C, see [`stop`](crate::stop). A panic of program or observer
    /// goes on when Ipopt has returned.
    ///
    /// # Errors
    ///
    /// If Ipopt rejects an option or the problem as such. A solve that fails is no error but a [`Status`].
    ///
    /// # Panics
    ///
    /// If the lengths of the starting point are not those of the program, or if a start with multipliers is asked for without any.
    pub fn solve(
        &mut self,
        start: &StartingPoint,
        observer: &mut dyn FnMut(&Iteration, &Reached<'_>) -> ControlFlow<()>,
    ) -> Result<&SolverResult, IpoptError> {
        let n = self.program().variables().count();
        let values = start.x.len();
        assert_eq!(values, n, "one value per variable in the starting point");
        self.result.x.clone_from(&start.x);
        let costates = &mut self.result.costates;
        match self.options.start {
            Start::Cold | Start::Simulated | Start::Primal { .. } => {}
            Start::PrimalDual | Start::Centred | Start::Resumed { .. } => {
                let known = start.costates.as_ref();
                costates.clone_from(known.expect("a start with multipliers has them"));
            }
        }
        self.solve_again(observer)
    }

    /// Solves the program from the point where the last solve has ended, with its multipliers where the options ask for them.
    ///
    /// # Errors
    ///
    /// As of [`solve`](Self::solve).
    pub fn solve_again(
        &mut self,
        observer: &mut dyn FnMut(&Iteration, &Reached<'_>) -> ControlFlow<()>,
    ) -> Result<&SolverResult, IpoptError> {
        self.record.relaxed = self.options.relaxed();
        self.program.take_bounds(self.record.relaxed);
        let mut problem = self.known_problem()?;
        let scale = self.scale();
        let (n, m) = (self.bounds.variables.count(), self.bounds.right.len());
        let mut x = mem::take(&mut self.result.x);
        let mut costates = mem::take(&mut self.result.costates);
        match self.options.start.is_dual() {
            true => costates.scale(scale),
            false => costates.reset(n, m),
        }
        self.squares.of_squares(&x, &mut costates);
        self.squares.square(&mut x);
        if self.options.start == Start::Centred {
            let structures = &self.structures;
            centre(&mut self.program, structures, scale, &mut x, &mut costates);
        }

        self.record.iterations = mem::take(&mut self.result.iterations);
        let asked = Asked {
            nlp: &mut self.program,
            observer,
            scale,
            structures: &self.structures,
            right: &self.bounds.right,
            squares: &self.squares,
        };
        let mut evaluator = Evaluator::new(asked, &mut self.record, &x, self.options.max_seconds);
        let mut solve = || problem.solve(&mut evaluator, &mut x, &mut costates);
        let (code, stages) = match self.session.take() {
            Some(session) => {
                let (code, report, session) = session.during(solve);
                self.session = Some(session);
                (code, Some(report))
            }
            None => (solve(), None),
        };
        evaluator.end();
        // MUMPS is there for others until the next solve.
        self.problem = self.session.is_some().then_some(problem);
        let _unwatched = stop::unwatched();
        let within = stages.and_then(|stages| stages.stopped);
        let stopped = self.record.stopped.or(within);
        let status = Status::from_code(code);
        self.squares.root(&mut x);
        let is_left_off = stopped.is_some() && !status.is_solved() && status != Status::Interrupted;
        if is_left_off {
            let bounds = &self.bounds.variables;
            self.record.write_multipliers(bounds, &mut costates);
        }
        let latest = &mut self.record.latest;
        self.squares.root(latest);
        let multiplied_at = if is_left_off { &*latest } else { &x };
        self.squares.of_roots(multiplied_at, &mut costates);
        costates.scale(scale.recip());
        let (record, result) = (&mut self.record, &mut self.result);
        (result.x, result.costates) = (x, costates);
        result.iterations = mem::take(&mut record.iterations);
        result.seconds = record.seconds;
        result.evaluations = record.evaluations;
        result.failed_evaluations = record.failed;
        result.linear.stages = stages;
        result.status = match status {
            // Ipopt minimises nothing where equations leave no freedom, or seem to.
            Status::Solved if self.bounds.is_square() => Status::FeasiblePoint,
            status if status.is_solved() => status,
            status => stopped.unwrap_or(status),
        };
        self.end();
        Ok(&self.result)
    }

    /// Factor of the objective.
    fn scale(&self) -> f64 {
        let scale = self.options.objective_scale;
        let scale = scale.unwrap_or_else(|| self.program.objective_scale());
        assert!(scale > 0.0, "a positive scale of the objective");
        scale
    }

    /// The problem that Ipopt knows, or a new one where it has to know other bounds or options.
    fn known_problem(&mut self) -> Result<Problem, IpoptError> {
        let program = &self.program;
        if self.bounds.take(program.variables(), program.constraints()) {
            (self.problem, self.session) = (None, None);
        }
        if let Some(problem) = self.problem.take() {
            return Ok(problem);
        }
        let taken = self.options.taken()?;
        let is_along = taken.is_along;
        match is_along {
            false if !mumps::has_room() => return Err(IpoptError::NoRoom),
            false if !mumps::has_threads() => return Err(IpoptError::NoThreads),
            _ => {}
        }
        let KnownBounds {
            variables,
            constraints,
            ..
        } = &self.bounds;
        let n = variables.count();
        self.session = is_along.then(|| {
            self.session.take().unwrap_or_else(|| {
                let stages = program.stages();
                let staged = stages.as_ref().map_or(n, Vec::len);
                assert_eq!(staged, n, "a stage for each variable");
                Session::new(variables, constraints, stages.as_deref())
            })
        });
        let solver = if is_along { "stages" } else { taken.name };
        self.result.linear.solver = solver.to_owned();
        self.result.linear.why_not = taken.why_not;
        let Structures { jacobian, hessian } = &self.structures;
        let (first, second) = (jacobian.count(), hessian.count());
        let mut problem = Problem::new(variables, constraints, first, second, !is_along).ok_or(
            IpoptError::ProblemNotCreated {
                variables: n,
                constraints: self.bounds.right.len(),
                entries: first,
            },
        )?;
        for (name, value) in self.options.settings(taken) {
            if !problem.set(&name, &value) {
                let nearest = options::nearest(&name).map(str::to_owned);
                return Err(IpoptError::OptionRejected {
                    name,
                    value,
                    nearest,
                });
            }
        }
        Ok(problem)
    }

    /// Puts the latest iterate in the place of the point where Ipopt gave up, if it violates less.
    fn end(&mut self) {
        let (program, result) = (&mut self.program.program, &mut self.result);
        // Iterates may leave the bounds by what they are relaxed.
        program.variables().keep(&mut result.x);
        let (objective, violation) = measure(program, &result.x, &mut result.constraints);
        result.objective = objective;
        if result.status.is_solved() && violation == f64::INFINITY {
            result.status = Status::InvalidNumber;
        }
        if result.status.is_solved() {
            return;
        }
        let latest = &mut self.record.latest;
        program.variables().keep(latest);
        let (objective, of_latest) = measure(program, latest, &mut self.latest);
        if of_latest < violation {
            result.objective = objective;
            mem::swap(&mut result.x, latest);
            mem::swap(&mut result.constraints, &mut self.latest);
        }
    }
}

impl<N> fmt::Debug for Solver<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut out = f.debug_struct("Solver");
        out.field("result", &self.result).finish_non_exhaustive()
    }
}

/// f, and the greatest violation of a bound or constraint at `x`, whose g is written; infinite where f or g does not exist.
fn measure(program: &mut impl Nlp, x: &[f64], g: &mut [f64]) -> (f64, f64) {
    let objective = program.objective(x);
    program.constraint(x, g);
    let violation = match objective.is_finite() {
        true => {
            let of_rows = program.constraints().violation(g);
            program.variables().violation(x).max(of_rows)
        }
        false => f64::INFINITY,
    };
    (objective, violation)
}

fn check_structure(entries: &Entries, rows: usize, cols: usize, matrix: &str) {
    assert_eq!(
        entries.rows.len(),
        entries.cols.len(),
        "as many rows as columns in the structure of the {matrix}"
    );
    assert!(
        entries.places().all(|(row, col)| row < rows && col < cols),
        "{matrix} of {rows} rows and {cols} columns"
    );
}

/// Reason why Ipopt could not be called.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IpoptError {
    /// Ipopt does not know the option, or the value is of another kind or out of range.
    ///
    /// Ipopt then writes a line of its own to standard output, where it is silent otherwise.
    #[error("Ipopt rejects the option {name} = {value}{}", hint(.nearest.as_deref()))]
    OptionRejected {
        /// Name of the option.
        name: String,
        /// The value given.
        value: OptionValue,
        /// The known option with the most similar name; none if the name is known, so that the value must be wrong.
        nearest: Option<String>,
    },
    /// This Ipopt takes no linear solver but those that it was built with.
    #[error("{0}: write \"auto\" or \"mumps\"")]
    NoStages(#[from] NoStages),
    /// Ipopt takes no problem without variables, nor constraints without any entry in their Jacobian.
    #[error(
        "Ipopt cannot work on {variables} variables and {constraints} constraints with {entries} entries in their Jacobian"
    )]
    ProblemNotCreated {
        /// Number of variables.
        variables: usize,
        /// Number of constraints.
        constraints: usize,
        /// Number of entries of the Jacobian.
        entries: usize,
    },
    /// OpenBLAS, which MUMPS calls, would wait for memory for ever.
    #[error("{}", mumps::NO_ROOM)]
    NoRoom,
    /// MPI, which a parallel MUMPS needs, would end the process.
    #[error("{}", mumps::NO_THREADS)]
    NoThreads,
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"))
}

/// Bounds as Ipopt knows them.
#[derive(Debug, Default)]
pub(super) struct KnownBounds {
    pub(super) variables: Bounds,
    /// Of the constraints less their right-hand sides.
    pub(super) constraints: Bounds,
    /// b of an equation, 0 of an inequality.
    pub(super) right: Vec<f64>,
}

impl KnownBounds {
    /// Takes the bounds of a program, and returns true if Ipopt needs others than before.
    pub(super) fn take(&mut self, variables: &Bounds, constraints: &Bounds) -> bool {
        let Bounds { lower, upper } = constraints;
        let is_equation = |low: f64, high: f64| low == high && low.is_finite();
        let both = lower.iter().zip(upper);
        let rights = both.map(|(&low, &high)| if is_equation(low, high) { low } else { 0.0 });
        self.right.clear();
        self.right.extend(rights);
        let known = &mut self.constraints;
        let is_known = |known: &[f64], bounds: &[f64]| {
            let bounds = differences(bounds, &self.right);
            known.iter().copied().eq(bounds)
        };
        let are_known = self.variables == *variables
            && is_known(&known.lower, lower)
            && is_known(&known.upper, upper);
        if !are_known {
            self.variables.clone_from(variables);
            for (known, bounds) in [(&mut known.lower, lower), (&mut known.upper, upper)] {
                known.clear();
                known.extend(differences(bounds, &self.right));
            }
        }
        !are_known
    }

    /// Returns true if there are as many equations as free variables.
    pub(super) fn is_square(&self) -> bool {
        let equal = |of: &Bounds| (0..of.count()).filter(|&i| of.are_equal(i)).count();
        self.variables.count() - equal(&self.variables) == equal(&self.constraints)
    }
}

/// Bounds less the right-hand sides.
fn differences<'a>(bounds: &'a [f64], right: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    bounds.iter().zip(right).map(|(bound, right)| bound - right)
}

/// Range of the barrier parameter.
///
/// Iterations of seventeen starts on other grids and one of another duration, trunks and pairs: 216; not centred 365, cold 406.
const RANGE: [f64; 2] = [1e-4, 3e-4];
/// Least curvature: a variable in which the Lagrangian is flat, as the square of a voltage ([`Nlp::squares`]), goes no farther than the middle of
/// its bounds. With 1 the starts above take 200 iterations, one of them to a worse optimum.
const FLAT: f64 = 1e-8;
/// Least distance from a bound.
const LEAST: f64 = 1e-14;

/// Moves the bounded variables and the multipliers of their bounds to the barrier's path; multipliers are of the scaled objective.
/// Moves nothing where a derivative does not exist.
pub(super) fn centre(
    nlp: &mut dyn Nlp,
    structures: &Structures,
    scale: f64,
    x: &mut [f64],
    costates: &mut Multipliers,
) {
    let y = &costates.constraints;
    let slope = slopes(nlp, &structures.jacobian, scale, x, y);
    let curvature = curvatures(nlp, &structures.hessian, scale, x, y);
    let is_known = |list: &[f64]| list.iter().all(|v| v.is_finite());
    if !is_known(&slope) || !is_known(&curvature) {
        return;
    }
    let bounds = nlp.variables();
    let mu = complementarity(bounds, x, &slope).clamp(RANGE[0], RANGE[1]);
    let Bounds { lower, upper } = bounds;
    for i in 0..x.len() {
        let (low, high) = (lower[i], upper[i]);
        let is_free = low.is_infinite() && high.is_infinite();
        if is_free || low == high {
            continue;
        }
        let half = 0.5 * (high - low);
        let is_low_near = x[i] - low <= high - x[i];
        let (gap, push) = match is_low_near {
            true => (x[i] - low, slope[i]),
            false => (high - x[i], -slope[i]),
        };
        let c = curvature[i].abs().max(FLAT);
        let s = distance(gap.max(0.0), push.max(0.0), c, mu).clamp(LEAST, half);
        x[i] = if is_low_near { low + s } else { high - s };
        // No distance from a bound that is infinite: no multiplier.
        costates.lower[i] = mu / (x[i] - low).max(LEAST);
        costates.upper[i] = mu / (high - x[i]).max(LEAST);
    }
}

/// Mean over all bounds of the distance times the slope that pushes towards it; 0 without bounds.
fn complementarity(bounds: &Bounds, x: &[f64], slope: &[f64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (i, (x, r)) in x.iter().zip(slope).enumerate() {
        let (low, high) = (bounds.lower[i], bounds.upper[i]);
        if low == high {
            continue;
        }
        for (gap, push) in [(x - low, *r), (high - x, -r)] {
            if gap.is_finite() {
                sum += gap.max(0.0) * push.max(0.0);
                count += 1;
            }
        }
    }
    sum / f64::from(count.max(1))
}

/// The positive root s of (r + c (s − gap)) s = μ, by the form that does not cancel.
fn distance(gap: f64, r: f64, c: f64, mu: f64) -> f64 {
    let b = r - c * gap;
    let root = (b * b + 4.0 * c * mu).sqrt();
    match b > 0.0 {
        true => 2.0 * mu / (b + root),
        false => (root - b) / (2.0 * c),
    }
}

/// Second derivatives of f + Σ yᵢ gᵢ by each variable, f scaled.
fn curvatures(nlp: &mut dyn Nlp, hessian: &Entries, scale: f64, x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; hessian.count()];
    nlp.hessian(x, scale, y, &mut values);
    let mut curvature = vec![0.0; x.len()];
    for (row, col, value) in hessian.with(&values) {
        if row == col {
            curvature[row] += value;
        }
    }
    curvature
}
