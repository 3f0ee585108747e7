//! Distances between motions, and lengths of their paths.

use serde::Serialize;

use crate::control::Solution;
use crate::model::Model;
use crate::model::system::JointKind;

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

    /// The longest path of a joint, and of a body or a node, along a motion.
    pub(crate) fn path_length(model: &Model, motion: &Solution) -> Self {
        Self::path_length_by(model, motion, 1)
    }

    /// The same over every `stride`th instant.
    pub(crate) fn path_length_by(model: &Model, motion: &Solution, stride: usize) -> Self {
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
impl std::fmt::Display for Distance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
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
