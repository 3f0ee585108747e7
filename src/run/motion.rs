//! From coordinates and multipliers to what people look at: poses, joint coordinates, voltages by muscle.

use crate::control::{Costates, Solved};
use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::dynamics::{History, observations};
use crate::model::Model;
use crate::model::system::{Joint, JointKind};

/// Whether a joint has one coordinate.
pub(super) fn has_coordinate(joint: &Joint) -> bool {
    matches!(
        joint.kind,
        JointKind::Revolute { .. } | JointKind::Prismatic { .. }
    )
}

/// What is kept of a motion.
pub fn solved(model: &Model, history: &History, costates: Option<Costates>) -> Solved {
    let mut instant = model.action.motion.instant();
    let mut near = vec![0.0; model.gauges.len()];
    let (mut joints, mut poses) = (Vec::new(), Vec::new());
    for z in &history.z {
        instant.z.copy_from_slice(z);
        model.action.motion.place(&mut instant);
        near = model.joints(&instant, &near);
        joints.push(near.clone());
        poses.push(model.poses(&instant));
    }
    let voltages = history.scalars.iter().map(|scalars| {
        let mut row = vec![0.0; model.system.muscles.len()];
        for (&muscle, &voltage) in model.voltages.iter().zip(scalars) {
            row[muscle] = voltage;
        }
        row
    });
    Solved {
        coordinates: model.coordinates,
        times: history.times.clone(),
        joints,
        poses,
        z: history.z.clone(),
        multiplier_time: model.multiplier_time,
        voltages: voltages.collect(),
        costates,
    }
}

/// The motion as tables and figures show it.
pub fn trajectory(model: &Model, solved: &Solved) -> Trajectory {
    let shown = |row: &Vec<f64>| {
        let joints = row.iter().zip(&model.system.joints);
        joints
            .filter(|(_, joint)| has_coordinate(joint))
            .map(|(&value, _)| value)
            .collect()
    };
    Trajectory {
        times: solved.times.clone(),
        joints: solved.joints.iter().map(shown).collect(),
        poses: solved.poses.clone(),
        voltages: solved.voltages.clone(),
    }
}

/// What is observed at the instants of a motion that is kept.
pub(super) fn observed(model: &Model, kept: &Solved) -> Observations {
    let history = History {
        times: kept.times.clone(),
        z: kept.z.clone(),
        scalars: kept.voltages.iter().map(|v| model.scalars(v)).collect(),
        ..History::default()
    };
    observations(model, &history)
}
