//! `summary.json`: the problem, its status, its size and its times.

use crate::app::blocks::EnergySummary;
use crate::app::comparison::Comparison;
use crate::app::displayed_motion::ShownPart;
use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use crate::files::{Entries, Loaded, lay_out};
use crate::ipopt;
use crate::report::PageContent;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::closed_loop::ClosedLoop;
use crate::workflow::effects::Plan;
use crate::workflow::regulator::RegulatorReport;
use crate::workflow::tracking::FinalValue;
use crate::workflow::warnings::Outside;
use crate::workflow::{Remarks, Tracked};
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
    pub(super) energies: Option<EnergySummary>,
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
