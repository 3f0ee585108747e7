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

use crate::kinematics::{MaterialVector, Pose, Term};
use crate::math::{Matrix, Vector, skew};
use crate::reduction::instant::{Instant, Moments, TreeState};
use nalgebra::{Rotation3, Unit};

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
            tree.lay_vector(index, vector);
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
            match term.body {
                Some(body) => {
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
                None => constant += term.at(&Pose::GROUND),
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

    /// The joints.
    pub fn joints(&self) -> &[TreeJoint] {
        &self.joints
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

    /// Poses of all bodies at joint coordinates u, from root to leaves.
    pub fn place(&self, u: &[f64], state: &mut TreeState) {
        for (j, joint) in self.joints.iter().enumerate() {
            let parent = joint.parent.map_or(Pose::GROUND, |b| state.poses[b]);
            let axis = parent.directors * joint.axis;
            let point = parent.point(&joint.point);
            let value = joint.coordinate.map_or(0.0, |c| u[c]);
            let mut pose = Pose {
                centre: point + parent.directors * joint.centre,
                directors: parent.directors * joint.directors,
            };
            match joint.kind {
                TreeKind::Revolute => {
                    let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(joint.axis), value);
                    let turned = parent.directors * turn.matrix();
                    pose.centre = point + turned * joint.centre;
                    pose.directors = turned * joint.directors;
                }
                TreeKind::Prismatic => pose.centre += axis * value,
                TreeKind::Fixed => {}
            }
            state.axes[j] = axis;
            state.points[j] = point;
            state.poses[joint.child] = pose;
        }
    }

    /// Values of all vectors at the poses.
    pub fn vectors(&self, state: &mut TreeState, x: &mut [Vector]) {
        x.copy_from_slice(&self.constants);
        for (term, value) in self.terms.iter().zip(&mut state.terms) {
            let pose = &state.poses[term.body];
            *value = pose.centre * term.centre + pose.directors * term.directors;
            x[term.vector] += *value;
        }
    }

    /// Columns of P.
    pub fn tangent(&self, state: &mut TreeState, columns: &mut [f64]) {
        for (arm, value) in self.arms.iter().zip(&mut state.arms) {
            *value = sum(&state.terms[arm.first..arm.first + arm.count]);
        }
        for column in &self.columns {
            let axis = state.axes[column.joint];
            let centre = self.arms[column.arm].centre;
            let value = match self.joints[column.joint].kind {
                TreeKind::Revolute => {
                    axis.cross(&(state.arms[column.arm] - state.points[column.joint] * centre))
                }
                _ => axis * centre,
            };
            column.store(&value, columns);
        }
    }

    /// Twists along l, derivatives of axes, points and columns along l, and w = P l.
    pub fn along(&self, instant: &mut Instant) {
        let Instant {
            l,
            w,
            columns_l,
            tree,
            ..
        } = instant;
        for (j, joint) in self.joints.iter().enumerate() {
            let [omega, origin] = joint
                .parent
                .map_or([Vector::zeros(); 2], |b| tree.twists[b]);
            let (axis, point) = (tree.axes[j], tree.points[j]);
            tree.axes_l[j] = omega.cross(&axis);
            tree.points_l[j] = origin + omega.cross(&point);
            let rate = joint.coordinate.map_or(0.0, |c| l[c]);
            tree.twists[joint.child] = match joint.kind {
                TreeKind::Revolute => [omega + axis * rate, origin + point.cross(&axis) * rate],
                TreeKind::Prismatic => [omega, origin + axis * rate],
                TreeKind::Fixed => [omega, origin],
            };
        }
        w.fill(Vector::zeros());
        for ((term, value), rate) in self.terms.iter().zip(&tree.terms).zip(&mut tree.terms_l) {
            let [omega, origin] = tree.twists[term.body];
            *rate = origin * term.centre + omega.cross(value);
            w[term.vector] += *rate;
        }
        for (arm, rate) in self.arms.iter().zip(&mut tree.arms_l) {
            *rate = sum(&tree.terms_l[arm.first..arm.first + arm.count]);
        }
        for column in &self.columns {
            let (j, arm) = (column.joint, column.arm);
            let centre = self.arms[arm].centre;
            let value = match self.joints[j].kind {
                TreeKind::Revolute => {
                    let reach = tree.arms[arm] - tree.points[j] * centre;
                    let reach_l = tree.arms_l[arm] - tree.points_l[j] * centre;
                    tree.axes_l[j].cross(&reach) + tree.axes[j].cross(&reach_l)
                }
                _ => tree.axes_l[j] * centre,
            };
            column.store(&value, columns_l);
        }
    }

    /// Adds Pᵀ R for the forces on all vectors, without columns: `a·τ` about each joint, gathered from the leaves to the
    /// root (prismatic: `a·f`).
    pub fn pull_back(&self, state: &mut TreeState, forces: &[Vector], rows: &mut [f64]) {
        state.wrenches.fill([Vector::zeros(); 2]);
        for (term, x) in self.terms.iter().zip(&state.terms) {
            let force = &forces[term.vector];
            let [torque, sum] = &mut state.wrenches[self.carrier[term.body]];
            *torque += x.cross(force);
            *sum += force * term.centre;
        }
        for (j, joint) in self.joints.iter().enumerate().rev() {
            let [torque, force] = state.wrenches[j];
            if let Some(before) = self.before[j] {
                state.wrenches[before][0] += torque;
                state.wrenches[before][1] += force;
            }
            let axis = state.axes[j];
            match (joint.coordinate, joint.kind) {
                (Some(c), TreeKind::Revolute) => {
                    rows[c] += axis.dot(&(torque - state.points[j].cross(&force)));
                }
                (Some(c), _) => rows[c] += axis.dot(&force),
                (None, _) => {}
            }
        }
    }

    /// Moments of the forces R on all vectors, gathered from the leaves to the root; with rates along l where `rates`
    /// holds the contracted forces.
    fn gather(&self, instant: &mut Instant, rates: bool) {
        let Instant {
            forces,
            contracted,
            tree,
            ..
        } = instant;
        tree.moments.fill(Moments::default());
        for (t, term) in self.terms.iter().enumerate() {
            let (x, force) = (&tree.terms[t], &forces[term.vector]);
            let m = &mut tree.moments[self.carrier[term.body]];
            m.moment += x * force.transpose();
            m.force += force * term.centre;
            if rates {
                let rate = &contracted[term.vector];
                m.moment_l += tree.terms_l[t] * force.transpose() + x * rate.transpose();
                m.force_l += rate * term.centre;
            }
        }
        for j in (0..self.joints.len()).rev() {
            if let Some(i) = self.before[j] {
                let m = tree.moments[j];
                let sum = &mut tree.moments[i];
                sum.moment += m.moment;
                sum.force += m.force;
                sum.moment_l += m.moment_l;
                sum.force_l += m.force_l;
            }
        }
    }

    /// Adds R·P′ at the slots of `curvature_entries`, both orders: `slots[e]` is (i, k), (k, i).
    pub fn curvature(&self, instant: &mut Instant, slots: &[[usize; 2]], values: &mut [f64]) {
        self.gather(instant, false);
        let tree = &instant.tree;
        let mut of = usize::MAX;
        let mut y = Vector::zeros();
        for (&(i, k), slot) in self.paths.iter().zip(slots) {
            if k != of {
                of = k;
                let m = &tree.moments[k];
                let axis = tree.axes[k];
                y = match self.joints[k].kind {
                    TreeKind::Revolute => {
                        let moment = m.moment - tree.points[k] * m.force.transpose();
                        moment * axis - axis * moment.trace()
                    }
                    _ => axis.cross(&m.force),
                };
            }
            let value = tree.axes[i].dot(&y);
            values[slot[0]] += value;
            if i != k {
                values[slot[1]] += value;
            }
        }
    }

    /// Adds (Hᵀw)·P′ + R·P″_l at the slots of `curvature_entries`, both orders.
    pub fn curvature_along(&self, instant: &mut Instant, slots: &[[usize; 2]], values: &mut [f64]) {
        self.gather(instant, true);
        let tree = &instant.tree;
        let mut of = usize::MAX;
        let (mut y, mut y_l) = (Vector::zeros(), Vector::zeros());
        for (&(i, k), slot) in self.paths.iter().zip(slots) {
            if k != of {
                of = k;
                let m = &tree.moments[k];
                let (a, a_l) = (tree.axes[k], tree.axes_l[k]);
                (y, y_l) = match self.joints[k].kind {
                    TreeKind::Revolute => {
                        let (c, c_l) = (tree.points[k], tree.points_l[k]);
                        let n = m.moment - c * m.force.transpose();
                        let n_l =
                            m.moment_l - c_l * m.force.transpose() - c * m.force_l.transpose();
                        (
                            n * a - a * n.trace(),
                            n_l * a + n * a_l - a_l * n.trace() - a * n_l.trace(),
                        )
                    }
                    _ => (
                        skew(&a) * m.force,
                        a_l.cross(&m.force) + a.cross(&m.force_l),
                    ),
                };
            }
            let value = tree.axes_l[i].dot(&y) + tree.axes[i].dot(&y_l);
            values[slot[0]] += value;
            if i != k {
                values[slot[1]] += value;
            }
        }
    }
}

#[inline]
fn sum(vectors: &[Vector]) -> Vector {
    vectors[1..].iter().fold(vectors[0], |sum, v| sum + v)
}

impl Column {
    #[inline]
    fn store(&self, value: &Vector, columns: &mut [f64]) {
        columns[self.place] = value.x;
        columns[self.place + self.stride] = value.y;
        columns[self.place + 2 * self.stride] = value.z;
    }
}
