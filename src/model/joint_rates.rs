//! Rates of joint coordinates, from the rates of the coordinates of an instant, and what moves.

use crate::coordinates::Configuration;
use crate::energy::{Angle, Energy, Projection};
use crate::kinematics::Pose;
use crate::math::{Jet, Matrix, Vector};
use crate::model::analysis::Coordinates;
use crate::model::joints::{JointCoordinate, JointReading};
use crate::model::model::Model;
use nalgebra::SVector;

impl Model {
    /// Joints of the scene with exactly one coordinate, which can change.
    pub fn moving_joints(&self) -> Vec<usize> {
        let joints = self.system.joints.iter().enumerate();
        let moving = joints
            .filter(|(j, joint)| joint.has_coordinate() && self.presolved.joint(*j).is_some());
        moving.map(|(j, _)| j).collect()
    }

    /// Markers that can move, each with its vector.
    pub fn moving_markers(&self) -> Vec<(usize, usize)> {
        let markers = self.markers.iter().copied().enumerate();
        let moves = |&(_, vector): &(usize, usize)| !self.action.map.support(vector).is_empty();
        markers.filter(moves).collect()
    }

    /// Rate of the coordinate of a [moving joint](Self::moving_joints) in rad/ms or mm/ms, at a placed instant of which `l` holds the
    /// rates of the coordinates.
    pub fn joint_rate(&self, joint: usize, instant: &Configuration) -> f64 {
        let index = self.presolved.joint(joint).expect("a joint that moves");
        match self.coordinates {
            Coordinates::Reduced => {
                let coordinate = self.joint_readings[joint].coordinate;
                instant.l[coordinate.expect("a joint of one coordinate")]
            }
            Coordinates::Redundant => {
                let joint = &self.presolved.system.joints[index];
                let reading = JointReading::new(joint, None, &self.reference);
                let bodies = instant.l.chunks_exact(12);
                let bodies = bodies.take(self.presolved.system.bodies.len());
                let rates: Vec<Pose> = bodies.map(pose).collect();
                reading.rate(&self.condensed_poses(instant), &rates)
            }
        }
    }
}

/// Centre and directors, or their rates, of twelve numbers.
fn pose(q: &[f64]) -> Pose {
    Pose {
        centre: Vector::from_column_slice(&q[..3]),
        directors: Matrix::from_column_slice(&q[3..]),
    }
}

impl JointReading {
    /// Rate of the coordinate at poses with these rates; zero where there is no coordinate.
    fn rate(&self, poses: &[Pose], rates: &[Pose]) -> f64 {
        match &self.measure {
            JointCoordinate::Angle { vectors } => {
                let [p, w] = [
                    vectors.each_ref().map(|v| v.at(poses, &[])),
                    vectors.each_ref().map(|v| v.rate(rates)),
                ];
                let [p, w] = [p, w].map(|v| SVector::<f64, 9>::from_iterator(scalars(&v)));
                let angle: Jet<9, 3> = Angle { near: 0.0 }.at(&p, &w);
                angle.value_w
            }
            JointCoordinate::Displacement { axis, span } => {
                let [p, w] = [
                    [axis, span].map(|v| v.at(poses, &[])),
                    [axis, span].map(|v| v.rate(rates)),
                ];
                let [p, w] = [p, w].map(|v| SVector::<f64, 6>::from_iterator(scalars(&v)));
                let displacement: Jet<6, 3> = Projection.at(&p, &w);
                displacement.value_w
            }
            JointCoordinate::None => 0.0,
        }
    }
}

fn scalars(vectors: &[Vector]) -> impl Iterator<Item = f64> + '_ {
    vectors.iter().flat_map(|v| v.iter().copied())
}
