//! `summary.json`: the problem, its status, its size and its times.

use crate::app::blocks::{BlockSizes, EnergySummary};
use crate::app::comparison::Comparison;
use crate::app::displayed_motion::ShownPart;
use crate::app::equilibrium_summary::PathSummary;
use crate::app::equilibrium_summary::Rest;
use crate::app::error::CommandError;
use crate::app::linear_systems::{LinearSystems, MultigridCounts};
use crate::app::request::CommandInput;
use crate::app::sensitivity_summary::SensitivitySummary;
use crate::control::problem;
use crate::dynamics::{DiscreteTrajectory, LocalError};
use crate::files::{Entries, Loaded, lay_out};
use crate::ipopt;
use crate::math::significant;
use crate::model::FoundParameter;
use crate::report::PageContent;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::closed_loop::ClosedLoop;
use crate::workflow::effects::Plan;
use crate::workflow::hold_check::Afterwards;
use crate::workflow::hold_check::Repeated;
use crate::workflow::optimum::Violation;
use crate::workflow::regulator::RegulatorReport;
use crate::workflow::resimulate::Resimulation;
use crate::workflow::tracking::FinalValue;
use crate::workflow::warnings::Outside;
use crate::workflow::{EstimatedError, Remarks, Tracked};
use serde::Serialize;
use std::fs;
use std::time::Instant;

/// Time in s that goes into measuring each effect for it.
pub(super) const MEASURED: f64 = 2e-4;

/// The file.
#[derive(Debug, Default, Serialize)]
pub(super) struct Summary {
    pub(super) command: String,
    pub(super) input: String,
    /// A word: `solved`, `simulated`, `infeasible`, `interrupted`, …
    pub(super) status: String,
    /// Reason why it ended early, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) message: Option<String>,
    /// Warnings and notes on the result.
    #[serde(skip_serializing_if = "Remarks::is_empty")]
    pub(super) notes: Remarks,
    #[serde(flatten)]
    pub(super) program: Option<Program>,
    #[serde(flatten)]
    pub(super) simulation: Option<Simulation>,
    /// The regulator along an optimum.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) feedback: Option<RegulatorReport>,
    /// The motion under a controller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) closed_loop: Option<ClosedLoop>,
    /// Number of instants that tables, figures and page show, where not all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) shown: Option<ShownPart>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) accuracy: Option<Accuracy>,
    /// Deviations of markers and joints from the references of the objective.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) tracking: Vec<Tracked>,
    /// Values at waypoints for which costs ask.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) waypoint_values: Vec<FinalValue>,
    /// Values at its end for which final costs ask.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) final_values: Vec<FinalValue>,
    /// Derivatives of the optimum by numbers that the problem names.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) sensitivities: Vec<SensitivitySummary>,
    /// Electrical energy and mechanical work of a motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) energies: Option<EnergySummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) comparison: Option<Comparison>,
    #[serde(flatten)]
    pub(super) rest: Option<Rest>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) path: Option<PathSummary>,
    /// Constants that were fitted to recordings.
    #[serde(flatten)]
    pub(super) identification: Option<Entries>,
    /// Muscles and blocks that leave the domain of the first-order dielectric.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) domain: Vec<Outside>,
    #[serde(flatten)]
    pub(super) blocks: Option<BlockSizes>,
    /// Those of the model; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) coordinates: Option<&'static str>,
    pub(super) seconds: Seconds,
    #[serde(flatten)]
    pub(super) plan: Plan,
    pub(super) versions: Versions,
}

/// The nonlinear program of a control problem and its solution.
#[derive(Debug, Serialize)]
pub(super) struct Program {
    pub(super) objective: f64,
    pub(super) objective_units: Vec<String>,
    pub(super) iterations: usize,
    pub(super) intervals: usize,
    /// Final time in s.
    pub(super) duration: f64,
    pub(super) variables: usize,
    pub(super) constraints: usize,
    pub(super) jacobian_nonzeros: usize,
    pub(super) hessian_nonzeros: usize,
    /// Solver of the linear systems, with its counts and times.
    pub(super) linear_solver: LinearSystems,
    /// Number of evaluations of each quantity by the solver.
    pub(super) evaluations: Evaluations,
    /// Mean time of one evaluation per interval.
    pub(super) interval_microseconds: PerInterval,
    /// Greatest scaled violation of an equation or limit; absent where one has no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) infeasibility: Option<f64>,
    /// The worst rows that do not hold; none of a solution.
    pub(super) violations: Vec<Violation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) resimulation: Option<Resimulation>,
    /// Parameters that were sought.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) parameters: Vec<SoughtValue>,
    /// Bound of the objective above its least value; absent without a solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) gap: Option<f64>,
    /// Motion after a goal that no known voltages hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) afterwards: Option<Afterwards>,
    /// A periodic motion under the same inputs again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) repeated: Option<Repeated>,
}

/// A parameter that was sought: the value that was found.
#[derive(Debug, Serialize)]
pub(super) struct SoughtValue {
    /// Its path in the scene.
    pub(super) name: String,
    /// In the unit.
    pub(super) value: f64,
    /// Of the International System, empty for a ratio.
    pub(super) unit: &'static str,
    /// True if it lies at a bound.
    pub(super) at_bound: bool,
}

impl SoughtValue {
    /// Of a solution.
    pub(super) fn new(found: &FoundParameter) -> Self {
        Self {
            name: found.name.clone(),
            value: found.value * found.unit.factor,
            unit: found.unit.symbol,
            at_bound: found.is_at_bound,
        }
    }

    /// In words.
    pub(super) fn text(&self) -> String {
        let value = format!("{} {}", significant(self.value, 8), self.unit);
        match self.at_bound {
            true => format!("{}, at its bound", value.trim_end()),
            false => value.trim_end().to_owned(),
        }
    }
}

/// Numbers of evaluations.
#[derive(Debug, Serialize)]
pub(super) struct Evaluations {
    pub(super) objective: usize,
    pub(super) gradient: usize,
    pub(super) constraints: usize,
    pub(super) jacobian: usize,
    pub(super) hessian: usize,
}

impl Evaluations {
    /// Of a solve.
    pub(super) fn new(evaluations: &ipopt::Evaluations) -> Self {
        Self {
            objective: evaluations.objective,
            gradient: evaluations.gradient,
            constraints: evaluations.constraints,
            jacobian: evaluations.jacobian,
            hessian: evaluations.hessian,
        }
    }
}

/// Mean time of one evaluation per interval, in µs; nothing where there was none.
#[derive(Debug, Serialize)]
pub(super) struct PerInterval {
    pub(super) jacobian: Option<f64>,
    pub(super) hessian: Option<f64>,
}

/// Report of a simulation.
#[derive(Debug, Serialize)]
pub(super) struct Simulation {
    /// Steps recorded.
    pub(super) steps: usize,
    /// Length of the motion in s.
    pub(super) duration: f64,
    /// Estimate of the local errors of the steps; absent where they are too few.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) local_error: Option<Neglected>,
    /// The method.
    pub(super) integrator: String,
    /// Tolerance that controlled the lengths of the steps; absent of equal ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) tolerance: Option<f64>,
    /// Estimated error of the motion in the unit of the tolerance; absent of equal steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) estimated_error: Option<f64>,
    /// True if steps of two other lengths confirm the estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) is_confirmed: Option<bool>,
    /// Newton iterations.
    pub(super) newton_iterations: usize,
    /// Steps that had to be halved.
    pub(super) halved_steps: usize,
    /// Method that solved the linear systems.
    pub(super) linear_solver: String,
    /// Counts of an iteration with multigrid, where one solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) multigrid: Option<MultigridCounts>,
    /// Factorisations of the tangent.
    pub(super) factorisations: usize,
    /// Seconds in rows and tangents.
    pub(super) assembly_seconds: f64,
    /// Seconds in factorisations.
    pub(super) factorisation_seconds: f64,
    /// Seconds in solutions with them.
    pub(super) solution_seconds: f64,
}

/// The sum of the local errors of a motion, an estimate of its distance from the exact one.
#[derive(Debug, Serialize)]
pub(super) struct Neglected {
    /// Of the point where it is greatest, in m.
    pub(super) sum: f64,
    /// Way of the point that goes farthest, in m.
    pub(super) path: f64,
    /// The sum as a part of the path.
    pub(super) relative: f64,
    /// Order of the method.
    pub(super) order: usize,
    /// True if differences of the motion fall with their order; otherwise the estimate is no more than a warning.
    pub(super) is_resolved: bool,
}

impl Neglected {
    fn new(error: LocalError) -> Self {
        Self {
            sum: error.error / 1e3,
            path: error.path / 1e3,
            relative: error.relative(),
            order: error.order,
            is_resolved: error.is_resolved,
        }
    }
}

impl Simulation {
    /// Of a motion.
    pub(super) fn new(
        (discrete, estimated): (&DiscreteTrajectory, Option<EstimatedError>),
        task: &problem::Simulation,
        error: Option<LocalError>,
    ) -> Self {
        let (steps, report) = (discrete.intervals(), discrete.report);
        Self {
            steps,
            duration: discrete.times[steps] / 1e3,
            local_error: error.map(Neglected::new),
            integrator: task.solving.integrator.name(),
            tolerance: task.tolerance,
            estimated_error: estimated.map(|estimated| estimated.error),
            is_confirmed: estimated.map(|estimated| estimated.is_confirmed),
            newton_iterations: report.iterations,
            halved_steps: report.halved,
            linear_solver: discrete.solver.clone(),
            multigrid: MultigridCounts::new(report.multigrid, report.fallbacks),
            factorisations: report.factorisations,
            assembly_seconds: report.assembly,
            factorisation_seconds: report.factorisation,
            solution_seconds: report.solution,
        }
    }
}

/// Versions that the result depends on: those of this program.
#[derive(Debug, Serialize)]
pub(super) struct Versions {
    program: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    commit: Option<&'static str>,
    ipopt: &'static str,
}

impl Default for Versions {
    fn default() -> Self {
        Self {
            program: env!("CARGO_PKG_VERSION"),
            commit: option_env!("PROBOSCIS_COMMIT"),
            ipopt: ipopt::VERSION,
        }
    }
}

/// The summary that a command has written.
///
/// # Errors
/// It cannot be read any more.
pub fn written_summary(request: &CommandInput) -> Result<String, CommandError> {
    let file = request.folder().join("summary.json");
    fs::read_to_string(&file).map_err(|cause| CommandError::Unreadable { file, cause })
}

impl Summary {
    /// A summary without a result.
    pub(super) fn new(
        request: &CommandInput,
        status: &str,
        coordinates: impl Into<Option<&'static str>>,
    ) -> Self {
        Self {
            command: request.command.clone(),
            input: request.input.display().to_string(),
            status: status.to_owned(),
            coordinates: coordinates.into(),
            ..Self::default()
        }
    }

    /// Rows of the page: computing time, energies, and estimated errors.
    pub(super) fn rows(&self) -> Vec<(String, String)> {
        let seconds = format!("{:.3} s", self.seconds.total);
        let mut rows = vec![("computing time".to_owned(), seconds)];
        rows.extend(self.energies.iter().flat_map(EnergySummary::rows));
        let estimated = self.accuracy.iter().flat_map(|accuracy| &accuracy.estimate);
        rows.extend(
            estimated
                .map(|(name, error)| (format!("estimated error, {name}"), format!("{error:.1e}"))),
        );
        rows
    }

    /// Writes it as `summary.json`, the last file of a result.
    pub(super) fn write(&self, mut files: FileSet) -> Result<(), WriteError> {
        files.add("summary.json", self.text().as_bytes())?;
        files.finish()
    }

    /// Texts of its page before rows and plots, and those of its problem, where there is a file of it.
    pub(super) fn page(&self, title: &str, loaded: Option<&Loaded>) -> PageContent {
        let mut documents = vec![("Summary".to_owned(), self.text())];
        documents.extend(loaded.into_iter().flat_map(asked));
        PageContent {
            title: title.to_owned(),
            is_solved: self.message.is_none(),
            answer: self.status.replace('_', " "),
            notes: self
                .message
                .iter()
                .cloned()
                .chain(self.notes.lines())
                .collect(),
            documents,
            ..PageContent::default()
        }
    }

    /// Its text.
    pub(super) fn text(&self) -> String {
        lay_out(&serde_json::to_string(self).expect("numbers and names are JSON"))
    }
}

/// Wall time in s.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Seconds {
    /// Seconds from reading to the last file but the summary.
    pub(super) total: f64,
    /// Seconds of these for output: tables, figures, page.
    pub(super) writing: f64,
    /// Before the solver or the first step.
    pub(super) setup: f64,
    /// In Ipopt without the callbacks, or in the steps of a simulation.
    pub(super) solver: f64,
    pub(super) objective: f64,
    pub(super) gradient: f64,
    pub(super) constraints: f64,
    pub(super) jacobian: f64,
    pub(super) hessian: f64,
}

impl Seconds {
    /// The files are written, since `writing`; the run began at `began`.
    pub(super) fn wrote(&mut self, began: Instant, writing: Instant) {
        self.total = began.elapsed().as_secs_f64();
        self.writing = writing.elapsed().as_secs_f64();
    }
}

/// Names and texts of problem and scene as they were read, overrides applied.
fn asked(loaded: &Loaded) -> Vec<(String, String)> {
    let mut documents = vec![("Problem".to_owned(), lay_out(&loaded.problem))];
    if loaded.scene_path.is_some() {
        documents.push(("Scene".to_owned(), lay_out(&loaded.scene)));
    }
    documents
}
