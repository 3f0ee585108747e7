//! What a motion leaves behind: instants, joint coordinates, poses, voltages and observed columns.

use nalgebra::{Matrix3, Vector3};

use crate::model::system::{Attachment, JointKind, System};

/// Pose of a rigid body at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of mass in mm.
    pub centre: Vector3<f64>,
    /// The directors d₁, d₂, d₃ as columns, in the ground frame.
    pub directors: Matrix3<f64>,
}

/// What changes over time: N + 1 instants and the N intervals between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// Instants in ms, N + 1 of them; at least one.
    pub times: Vec<f64>,
    /// Joint coordinates in rad or mm, per instant; named by [`Trajectory::coordinates`].
    pub joints: Vec<Vec<f64>>,
    /// Poses per instant and body.
    pub poses: Vec<Vec<Pose>>,
    /// Voltages in V, per interval and muscle.
    pub voltages: Vec<Vec<f64>>,
}

impl Trajectory {
    /// Place in mm of a material point at instant `k`: c + R R₀ᵀ (X − c₀); points of the ground stay.
    pub fn point(&self, k: usize, point: &Attachment, system: &System) -> Vector3<f64> {
        match point.body {
            Some(body) => self.poses[k][body].carry(point.at, &Pose::reference(system, body)),
            None => point.at,
        }
    }

    /// Number N of intervals.
    pub fn intervals(&self) -> usize {
        self.times.len().saturating_sub(1)
    }

    /// Names and units of the joint coordinates, in the order of `joints`: one for a revolute or
    /// prismatic joint, none for a fixed one; spherical joints share evenly what remains.
    pub fn coordinates(&self, system: &System) -> Vec<Coordinate> {
        let count = |wanted: fn(&JointKind) -> bool| {
            system.joints.iter().filter(|j| wanted(&j.kind)).count()
        };
        let spherical = count(|kind| matches!(kind, JointKind::Spherical));
        let single = count(|kind| {
            matches!(
                kind,
                JointKind::Revolute { .. } | JointKind::Prismatic { .. }
            )
        });
        let total = self.joints.first().map_or(single, Vec::len);
        let share = total
            .saturating_sub(single)
            .checked_div(spherical)
            .unwrap_or(0);
        let mut coordinates = Vec::new();
        for joint in &system.joints {
            let (suffixes, unit) = match joint.kind {
                JointKind::Revolute { .. } => (vec![String::new()], "rad"),
                JointKind::Prismatic { .. } => (vec![String::new()], "mm"),
                JointKind::Spherical => ((1..=share).map(|i| format!("_{i}")).collect(), "rad"),
                JointKind::Fixed => (vec![], ""),
            };
            coordinates.extend(suffixes.iter().map(|suffix| Coordinate {
                name: format!("{}{suffix}", joint.name),
                unit,
            }));
        }
        coordinates
    }

    /// What a motion shows by itself: time, joint coordinates and marker positions.
    pub fn observe(&self, system: &System) -> Observations {
        let mut columns = vec![Column {
            name: "time".to_owned(),
            unit: "ms",
            values: self.times.clone(),
        }];
        for (i, coordinate) in self.coordinates(system).into_iter().enumerate() {
            columns.push(Column {
                name: coordinate.name,
                unit: coordinate.unit,
                values: self.joints.iter().map(|u| u[i]).collect(),
            });
        }
        for marker in &system.markers {
            let path: Vec<_> = (0..self.times.len())
                .map(|k| self.point(k, &marker.point, system))
                .collect();
            for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
                columns.push(Column {
                    name: format!("{}_{axis}", marker.name),
                    unit: "mm",
                    values: path.iter().map(|p| p[i]).collect(),
                });
            }
        }
        Observations { columns }
    }
}

/// Name and unit of a joint coordinate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coordinate {
    /// Name of the joint, numbered where a joint has several coordinates.
    pub name: String,
    /// `rad` or `mm`.
    pub unit: &'static str,
}

impl Pose {
    /// Pose of a body in the reference configuration.
    pub fn reference(system: &System, body: usize) -> Self {
        let body = &system.bodies[body];
        Self {
            centre: body.centre,
            directors: body.directors,
        }
    }

    /// Where the material point that stands at `at` in the pose `reference` stands in this pose, in mm.
    pub fn carry(&self, at: Vector3<f64>, reference: &Self) -> Vector3<f64> {
        self.centre + self.directors * reference.directors.tr_mul(&(at - reference.centre))
    }
}

/// Columns of numbers with names and units: one row per instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// The columns, all of one length.
    pub columns: Vec<Column>,
}

/// One observed quantity over the instants.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name, such as `kinetic_energy` or `tip_x`.
    pub name: String,
    /// Unit, such as `N mm`; empty for a pure number.
    pub unit: &'static str,
    /// One value per instant.
    pub values: Vec<f64>,
}
