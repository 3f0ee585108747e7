//! Internal coordinates: numbers of an instant that belong to a part of the scene and are no places, with the value at a start.
//!
//! They have no mass. Each has an equation: a force that depends on it, or a constraint.

use crate::kinematics::MaterialVector;
use crate::model::analysis::Coordinates;
use crate::model::solids::Solids;
use crate::model::system::{Joint, JointKind, System};
use crate::model::variables::Size;

/// An internal coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Internal {
    /// Full name.
    pub(super) name: String,
    /// Typical size of its value.
    pub(super) size: Size,
    /// Joint of the presolved system of which it is the coordinate.
    pub(super) joint: usize,
}

impl Internal {
    fn of_joint(index: usize, joint: &Joint) -> Self {
        Self {
            name: format!("coordinate of {}", joint.name),
            size: match joint.kind {
                JointKind::Prismatic { .. } => Size::Length,
                _ => Size::One,
            },
            joint: index,
        }
    }
}

/// The internal coordinates of a model, behind all others.
#[derive(Debug)]
pub(super) struct Internals {
    /// Coordinate of each joint that has exactly one in the tree.
    of_tree: Vec<Option<usize>>,
    /// Number of the coordinates before them.
    first: usize,
    pub(super) list: Vec<Internal>,
}

impl Internals {
    /// Those of a presolved system, whose tree has `of_tree` coordinates: redundant coordinates lack those of joints with springs.
    pub(super) fn new(
        system: &System,
        coordinates: Coordinates,
        of_tree: usize,
        blocks: &Solids,
    ) -> Self {
        let nodes = blocks.nodes.iter().flat_map(|node| node.free);
        let of_nodes = nodes.filter(|&is_free| is_free).count();
        let joints = system.joints.iter().enumerate();
        let sprung = joints.filter(|(_, joint)| joint.spring.is_some());
        match coordinates {
            Coordinates::Reduced => Self {
                of_tree: system.joint_coordinates(),
                first: of_tree + of_nodes,
                list: Vec::new(),
            },
            Coordinates::Redundant => Self {
                of_tree: vec![None; system.joints.len()],
                first: 12 * system.bodies.len() + of_nodes,
                list: sprung
                    .map(|(j, joint)| Internal::of_joint(j, joint))
                    .collect(),
            },
        }
    }

    /// The vector that has the coordinate of a joint in its first component; `None` where nothing calls for it.
    pub(super) fn joint(&self, joint: usize) -> Option<MaterialVector> {
        let own = || self.list.iter().position(|own| own.joint == joint);
        let coordinate = self.of_tree[joint].or_else(|| Some(self.first + own()?));
        coordinate.map(MaterialVector::coordinate)
    }
}
