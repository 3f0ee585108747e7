//! Internal coordinates: numbers of an instant that belong to a part of the scene and are no places, with the value at a start.
//!
//! They have no mass. Each has an equation: a force that depends on it, or a constraint.

use crate::kinematics::{MaterialVector, Vectors};
use crate::model::analysis::{Analysis, Coordinates};
use crate::model::components::LoadPlace;
use crate::model::layout::solid_block::SolidBlock;
use crate::model::layout::solids::Solids;
use crate::model::layout::variables::Size;
use crate::model::presolve::graph::Graph;
use crate::model::presolve::presolved::Presolved;
use crate::model::system::{Fidelity, Joint, JointKind, System};
use std::collections::BTreeMap;
use std::ops::Range;

/// An internal coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Internal {
    /// Full name.
    pub(crate) name: String,
    /// Typical size of its value.
    pub(crate) size: Size,
    /// Part of the scene to which it belongs.
    pub(crate) kind: InternalKind,
}

/// Meaning of an internal coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum InternalKind {
    /// The coordinate of a joint of the presolved system.
    Joint(usize),
    /// The logarithm of the viscous stretch of a Maxwell branch of a muscle: an internal variable that relaxes under constant stretch.
    Branch { muscle: usize, branch: usize },
    /// A coordinate of the viscous strain of a Maxwell branch at a Gauss point of a block: what the block remembers.
    Strain {
        block: usize,
        element: usize,
        point: usize,
        /// Number of the coordinate among those of the strain.
        component: usize,
    },
    /// The charge of a muscle or of electrodes behind the resistor of a source, in a unit of its own: a current brings and takes it.
    Charge(usize),
    /// A component of the elastic displacement of a contact that sticks, over its greatest length.
    Bristle,
}

impl InternalKind {
    /// Returns true if it is what a muscle, block or contact remembers: it has no momentum, and nothing brings it to rest but time.
    pub(crate) fn is_memory(self) -> bool {
        !matches!(self, Self::Joint(_))
    }
}

impl Internal {
    fn new(name: String, kind: InternalKind) -> Self {
        let size = Size::One;
        Self { name, size, kind }
    }

    fn of_joint(index: usize, joint: &Joint) -> Self {
        let name = format!("coordinate of {}", joint.name);
        let mut own = Self::new(name, InternalKind::Joint(index));
        if let JointKind::Prismatic { .. } = joint.kind {
            own.size = Size::Length;
        }
        own
    }

    fn of_branch(name: &str, muscle: usize, branch: usize) -> Self {
        let name = format!("logarithm of viscous stretch {} of {name}", branch + 1);
        Self::new(name, InternalKind::Branch { muscle, branch })
    }

    fn of_charge(name: &str, source: usize) -> Self {
        Self::new(format!("charge of {name}"), InternalKind::Charge(source))
    }

    fn of_bristle(name: &str, component: usize) -> Self {
        let name = format!("elastic displacement {} of {name}", component + 1);
        Self::new(name, InternalKind::Bristle)
    }

    /// Those of the viscous strains of the branches of an element, branch by branch and point by point.
    fn of_element(block: usize, of: &SolidBlock, element: usize) -> impl Iterator<Item = Self> {
        let branches = 0..of.material(element).maxwell.list().len();
        let [points, coordinates] = of.strains();
        let points = branches.flat_map(move |branch| (0..points).map(move |point| (branch, point)));
        let all = points.flat_map(move |at| (0..coordinates).map(move |component| (at, component)));
        all.map(move |((branch, point), component)| {
            let name = format!(
                "viscous strain {} of branch {} at point {point} of element {element} of {}",
                component + 1,
                branch + 1,
                of.solid.name
            );
            let kind = InternalKind::Strain {
                block,
                element,
                point,
                component,
            };
            Self::new(name, kind)
        })
    }
}

/// The internal coordinates of a model, behind all others.
#[derive(Debug)]
pub(crate) struct Internals {
    /// Coordinate of each joint that has exactly one in the tree.
    of_tree: Vec<Option<usize>>,
    /// Number of the coordinates before them.
    first: usize,
    /// Coordinates of the elastic displacement of each contact that sticks in a motion, by its name.
    pub(crate) bristles: BTreeMap<String, Range<usize>>,
    /// First in the list of each block and element with Maxwell branches.
    pub(crate) of_elements: BTreeMap<(usize, usize), usize>,
    pub(crate) list: Vec<Internal>,
}

impl Internals {
    /// Those of a scene and its presolved system with its graph: coordinates of joints with springs, loads or a prescribed motion that are
    /// in no tree of joint coordinates. Muscles and blocks at rest remember nothing, and have the voltages of their sources.
    pub(crate) fn new(
        scene: &System,
        presolved: &Presolved,
        analysis: &Analysis,
        graph: &Graph,
        blocks: &Solids,
        vectors: &Vectors,
    ) -> Self {
        let coordinates = analysis.coordinates.unwrap_or(Coordinates::Reduced);
        let system = &presolved.system;
        let nodes = blocks.nodes.iter().flat_map(|node| node.free);
        let of_nodes = nodes.filter(|&is_free| is_free).count();
        let (of_tree, of_bodies) = match coordinates {
            Coordinates::Reduced => (
                graph.joint_coordinates(system),
                graph.coordinate_count(system),
            ),
            Coordinates::Redundant => (vec![None; system.joints.len()], 12 * system.bodies.len()),
        };
        let joints = system.joints.iter().enumerate();
        let is_loaded = |j: usize| {
            let mut loads = scene.components.loads.iter();
            loads.any(|load| load.on == LoadPlace::Joint(presolved.joints[j]))
        };
        let is_read = |joint: &Joint| {
            joint.spring.is_some() || joint.stops.is_some() || joint.motion.is_some()
        };
        let needed = joints.filter(|(j, joint)| is_read(joint) || is_loaded(*j));
        let missing = needed.filter(|(j, _)| of_tree[*j].is_none());
        let mut list: Vec<_> = missing.map(|(j, of)| Internal::of_joint(j, of)).collect();
        for (m, muscle) in scene.muscles.iter().enumerate() {
            let moves = presolved.moves(muscle);
            if analysis.of_motion && moves && muscle.fidelity == Fidelity::Lumped {
                let branches = 0..muscle.material.maxwell.list().len();
                list.extend(branches.map(|b| Internal::of_branch(&muscle.name, m, b)));
            }
            let is_lumped = muscle.fidelity == Fidelity::Lumped;
            if analysis.of_motion && muscle.is_behind_resistor() && is_lumped {
                list.push(Internal::of_charge(&muscle.name, m));
            }
        }
        let circuits = blocks.circuits.iter();
        list.extend(circuits.map(|of| Internal::of_charge(&of.name, of.source)));
        let first = of_bodies + of_nodes;
        let mut bristles = BTreeMap::new();
        let contacts = scene.components.contacts.iter();
        let sticking = contacts.filter(|one| {
            let [a, b] = one.ends().map(|end| presolved.carrier(end.body));
            let mut node = one.round.node.iter();
            let node_moves =
                node.any(|&[block, node]| vectors.moves(blocks.list[block].vectors[node]));
            analysis.of_motion && (a != b || node_moves) && one.bristles() > 0
        });
        for contact in sticking {
            let components = 0..contact.bristles();
            let before = first + list.len();
            bristles.insert(contact.name.clone(), before..before + components.len());
            list.extend(components.map(|k| Internal::of_bristle(&contact.name, k)));
        }
        let mut of_elements = BTreeMap::new();
        let moving = blocks.list.iter().enumerate();
        let moving = moving.filter(|(_, block)| analysis.of_motion && !block.is_immobile);
        for (b, block) in moving {
            let elements = 0..block.solid.mesh.element_count();
            for e in elements.filter(|&e| !block.material(e).maxwell.list().is_empty()) {
                of_elements.insert((b, e), list.len());
                list.extend(Internal::of_element(b, block, e));
            }
        }
        Self {
            of_tree,
            first,
            bristles,
            of_elements,
            list,
        }
    }

    /// The coordinate of a joint in the tree; redundant coordinates have none.
    pub(crate) fn in_tree(&self, joint: usize) -> Option<usize> {
        self.of_tree[joint]
    }

    /// The vector that has the coordinate of a joint in its first component; `None` where nothing calls for it.
    pub(crate) fn joint(&self, joint: usize) -> Option<MaterialVector> {
        self.joint_coordinate(joint).map(MaterialVector::coordinate)
    }

    /// The coordinate of a joint; `None` where nothing calls for it.
    pub(crate) fn joint_coordinate(&self, joint: usize) -> Option<usize> {
        let kind = InternalKind::Joint(joint);
        let internal = || self.list.iter().position(|own| own.kind == kind);
        self.in_tree(joint)
            .or_else(|| internal().map(|place| self.first + place))
    }

    /// The vector that has an internal coordinate in its first component.
    pub(crate) fn vector(&self, kind: InternalKind) -> Option<MaterialVector> {
        let mut own = self.vectors().filter(|(internal, _)| internal.kind == kind);
        own.next().map(|(_, vector)| vector)
    }

    /// The vectors (z₁, z₂, ·) and (a, b, c), or (a, ·, ·) in a membrane, of the viscous strain of a branch at each Gauss point of an element of a block; `None` where
    /// nothing calls for it.
    pub(crate) fn strains(
        &self,
        block: usize,
        element: usize,
        branch: usize,
        of: &SolidBlock,
    ) -> Option<Vec<[MaterialVector; 2]>> {
        let first = self.first + self.of_elements.get(&(block, element))?;
        let [points, coordinates] = of.strains();
        let vectors = |point: usize| {
            let start = first + coordinates * (points * branch + point);
            let parts = [start..start + 2, start + 2..start + coordinates];
            parts.map(MaterialVector::coordinates)
        };
        Some((0..points).map(vectors).collect())
    }

    /// All of them, each with the vector that has it in its first component.
    pub(crate) fn vectors(&self) -> impl Iterator<Item = (&Internal, MaterialVector)> {
        let coordinates = (self.first..).map(MaterialVector::coordinate);
        self.list.iter().zip(coordinates)
    }
}
