//! `summary.json`: the problem, its status, its size and its times.
//!
//! Parts that a stop leaves out of a result: tables, figures and page that are not made in time.
//!
//! Result of a run that finds no state of rest to begin with, to end with, or at all, or no optimum that its controller follows: its summary alone.

use crate::app::blocks::energy_rows;
use crate::app::comparison::Comparison;
use crate::app::error::CommandError;
use crate::app::fields::FOLDER;
use crate::app::kept::record::make_folder_of;
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::control::problem::Task;
use crate::dynamics::EquilibriumError;
use crate::files::{Entries, Loaded, lay_out};
use crate::ipopt;
use crate::model::Model;
use crate::model::system::InputKind;
use crate::nlp::Status;
use crate::report::atomic::WriteError;
use crate::report::curves::input_names;
use crate::report::file_set::FileSet;
use crate::report::paraview::remove_from;
use crate::report::{PageContent, quoting};
use crate::stop::TimeLimit;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::closed_loop::ClosedLoop;
use crate::workflow::effects::Plan;
use crate::workflow::regulator::RegulatorReport;
use crate::workflow::tracking::FinalValue;
use crate::workflow::warnings::Outside;
use crate::workflow::{Remarks, Tracked};
use serde::Serialize;
use std::collections::BTreeMap;
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
    /// Program and solution of a control problem; report of a simulation; an equilibrium or a path of them; constants that were identified.
    #[serde(flatten)]
    pub(super) task: Entries,
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
    pub(super) sensitivities: Vec<Entries>,
    /// Electrical energy and mechanical work of a motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) energies: Option<BTreeMap<&'static str, f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) comparison: Option<Comparison>,
    /// Muscles and blocks that leave the domain of the first-order dielectric.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) domain: Vec<Outside>,
    #[serde(flatten)]
    pub(super) blocks: Option<Entries>,
    /// Those of the model; absent where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) coordinates: Option<&'static str>,
    pub(super) seconds: Seconds,
    #[serde(flatten)]
    pub(super) plan: Plan,
    pub(super) versions: Entries,
}

/// Size of the displayed part of a motion.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct ShownPart {
    pub(super) instants: usize,
    pub(super) of: usize,
}

/// Versions that the result depends on: those of this program.
pub(super) fn versions() -> Entries {
    Entries::default()
        .with("program", env!("CARGO_PKG_VERSION"))
        .with_some("commit", option_env!("PROBOSCIS_COMMIT"))
        .with("ipopt", ipopt::VERSION)
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
            versions: versions(),
            ..Self::default()
        }
    }

    /// Rows of the page: computing time, energies, and estimated errors.
    pub(super) fn rows(&self) -> Vec<(String, String)> {
        let seconds = format!("{:.3} s", self.seconds.total);
        let mut rows = vec![("computing time".to_owned(), seconds)];
        rows.extend(self.energies.iter().flat_map(energy_rows));
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
    /// Those so far of a run that began at a time, and those of its setup.
    pub(super) fn since(began: Instant, setup: f64) -> Self {
        Self {
            total: began.elapsed().as_secs_f64(),
            setup,
            ..Self::default()
        }
    }

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

/// Files that an earlier result of the folder may have, beside the figures of its inputs.
const EARLIER: [&str; 22] = [
    "charge.svg",
    "configuration.svg",
    "continuation.npz",
    "controls.csv",
    "energy.svg",
    "equilibrium.csv",
    "joint_angles.svg",
    "motion.gltf",
    "parts.pvd",
    "path.csv",
    "path.svg",
    "report.html",
    "residuals.csv",
    "snapshots.svg",
    "solution.json",
    "solution.npz",
    "tables.npz",
    "tip_path.svg",
    "tracking.csv",
    "tracking.svg",
    "trajectory.csv",
    "trajectory.pvd",
];

/// Removes the files and fields of an earlier result.
pub(super) fn remove_earlier(files: &mut FileSet) {
    let inputs = InputKind::ALL.map(|kind| input_names(kind).0);
    let earlier = EARLIER.into_iter().chain(inputs);
    earlier.for_each(|name| files.remove(name));
    remove_from(0, FOLDER, files);
}

/// Statuses of a run that was stopped.
pub(super) const STOPPED: [&str; 2] = ["interrupted", "time_limit"];

/// Most unknowns of a run that was stopped whose effects are counted: those of 10⁶ take several seconds.
const COUNTED: usize = 100_000;

/// The plan of a model; where a large one was stopped, without effects and with words that say so.
pub(super) fn plan(model: &Model, was_stopped: bool) -> (Plan, Option<String>) {
    match was_stopped && model.variables.unknown_count() > COUNTED {
        true => {
            let words = "effects are not counted: the run was stopped";
            (Plan::uncounted(model), Some(words.to_owned()))
        }
        false => (Plan::from_model(model, None, MEASURED), None),
    }
}

/// The limit of writing, of a run that began at a time.
pub(super) fn time_to_write(request: &CommandInput, began: Instant) -> TimeLimit {
    let spent = began.elapsed().as_secs_f64();
    TimeLimit::with_grace(request.max_seconds.map(|seconds| seconds - spent))
}

/// Makes a result one whose writing was stopped: the first `kept` files alone, a warning, and the status where it has no message of another.
pub(super) fn leave_out(summary: &mut Summary, stopped: Status, files: &mut FileSet, kept: usize) {
    files.truncate(kept);
    remove_earlier(files);
    if summary.message.is_none() {
        stopped.word().clone_into(&mut summary.status);
    }
    let words = "tables, figures and page are left out: the run was stopped before they were made";
    summary.notes.warn("left_out", [words.to_owned()]);
}

/// Writes the summary of a run that has ended so, and gives its answer back.
///
/// # Errors
/// Those of the run; or the summary cannot be written.
pub(super) fn keep_unanswered<T>(
    request: &CommandInput,
    answer: Result<T, CommandError>,
) -> Result<T, CommandError> {
    if let Err(error @ CommandError::InFile { error: reason, .. }) = &answer
        && let Some(status) = error.unanswered()
    {
        write_alone(request, status, &reason.to_string())?;
    }
    answer
}

/// Writes the summary alone, with a status and its reason.
///
/// # Errors
/// It cannot be written.
fn write_alone(
    request: &CommandInput,
    status: &'static str,
    reason: &str,
) -> Result<(), CommandError> {
    let folder = make_folder_of(request)?;
    let mut summary = Summary::new(request, status, None);
    summary.message = Some(reason.to_owned());
    let mut files = FileSet::in_folder(&folder);
    remove_earlier(&mut files);
    Ok(summary.write(files)?)
}

/// Handles a missing equilibrium: a floating block is wrong input, anything else a result of which the summary alone is written.
pub(super) fn refused(
    request: &CommandInput,
    error: &EquilibriumError,
    result: &str,
) -> Result<CommandOutput, CommandError> {
    match error {
        EquilibriumError::Floating { .. } => {
            return Err(CommandError::problem(
                &request.input,
                "equilibrium",
                error.to_string(),
            ));
        }
        EquilibriumError::Stopped(stopped) => return Err((*stopped).into()),
        _ => {}
    }
    write_alone(request, "no_equilibrium", &error.to_string())?;
    Ok(CommandOutput {
        is_solved: false,
        result: format!("{result}, {}", request.folder().display()),
        notes: vec![error.to_string()],
    })
}

/// Refuses a problem that asks for something else than a motion under given voltages.
pub(super) fn refuse_all_but_motions(
    request: &CommandInput,
    task: &Task,
) -> Result<(), CommandError> {
    let instead = match task {
        Task::Simulate(_) => return Ok(()),
        Task::Control(_) | Task::Motions(_) => {
            "; a motion under given voltages is asked for by \"simulate\" in place of \"control\""
        }
        Task::Identify(_) | Task::Equilibrium(_) => "",
    };
    Err(asks_for(request, task, instead))
}

/// The refusal of a problem that asks for no state of rest.
pub(super) fn no_equilibrium(request: &CommandInput, task: &Task) -> CommandError {
    let instead =
        ", and for no equilibrium; for that of its scene name the voltages with --voltages";
    asks_for(request, task, instead)
}

/// The refusal of a problem that asks for something else, with the command that finds it, and what there is `instead`.
fn asks_for(request: &CommandInput, task: &Task, instead: &str) -> CommandError {
    let (asks, word) = match task {
        Task::Control(_) | Task::Motions(_) => ("optimal voltages", "solve"),
        Task::Identify(_) => ("constants", "solve"),
        Task::Equilibrium(_) => ("a state of rest", "equilibrium"),
        Task::Simulate(_) => ("a motion", "simulate"),
    };
    let found = quoting::command(request.words(word));
    let reason = format!("asks for {asks}, found by `{found}`{instead}");
    CommandError::problem(&request.input, key(task), reason)
}
