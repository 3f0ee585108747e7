//! The joint graph: a spanning tree from the ground, and the joints that close loops.

use crate::coordinates::{Configuration, CoordinateMap, Link, LinkKind, Tree};
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm};
use crate::math::{Matrix, Vector};
use crate::model::system::joints::Screw;
use crate::model::system::{Joint, JointKind, System};

/// Joints in an order from the ground outwards, those that close loops, and bodies that nothing holds.
#[derive(Clone, Debug)]
pub struct Graph {
    /// Branches of the spanning tree.
    tree: Vec<Branch>,
    /// Joints that close loops.
    loops: Vec<usize>,
    /// First bodies of parts that no joint connects to the ground.
    free: Vec<usize>,
}

/// A joint of the spanning tree, as it is walked from the ground outwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    pub(crate) joint: usize,
    /// Body on this side of the joint; none is the ground.
    pub(crate) from: Option<usize>,
    /// Body on the other side.
    pub(crate) to: usize,
    /// −1 of a joint that is walked from its child to its parent, where the same coordinate moves the other body the other way.
    sign: f64,
}

impl Graph {
    /// The spanning tree of a system: joints of fewest freedoms first, then in the order of the scene.
    pub fn new(system: &System) -> Self {
        let mut graph = Self {
            tree: Vec::new(),
            loops: Vec::new(),
            free: Vec::new(),
        };
        let mut reached = vec![false; system.bodies.len()];
        let mut used = vec![false; system.joints.len()];
        loop {
            // Those of fewest freedoms first: a loop is closed by one of most, which holds least.
            while (0..=6).any(|freedoms| graph.grow(system, freedoms, &mut reached, &mut used)) {}
            let Some(body) = reached.iter().position(|r| !r) else {
                break;
            };
            graph.free.push(body);
            reached[body] = true;
        }
        graph.loops = (0..system.joints.len()).filter(|&j| !used[j]).collect();
        graph
    }

    /// Adds joints with so many freedoms; returns true if there were any.
    fn grow(
        &mut self,
        system: &System,
        freedoms: usize,
        reached: &mut [bool],
        used: &mut [bool],
    ) -> bool {
        let before = self.tree.len();
        for (j, joint) in system.joints.iter().enumerate() {
            let parent = joint.parent.is_none_or(|b| reached[b]);
            if used[j] || parent == reached[joint.child] || joint.kind.freedoms() != freedoms {
                continue;
            }
            let (from, to, sign) = match joint.parent {
                Some(body) if !parent => (Some(joint.child), body, -1.0),
                _ => (joint.parent, joint.child, 1.0),
            };
            reached[to] = true;
            used[j] = true;
            self.tree.push(Branch {
                joint: j,
                from,
                to,
                sign,
            });
        }
        self.tree.len() > before
    }

    /// Returns true if the joints form a tree from the ground and have one coordinate each, or none.
    pub fn has_one_coordinate_a_joint(&self, system: &System) -> bool {
        let mut joints = system.joints.iter();
        let is_tree = self.loops.is_empty() && self.free.is_empty();
        is_tree && joints.all(|joint| joint.kind.freedoms() <= 1)
    }

    /// Bodies of a tree that may start with any velocity: those that float, and those that turn about a point of another.
    pub fn movable(&self, system: &System) -> (Vec<usize>, Vec<usize>) {
        let (mut floating, mut turning) = (self.free.clone(), Vec::new());
        for branch in &self.tree {
            match system.joints[branch.joint].kind {
                JointKind::Floating => floating.push(branch.to),
                JointKind::Spherical => turning.push(branch.to),
                _ => {}
            }
        }
        (floating, turning)
    }

    /// Joints of the tree, those nearer to the ground first.
    pub(crate) fn outwards(&self) -> &[Branch] {
        &self.tree
    }

    /// Joints that close loops.
    pub(crate) fn loops(&self) -> &[usize] {
        &self.loops
    }

    /// Typical sizes of the coordinates of the tree: one radian, or a length in mm.
    pub(crate) fn sizes(&self, system: &System, length: f64) -> Vec<f64> {
        let kinds = self.in_order(system).map(|(_, joint)| joint.kind);
        let free = self.free.iter().map(|_| JointKind::Floating);
        let size = |screw: &Screw| match screw {
            Screw::Turn(_) => 1.0,
            Screw::Slide(_) => length,
        };
        let sizes = |kind: JointKind| kind.screws().0.iter().map(size).collect::<Vec<_>>();
        kinds.chain(free).flat_map(sizes).collect()
    }

    /// First bodies of parts that no joint connects to the ground: their coordinates follow those of the joints.
    pub(crate) fn free(&self) -> &[usize] {
        &self.free
    }

    /// The spanning tree as kinematics; free bodies are children of the ground by floating joints.
    pub fn tree(&self, system: &System, reference: &[Pose], vectors: &[MaterialVector]) -> Tree {
        let mut links = Links {
            reference,
            list: Vec::new(),
            frames: system.bodies.len(),
            charts: 0,
        };
        let joints = self.first_coordinates(system);
        let mut next = self.coordinate_count(system) - 6 * self.free.len();
        for &body in &self.free {
            let at = reference[body].centre;
            links.add(JointKind::Floating, None, body, at, 1.0, next);
            next += 6;
        }
        for branch in &self.tree {
            let (joint, first) = (&system.joints[branch.joint], joints[branch.joint]);
            let Branch { from, to, sign, .. } = *branch;
            links.add(joint.kind, from, to, joint.at, sign, first);
        }
        Tree::new(links.list, system.bodies.len(), vectors)
    }

    /// Poses at joint coordinates (by joint), along the spanning tree.
    pub fn poses(&self, system: &System, reference: &[Pose], joints: &[f64]) -> Vec<Pose> {
        let map = CoordinateMap::articulated(self.tree(system, reference, &[]), &[], &[], 0, 0);
        let instant = map.placed(&self.coordinates(system, joints));
        map.poses(&instant, system.bodies.len())
    }

    /// The tree at joint coordinates with given rates (by joint), and the vectors φ, d₁, d₂, d₃ of all bodies on it.
    pub fn moving(
        &self,
        system: &System,
        reference: &[Pose],
        joints: &[f64],
        rates: &[f64],
    ) -> (CoordinateMap, Configuration) {
        let term = |body: usize, i: usize| VectorTerm {
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
        let map =
            CoordinateMap::articulated(self.tree(system, reference, &vectors), &vectors, &[], 0, 0);
        let mut instant = map.placed(&self.coordinates(system, joints));
        instant.l.copy_from_slice(&self.coordinates(system, rates));
        map.along(&mut instant);
        (map, instant)
    }

    /// Joints of the tree in the order of the system, which is that of their coordinates, each with its index.
    pub(crate) fn in_order<'s>(
        &self,
        system: &'s System,
    ) -> impl Iterator<Item = (usize, &'s Joint)> {
        let joints = system.joints.iter().enumerate();
        joints.filter(|(j, _)| !self.loops.contains(j))
    }

    /// Coordinate of each joint that has exactly one; joints that close loops have none.
    pub(crate) fn joint_coordinates(&self, system: &System) -> Vec<Option<usize>> {
        let first = self.first_coordinates(system);
        let own = |(j, first)| (self.freedoms(system, j) == 1).then_some(first);
        first.into_iter().enumerate().map(own).collect()
    }

    /// Index of the first coordinate of each joint of the tree; joints that close loops have none.
    fn first_coordinates(&self, system: &System) -> Vec<usize> {
        let mut next = 0;
        let first = |j: usize| {
            let first = next;
            next += self.freedoms(system, j);
            first
        };
        (0..system.joints.len()).map(first).collect()
    }

    /// Number of coordinates of a joint of the tree; those that close loops have none.
    fn freedoms(&self, system: &System, joint: usize) -> usize {
        match self.loops.contains(&joint) {
            true => 0,
            false => system.joints[joint].kind.freedoms(),
        }
    }

    /// Number of coordinates of the tree: those of its joints, then six for each free part.
    pub(crate) fn coordinate_count(&self, system: &System) -> usize {
        let joints = (0..system.joints.len()).map(|j| self.freedoms(system, j));
        joints.sum::<usize>() + 6 * self.free.len()
    }

    /// Values of the coordinates of the tree from one value a joint; those of joints with several and of free bodies are zero.
    fn coordinates(&self, system: &System, joints: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.coordinate_count(system)];
        for (own, &value) in self.joint_coordinates(system).into_iter().zip(joints) {
            if let Some(own) = own {
                values[own] = value;
            }
        }
        values
    }
}

/// Links of a tree collected for a list.
struct Links<'a> {
    reference: &'a [Pose],
    list: Vec<Link>,
    /// Number of frames so far: the bodies, then those between screws.
    frames: usize,
    charts: usize,
}

impl Links<'_> {
    /// Adds a joint from a parent to a child at a point of the ground frame, with coordinates from `first` that count by `sign`.
    fn add(
        &mut self,
        kind: JointKind,
        parent: Option<usize>,
        child: usize,
        at: Vector,
        sign: f64,
        first: usize,
    ) {
        let p = parent.map_or(Pose::GROUND, |b| self.reference[b]);
        let c = self.reference[child];
        let (mut screws, chart) = kind.screws();
        // Seen from the other side the last screw comes first; three turns behind a chart are any rotation in either order.
        let is_reversed = sign < 0.0 && chart.is_none();
        if is_reversed {
            screws.reverse();
        }
        let last = screws.len().max(1) - 1;
        let mut before = parent;
        for i in 0..=last {
            let (kind, axis) = match screws.get(i) {
                Some(&Screw::Turn(axis)) => (LinkKind::Turn, axis),
                Some(&Screw::Slide(axis)) => (LinkKind::Slide, axis),
                None => (LinkKind::Fixed, Vector::z()),
            };
            // Frames between screws lie at the point of the joint, with the directors of the parent.
            let (to, directors, centre) = match i == last {
                true => (
                    child,
                    p.directors.tr_mul(&c.directors),
                    p.directors.tr_mul(&(c.centre - at)),
                ),
                false => (self.frames, Matrix::identity(), Vector::zeros()),
            };
            self.list.push(Link {
                kind,
                parent: before,
                child: to,
                chart: (chart == Some(i)).then_some(self.charts),
                axis: p.directors.tr_mul(&axis) * sign,
                point: if i == 0 {
                    p.local(&at)
                } else {
                    Vector::zeros()
                },
                directors,
                centre,
                coordinate: (!screws.is_empty()).then_some(match is_reversed {
                    true => first + last - i,
                    false => first + i,
                }),
            });
            self.charts += usize::from(chart == Some(i));
            self.frames += usize::from(i != last);
            before = Some(to);
        }
    }
}
