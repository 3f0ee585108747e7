//! Motions as they are kept, their conversion from unknowns, and distances between them.

use crate::control::{Costates, Solution};
use crate::dynamics::trajectory::{Trajectory, by_source};
use crate::dynamics::{DiscreteTrajectory, last_momentum};
use crate::ipopt::Iteration;
use crate::model::system::{Joint, JointKind};
use crate::model::{FoundParameter, Model, Role};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Returns the solution that is stored of a motion.
pub fn solved(
    model: &Model,
    discrete: &DiscreteTrajectory,
    costates: Option<Costates>,
) -> Solution {
    let motion = Trajectory::from_discrete(model, discrete);
    solved_of(model, discrete, motion, costates)
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
    let meshes = blocks.map(|solid| {
        let nodes = solid.mesh.nodes.iter().map(|&place| place.into());
        (solid.name.clone(), nodes.collect())
    });
    meshes.collect()
}

/// Values of the parameters that a motion was found with; none where none is sought.
pub(crate) fn parameters(model: &Model, discrete: &DiscreteTrajectory) -> Vec<FoundParameter> {
    let range = model.variables.range(Role::Parameter);
    let values = discrete.scalars.first().into_iter();
    let values = values.flat_map(|row| &row[range.clone()]);
    let parameters = model.analysis.parameters.iter().zip(values);
    let found = parameters.map(|(parameter, &value)| parameter.found(value, &model.system));
    found.collect()
}

/// The motion as tables and figures show it.
pub fn trajectory(model: &Model, solved: &Solution) -> Trajectory {
    Trajectory::from_discrete(model, &discrete_trajectory(model, solved))
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
    let rows = kept.voltages.iter().enumerate();
    let rows = rows.map(|(k, voltages)| {
        let mut row = model.variables.scalars(&model.scalars(voltages));
        let potentials = &mut row[model.variables.range(Role::Potential)];
        let known = kept.potentials.get(k).into_iter().flatten();
        let potentials = potentials.iter_mut().zip(known);
        potentials.for_each(|(to, from)| *to = *from);
        row
    });
    rows.collect()
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

/// Ways that count as none, in rad and in lengths of the system.
const NO_LENGTH: f64 = 1e-3;

/// Distance of an instant from another, or length of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Distance {
    /// Greatest distance of a joint angle, or of the orientation of a body that joint angles do not give, in rad.
    pub angle: f64,
    /// Greatest distance of a joint displacement, of the centre of a body or of a node in m.
    pub length: f64,
}

impl Distance {
    /// Between instant `k` of a motion and instant `l` of another.
    pub(crate) fn between(
        model: &Model,
        motion: &Solution,
        k: usize,
        other: &Solution,
        l: usize,
    ) -> Self {
        let mut out = Self::default();
        each(model, motion, k, other, l, |_, kind, apart| {
            let part = out.part(kind);
            *part = part.max(apart);
        });
        out
    }

    /// The longest path of a joint, and of a body or a node, over every `stride`th instant of a motion.
    pub(crate) fn path_length(model: &Model, motion: &Solution, stride: usize) -> Self {
        let mut lengths: Vec<(DistanceKind, f64)> = Vec::new();
        for k in (stride..motion.times.len()).step_by(stride) {
            each(model, motion, k - stride, motion, k, |i, kind, apart| {
                lengths.resize(lengths.len().max(i + 1), (kind, 0.0));
                lengths[i] = (kind, lengths[i].1 + apart);
            });
        }
        let mut out = Self::default();
        for (kind, path_length) in lengths {
            let part = out.part(kind);
            *part = part.max(path_length);
        }
        out
    }

    /// The greater of both, part by part.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            angle: self.angle.max(other.angle),
            length: self.length.max(other.length),
        }
    }

    /// The smaller of both, part by part.
    pub(crate) fn min(self, other: Self) -> Self {
        Self {
            angle: self.angle.min(other.angle),
            length: self.length.min(other.length),
        }
    }

    /// The greater of angle and length, in rad and lengths of the system.
    pub(crate) fn size(self, model: &Model) -> f64 {
        self.angle.max(self.length / metres(model))
    }

    /// The greater part of a way that this is, of its angle or of its length.
    pub(crate) fn over(self, path_length: Self, model: &Model) -> f64 {
        let length = metres(model);
        let turned = self.angle / path_length.angle.max(NO_LENGTH);
        turned.max(self.length / path_length.length.max(NO_LENGTH * length))
    }

    fn part(&mut self, kind: DistanceKind) -> &mut f64 {
        match kind {
            DistanceKind::Angle => &mut self.angle,
            DistanceKind::Length => &mut self.length,
        }
    }
}

/// In words, as in `0.0210 rad, 3.40 mm`.
impl fmt::Display for Distance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} rad, {} mm",
            digits(self.angle),
            digits(1e3 * self.length)
        )
    }
}

/// A number with three digits; rounding, and what is beyond all measure, with its power of ten.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e4).contains(&value) {
        return format!("{value:.2e}");
    }
    let places = (2.0 - value.log10().floor()).max(0.0) as usize;
    format!("{value:.places$}")
}

#[derive(Clone, Copy, Debug)]
enum DistanceKind {
    Angle,
    Length,
}

/// Length of the system in m.
fn metres(model: &Model) -> f64 {
    model.length() / 1e3
}

/// Calls `visit` with number, kind and distance (rad or m) of each joint, body and coordinate of a node; of a body also the angle
/// between its orientations, where joint coordinates do not give all.
fn each(
    model: &Model,
    motion: &Solution,
    k: usize,
    other: &Solution,
    l: usize,
    mut visit: impl FnMut(usize, DistanceKind, f64),
) {
    let mut number = 0..;
    let mut next = |kind, apart| visit(number.next().unwrap_or_default(), kind, apart);
    let joints = motion.joints[k].iter().zip(&other.joints[l]);
    for ((a, b), joint) in joints.zip(&model.system.joints) {
        match joint.kind {
            JointKind::Prismatic { .. } => next(DistanceKind::Length, (a - b).abs() / 1e3),
            _ => next(DistanceKind::Angle, (a - b).abs()),
        }
    }
    let turns_freely = model.turns_freely();
    for (a, b) in motion.poses[k].iter().zip(&other.poses[l]) {
        next(DistanceKind::Length, (a.centre - b.centre).norm() / 1e3);
        if turns_freely {
            // ‖A − B‖ = 2√2 sin(θ/2), exact where both are nearly the same.
            let half = (a.directors - b.directors).norm() / 8.0_f64.sqrt();
            next(DistanceKind::Angle, 2.0 * half.min(1.0).asin());
        }
    }
    let nodes = model.action.map.nodes();
    for (a, b) in motion.z[k][nodes.clone()].iter().zip(&other.z[l][nodes]) {
        next(DistanceKind::Length, (a - b).abs() / 1e3);
    }
}
