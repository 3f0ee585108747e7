//! A simulation under the voltages of an earlier solution, compared with that solution: the accuracy of another model.

use crate::dynamics::trajectory::Trajectory;
use crate::files::solution;
use crate::kinematics::Pose;
use crate::model::Model;
use crate::model::system::Marker;
use crate::workflow::accuracy::{Accuracy, GridLevel, greatest};
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Distance of the markers of two motions, in m.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    /// The solution.
    solution: String,
    /// By marker.
    markers: BTreeMap<String, Apart>,
}

/// Distances of one marker.
#[derive(Debug, Default, Serialize)]
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
    let mut markers = model.system.markers.iter();
    let on_bodies = markers.all(|marker| marker.solid.is_none());
    if !on_bodies || solved.poses.len() != solved.times.len() {
        return None;
    }
    let system = &model.system;
    let marks = |poses: &Vec<Pose>| {
        let place = |m: &Marker| m.point.place(poses, |body| system.bodies[body].pose());
        system.markers.iter().map(place).collect()
    };
    let joints = |row: &Vec<f64>| {
        let named = row.iter().zip(&system.joints);
        let named = named.filter(|(_, joint)| joint.has_coordinate());
        named.map(|(&value, _)| value).collect()
    };
    Some(Trajectory {
        joints: solved.joints.iter().map(joints).collect(),
        marks: solved.poses.iter().map(marks).collect(),
        times: solved.times,
        poses: solved.poses,
        voltages: solved.voltages,
        ..Trajectory::default()
    })
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
            let mut apart = Apart::default();
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
        let lines = self.markers.iter().map(|(name, apart)| {
            format!(
                "{name}: at most {:.3} mm from the motion of {}, at its end {:.3} mm, after travelling {:.1} mm",
                1e3 * apart.greatest,
                self.solution,
                1e3 * apart.last,
                1e3 * apart.path_length
            )
        });
        lines.collect()
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

/// Errors that have a column, where a run has them.
const COLUMNS: [&str; 5] = ["objective", "duration", "path", "end", "response"];

impl Accuracy {
    /// The grids as a table, one line each, and why there is no finer one.
    pub(super) fn notes(&self) -> Vec<String> {
        let has_objective = self.levels[0].objective.is_some();
        let is_estimated =
            |name: &&&str| self.levels.iter().any(|l| l.estimate.contains_key(**name));
        let columns: Vec<&str> = COLUMNS.iter().filter(is_estimated).copied().collect();
        let mut head = "intervals  iterations   seconds".to_owned();
        if has_objective {
            head.push_str("     objective");
        }
        for (i, name) in columns.iter().enumerate() {
            let lead = if i == 0 { "  error of " } else { "" };
            head.push_str(&format!("{lead}{name:>10}"));
        }
        let line = |level: &GridLevel| {
            let (n, i) = (level.intervals, level.iterations);
            let mut line = format!("{n:>9}{i:>12}{:>10.2}", level.seconds);
            if let Some(objective) = level.objective {
                line.push_str(&format!("{objective:>14.7}"));
            }
            for (i, name) in columns.iter().enumerate() {
                let lead = if i == 0 { "           " } else { "" };
                let error = level.estimate.get(name);
                let error = error.map_or(String::new(), |e| format!("{e:.1e}"));
                line.push_str(&format!("{lead}{error:>10}"));
            }
            line.trim_end().to_owned()
        };
        let lines = self.levels.iter().map(line);
        let mut notes: Vec<String> = std::iter::once(head).chain(lines).collect();
        let orders: Vec<String> = self
            .order
            .iter()
            .map(|(name, p)| format!("{name} {p:.2}"))
            .collect();
        if !orders.is_empty() {
            notes.push(format!("orders observed: {}", orders.join(", ")));
        }
        let growing = self.order.iter().filter(|(_, p)| **p <= 0.0);
        let growing: Vec<&str> = growing.map(|(name, _)| *name).collect();
        if !growing.is_empty() {
            notes.push(format!(
                "the last refinement changed {} no less than the one before: errors do not fall steadily, their estimates are rough",
                growing.join(" and ")
            ));
        }
        notes.extend(self.stopped.as_deref().map(|word| match word {
            "too_large" => "no finer grid is tried: it would be too large".to_owned(),
            "time_limit" => "no finer grid: the time allowed was used up".to_owned(),
            "interrupted" => "no finer grid: interrupted".to_owned(),
            other => format!("no finer grid: {}", other.replace('_', " ")),
        }));
        notes
    }

    /// The accuracy of a run that is `done` ("solved", "simulated"), in words, and true if that is what was asked for.
    pub(super) fn outcome(&self, done: &str) -> (String, bool) {
        let error = greatest(&self.estimate);
        let found = error.map_or_else(
            || "error not known".to_owned(),
            |(name, error)| format!("error about {error:.1e} ({name})"),
        );
        match self.requested {
            Some(asked) if error.is_none() || self.is_met != Some(true) => {
                (format!("{done}, but not to {asked:e}: {found}"), false)
            }
            _ => (format!("{done}, {found}"), true),
        }
    }
}
