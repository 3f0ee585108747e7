//! A control problem and the end of its solve.

use crate::control::problem::Control;
use crate::control::{BoundaryConditions, Carried, Solution};
use crate::ipopt::SolverResult;
use crate::model::Model;
use crate::nlp::{Nlp, Status};
use crate::workflow::active::{Active, Violation};
use crate::workflow::distance::Distance;
use crate::workflow::hold_check::{Afterwards, afterwards};
use crate::workflow::period::{Repeated, repeated};
use crate::workflow::reasons::Cause;
use crate::workflow::resimulate::Resimulation;
use std::time::Instant;

/// Limits of a solve, in place of those of its problem.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveLimits {
    /// Iterations of the solver.
    pub iterations: Option<usize>,
    /// Seconds, set-up included.
    pub seconds: Option<f64>,
}

/// Seconds that are left of those allowed since an instant, where they are limited.
pub(crate) fn seconds_left(allowed: Option<f64>, began: Instant) -> Option<f64> {
    let spent = began.elapsed().as_secs_f64();
    allowed.map(|limit| (limit - spent).max(0.0))
}

/// The program of one motion or several in numbers, with its result.
#[derive(Clone, Debug)]
pub struct WholeProgram {
    /// The sum of the objectives, or the greatest one.
    pub objective: f64,
    /// Weights of the objectives at the optimum, where the greatest one is minimised.
    pub weights: Option<Vec<f64>>,
    /// Number of variables.
    pub variables: usize,
    /// Number of equations and limits.
    pub constraints: usize,
    /// Nonzeros of the Jacobian.
    pub jacobian_nonzeros: usize,
    /// Nonzeros of the lower triangle of the Hessian, those of shared variables motion by motion.
    pub hessian_nonzeros: usize,
    /// The objective lies no farther above its least value nearby, in its unit.
    pub gap: f64,
    /// A warning that it is large compared with the objective.
    pub(crate) wide: Option<String>,
}

impl WholeProgram {
    /// A program with its result and its gap.
    pub(crate) fn new(program: &impl Nlp, solution: &SolverResult, gap: f64) -> Self {
        Self {
            objective: solution.objective,
            weights: None,
            variables: solution.x.len(),
            constraints: solution.constraints.len(),
            jacobian_nonzeros: program.jacobian_structure().rows.len(),
            hessian_nonzeros: program.hessian_structure().rows.len(),
            gap,
            wide: None,
        }
    }
}

/// A control problem and how its solve ended.
#[derive(Debug)]
pub struct Optimum {
    /// The model, with the parameters that were found put in.
    pub model: Model,
    /// The model of the program, where it has free parameters.
    pub sought: Option<Model>,
    /// Start and goal.
    pub boundary: BoundaryConditions,
    /// The motion: the optimal one, or the last iterate.
    pub motion: Solution,
    /// The result of the solver.
    pub solution: SolverResult,
    /// Interval in which the span of a muscle turns by a right angle or more, and the muscle: the discrete equations hold, but
    /// describe no motion.
    pub reversed: Option<(usize, usize)>,
    /// The worst rows that do not hold; none of a solution.
    pub violated: Vec<Violation>,
    /// Greatest scaled violation of an equation or limit.
    pub infeasibility: f64,
    /// Its program; the gap of a single motion is that of the program with its states of rest.
    pub program: WholeProgram,
    /// Seconds before the solver began.
    pub setup: f64,
    /// The use of the solution that it started from.
    pub carried: Carried,
    /// The verification of its voltages, where the solver found a solution.
    pub resimulation: Option<Resimulation>,
    /// Seconds that the test took.
    pub tested: f64,
    /// End of the first start, where another one found the optimum.
    pub restarted: Option<Restarted>,
    /// The shortest motion, where none was found in the given time.
    pub shortest: Shortest,
    /// Half a period of the slowest vibration about rest in ms, where no motion was found and that is known.
    pub half_period: Option<f64>,
    /// Reason why other starts or finer grids were not tried to the end, where none before led to an answer.
    pub stopped: Option<Status>,
    /// Reason why the solver ended at a point that meets a weaker tolerance only, where a stop kept it from better ones.
    pub cut_short: Option<Status>,
    /// Bounds and limits that the motion reaches, the most frequent first; none of a solution.
    pub active: Vec<Active>,
    /// The motion after a goal that no voltages are known to hold.
    pub afterwards: Option<Afterwards>,
    /// A periodic motion under the same inputs again.
    pub repeated: Option<Repeated>,
}

impl Optimum {
    /// Returns true for an optimal motion: the solver found it, and a simulation under its voltages reproduces it.
    pub fn is_solved(&self) -> bool {
        self.meets_equations() && self.cause().is_none()
    }

    /// Holds the voltages of the goal after its end, or those of the last interval where none are known, if it is reproduced; repeats a
    /// periodic motion.
    pub(crate) fn hold(&mut self, control: &Control) {
        if self.is_solved() {
            let path_length = match &self.resimulation {
                Some(tested) => tested.path_length,
                None => Distance::path_length(&self.model, &self.motion),
            };
            self.afterwards = afterwards(&self.model, control, &self.motion, path_length);
            let start = &self.boundary.start;
            self.repeated = repeated(&self.model, control, start, &self.motion, path_length);
        }
        let Self {
            model,
            boundary,
            motion,
            resimulation: Some(tested),
            ..
        } = self
        else {
            return;
        };
        if tested.cause.is_none() {
            tested.hold(model, boundary, motion);
        }
    }

    /// Returns true if it meets the discrete equations, reproduced or not.
    pub(crate) fn meets_equations(&self) -> bool {
        self.solution.status.is_solved() && self.reversed.is_none()
    }

    /// The reason why a simulation does not reproduce it.
    pub fn cause(&self) -> Option<&Cause> {
        self.resimulation.as_ref()?.cause.as_ref()
    }

    /// Its status, in a word.
    pub fn word(&self) -> &'static str {
        if let Some(status) = self.stopped {
            return status.word();
        }
        match self.cause() {
            _ if self.reversed.is_some() => "unresolved",
            Some(_) => "not_reproduced",
            None => self.solution.status.word(),
        }
    }
}

/// Start of an optimum that the first start did not find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Restarted {
    /// Status of the first start.
    pub first: Status,
    /// Start of the other one, in words.
    pub from: &'static str,
}

/// Result of a solve with a free duration, for a problem whose duration is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Shortest {
    /// It was not tried, or not to the end.
    #[default]
    Unknown,
    /// A motion of the duration asked for.
    AsGiven,
    /// The shortest motion found is longer, in ms.
    Longer(f64),
    /// None was found up to this duration in ms.
    NotUpTo(f64),
}
