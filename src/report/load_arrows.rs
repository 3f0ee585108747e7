//! Loads as arrows: along the force from the point on which it acts, or about the axis of the joint as an arc, as long as the load is
//! large relative to its largest size in the motion.

use crate::dynamics::trajectory::Trajectory;
use crate::model::components::{Load, LoadPlace};
use crate::model::system::{Attachment, JointKind, System};
use crate::report::body::extent_points;
use nalgebra::{Rotation3, Unit, Vector3};

/// Length of the longest arrow, as a part of the size of the system.
const LENGTH: f64 = 0.25;
/// Radius of an arc, as a part of the longest arrow.
const RADIUS: f64 = 0.5;
/// Angle in rad of the longest arc.
const ARC: f64 = 1.5 * std::f64::consts::PI;
/// Length of the head of an arrow, as a part of the longest one, and its half width as a part of that.
const HEAD: [f64; 2] = [0.22, 0.4];
/// Segments of the shaft.
const SEGMENTS: usize = 24;

/// The loads of a motion, ready to be drawn at any instant.
pub(super) struct LoadArrows<'a> {
    system: &'a System,
    trajectory: &'a Trajectory,
    /// Source of the first load.
    first: usize,
    /// Largest size of each load in the motion.
    largest: Vec<f64>,
    /// Length of the longest arrow in mm.
    length: f64,
}

impl<'a> LoadArrows<'a> {
    /// Of a motion; of one without inputs none.
    pub(super) fn new(system: &'a System, trajectory: &'a Trajectory) -> Self {
        let first = system.first_load();
        let count = system.components.loads.len();
        let largest = |load: usize| {
            let rows = trajectory.voltages.iter();
            rows.map(|row| row[first + load].abs()).fold(0.0, f64::max)
        };
        Self {
            system,
            trajectory,
            first,
            largest: match trajectory.voltages.is_empty() {
                true => Vec::new(),
                false => (0..count).map(largest).collect(),
            },
            length: LENGTH * size(system),
        }
    }

    /// Each load that ever acts with its source.
    pub(super) fn loads(&self) -> impl Iterator<Item = (usize, &'a Load)> + '_ {
        let first = self.first;
        let loads = self.largest.iter().zip(&self.system.components.loads);
        let loads = loads
            .enumerate()
            .filter(|(_, (largest, _))| **largest > 0.0);
        loads.map(move |(index, (_, load))| (first + index, load))
    }

    /// Its arrow at an instant, in mm: always the same number of points.
    pub(super) fn arrow(&self, source: usize, load: &Load, k: usize) -> Vec<Vector3<f64>> {
        let rows = &self.trajectory.voltages;
        let size = rows[k.min(rows.len() - 1)][source];
        let part = size / self.largest[source - self.first];
        let place = |point: Attachment| self.trajectory.point(k, &point, self.system);
        let (at, axis, is_turn) = match load.on {
            LoadPlace::Point { at, direction } => (place(at), direction, false),
            LoadPlace::Joint(joint) => {
                let joint = &self.system.joints[joint];
                let on = |at| Attachment {
                    body: Some(joint.child),
                    at,
                };
                let at = place(on(joint.at));
                let along = |axis: &Vector3<f64>| place(on(joint.at + axis)) - at;
                match &joint.kind {
                    JointKind::Revolute { axis } => (at, along(axis), true),
                    JointKind::Prismatic { axis } => (at, along(axis), false),
                    _ => (at, Vector3::zeros(), false),
                }
            }
        };
        let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
        let shaft = |s: f64| match is_turn {
            false => at + axis * (self.length * part * s),
            true => {
                let turn = Rotation3::from_axis_angle(&Unit::new_normalize(axis), ARC * part * s);
                at + turn * across * (RADIUS * self.length)
            }
        };
        let side = if is_turn { axis } else { across };
        with_head(shaft, &side, self.length * part.abs())
    }
}

/// Points of a shaft from s = 0 to 1, then of the four barbs of its head, two of them along a side.
fn with_head(
    shaft: impl Fn(f64) -> Vector3<f64>,
    side: &Vector3<f64>,
    length: f64,
) -> Vec<Vector3<f64>> {
    let at = |i: usize| shaft(i as f64 / SEGMENTS as f64);
    let mut points: Vec<_> = (0..=SEGMENTS).map(at).collect();
    let tip = points[SEGMENTS];
    let along = tip - points[SEGMENTS - 1];
    let along = along.try_normalize(0.0).unwrap_or_default();
    let other = along.cross(side);
    let back = HEAD[0] * length;
    for out in [*side, -side, other, -other] {
        points.push(tip - along * back + out * (HEAD[1] * back));
        points.push(tip);
    }
    points
}

/// Diagonal in mm of the box around the bodies, joints and loads in the reference configuration; 1 where it is a point.
fn size(system: &System) -> f64 {
    let bodies = system.bodies.iter();
    let bodies = bodies.flat_map(|body| extent_points(&body.shape, &body.pose()));
    let joints = system.joints.iter().map(|joint| joint.at);
    let loads = system.components.loads.iter();
    let loads = loads.filter_map(|load| match load.on {
        LoadPlace::Point { at, .. } => Some(at.at),
        LoadPlace::Joint(_) => None,
    });
    let points: Vec<_> = bodies.chain(joints).chain(loads).collect();
    let corner = |pick: fn(&Vector3<f64>, &Vector3<f64>) -> Vector3<f64>| {
        points.iter().copied().reduce(|a, b| pick(&a, &b))
    };
    match (corner(Vector3::inf), corner(Vector3::sup)) {
        (Some(low), Some(high)) if low != high => (high - low).norm(),
        _ => 1.0,
    }
}
