//! `summary.json` of several motions: what they have in common once, and each by its name and folder.

use serde::Serialize;

use crate::app::request::CommandInput;
use crate::app::summary::{SoughtValue, Summary, Versions};
use crate::control::{Motions, PEAK_VOLTAGE};
use crate::files::lay_out;
use crate::tasks::MotionsResult;
use crate::workflow::Remarks;
use crate::workflow::accuracy::Accuracy;

/// The file.
#[derive(Debug, Serialize)]
pub(super) struct MotionsSummary {
    command: String,
    input: String,
    /// A word: `solved`, where each motion is, or that of the first that is not.
    pub(super) status: String,
    /// Reasons why motions are not solved, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) message: Option<String>,
    /// Warnings and notes on all of them.
    #[serde(skip_serializing_if = "Remarks::is_empty")]
    pub(super) notes: Remarks,
    /// The sum of their objectives, or the greatest one.
    pub(super) objective: f64,
    objective_units: Vec<String>,
    pub(super) iterations: usize,
    variables: usize,
    constraints: usize,
    jacobian_nonzeros: usize,
    hessian_nonzeros: usize,
    /// Greatest violation of an equation or limit of a motion.
    infeasibility: f64,
    /// Constants that were sought.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) parameters: Vec<SoughtValue>,
    /// Sources whose inputs are the same in all motions.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shared_inputs: Vec<String>,
    /// Bound of the objective above its least value; absent without a solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<f64>,
    /// Estimated errors, the greatest of all motions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) accuracy: Option<Accuracy>,
    /// The motions in their order, with the summaries of their folders.
    pub(super) motions: Vec<MotionEntry>,
    pub(super) seconds: TotalSeconds,
    versions: Versions,
}

/// A motion in the summary of all.
#[derive(Debug, Serialize)]
pub(super) struct MotionEntry {
    name: String,
    /// Its folder, in that of the results.
    pub(super) folder: String,
    status: String,
    /// Its part of the objective, or its objective beside the greatest one.
    objective: f64,
    /// The weight of its objective at the optimum, where the greatest one is minimised: 0 below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    weight: Option<f64>,
    intervals: usize,
    /// Final time in s.
    duration: f64,
}

/// Wall time in s.
#[derive(Debug, Default, Serialize)]
pub(super) struct TotalSeconds {
    /// Seconds from reading to the last file but the summary.
    pub(super) total: f64,
}

impl MotionsSummary {
    /// Of a result whose motions have these summaries.
    pub(super) fn new(
        request: &CommandInput,
        motions: &Motions,
        result: &MotionsResult,
        each: &[Summary],
    ) -> Self {
        let MotionsResult {
            list,
            whole,
            iterations,
            accuracy,
            verdict,
            remarks,
        } = result;
        let constants = list[0].optimum.motion.parameters.iter();
        let constants = constants.filter(|found| found.name != PEAK_VOLTAGE);
        let weight = |number: usize| whole.weights.as_ref().map(|all| all[number]);
        let entries = motions.list.iter().zip(list).zip(each).enumerate();
        let entries = entries.map(|(number, ((motion, result), summary))| {
            let found = &result.optimum.motion;
            MotionEntry {
                name: motion.name.clone(),
                folder: motion.name.clone(),
                status: summary.status.clone(),
                objective: result.optimum.solution.objective,
                weight: weight(number),
                intervals: found.intervals(),
                duration: found.times[found.intervals()] / 1e3,
            }
        });
        let mut units: Vec<String> = Vec::new();
        let of_motions = motions.list.iter();
        for unit in of_motions.flat_map(|one| one.control.objective_units(&one.system)) {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        Self {
            command: request.command.clone(),
            input: request.input.display().to_string(),
            status: verdict.word.to_owned(),
            message: verdict.message.clone(),
            notes: remarks.clone(),
            objective: whole.objective,
            objective_units: units,
            iterations: *iterations,
            variables: whole.variables,
            constraints: whole.constraints,
            jacobian_nonzeros: whole.jacobian_nonzeros,
            hessian_nonzeros: whole.hessian_nonzeros,
            parameters: constants.map(SoughtValue::new).collect(),
            shared_inputs: motions.shared_inputs.clone(),
            infeasibility: list
                .iter()
                .fold(0.0, |worst, one| one.optimum.infeasibility.max(worst)),
            gap: Some(whole.gap).filter(|gap| verdict.is_solved && gap.is_finite()),
            accuracy: accuracy.clone(),
            motions: entries.collect(),
            seconds: TotalSeconds::default(),
            versions: Versions::new(),
        }
    }

    /// Its text.
    pub(super) fn text(&self) -> String {
        lay_out(&serde_json::to_string(self).expect("numbers and names are JSON"))
    }
}
