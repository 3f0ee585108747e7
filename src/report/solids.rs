//! Bodies and muscles as solids in space: the geometry that figures and page share.
//!
//! Voltages that colour muscles in pictures: those of their electrodes.
//!
//! They are those of the sources but for muscles with a charge, whose voltage is an observation at the instants.

use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::kinematics::Pose;
use crate::mesh::triangulated::faces_of_box;
use crate::model::system::{Attachment, System};
use nalgebra::Vector3;
use std::borrow::Cow;

/// A box that may be skewed: corner `i` is at + or − along edge `j` as bit `j` of `i` is set or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prism {
    /// Centre in mm.
    pub centre: Vector3<f64>,
    /// Half of each edge in mm; the third runs along the length.
    pub halves: [Vector3<f64>; 3],
}

/// A face of a prism: its outward normal, not of unit length, and its corners in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Outward normal.
    pub normal: Vector3<f64>,
    /// Corners in mm.
    pub corners: [Vector3<f64>; 4],
}

impl Prism {
    /// A box along the directors of a pose, with edge lengths in mm.
    pub fn block(pose: &Pose, size: [f64; 3]) -> Self {
        let half = |i: usize| pose.directors.column(i) * (size[i] / 2.0);
        Self {
            centre: pose.centre,
            halves: [half(0), half(1), half(2)],
        }
    }

    /// A muscle at instant `k`: sides of its cross-section follow its body and shrink as 1/√Λ,
    /// so that the volume stays.
    pub fn muscle(system: &System, trajectory: &Trajectory, k: usize, muscle: usize) -> Self {
        let muscle = &system.muscles[muscle];
        let from = trajectory.point(k, &muscle.from, system);
        let to = trajectory.point(k, &muscle.to, system);
        let span = to - from;
        let length = span.norm().max(1e-9);
        let rest = (muscle.to.at - muscle.from.at).norm();
        let shrink = (rest / length).sqrt();
        let (a, b) = section_axes(
            &muscle.from,
            &muscle.to,
            &trajectory.poses[k],
            span / length,
        );
        let [width, depth] = muscle.cross_section.map(|side| side * shrink / 2.0);
        Self {
            centre: (from + to) / 2.0,
            halves: [a * width, b * depth, span / 2.0],
        }
    }

    /// The eight corners in mm.
    pub fn corners(&self) -> [Vector3<f64>; 8] {
        std::array::from_fn(|i| {
            let sign = |j: usize| if i >> j & 1 == 1 { 1.0 } else { -1.0 };
            self.centre
                + (0..3)
                    .map(|j| self.halves[j] * sign(j))
                    .sum::<Vector3<f64>>()
        })
    }

    /// The six faces.
    pub fn faces(&self) -> [Face; 6] {
        let faces = faces_of_box(self.centre, &self.halves);
        std::array::from_fn(|i| {
            let (axis, sign) = (i / 2, if i % 2 == 0 { 1.0 } else { -1.0 });
            let out = self.halves[axis] * sign;
            let (a, b) = (self.halves[(axis + 1) % 3], self.halves[(axis + 2) % 3]);
            Face {
                normal: a.cross(&b) * a.cross(&b).dot(&out).signum(),
                corners: faces[i],
            }
        })
    }
}

/// Two orthonormal directions across a span: the body's director that lies most across it, made normal, and the third.
fn section_axes(
    from: &Attachment,
    to: &Attachment,
    poses: &[Pose],
    along: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let directors = match to.body.or(from.body) {
        Some(body) => poses[body].directors,
        None => nalgebra::Matrix3::identity(),
    };
    let across = (0..3)
        .map(|i| directors.column(i).into_owned())
        .min_by(|a, b| a.dot(&along).abs().total_cmp(&b.dot(&along).abs()))
        .unwrap_or_else(Vector3::x);
    let a = (across - along * across.dot(&along)).normalize();
    (a, along.cross(&a))
}

/// The line across a side face at `height` from −1 to 1 along the length of its prism.
pub(super) fn slice(
    corners: &[Vector3<f64>; 4],
    half: &Vector3<f64>,
    centre: Vector3<f64>,
    height: f64,
) -> Vec<Vector3<f64>> {
    let at = |p: &Vector3<f64>| (p - centre).dot(half) / half.norm_squared();
    let edges = (0..4).map(|i| (corners[i], corners[(i + 1) % 4]));
    edges
        .filter(|(a, b)| (at(a) - height) * (at(b) - height) < 0.0)
        .map(|(a, b)| a + (b - a) * ((height - at(&a)) / (at(&b) - at(&a))))
        .collect()
}

/// The motion with the voltages of the electrodes at the end of each interval.
pub fn coloured<'t>(
    system: &System,
    trajectory: &'t Trajectory,
    observations: &Observations,
) -> Cow<'t, Trajectory> {
    let mut out = Cow::Borrowed(trajectory);
    let charged = (0..system.muscles.len()).filter(|&m| !system.has_source_voltage(m));
    for muscle in charged {
        let name = format!("{}_voltage", system.muscles[muscle].name);
        let is_own = |column: &&Column| column.name == name;
        let Some(column) = observations.columns.iter().find(is_own) else {
            continue;
        };
        let rows = out.to_mut().voltages.iter_mut();
        for (row, voltage) in rows.zip(column.values.iter().skip(1)) {
            row[muscle] = *voltage;
        }
    }
    out
}
