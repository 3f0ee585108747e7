//! Sections at joints: the bodies on one side of each, whose balance of momentum gives the force and torque that the joint transmits.

use crate::functional::Turn;
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm, Vectors};
use crate::math::{DisjointSets, Vector};
use crate::model::model::Model;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::{JointKind, System};
use crate::model::terms::constraints::GLUE;

/// A joint that alone connects the bodies on one side of it to the ground or to the others.
#[derive(Clone, Debug)]
pub struct JointSection {
    /// Joint of the scene.
    pub joint: usize,
    /// Bodies of the presolved system on one side.
    bodies: Vec<usize>,
    /// 1 if the child of the scene is among them, −1 otherwise.
    sign: f64,
    /// Point of the joint, fixed in its child, or in its parent where the child is fixed.
    at: MaterialVector,
    /// False of spherical joints, which transmit no torque.
    pub has_torque: bool,
}

impl Model {
    /// The joints of the scene that can move and are in no loop; none where blocks are glued to bodies by constraints.
    pub fn joint_sections(&self) -> Vec<JointSection> {
        if self.present.iter().any(|present| present.term == GLUE) {
            return Vec::new();
        }
        let joints = 0..self.presolved.system.joints.len();
        let (scene, presolved) = (&self.system, &self.presolved);
        joints
            .filter_map(|kept| JointSection::new(scene, presolved, &self.reference, kept))
            .collect()
    }

    /// Force and torque about the origin on each body of the presolved system, of forces on all vectors at poses.
    pub fn wrenches(&self, poses: &[Pose], forces: &[Vector]) -> Vec<[Vector; 2]> {
        let mut wrenches = vec![[Vector::zeros(); 2]; poses.len()];
        for (vector, force) in self.vectors.iter().zip(forces) {
            for term in &vector.terms {
                if let Carrier::Body(body) = term.carrier {
                    let [sum, torque] = &mut wrenches[body];
                    *sum += force * term.centre;
                    *torque += term.at(&poses[body]).cross(force);
                }
            }
        }
        wrenches
    }
}

impl JointSection {
    /// The section at a joint of the presolved system; none where it moves nothing or is in a loop.
    pub(crate) fn new(
        scene: &System,
        presolved: &Presolved,
        reference: &[Pose],
        kept: usize,
    ) -> Option<Self> {
        let system = &presolved.system;
        let ground = system.bodies.len();
        let joint = &system.joints[kept];
        let mut sets = DisjointSets::new(ground + 1);
        for (other, joint) in system.joints.iter().enumerate() {
            if other != kept {
                sets.join(joint.parent.unwrap_or(ground), joint.child);
            }
        }
        let [child, parent, fixed] =
            [joint.child, joint.parent.unwrap_or(ground), ground].map(|body| sets.smallest(body));
        if joint.kind == JointKind::Floating || child == parent {
            return None;
        }
        let (side, own) = match child == fixed {
            true => (parent, -1.0),
            false => (child, 1.0),
        };
        let index = presolved.joints[kept];
        let of_scene = Some(scene.joints[index].child);
        let turned = match presolved.carrier(of_scene) == Some(joint.child) {
            true => 1.0,
            false => -1.0,
        };
        let bodies = 0..ground;
        Some(Self {
            joint: index,
            bodies: bodies.filter(|&b| sets.smallest(b) == side).collect(),
            sign: own * turned,
            at: MaterialVector::point(Some(joint.child), &joint.at, reference),
            has_torque: joint.has_torque(),
        })
    }

    /// The part of a vector that is carried by bodies of the section.
    fn part(&self, vector: &MaterialVector) -> MaterialVector {
        let moved = |term: &&VectorTerm| match term.carrier {
            Carrier::Body(body) => self.bodies.contains(&body),
            _ => false,
        };
        MaterialVector {
            terms: vector.terms.iter().filter(moved).copied().collect(),
        }
    }

    /// Displacement of a vector when all bodies of the section move along a direction, with the sign of the force from the parent on the child.
    pub(crate) fn displacement(&self, vector: &MaterialVector, direction: &Vector) -> Vector {
        direction * (-self.sign * self.part(vector).centre())
    }

    /// Displacements of vectors when all bodies of the section turn about the point of the joint, with the sign of the torque from the parent on
    /// the child; what they read joins the vectors.
    pub(crate) fn turns(&self, vectors: &mut Vectors) -> Vec<Turn> {
        let mut turns = Vec::new();
        let at = vectors.index(self.at.clone());
        for of in 0..vectors.list().len() {
            let part = self.part(&vectors.list()[of]);
            let centre = part.centre();
            if !part.terms.is_empty() {
                let (by, factor) = (vectors.index(part), -self.sign);
                turns.push(Turn { of, by, factor });
            }
            if centre != 0.0 {
                let factor = self.sign * centre;
                turns.push(Turn { of, by: at, factor });
            }
        }
        turns
    }

    /// Force and torque about the point of the joint that balance wrenches of the bodies at poses: from the parent on the child.
    pub fn reaction(&self, wrenches: &[[Vector; 2]], poses: &[Pose]) -> [Vector; 2] {
        let sum = |part: usize| -> Vector { self.bodies.iter().map(|&b| wrenches[b][part]).sum() };
        let (force, torque) = (-sum(0) * self.sign, -sum(1) * self.sign);
        let point = self.at.at(poses, &[]);
        [force, torque - point.cross(&force)]
    }
}
