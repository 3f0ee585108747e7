//! Optimal motions.

use crate::control::Solution;
use crate::interface::motion::Motion;
use crate::model::FoundParameter;
use crate::sensitivity::{Gradients, Sensitivity};
use crate::tasks::SolveResult;
use crate::workflow::{Afterwards, FinalValue, Repeated, Tracked};
use std::sync::Arc;

/// Result of the solver: an optimal motion, or its last iterate.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// Status at its end, in a word: `solved`, `not_reproduced`, `infeasible`, ….
    pub status: &'static str,
    /// Value of the objective.
    pub objective: f64,
    /// Iterations over all grids.
    pub iterations: usize,
    /// Reason why it is no optimum, where it is none.
    pub message: Option<String>,
    /// The motion with its voltages.
    pub motion: Motion,
    /// Deviations of markers and joints from the references that [`Control::track`](crate::interface::Control::track) and
    /// [`Control::track_joint`](crate::interface::Control::track_joint) name, marker by marker and joint by joint, in m and rad.
    pub tracking: Vec<Tracked>,
    /// Values at waypoints for which [`Control::marker_passes_near`](crate::interface::Control::marker_passes_near) and its neighbour ask.
    pub waypoint_values: Vec<FinalValue>,
    /// Values at the end of the motion for which final costs ask.
    pub final_values: Vec<FinalValue>,
    /// The motion that follows a goal that no voltages are known to hold.
    pub afterwards: Option<Afterwards>,
    /// A periodic motion under the same inputs again.
    pub repeated: Option<Repeated>,
    /// Parameters that were sought.
    pub parameters: Vec<FoundParameter>,
    /// Derivatives of the optimum by the numbers that [`Control::sensitivity`](crate::interface::Control::sensitivity) names; none where they do not
    /// exist, which a remark of the motion says.
    pub sensitivities: Vec<Sensitivity>,
    /// Derivatives of the outcomes that [`Control::outcome`](crate::interface::Control::outcome) names by these numbers.
    pub gradients: Option<Gradients>,
    pub(super) is_solved: bool,
    /// All that a later solve can start from, see [`Control::starting_from`](crate::interface::Control::starting_from).
    pub solution: Solution,
}

impl Optimum {
    pub(super) fn from_result(result: SolveResult) -> Self {
        let SolveResult {
            optimum, verdict, ..
        } = result;
        Self {
            status: verdict.word,
            objective: optimum.solution.objective,
            iterations: result.iterations,
            message: verdict.message,
            is_solved: verdict.is_solved,
            motion: Motion {
                exchange: result.exchange,
                model: Arc::new(optimum.model),
                discrete: Arc::new(result.discrete),
                trajectory: result.trajectory,
                remarks: result.remarks.0,
            },
            parameters: optimum.motion.parameters.clone(),
            sensitivities: result.sensitivities,
            gradients: result.gradients,
            tracking: result.tracking,
            waypoint_values: result.waypoint_values,
            final_values: result.final_values,
            afterwards: optimum.afterwards,
            repeated: optimum.repeated,
            solution: optimum.motion,
        }
    }

    /// Returns true if it meets the optimality conditions and a simulation under its voltages reproduces it.
    pub fn is_solved(&self) -> bool {
        self.is_solved
    }
}
