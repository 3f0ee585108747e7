//! The joint graph: a spanning tree from the ground, and the joints that close loops.

use crate::kinematics::{Carrier, MaterialVector, Pose, Term};
use crate::math::Vector;
use crate::model::ModelError;
use crate::model::system::{JointKind, System};
use crate::reduction::{Motion, Tree, TreeJoint, TreeKind};

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
        let coordinates = self.tree_coordinates(system);
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
        let mut state = tree.state();
        tree.place(&self.coordinates(system, joints), &mut state);
        state.poses
    }

    /// Rates of the vectors φ, d₁, d₂, d₃ of all bodies at joint coordinates with given rates (by joint).
    pub fn rates(
        &self,
        system: &System,
        reference: &[Pose],
        joints: &[f64],
        rates: &[f64],
    ) -> Vec<f64> {
        let term = |body: usize, i: usize| Term {
            carrier: Carrier::Body(body),
            centre: if i == 0 { 1.0 } else { 0.0 },
            directors: if i == 0 {
                Vector::zeros()
            } else {
                Vector::ith(i - 1, 1.0)
            },
        };
        let all = (0..system.bodies.len()).flat_map(|b| (0..4).map(move |i| (b, i)));
        let vectors: Vec<MaterialVector> = all
            .map(|(b, i)| MaterialVector {
                terms: vec![term(b, i)],
            })
            .collect();
        let motion = Motion::articulated(self.tree(system, reference, &vectors), &vectors, &[], 0);
        let mut instant = motion.instant();
        instant.z.copy_from_slice(&self.coordinates(system, joints));
        instant.l.copy_from_slice(&self.coordinates(system, rates));
        motion.place(&mut instant);
        motion.along(&mut instant);
        instant.w.iter().flat_map(|w| [w.x, w.y, w.z]).collect()
    }

    /// Index of the coordinate of each joint of the tree; joints that close loops have none.
    fn tree_coordinates(&self, system: &System) -> Vec<Option<usize>> {
        let mut next = 0;
        let index = |(j, coordinate): (usize, Option<usize>)| {
            let in_tree = coordinate.is_some() && !self.loops.contains(&j);
            in_tree.then(|| {
                next += 1;
                next - 1
            })
        };
        let all = system.joint_coordinates();
        all.into_iter().enumerate().map(index).collect()
    }

    /// Values of the coordinates of the tree from one value a joint.
    fn coordinates(&self, system: &System, joints: &[f64]) -> Vec<f64> {
        let coordinates = self.tree_coordinates(system);
        let with_coordinate = coordinates.iter().zip(joints).filter(|(c, _)| c.is_some());
        with_coordinate.map(|(_, &value)| value).collect()
    }
}
