//! What an unknown of a model is, in words and in kind.

use crate::model::system::{Joint, JointKind};
use crate::model::{Coordinates, Model};

impl Model {
    /// What coordinate or multiplier `i` of an instant is, or what potential of an interval after these.
    pub fn unknown_name(&self, i: usize) -> String {
        let n = self.coordinate_count();
        match self.coordinates {
            _ if i >= n + self.multiplier_names.len() => {
                let potential = i - n - self.multiplier_names.len();
                format!("potential of {}", self.potential_names[potential])
            }
            _ if i >= n => format!("multiplier of {}", self.multiplier_names[i - n]),
            _ if i >= self.action.motion.of_bodies => {
                let (node, axis) = self.action.motion.of_nodes[i - self.action.motion.of_bodies];
                let (block, node) = self.node_names[node];
                let name = &self.continua[block].solid.name;
                format!("{} of node {node} of {name}", ["x", "y", "z"][axis])
            }
            Coordinates::Reduced => {
                let joint = self.gauges.iter().position(|g| g.coordinate == Some(i));
                format!(
                    "coordinate of {}",
                    self.system.joints[joint.expect("each coordinate has a joint")].name
                )
            }
            Coordinates::Redundant => {
                let part = ["centre", "d1", "d2", "d3"][i % 12 / 3];
                let axis = ["x", "y", "z"][i % 3];
                format!(
                    "{} {part}.{axis}",
                    self.condensed.system.bodies[i / 12].name
                )
            }
        }
    }

    /// Whether coordinate `i` is a length, rather than an angle or a component of a director.
    pub fn is_length(&self, i: usize) -> bool {
        match self.coordinates {
            _ if i >= self.action.motion.of_bodies => true,
            Coordinates::Redundant => i % 12 < 3,
            Coordinates::Reduced => {
                let prismatic = |j: &Joint| matches!(j.kind, JointKind::Prismatic { .. });
                let joint = self.gauges.iter().position(|g| g.coordinate == Some(i));
                joint.is_some_and(|j| prismatic(&self.system.joints[j]))
            }
        }
    }
}
