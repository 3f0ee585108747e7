//! The joint graph: a spanning tree from the ground, and the joints that close loops.

use crate::kinematics::{MaterialVector, Pose};
use crate::math::Vector;
use crate::model::ModelError;
use crate::model::system::{JointKind, System};
use crate::reduction::{Tree, TreeJoint, TreeKind};

/// Joints in an order from the ground outwards, those that close loops, and bodies that nothing holds.
#[derive(Clone, Debug)]
pub struct Graph {
    /// (joint, whether it is walked from child to parent).
    tree: Vec<(usize, Direction)>,
    /// Joints that close loops.
    loops: Vec<usize>,
    /// First bodies of parts that no joint connects to the ground.
    free: Vec<usize>,
}

/// In which direction the spanning tree walks a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Forward,
    Backward,
}

impl Graph {
    /// The spanning tree of a system, joints in the order of the scene.
    pub fn new(system: &System) -> Self {
        let mut graph = Self {
            tree: Vec::new(),
            loops: Vec::new(),
            free: Vec::new(),
        };
        let mut reached = vec![false; system.bodies.len()];
        let mut used = vec![false; system.joints.len()];
        loop {
            graph.grow(system, &mut reached, &mut used);
            let Some(body) = reached.iter().position(|r| !r) else {
                break;
            };
            graph.free.push(body);
            reached[body] = true;
        }
        graph.loops = (0..system.joints.len()).filter(|&j| !used[j]).collect();
        graph
    }

    fn grow(&mut self, system: &System, reached: &mut [bool], used: &mut [bool]) {
        loop {
            let mut grown = false;
            for (j, joint) in system.joints.iter().enumerate() {
                let parent = joint.parent.is_none_or(|b| reached[b]);
                if used[j] || parent == reached[joint.child] {
                    continue;
                }
                let direction = if parent {
                    Direction::Forward
                } else {
                    Direction::Backward
                };
                reached[joint.child] = true;
                if let Some(body) = joint.parent {
                    reached[body] = true;
                }
                used[j] = true;
                grown = true;
                self.tree.push((j, direction));
            }
            if !grown {
                return;
            }
        }
    }

    /// Joints that close loops.
    pub fn loops(&self) -> &[usize] {
        &self.loops
    }

    /// Why reduced coordinates do not exist, if they do not.
    pub fn obstacle(&self, system: &System) -> Option<ModelError> {
        let spherical = self
            .tree
            .iter()
            .find(|(j, _)| system.joints[*j].kind == JointKind::Spherical);
        let reason = if let Some(&j) = self.loops.first() {
            format!("joint \"{}\" closes a loop", system.joints[j].name)
        } else if let Some(&body) = self.free.first() {
            format!(
                "no joint connects body \"{}\" to the ground",
                system.bodies[body].name
            )
        } else {
            format!(
                "joint \"{}\" is spherical",
                system.joints[spherical?.0].name
            )
        };
        Some(ModelError::NoTree { reason })
    }

    /// The spanning tree as kinematics; spherical joints and free bodies stay at their reference pose.
    pub fn tree(&self, system: &System, reference: &[Pose], vectors: &[MaterialVector]) -> Tree {
        let pose = |body: Option<usize>| body.map_or(Pose::GROUND, |b| reference[b]);
        let coordinates = system.joint_coordinates();
        let held = |&(j, direction): &(usize, Direction)| {
            let joint = &system.joints[j];
            let (parent, child) = match direction {
                Direction::Forward => (joint.parent, joint.child),
                Direction::Backward => (
                    Some(joint.child),
                    joint.parent.expect("the ground is reached first"),
                ),
            };
            let (kind, axis) = match joint.kind {
                JointKind::Revolute { axis } => (TreeKind::Revolute, axis),
                JointKind::Prismatic { axis } => (TreeKind::Prismatic, axis),
                JointKind::Spherical | JointKind::Fixed => (TreeKind::Fixed, Vector::z()),
            };
            // Walked backwards, the same coordinate moves the other body the other way.
            let sign = if direction == Direction::Forward {
                1.0
            } else {
                -1.0
            };
            let (p, c) = (pose(parent), reference[child]);
            TreeJoint {
                kind,
                parent,
                child,
                axis: p.directors.tr_mul(&axis) * sign,
                point: p.local(&joint.at),
                directors: p.directors.tr_mul(&c.directors),
                centre: p.directors.tr_mul(&(c.centre - joint.at)),
                coordinate: coordinates[j],
            }
        };
        let free = |&body: &usize| TreeJoint {
            kind: TreeKind::Fixed,
            parent: None,
            child: body,
            axis: Vector::z(),
            point: Vector::zeros(),
            directors: reference[body].directors,
            centre: reference[body].centre,
            coordinate: None,
        };
        let joints = self
            .free
            .iter()
            .map(free)
            .chain(self.tree.iter().map(held))
            .collect();
        Tree::new(joints, system.bodies.len(), vectors)
    }

    /// Poses at joint coordinates (by joint), along the spanning tree.
    pub fn poses(&self, system: &System, reference: &[Pose], joints: &[f64]) -> Vec<Pose> {
        let tree = self.tree(system, reference, &[]);
        let mut u = vec![0.0; tree.coordinates()];
        for (coordinate, &value) in system.joint_coordinates().iter().zip(joints) {
            if let Some(c) = coordinate {
                if *c < u.len() {
                    u[*c] = value;
                }
            }
        }
        let mut state = tree.state();
        tree.place(&u, &mut state);
        state.poses
    }
}
