//! Motions: times, positions, poses, voltages and energies.

use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{DiscreteTrajectory, EnergyExchange, SourceEnergies, observations};
use crate::interface::handle::Handle;
use crate::interface::input::Input;
use crate::kinematics::Pose;
use crate::model::Model;
use crate::model::system::{Body, Joint, Marker, Muscle};
use crate::workflow::Remark;
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
