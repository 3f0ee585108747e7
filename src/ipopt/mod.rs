//! Ipopt behind one safe function over the trait [`Nlp`].
//!
//! Solves with the linear solver along the horizon run in any number of threads, also within a callback. With MUMPS, which is not made for
//! more, one runs at a time in a process and a second call waits; an observer or an [`Nlp`] must not call [`solve`] itself then.

mod centre;
mod evaluation;
mod ffi;
mod hook;
pub mod interrupt;
mod linear_report;
mod linear_solver;
mod options;
mod session;
mod solution;
mod status;

use std::ops::ControlFlow;

use thiserror::Error;

use crate::nlp::{Bounds, Entries, Nlp};

use centre::{Structures, centre};
use evaluation::Evaluator;
pub use linear_report::{LinearReport, StagesReport};
pub use linear_solver::LinearSolver;
pub use options::{MUMPS_ORDERING, OptionValue, Options, Start};
use session::Session;
pub use solution::{Evaluations, Iteration, Multipliers, Seconds, SolverResult, StartingPoint};
pub use status::Status;

/// Version of the Ipopt that the program was built with.
pub const VERSION: &str = env!("PROBOSCIS_IPOPT");

/// Why Ipopt could not be called.
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
    #[error(
        "this Ipopt ({VERSION}) takes no linear solver along the horizon: write \"auto\" or \"mumps\""
    )]
    NoStages,
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
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"))
}

/// Solves `nlp` from `start`.
///
/// `observer` hears of every iterate and its x, and may ask to stop; so may Ctrl-C, see [`interrupt`]. A panic of `nlp` or `observer`
/// goes on when Ipopt has returned.
///
/// # Errors
///
/// If Ipopt rejects an option or the problem as such. A solve that fails is no error but a [`Status`].
///
/// # Panics
///
/// If the lengths of bounds, structures and starting point contradict each other, or if a start with multipliers is asked for
/// without any.
pub fn solve(
    nlp: &mut dyn Nlp,
    start: &StartingPoint,
    options: &Options,
    observer: &mut dyn FnMut(&Iteration, &[f64]) -> ControlFlow<()>,
) -> Result<SolverResult, IpoptError> {
    let (variables, constraints) = (nlp.variables(), nlp.constraints());
    let (jacobian, hessian) = (nlp.jacobian_structure(), nlp.hessian_structure());
    let (n, m) = (variables.lower.len(), constraints.lower.len());
    check_structure(&jacobian, m, n, "Jacobian");
    check_structure(&hessian, n, n, "Hessian");
    assert!(
        hessian
            .rows
            .iter()
            .zip(&hessian.cols)
            .all(|(row, col)| row >= col),
        "lower triangle of the Hessian"
    );
    let mut x = start.x.clone();
    let mut costates = starting_costates(start, options.start, n, m);
    let scale = nlp.objective_scale();
    assert!(scale > 0.0, "a positive scale of the objective");
    costates.scale(scale);
    if options.start == Start::Centred {
        let structures = Structures {
            jacobian: &jacobian,
            hessian: &hessian,
        };
        centre(nlp, &structures, &mut x, &mut costates);
    }

    let (linear_solver, is_along) = linear_solver(options)?;
    let stages = nlp.stages();
    let staged = stages.as_ref().map_or(n, Vec::len);
    assert_eq!(staged, n, "a stage for each variable");
    let (entries, second) = (jacobian.rows.len(), hessian.rows.len());
    let mut problem = ffi::Problem::new(&variables, &constraints, entries, second, !is_along)
        .ok_or(IpoptError::ProblemNotCreated {
            variables: n,
            constraints: m,
            entries,
        })?;
    for (name, value) in options.settings(&linear_solver) {
        if !problem.set(&name, &value) {
            let nearest = options::nearest(&name).map(str::to_owned);
            return Err(IpoptError::OptionRejected {
                name,
                value,
                nearest,
            });
        }
    }

    let mut evaluator = Evaluator::new(nlp, observer, jacobian, hessian, &x, options.max_seconds);
    let solve = || problem.solve(&mut evaluator, &mut x, &mut costates);
    let (code, stages) = match is_along {
        true => {
            let session = Session::new(&variables, &constraints, stages.as_deref());
            let (code, report) = session.during(solve);
            (code, Some(report))
        }
        false => (solve(), None),
    };
    let record = evaluator.into_record();
    let _unwatched = interrupt::unwatched();
    let mut status = match Status::from_code(code) {
        // Ipopt minimises nothing where equations leave no freedom, or seem to.
        Status::Solved if is_square(&variables, &constraints) => Status::FeasiblePoint,
        status if status.is_solved() => status,
        status => record.stopped.unwrap_or(status),
    };

    let mut end = Ending::at(nlp, &variables, &constraints, x);
    if status.is_solved() && end.violation == f64::INFINITY {
        status = Status::InvalidNumber;
    }
    if !status.is_solved() {
        // Iterates may leave the bounds by 1e-8 (`bound_relax_factor`); the point that Ipopt returns does not.
        let mut x = record.latest;
        for ((x, lower), upper) in x.iter_mut().zip(&variables.lower).zip(&variables.upper) {
            *x = x.max(*lower).min(*upper);
        }
        let latest = Ending::at(nlp, &variables, &constraints, x);
        if latest.violation < end.violation {
            end = latest;
        }
    }
    costates.scale(scale.recip());
    Ok(SolverResult {
        status,
        x: end.x,
        objective: end.objective,
        constraints: end.constraints,
        costates,
        iterations: record.iterations,
        seconds: record.seconds,
        linear: LinearReport {
            solver: if is_along {
                "stages".to_owned()
            } else {
                linear_solver
            },
            stages,
        },
        evaluations: record.evaluations,
        failed_evaluations: record.failed,
    })
}

/// The name of the linear solver in Ipopt, and whether it is the one along the horizon.
fn linear_solver(options: &Options) -> Result<(String, bool), IpoptError> {
    if let Some(name) = options.named_linear_solver() {
        return Ok((name.to_owned(), false));
    }
    let solver = options
        .linear_solver
        .resolve()
        .ok_or(IpoptError::NoStages)?;
    Ok((solver.name().to_owned(), solver == LinearSolver::Stages))
}

/// Whether there are as many equations as variables that are free.
fn is_square(variables: &Bounds, constraints: &Bounds) -> bool {
    let equal = |bounds: &Bounds| {
        let pairs = bounds.lower.iter().zip(&bounds.upper);
        pairs.filter(|(lower, upper)| lower == upper).count()
    };
    variables.lower.len() - equal(variables) == equal(constraints)
}

/// A point where a solve may end.
struct Ending {
    x: Vec<f64>,
    objective: f64,
    constraints: Vec<f64>,
    violation: f64,
}

impl Ending {
    /// f, g and the greatest violation of a bound or constraint at `x`; the latter is infinite where f or g does not exist.
    fn at(nlp: &mut dyn Nlp, variables: &Bounds, constraints: &Bounds, x: Vec<f64>) -> Self {
        let mut g = vec![0.0; constraints.lower.len()];
        let objective = nlp.objective(&x);
        nlp.constraint(&x, &mut g);
        let violation = match objective.is_finite() {
            true => variables.violation(&x).max(constraints.violation(&g)),
            false => f64::INFINITY,
        };
        Self {
            x,
            objective,
            constraints: g,
            violation,
        }
    }
}

/// The multipliers to begin with; zeros unless they are asked for.
fn starting_costates(start: &StartingPoint, kind: Start, n: usize, m: usize) -> Multipliers {
    assert_eq!(
        start.x.len(),
        n,
        "one value per variable in the starting point"
    );
    match kind {
        Start::Cold | Start::Simulated | Start::Primal { .. } => Multipliers {
            constraints: vec![0.0; m],
            lower: vec![0.0; n],
            upper: vec![0.0; n],
        },
        Start::PrimalDual | Start::Centred => start
            .costates
            .clone()
            .expect("a start with multipliers has them"),
    }
}

fn check_structure(entries: &Entries, rows: usize, cols: usize, matrix: &str) {
    let below =
        |indices: &[u32], count: usize| indices.iter().all(|&index| (index as usize) < count);
    assert_eq!(
        entries.rows.len(),
        entries.cols.len(),
        "as many rows as columns in the structure of the {matrix}"
    );
    assert!(
        below(&entries.rows, rows) && below(&entries.cols, cols),
        "{matrix} of {rows} rows and {cols} columns"
    );
}
