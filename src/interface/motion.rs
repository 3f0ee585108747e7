//! Motions: times, positions, poses, voltages and energies.

use crate::control::Solution;
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{DiscreteTrajectory, EnergyExchange, SourceEnergies, observations};
use crate::interface::handle::{Handle, Input};
use crate::kinematics::Pose;
use crate::model::system::{Body, Joint, Marker, Muscle};
use crate::model::{FoundParameter, Model};
use crate::sensitivity::{Gradients, Sensitivity};
use crate::tasks::SolveResult;
use crate::workflow::{Afterwards, FinalValue, Remark, Repeated, Tracked};
use nalgebra::Vector3;
use std::sync::Arc;

/// A motion: N + 1 instants and the N intervals between them.
#[derive(Clone, Debug)]
pub struct Motion {
    pub(super) model: Arc<Model>,
    pub(super) discrete: Arc<DiscreteTrajectory>,
    pub(super) trajectory: Trajectory,
    pub(super) exchange: EnergyExchange,
    /// Warnings and notes: steps that do not resolve it, muscles outside the domain of their material.
    pub(super) remarks: Vec<Remark>,
}

impl Motion {
    /// Instants in ms.
    pub fn times(&self) -> &[f64] {
        &self.trajectory.times
    }

    /// Places of a marker in mm, by instant.
    pub fn position(&self, marker: Handle<Marker>) -> Vec<Vector3<f64>> {
        self.trajectory.path(marker.index())
    }

    /// Coordinate of a revolute or prismatic joint in rad or mm, by instant; nothing of another joint.
    pub fn joint(&self, joint: Handle<Joint>) -> Vec<f64> {
        let joints = &self.model.system.joints;
        if !joints[joint.index()].has_coordinate() {
            return Vec::new();
        }
        let before = joints[..joint.index()].iter();
        let column = before.filter(|joint| joint.has_coordinate()).count();
        let rows = self.trajectory.joints.iter();
        rows.map(|row| row[column]).collect()
    }

    /// Poses of a body, by instant.
    pub fn pose(&self, body: Handle<Body>) -> Vec<Pose> {
        let rows = self.trajectory.poses.iter();
        rows.map(|row| row[body.index()]).collect()
    }

    /// Start in ms and input in V, N or N mm of each interval; nothing for parts without an input.
    pub fn voltage(&self, input: impl Into<Input>) -> Vec<(f64, f64)> {
        let Some(source) = input.into().source(&self.model.system) else {
            return Vec::new();
        };
        let rows = self.trajectory.voltages.iter();
        let starts = self.trajectory.times.iter();
        starts.zip(rows).map(|(&t, row)| (t, row[source])).collect()
    }

    /// Electrical energy in mJ from the source of a lumped muscle from the start to each instant; energy that flows back is negative. At
    /// the last instant of an optimum it includes the switch to the voltages that hold the goal, where they are known. Nothing of a muscle
    /// without voltage.
    pub fn electrical_energy(&self, muscle: Handle<Muscle>) -> &[f64] {
        self.exchanged(muscle)
            .map_or(&[], |source| &source.electrical_energy)
    }

    /// Work in mJ of the electrical forces of a lumped muscle from the start to each instant. Nothing of a muscle without voltage.
    pub fn mechanical_work(&self, muscle: Handle<Muscle>) -> &[f64] {
        self.exchanged(muscle)
            .map_or(&[], |source| &source.mechanical_work)
    }

    fn exchanged(&self, muscle: Handle<Muscle>) -> Option<&SourceEnergies> {
        let mut sources = self.exchange.sources.iter();
        sources.find(|one| one.source == muscle.index())
    }

    /// Returns the warnings and notes: steps that do not resolve it, muscles outside the domain of their material.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// All columns of `trajectory.csv` but the energies from sources, computed when they are asked for: rates of joints, tensions, fields,
    /// currents and powers, charges, energies, momenta, by their names and units.
    pub fn observations(&self) -> Observations {
        observations(&self.model, &self.discrete)
    }

    /// All of it, as tables and figures read it.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }
}

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
                model: optimum.model,
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
