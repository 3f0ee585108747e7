//! A simulation under the voltages of an earlier solution, compared with that solution: the accuracy of another model.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::Vector3;
use serde::Serialize;

use crate::dynamics::trajectory::Trajectory;
use crate::files::solution;
use crate::kinematics::Pose;
use crate::model::Model;
use crate::model::system::Marker;

/// Distance of the markers of two motions, in m.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    /// The solution.
    solution: String,
    /// By marker.
    markers: BTreeMap<String, Apart>,
}

/// Distances of one marker.
#[derive(Debug, Serialize)]
struct Apart {
    /// The greatest at the instants of the solution.
    greatest: f64,
    /// That at its last instant.
    last: f64,
    /// Length of the marker's path in the solution, to compare with.
    path_length: f64,
}

/// The motion of an earlier solution of a scene with the same joints and bodies; `None` where it is none, or where markers
/// are on blocks, whose nodes the other scene may not have.
pub(super) fn earlier(model: &Model, path: &Path) -> Option<Trajectory> {
    let solved = solution::read(path, model).ok()?;
    let markers = &model.system.markers;
    let on_bodies = markers.iter().all(|marker| marker.solid.is_none());
    if !on_bodies || solved.poses.len() != solved.times.len() {
        return None;
    }
    let joints = |row: &Vec<f64>| {
        let named = row.iter().zip(&model.system.joints);
        named
            .filter(|(_, joint)| joint.has_coordinate())
            .map(|(&value, _)| value)
            .collect()
    };
    let marks = |poses: &Vec<Pose>| markers.iter().map(|m| place(model, m, poses)).collect();
    Some(Trajectory {
        joints: solved.joints.iter().map(joints).collect(),
        marks: solved.poses.iter().map(marks).collect(),
        times: solved.times,
        poses: solved.poses,
        voltages: solved.voltages,
        ..Trajectory::default()
    })
}

fn place(model: &Model, marker: &Marker, poses: &[Pose]) -> Vector3<f64> {
    match marker.point.body {
        Some(body) => poses[body].point(&model.system.bodies[body].pose().local(&marker.point.at)),
        None => marker.point.at,
    }
}

impl Comparison {
    /// Compares a motion with an earlier one at the instants of that, as far as both go.
    pub(super) fn new(
        model: &Model,
        path: &Path,
        motion: &Trajectory,
        earlier: &Trajectory,
    ) -> Self {
        let apart = |m: usize| {
            let mut apart = Apart {
                greatest: 0.0,
                last: 0.0,
                path_length: 0.0,
            };
            let mut before = earlier.marks[0][m];
            for (&time, row) in earlier.times.iter().zip(&earlier.marks) {
                let Some(place) = at(motion, time, m) else {
                    break;
                };
                apart.last = (place - row[m]).norm() / 1e3;
                apart.greatest = apart.greatest.max(apart.last);
                apart.path_length += (row[m] - before).norm() / 1e3;
                before = row[m];
            }
            apart
        };
        let names = model.system.markers.iter().enumerate();
        Self {
            solution: path.display().to_string(),
            markers: names
                .map(|(m, marker)| (marker.name.clone(), apart(m)))
                .collect(),
        }
    }

    /// One line a marker.
    pub(super) fn notes(&self) -> Vec<String> {
        let line = |(name, apart): (&String, &Apart)| {
            format!(
                "{name}: at most {:.3} mm from the motion of {}, at its end {:.3} mm, after travelling {:.1} mm",
                1e3 * apart.greatest,
                self.solution,
                1e3 * apart.last,
                1e3 * apart.path_length
            )
        };
        self.markers.iter().map(line).collect()
    }
}

/// Place of a marker at a time in ms, between instants on the line between them.
fn at(motion: &Trajectory, time: f64, marker: usize) -> Option<Vector3<f64>> {
    let tolerance = 1e-9 * time.abs();
    let k = motion.times.iter().position(|&t| t >= time - tolerance)?;
    let (after, Some(before)) = (motion.marks[k][marker], k.checked_sub(1)) else {
        return Some(motion.marks[0][marker]);
    };
    let [from, to] = [motion.times[before], motion.times[k]];
    let s = ((time - from) / (to - from)).min(1.0);
    Some(motion.marks[before][marker] * (1.0 - s) + after * s)
}
