//! What an unknown of a model is, in words and in kind.

use crate::math::Vector;
use crate::model::system::JointKind;
use crate::model::{Coordinates, Model, Screw};

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
                let name = &self.solids[block].solid.name;
                format!("{} of node {node} of {name}", ["x", "y", "z"][axis])
            }
            Coordinates::Reduced => {
                let Freedom { of, screw, is_only } = self.freedom(i);
                match screw {
                    _ if is_only => format!("coordinate of {of}"),
                    Screw::Turn(axis) => format!("rotation about {} of {of}", axis_name(&axis)),
                    Screw::Slide(axis) => {
                        format!("displacement along {} of {of}", axis_name(&axis))
                    }
                }
            }
            Coordinates::Redundant => {
                let part = ["centre", "d1", "d2", "d3"][i % 12 / 3];
                let axis = ["x", "y", "z"][i % 3];
                format!(
                    "{} {part}.{axis}",
                    self.presolved.system.bodies[i / 12].name
                )
            }
        }
    }

    /// Whether coordinate `i` is a length, rather than an angle or a component of a director.
    pub fn is_length(&self, i: usize) -> bool {
        match self.coordinates {
            _ if i >= self.action.motion.of_bodies => true,
            Coordinates::Redundant => i % 12 < 3,
            Coordinates::Reduced => matches!(self.freedom(i).screw, Screw::Slide(_)),
        }
    }

    /// Joint coordinate `i` of reduced coordinates.
    pub fn freedom(&self, i: usize) -> Freedom<'_> {
        let system = &self.presolved.system;
        let mut at = i;
        for joint in &system.joints {
            let (screws, _) = joint.kind.screws();
            if let Some(&screw) = screws.get(at) {
                return Freedom {
                    of: &joint.name,
                    screw,
                    is_only: screws.len() == 1,
                };
            }
            at -= screws.len();
        }
        let (screws, _) = JointKind::Floating.screws();
        Freedom {
            of: &system.bodies[self.graph.free()[at / screws.len()]].name,
            screw: screws[at % screws.len()],
            is_only: false,
        }
    }
}

/// A joint coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Freedom<'m> {
    /// Name of the joint, or of the body that is free.
    pub of: &'m str,
    /// What it moves.
    pub screw: Screw,
    /// Whether it is the only coordinate of its joint.
    pub is_only: bool,
}

/// x, y or z of an axis of the ground frame.
fn axis_name(axis: &Vector) -> &'static str {
    ["x", "y", "z"][axis.iamax()]
}
