//! Map from the coordinates of an instant to vectors: on a kinematic tree, or linear in directors and nodes. Charts of whole configurations are
//! moved to where bodies are, exchanged, taken from poses, put at means.

use crate::coordinates::configuration::Configuration;
use crate::coordinates::tree::{CHART, TangentColumns, Tree};
use crate::kinematics::{Carrier, MaterialVector, Pose, VectorTerm};
use crate::math::{Matrix, Vector};
use std::ops::Range;

/// Dependence of one vector on the coordinates.
#[derive(Clone, Debug)]
pub enum Dependence {
    /// A constant plus Σ c u e over the parts.
    Linear {
        /// The constant.
        constant: Vector,
        /// The parts.
        parts: Vec<LinearPart>,
    },
    /// Columns of a tree, and of the nodes that move it too.
    Articulated(TangentColumns),
}

impl Dependence {
    /// The parts of one that is linear; none of a vector on a tree.
    fn parts(&self) -> &[LinearPart] {
        match self {
            Self::Linear { parts, .. } => parts,
            Self::Articulated(_) => &[],
        }
    }

    /// Σ c l e over the parts.
    fn along(&self, l: &[f64]) -> Vector {
        self.from(Vector::zeros(), l)
    }

    /// The value of one that is linear.
    fn at(&self, z: &[f64]) -> Vector {
        match self {
            Self::Linear { constant, .. } => self.from(*constant, z),
            Self::Articulated(_) => Vector::zeros(),
        }
    }

    fn from(&self, mut sum: Vector, of: &[f64]) -> Vector {
        for part in self.parts() {
            sum[part.axis] += of[part.coordinate] * part.factor;
        }
        sum
    }

    /// Coordinates that move it.
    fn support(&self) -> Vec<usize> {
        match self {
            Self::Articulated(packed) => packed.support.clone(),
            Self::Linear { parts, .. } => parts.iter().map(|p| p.coordinate).collect(),
        }
    }

    /// Adds Pᵀ f for a force on it.
    fn pull_back(&self, columns: &[f64], force: &Vector, rows: &mut [f64]) {
        match self {
            Self::Articulated(packed) => {
                let [x, y, z] = packed.rows(columns);
                for (i, &row) in packed.support.iter().enumerate() {
                    rows[row] += x[i] * force.x + y[i] * force.y + z[i] * force.z;
                }
            }
            Self::Linear { parts, .. } => {
                for part in parts {
                    rows[part.coordinate] += part.factor * force[part.axis];
                }
            }
        }
    }
}

/// Factor c times one coordinate along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearPart {
    /// The coordinate.
    pub coordinate: usize,
    /// The axis: 0, 1 or 2.
    pub axis: usize,
    /// The factor.
    pub factor: f64,
}

/// A node: where it is, and in which directions it has a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodePlace {
    /// Reference place in mm, kept in the directions without a coordinate.
    pub reference: Vector,
    /// Directions (x, y, z) in which it has a coordinate.
    pub free: [bool; 3],
}

/// Coordinates of an instant and the vectors that follow from them.
///
/// Coordinates of the bodies (of a tree, or directors) come first, then those of the nodes, then internal ones: numbers that belong to
/// a part of the scene and are no places.
#[derive(Clone, Debug)]
pub struct CoordinateMap {
    /// Number of coordinates u.
    pub coordinates: usize,
    /// Number of multipliers λ.
    pub multipliers: usize,
    /// Dependence of each vector.
    pub vectors: Vec<Dependence>,
    /// The tree of joint coordinates; without links where there are none.
    pub tree: Tree,
    /// Number of coordinates of the bodies.
    pub of_bodies: usize,
    /// Node and axis of each coordinate of the nodes.
    pub of_nodes: Vec<(usize, usize)>,
    /// Number of internal coordinates.
    pub of_internal: usize,
    /// Vectors with linear dependence.
    linear: Vec<usize>,
    /// Linear dependence on nodes of vectors on the tree.
    beside: Vec<(usize, Dependence)>,
}

/// First coordinate of the four vectors φ, d₁, d₂, d₃ of a body in director coordinates.
pub(super) fn body_offset(body: usize) -> usize {
    12 * body
}

impl CoordinateMap {
    /// Joint coordinates of a tree, and coordinates of nodes.
    pub fn articulated(
        mut tree: Tree,
        vectors: &[MaterialVector],
        nodes: &[NodePlace],
        internal: usize,
        multipliers: usize,
    ) -> Self {
        let parts = parts_of_nodes(tree.coordinates(), nodes);
        let of_nodes = |(index, vector): (usize, &MaterialVector)| {
            let is_node = |term: &&VectorTerm| matches!(term.carrier, Carrier::Node(_));
            let terms: Vec<_> = vector.terms.iter().filter(is_node).copied().collect();
            (!terms.is_empty()).then(|| (index, linear(&MaterialVector { terms }, nodes, &parts)))
        };
        let on_tree = vectors.iter().enumerate().filter(|(_, v)| v.is_on_tree());
        let beside: Vec<_> = on_tree.filter_map(of_nodes).collect();
        tree.widen(beside.iter().map(|(v, of)| (*v, of.support())));
        let dependence = |(vector, packed): (&MaterialVector, &TangentColumns)| {
            if vector.is_on_tree() {
                Dependence::Articulated(packed.clone())
            } else {
                linear(vector, nodes, &parts)
            }
        };
        let of_bodies = tree.coordinates();
        let vectors = vectors.iter().zip(tree.packed()).map(dependence).collect();
        let map = Self::new(vectors, tree, of_bodies, nodes, [internal, multipliers]);
        Self { beside, ..map }
    }

    /// Director coordinates of `bodies` bodies, and coordinates of nodes.
    pub fn redundant(
        bodies: usize,
        vectors: &[MaterialVector],
        nodes: &[NodePlace],
        internal: usize,
        multipliers: usize,
    ) -> Self {
        let parts = parts_of_nodes(12 * bodies, nodes);
        let vectors: Vec<_> = vectors.iter().map(|v| linear(v, nodes, &parts)).collect();
        let still = vec![MaterialVector::default(); vectors.len()];
        let tree = Tree::new(Vec::new(), 0, &still);
        Self::new(vectors, tree, 12 * bodies, nodes, [internal, multipliers])
    }

    fn new(
        vectors: Vec<Dependence>,
        tree: Tree,
        of_bodies: usize,
        nodes: &[NodePlace],
        [of_internal, multipliers]: [usize; 2],
    ) -> Self {
        let axes = |(node, place): (usize, &NodePlace)| {
            let free = place.free;
            (0..3)
                .filter(move |&axis| free[axis])
                .map(move |axis| (node, axis))
        };
        let of_nodes: Vec<_> = nodes.iter().enumerate().flat_map(axes).collect();
        let is_linear = |&v: &usize| matches!(vectors[v], Dependence::Linear { .. });
        Self {
            coordinates: of_bodies + of_nodes.len() + of_internal,
            multipliers,
            linear: (0..vectors.len()).filter(is_linear).collect(),
            vectors,
            tree,
            of_bodies,
            of_nodes,
            of_internal,
            beside: Vec::new(),
        }
    }

    /// Coordinates of the nodes.
    pub fn nodes(&self) -> Range<usize> {
        self.of_bodies..self.of_bodies + self.of_nodes.len()
    }

    /// Internal coordinates.
    pub fn internal(&self) -> Range<usize> {
        self.coordinates - self.of_internal..self.coordinates
    }

    /// Storage for an instant.
    pub fn instant(&self) -> Configuration {
        let zeros = || vec![Vector::zeros(); self.vectors.len()];
        let still = vec![0.0; self.tree.size()];
        let mut columns = still.clone();
        for (v, of) in &self.beside {
            let packed = &self.tree.packed()[*v];
            for (part, place) in of.parts().iter().zip(packed.of_tree..) {
                columns[packed.first + part.axis * packed.stride + place] = part.factor;
            }
        }
        let mut z = vec![0.0; self.unknowns()];
        for _ in 0..self.charts() {
            z.extend([1.0, 0.0, 0.0, 0.0]);
        }
        Configuration {
            z,
            l: vec![0.0; self.unknowns()],
            x: zeros(),
            w: zeros(),
            columns,
            columns_l: still,
            forces: zeros(),
            contracted: zeros(),
            tree: self.tree.state(),
        }
    }

    /// Coordinates and multipliers of an instant.
    pub fn unknowns(&self) -> usize {
        self.coordinates + self.multipliers
    }

    /// Number of charts, whose quaternions follow the unknowns in the list of an instant.
    pub(super) fn charts(&self) -> usize {
        self.tree.charts()
    }

    /// Returns true if bodies have joint coordinates, and no directors.
    pub fn is_articulated(&self) -> bool {
        self.of_bodies == self.tree.coordinates()
    }

    /// An instant placed at coordinates, and multipliers and charts where they are given.
    pub fn placed(&self, z: &[f64]) -> Configuration {
        let mut instant = self.instant();
        instant.z[..z.len()].copy_from_slice(z);
        self.place(&mut instant);
        instant
    }

    /// x = F(u) and the columns of P.
    pub fn place(&self, instant: &mut Configuration) {
        self.vectors(instant);
        self.tangent(instant);
    }

    /// x = F(u).
    pub fn vectors(&self, instant: &mut Configuration) {
        let Configuration {
            z, x, tree: state, ..
        } = instant;
        let (unknowns, charts) = z.split_at(self.unknowns());
        self.tree.place(unknowns, charts, state);
        self.tree.vectors(state, x);
        for &v in &self.linear {
            x[v] = self.vectors[v].at(z);
        }
        for (v, of) in &self.beside {
            x[*v] += of.at(z);
        }
    }

    /// The columns of P, once the vectors are known; linear vectors need none.
    pub fn tangent(&self, instant: &mut Configuration) {
        self.tree.tangent(&mut instant.tree, &mut instant.columns);
    }

    /// w = P l and, for a tree, the derivatives of the columns along l.
    pub fn along(&self, instant: &mut Configuration) {
        self.tree.along(instant);
        for &v in &self.linear {
            instant.w[v] = self.vectors[v].along(&instant.l);
        }
        for (v, of) in &self.beside {
            instant.w[*v] += of.along(&instant.l);
        }
    }

    /// Adds Pᵀ R of the forces on an instant to the rows of the coordinates; needs no columns.
    pub fn rows(&self, instant: &mut Configuration, rows: &mut [f64]) {
        self.tree
            .pull_back(&mut instant.tree, &instant.forces, rows);
        for &v in &self.linear {
            self.vectors[v].pull_back(&[], &instant.forces[v], rows);
        }
        for (v, of) in &self.beside {
            of.pull_back(&[], &instant.forces[*v], rows);
        }
    }

    /// Adds Pᵀ R to the rows of the coordinates.
    pub fn pull_back(&self, columns: &[f64], forces: &[Vector], rows: &mut [f64]) {
        for (vector, force) in forces.iter().enumerate() {
            self.pull_back_one(vector, columns, force, rows);
        }
    }

    /// Adds the derivative P′_lᵀ R, which only vectors on a tree have.
    pub fn pull_back_along(&self, columns_l: &[f64], forces: &[Vector], rows: &mut [f64]) {
        for (vector, force) in forces.iter().enumerate() {
            if let Dependence::Articulated(_) = self.vectors[vector] {
                self.pull_back_one(vector, columns_l, force, rows);
            }
        }
    }

    /// Adds Pᵀ f for a force on one vector.
    pub fn pull_back_one(&self, vector: usize, columns: &[f64], force: &Vector, rows: &mut [f64]) {
        self.vectors[vector].pull_back(columns, force, rows);
    }

    /// Adds Pᵀ f for the forces on some vectors times a factor, and takes them away.
    pub fn take_back(
        &self,
        vectors: &[usize],
        columns: &[f64],
        forces: &mut [Vector],
        factor: f64,
        rows: &mut [f64],
    ) {
        for &vector in vectors {
            let force = std::mem::take(&mut forces[vector]) * factor;
            self.pull_back_one(vector, columns, &force, rows);
        }
    }

    /// Columns of articulated vectors, such as the derivatives of P along a direction, times rates of the coordinates.
    pub fn times(&self, columns: &[f64], rates: &[f64]) -> Vec<Vector> {
        let of_vector = |dependence: &Dependence| match dependence {
            Dependence::Linear { .. } => Vector::zeros(),
            Dependence::Articulated(packed) => {
                let moves = |row: &[f64]| {
                    packed
                        .support
                        .iter()
                        .zip(row)
                        .map(|(&i, c)| c * rates[i])
                        .sum()
                };
                Vector::from_iterator(packed.rows(columns).into_iter().map(moves))
            }
        };
        self.vectors.iter().map(of_vector).collect()
    }

    /// Coordinates that move a vector.
    pub fn support(&self, vector: usize) -> Vec<usize> {
        self.vectors[vector].support()
    }

    /// Poses of the bodies at an instant.
    pub fn poses(&self, instant: &Configuration, bodies: usize) -> Vec<Pose> {
        if let Some(poses) = instant.tree.poses.get(..bodies) {
            return poses.to_vec();
        }
        let pose = |body: usize| {
            let q = &instant.z[body_offset(body)..];
            Pose {
                centre: Vector::new(q[0], q[1], q[2]),
                directors: self.directors(instant, body),
            }
        };
        (0..bodies).map(pose).collect()
    }

    /// Directors of a body at a placed instant.
    pub fn directors(&self, instant: &Configuration, body: usize) -> Matrix {
        match instant.tree.poses.get(body) {
            Some(pose) => pose.directors,
            None => Matrix::from_column_slice(&instant.z[body_offset(body) + 3..][..9]),
        }
    }
}

/// Parts of each node; its coordinates follow those of the nodes before.
fn parts_of_nodes(first: usize, nodes: &[NodePlace]) -> Vec<Vec<LinearPart>> {
    let mut next = first;
    let parts = |node: &NodePlace| {
        let free = (0..3).filter(|&axis| node.free[axis]);
        let part = |(i, axis)| LinearPart {
            coordinate: next + i,
            axis,
            factor: 1.0,
        };
        let parts: Vec<LinearPart> = free.enumerate().map(part).collect();
        next += parts.len();
        parts
    };
    nodes.iter().map(parts).collect()
}

/// The linear dependence of a vector on directors, nodes and single coordinates.
fn linear(vector: &MaterialVector, nodes: &[NodePlace], of_node: &[Vec<LinearPart>]) -> Dependence {
    let mut constant = Vector::zeros();
    let mut parts = Vec::new();
    for term in &vector.terms {
        match term.carrier {
            Carrier::Ground => constant += term.at(&Pose::GROUND),
            Carrier::Body(body) => {
                let d = &term.directors;
                for (i, factor) in [term.centre, d.x, d.y, d.z].into_iter().enumerate() {
                    if factor != 0.0 {
                        parts.extend((0..3).map(|axis| LinearPart {
                            coordinate: body_offset(body) + 3 * i + axis,
                            axis,
                            factor,
                        }));
                    }
                }
            }
            Carrier::Coordinate(coordinate) => {
                let axes = (0..3).filter(|&axis| term.directors[axis] != 0.0);
                parts.extend(axes.map(|axis| LinearPart {
                    coordinate,
                    axis,
                    factor: term.directors[axis],
                }));
            }
            Carrier::Node(node) => {
                let NodePlace { reference, free } = nodes[node];
                for axis in (0..3).filter(|&axis| !free[axis]) {
                    constant[axis] += term.centre * reference[axis];
                }
                parts.extend(of_node[node].iter().map(|part| LinearPart {
                    factor: part.factor * term.centre,
                    ..*part
                }));
            }
        }
    }
    Dependence::Linear { constant, parts }
}

impl CoordinateMap {
    /// Moves the charts of a placed instant to where its bodies are: nothing moves, and the coordinates that turn behind a
    /// chart become zero. Returns true if there are charts.
    pub fn recentre(&self, instant: &mut Configuration) -> bool {
        if self.charts() == 0 {
            return false;
        }
        let (unknowns, charts) = instant.z.split_at_mut(self.unknowns());
        self.tree.recentre(unknowns, charts);
        self.place(instant);
        true
    }

    /// Writes the differences between two lists of coordinates with the same charts: of turns behind a chart the rotation vector, which over
    /// the time between is a smooth mean of the angular velocity.
    pub fn differences(&self, [from, to]: [&[f64]; 2], differences: &mut [f64]) {
        for (difference, (from, to)) in differences.iter_mut().zip(from.iter().zip(to)) {
            *difference = to - from;
        }
        self.tree.rotations_between([from, to], differences);
    }

    /// Moves unknowns by a step along a direction, where the turns behind charts are zero: they stay zero, and the charts turn about the
    /// rotation vectors of their parts of the direction.
    pub fn advance(&self, step: f64, direction: &[f64], unknowns: &mut [f64], charts: &mut [f64]) {
        for (value, change) in unknowns.iter_mut().zip(direction) {
            *value += step * change;
        }
        self.tree.turn_charts(unknowns, charts);
    }

    /// Gives a body on a joint with a chart, with turns of zero, a velocity of its centre and an angular velocity by the rates of this joint,
    /// and updates the motion of all vectors; `false` where the body is on another joint.
    pub fn set_in_motion(
        &self,
        body: usize,
        twist: [Vector; 2],
        instant: &mut Configuration,
    ) -> bool {
        if !self.is_articulated() {
            return false;
        }
        let is_set = (self.tree).set_in_motion(body, twist, &instant.tree, &mut instant.l);
        self.along(instant);
        is_set
    }

    /// Returns true if the charts of a list of coordinates, multipliers and charts are quaternions of length one; lists of another length belong to
    /// other coordinates.
    pub fn has_unit_charts(&self, z: &[f64]) -> bool {
        let is_unit = |q: &[f64]| (q.iter().map(|q| q * q).sum::<f64>() - 1.0).abs() < 1e-9;
        z.len() != self.unknowns() + CHART * self.charts()
            || z[self.unknowns()..].chunks(CHART).all(is_unit)
    }

    /// Takes over the charts of another list of coordinates, multipliers and charts: the configuration stays.
    pub fn take_charts(&self, other: &[f64], z: &mut [f64]) {
        if self.charts() > 0 {
            let (u, charts) = z.split_at_mut(self.unknowns());
            self.tree.take_charts(&other[self.unknowns()..], u, charts);
        }
    }

    /// Lets the joints with a chart follow given poses of the bodies: their charts and slides, the turns behind them zero.
    pub fn follow(&self, poses: &[Pose], instant: &mut Configuration) {
        let (u, charts) = instant.z.split_at_mut(self.unknowns());
        self.tree.follow(poses, u, charts);
        self.place(instant);
    }

    /// Puts the charts of a list of coordinates, multipliers and charts at the mean of others, by weights whose sum is one; the
    /// coordinates that turn behind them become zero, others stay.
    pub fn mean_of_charts(&self, parts: &[(f64, &[f64])], z: &mut [f64]) {
        if self.charts() == 0 {
            return;
        }
        let split = parts.iter().map(|&(weight, z)| {
            let (unknowns, charts) = z.split_at(self.unknowns());
            (weight, [unknowns, charts])
        });
        let parts: Vec<_> = split.collect();
        let (unknowns, charts) = z.split_at_mut(self.unknowns());
        self.tree.mean(&parts, unknowns, charts);
    }
}
