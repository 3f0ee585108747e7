//! Kinematic trees: joint coordinates, and the derivatives of all vectors by them.
//!
//! For a joint j with axis a_j through c_j the column of P on every descendant is `a_j × (φ − c_j)`, `a_j × d_I`
//! (revolute) or `a_j`, `0` (prismatic). Second derivatives nest, the joint nearest the root outermost:
//! ∂_i ∂_k x = a_i × (a_k × v). Contracted with forces R one matrix `N_k = Σ v Rᵀ` and one force f_k per joint carry
//! the curvature (physics.md, 5.3),
//!
//! ```text
//! (R·P′)_ik = a_iᵀ N_k a_k − (a_i·a_k) tr N_k          prismatic k:  f_k·(a_i × a_k)
//! ```
//!
//! and R·P″_l is its derivative along l, in which axes and points move with the twists of their parents.

mod forces;
mod motion;

use crate::kinematics::{Carrier, MaterialVector, Pose, Term};
use crate::math::{Matrix, Vector};
use crate::reduction::instant::{Moments, TreeState};

/// What a joint of a tree lets move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeKind {
    /// Rotation about the axis.
    Revolute,
    /// Translation along the axis.
    Prismatic,
    /// Nothing.
    Fixed,
}

/// A joint of a tree; joints stand in an order in which parents come first.
#[derive(Clone, Debug)]
pub struct TreeJoint {
    /// What it lets move.
    pub kind: TreeKind,
    /// Parent body; `None` is the ground.
    pub parent: Option<usize>,
    /// Child body.
    pub child: usize,
    /// Unit axis in the parent's directors.
    pub axis: Vector,
    /// Point in the parent's directors, from its centre.
    pub point: Vector,
    /// Directors of the child relative to the parent at zero.
    pub directors: Matrix,
    /// Centre of the child relative to the point at zero, in the parent's directors.
    pub centre: Vector,
    /// Index of the joint coordinate; `None` for a fixed joint.
    pub coordinate: Option<usize>,
}

/// A column of an articulated vector: the joint, and the part of the vector that the joint moves.
#[derive(Clone, Copy, Debug)]
struct Column {
    joint: usize,
    /// The moved part.
    arm: usize,
    /// Where its first component is stored; the others follow at the stride of the vector.
    place: usize,
    stride: usize,
}

/// A sum of terms of one vector that the same joints move.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arm {
    /// The first term, and the number of terms: those that a joint moves are neighbours.
    first: usize,
    count: usize,
    /// Sum of their centre coefficients.
    centre: f64,
}

/// One term of a vector, flattened.
#[derive(Clone, Copy, Debug)]
struct FlatTerm {
    vector: usize,
    body: usize,
    centre: f64,
    directors: Vector,
}

/// The columns of one vector: three rows of `stride` numbers from `first`, one number for each coordinate, then zeros.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Packed {
    /// First number.
    pub first: usize,
    /// Numbers a row: the coordinates, rounded up to [`LANES`].
    pub stride: usize,
    /// Coordinates that move the vector.
    pub support: Vec<usize>,
}

impl Packed {
    /// The three rows of the vector's columns.
    #[inline]
    pub fn rows<'c>(&self, columns: &'c [f64]) -> [&'c [f64]; 3] {
        let (x, rest) = columns[self.first..self.first + 3 * self.stride].split_at(self.stride);
        let (y, z) = rest.split_at(self.stride);
        [x, y, z]
    }
}

/// Rows of columns are padded to a multiple of this.
pub(super) const LANES: usize = 4;

/// A kinematic tree and the vectors on it.
#[derive(Clone, Debug)]
pub struct Tree {
    joints: Vec<TreeJoint>,
    /// Joint that carries each body.
    carrier: Vec<usize>,
    /// Joint before each joint on its way to the ground.
    before: Vec<Option<usize>>,
    /// Constant part of each vector.
    constants: Vec<Vector>,
    terms: Vec<FlatTerm>,
    arms: Vec<Arm>,
    columns: Vec<Column>,
    packed: Vec<Packed>,
    size: usize,
    /// Pairs of joints (i, k) on one path, i not behind k.
    paths: Vec<(usize, usize)>,
}

impl Tree {
    /// The tree of `joints` over `bodies` bodies, each the child of exactly one joint, and the vectors on it.
    pub fn new(joints: Vec<TreeJoint>, bodies: usize, vectors: &[MaterialVector]) -> Self {
        let mut carrier = vec![usize::MAX; bodies];
        for (j, joint) in joints.iter().enumerate() {
            carrier[joint.child] = j;
        }
        assert!(
            carrier.iter().all(|&j| j != usize::MAX),
            "every body of a tree is carried by a joint"
        );
        let before = joints
            .iter()
            .map(|joint| joint.parent.map(|b| carrier[b]))
            .collect();
        let mut tree = Self {
            joints,
            carrier,
            before,
            constants: Vec::new(),
            terms: Vec::new(),
            arms: Vec::new(),
            columns: Vec::new(),
            packed: Vec::new(),
            size: 0,
            paths: Vec::new(),
        };
        for (index, vector) in vectors.iter().enumerate() {
            if vector.is_of_bodies() {
                tree.lay_vector(index, vector);
            } else {
                tree.constants.push(Vector::zeros());
                tree.packed.push(Packed::default());
            }
        }
        tree.lay_paths();
        tree
    }

    /// Joints from the one that carries `body` to the ground.
    fn path(&self, body: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(self.carrier[body]), |&j| self.before[j])
    }

    fn lay_vector(&mut self, index: usize, vector: &MaterialVector) {
        let first_term = self.terms.len();
        let mut constant = Vector::zeros();
        for term in &vector.terms {
            match term.carrier {
                Carrier::Body(body) => {
                    let Term {
                        centre, directors, ..
                    } = *term;
                    self.terms.push(FlatTerm {
                        vector: index,
                        body,
                        centre,
                        directors,
                    });
                }
                Carrier::Ground => constant += term.at(&Pose::GROUND),
                Carrier::Node(_) | Carrier::Joint(_) => {
                    unreachable!("vectors on the tree are of bodies")
                }
            }
        }
        self.constants.push(constant);
        let mut moved = Vec::new();
        for (j, joint) in self.joints.iter().enumerate() {
            let Some(coordinate) = joint.coordinate else {
                continue;
            };
            let is_moved = |&t: &usize| self.path(self.terms[t].body).any(|i| i == j);
            let terms: Vec<usize> = (first_term..self.terms.len()).filter(is_moved).collect();
            let centre: f64 = terms.iter().map(|&t| self.terms[t].centre).sum();
            let still = joint.kind == TreeKind::Prismatic && centre == 0.0;
            let (Some(&first), Some(&last), false) = (terms.first(), terms.last(), still) else {
                continue;
            };
            assert!(
                last - first + 1 == terms.len(),
                "terms that a joint moves are neighbours"
            );
            moved.push((
                j,
                coordinate,
                Arm {
                    first,
                    count: terms.len(),
                    centre,
                },
            ));
        }
        let (first, stride) = (self.size, moved.len().next_multiple_of(LANES));
        self.size += 3 * stride;
        let support = moved.iter().map(|&(_, coordinate, _)| coordinate).collect();
        self.packed.push(Packed {
            first,
            stride,
            support,
        });
        for (place, (joint, _, arm)) in moved.into_iter().enumerate() {
            let known = self.arms.iter().rposition(|a| *a == arm);
            let arm = known.unwrap_or_else(|| {
                self.arms.push(arm);
                self.arms.len() - 1
            });
            self.columns.push(Column {
                joint,
                arm,
                place: first + place,
                stride,
            });
        }
    }

    fn lay_paths(&mut self) {
        let mut paths = Vec::new();
        for k in 0..self.joints.len() {
            for i in std::iter::successors(Some(k), |&j| self.before[j]) {
                let moving = |j: usize| self.joints[j].kind != TreeKind::Fixed;
                let turning = self.joints[i].kind == TreeKind::Revolute
                    && (i != k || self.joints[k].kind == TreeKind::Revolute);
                if moving(i) && moving(k) && turning {
                    paths.push((i, k));
                }
            }
        }
        self.paths = paths;
    }

    /// Number of joint coordinates.
    pub fn coordinates(&self) -> usize {
        self.joints
            .iter()
            .filter(|j| j.coordinate.is_some())
            .count()
    }

    /// Columns of each vector: the structure of P.
    pub fn packed(&self) -> &[Packed] {
        &self.packed
    }

    /// Coordinates that the curvature couples; both orders are meant.
    pub fn curvature_entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let coordinate = |j: usize| {
            self.joints[j]
                .coordinate
                .expect("a moving joint has a coordinate")
        };
        self.paths
            .iter()
            .map(move |&(i, k)| (coordinate(i), coordinate(k)))
    }

    /// Storage for an instant.
    pub fn state(&self) -> TreeState {
        let joints = self.joints.len();
        TreeState {
            poses: vec![Pose::GROUND; self.carrier.len()],
            axes: vec![Vector::zeros(); joints],
            points: vec![Vector::zeros(); joints],
            axes_l: vec![Vector::zeros(); joints],
            points_l: vec![Vector::zeros(); joints],
            twists: vec![[Vector::zeros(); 2]; self.carrier.len()],
            moments: vec![Moments::default(); joints],
            wrenches: vec![[Vector::zeros(); 2]; joints],
            terms: vec![Vector::zeros(); self.terms.len()],
            terms_l: vec![Vector::zeros(); self.terms.len()],
            arms: vec![Vector::zeros(); self.arms.len()],
            arms_l: vec![Vector::zeros(); self.arms.len()],
        }
    }

    /// Length of the storage of all columns.
    pub fn size(&self) -> usize {
        self.size
    }
}
