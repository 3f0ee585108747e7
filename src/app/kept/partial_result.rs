//! Parts that a stop leaves out of a result: tables, figures and page that are not made in time.

use std::time::Instant;

use crate::app::fields::FOLDER;
use crate::app::request::CommandInput;
use crate::app::summary::{MEASURED, Summary};
use crate::model::Model;
use crate::nlp::Status;
use crate::report::file_set::FileSet;
use crate::report::paraview::remove_from;
use crate::stop::TimeLimit;
use crate::workflow::effects::Plan;

/// Files that an earlier result of the folder may have.
pub(in crate::app) const EARLIER: [&str; 29] = [
    "body_forces.svg",
    "charge.svg",
    "charges.svg",
    "configuration.svg",
    "continuation.npz",
    "controls.csv",
    "energy.svg",
    "equilibrium.csv",
    "forces.svg",
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
    "surface_charges.svg",
    "tables.npz",
    "tip_path.svg",
    "torques.svg",
    "tracking.csv",
    "tracking.svg",
    "tractions.svg",
    "trajectory.csv",
    "trajectory.pvd",
    "voltages.svg",
];

/// Statuses of a run that was stopped.
pub(in crate::app) const STOPPED: [&str; 2] = ["interrupted", "time_limit"];

/// Most unknowns of a run that was stopped whose effects are counted: those of 10⁶ take several seconds.
const COUNTED: usize = 100_000;

/// The plan of a model; where a large one was stopped, without effects and with words that say so.
pub(in crate::app) fn plan(model: &Model, was_stopped: bool) -> (Plan, Option<String>) {
    match was_stopped && model.variables.unknown_count() > COUNTED {
        true => {
            let words = "effects are not counted: the run was stopped";
            (Plan::uncounted(model), Some(words.to_owned()))
        }
        false => (Plan::from_model(model, None, MEASURED), None),
    }
}

/// The limit of writing, of a run that began at a time.
pub(in crate::app) fn time_to_write(request: &CommandInput, began: Instant) -> TimeLimit {
    let spent = began.elapsed().as_secs_f64();
    TimeLimit::with_grace(request.max_seconds.map(|seconds| seconds - spent))
}

/// Makes a result one whose writing was stopped: the first `kept` files alone, a warning, and the status where it has no message of another.
pub(in crate::app) fn leave_out(
    summary: &mut Summary,
    stopped: Status,
    files: &mut FileSet,
    kept: usize,
) {
    files.truncate(kept);
    EARLIER.iter().for_each(|name| files.remove(name));
    remove_from(0, FOLDER, files);
    if summary.message.is_none() {
        stopped.word().clone_into(&mut summary.status);
    }
    let words = "tables, figures and page are left out: the run was stopped before they were made";
    summary.notes.warn("left_out", [words.to_owned()]);
}
