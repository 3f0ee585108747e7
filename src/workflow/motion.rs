//! Conversion of coordinates and multipliers to poses, joint coordinates and voltages by muscle.

use crate::control::{Costates, Solution};
use crate::dynamics::trajectory::{Trajectory, by_source};
use crate::dynamics::{DiscreteTrajectory, last_momentum};
use crate::ipopt::Iteration;
use crate::math::Vector;
use crate::model::system::Joint;
use crate::model::{FoundParameter, Model, Role};
use std::collections::BTreeMap;
use std::fmt;

/// Returns the solution that is stored of a motion.
pub fn solved(
    model: &Model,
    discrete: &DiscreteTrajectory,
    costates: Option<Costates>,
) -> Solution {
    solved_of(
        model,
        discrete,
        Trajectory::from_discrete(model, discrete),
        costates,
    )
}

/// The same of a motion whose poses and joint coordinates are known.
pub(crate) fn solved_of(
    model: &Model,
    discrete: &DiscreteTrajectory,
    motion: Trajectory,
    costates: Option<Costates>,
) -> Solution {
    // One value a joint, zero where a joint has no coordinate.
    let by_joint = |row: Vec<f64>| {
        let mut values = row.into_iter();
        let value = |joint: &Joint| joint.has_coordinate().then(|| values.next()).flatten();
        let joints = model.system.joints.iter();
        joints.map(value).map(Option::unwrap_or_default).collect()
    };
    Solution {
        coordinates: model.coordinates,
        times: motion.times,
        joints: motion.joints.into_iter().map(by_joint).collect(),
        poses: motion.poses,
        z: discrete.z.clone(),
        momentum: match discrete.momenta.last() {
            Some(momentum) => momentum.clone(),
            None => last_momentum(model, discrete).unwrap_or_default(),
        },
        meshes: meshes(model),
        multiplier_time: model.multiplier_time,
        voltages: motion.voltages,
        hold: discrete.held.as_ref().map(|row| by_source(model, row)),
        potentials: potentials(model, discrete),
        parameters: parameters(model, discrete),
        costates,
        barrier: None,
    }
}

/// Reference places of the nodes of each block.
fn meshes(model: &Model) -> BTreeMap<String, Vec<[f64; 3]>> {
    let blocks = model.solids.iter().map(|block| &block.solid);
    blocks
        .map(|solid| {
            let nodes = solid.mesh.nodes.iter().map(|&place| place.into());
            (solid.name.clone(), nodes.collect())
        })
        .collect()
}

/// Values of the parameters that a motion was found with; none where none is sought.
pub(crate) fn parameters(model: &Model, discrete: &DiscreteTrajectory) -> Vec<FoundParameter> {
    let range = model.variables.range(Role::Parameter);
    let values = discrete
        .scalars
        .first()
        .into_iter()
        .flat_map(|row| &row[range.clone()]);
    let parameters = model.analysis.parameters.iter().zip(values);
    parameters
        .map(|(parameter, &value)| parameter.found(value, &model.system))
        .collect()
}

/// The motion as tables and figures show it.
pub fn trajectory(model: &Model, solved: &Solution) -> Trajectory {
    let shown = |row: &Vec<f64>| {
        let joints = row.iter().zip(&model.system.joints);
        joints
            .filter(|(_, joint)| joint.has_coordinate())
            .map(|(&value, _)| value)
            .collect()
    };
    Trajectory {
        times: solved.times.clone(),
        joints: solved.joints.iter().map(shown).collect(),
        poses: solved.poses.clone(),
        marks: marks(model, &solved.z),
        voltages: solved.voltages.clone(),
        ends: Vec::new(),
        charges: model.circuit_charges(&solved.z),
    }
}

/// Places of the markers at instants with coordinates z.
fn marks(model: &Model, z: &[Vec<f64>]) -> Vec<Vec<Vector>> {
    let mut instant = model.action.map.instant();
    let mut at = |z: &Vec<f64>| {
        instant.z.copy_from_slice(z);
        model.action.map.vectors(&mut instant);
        model.markers.iter().map(|&v| instant.x[v]).collect()
    };
    z.iter().map(&mut at).collect()
}

/// Potentials of a motion by interval; none where a scene has none.
fn potentials(model: &Model, discrete: &DiscreteTrajectory) -> Vec<Vec<f64>> {
    let potentials = model.variables.range(Role::Potential);
    if potentials.is_empty() {
        return Vec::new();
    }
    let rows = discrete.scalars.iter();
    rows.map(|row| row[potentials.clone()].to_vec()).collect()
}

/// Voltages and potentials of a motion that is kept, by interval.
pub(crate) fn scalars(model: &Model, kept: &Solution) -> Vec<Vec<f64>> {
    let row = |(k, voltages): (usize, &Vec<f64>)| {
        let mut row = model.variables.scalars(&model.scalars(voltages));
        let potentials = &mut row[model.variables.range(Role::Potential)];
        let known = kept.potentials.get(k).into_iter().flatten();
        potentials
            .iter_mut()
            .zip(known)
            .for_each(|(to, from)| *to = *from);
        row
    };
    kept.voltages.iter().enumerate().map(row).collect()
}

/// The record of a motion that is kept.
pub(crate) fn discrete_trajectory(model: &Model, kept: &Solution) -> DiscreteTrajectory {
    DiscreteTrajectory {
        times: kept.times.clone(),
        z: kept.z.clone(),
        scalars: scalars(model, kept),
        ..DiscreteTrajectory::default()
    }
}

/// Gives the motions of an iterate by their numbers.
pub type IterateMotions<'a> = &'a dyn Fn(usize) -> Solution;

/// An iterate of the solver.
pub struct Iterate<'a> {
    /// Report of the solver on it.
    pub report: &'a Iteration,
    /// The models, one for each motion.
    pub models: &'a [&'a Model],
    /// Its motions.
    pub motions: IterateMotions<'a>,
    /// Report of the solver on the iterate before, and the motions of that one with their costates, with which a later solve goes on; where they
    /// are known.
    pub before: Option<(&'a Iteration, IterateMotions<'a>)>,
}

impl fmt::Debug for Iterate<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}
