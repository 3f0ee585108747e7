//! How vectors follow from the coordinates of an instant: on a kinematic tree, or linearly from directors.

use crate::kinematics::{MaterialVector, Pose};
use crate::math::{Matrix, Vector};
use crate::reduction::instant::Instant;
use crate::reduction::tree::{Packed, Tree};

/// How one vector depends on the coordinates.
#[derive(Clone, Debug)]
pub enum Dependence {
    /// A constant plus Σ c · (three coordinates from `first`).
    Linear {
        /// The constant.
        constant: Vector,
        /// (first, c).
        parts: Vec<(usize, f64)>,
    },
    /// Columns of a tree.
    Articulated(Packed),
}

/// Coordinates of an instant and the vectors that follow from them.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Number of coordinates u.
    pub coordinates: usize,
    /// Number of multipliers λ.
    pub multipliers: usize,
    /// Dependence of each vector.
    pub vectors: Vec<Dependence>,
    /// The tree, for joint coordinates.
    pub tree: Option<Tree>,
}

/// First coordinate of the four vectors φ, d₁, d₂, d₃ of a body in director coordinates.
pub(super) fn body_offset(body: usize) -> usize {
    12 * body
}

impl Motion {
    /// Joint coordinates of a tree.
    pub fn articulated(tree: Tree, multipliers: usize) -> Self {
        let vectors = tree
            .packed()
            .iter()
            .cloned()
            .map(Dependence::Articulated)
            .collect();
        Self {
            coordinates: tree.coordinates(),
            multipliers,
            vectors,
            tree: Some(tree),
        }
    }

    /// Director coordinates of `bodies` bodies.
    pub fn redundant(bodies: usize, vectors: &[MaterialVector], multipliers: usize) -> Self {
        let dependence = |vector: &MaterialVector| {
            let mut constant = Vector::zeros();
            let mut parts = Vec::new();
            for term in &vector.terms {
                let Some(body) = term.body else {
                    constant += term.at(&Pose::GROUND);
                    continue;
                };
                let coefficients = [
                    term.centre,
                    term.directors.x,
                    term.directors.y,
                    term.directors.z,
                ];
                for (i, c) in coefficients.into_iter().enumerate() {
                    if c != 0.0 {
                        parts.push((body_offset(body) + 3 * i, c));
                    }
                }
            }
            Dependence::Linear { constant, parts }
        };
        Self {
            coordinates: 12 * bodies,
            multipliers,
            vectors: vectors.iter().map(dependence).collect(),
            tree: None,
        }
    }

    /// Storage for an instant.
    pub fn instant(&self) -> Instant {
        let zeros = || vec![Vector::zeros(); self.vectors.len()];
        let columns = vec![0.0; self.tree.as_ref().map_or(0, Tree::size)];
        Instant {
            z: vec![0.0; self.unknowns()],
            l: vec![0.0; self.unknowns()],
            x: zeros(),
            w: zeros(),
            columns: columns.clone(),
            columns_l: columns,
            forces: zeros(),
            contracted: zeros(),
            tree: self.tree.as_ref().map(Tree::state).unwrap_or_default(),
        }
    }

    /// Coordinates and multipliers of an instant.
    pub fn unknowns(&self) -> usize {
        self.coordinates + self.multipliers
    }

    /// x = F(u) and, for a tree, the columns of P.
    pub fn place(&self, instant: &mut Instant) {
        let Instant {
            z,
            x,
            columns,
            tree: state,
            ..
        } = instant;
        if let Some(tree) = &self.tree {
            tree.place(z, state);
            tree.vectors(state, x);
            tree.tangent(state, columns);
            return;
        }
        for (dependence, value) in self.vectors.iter().zip(x) {
            *value = Self::linear(dependence, z, true);
        }
    }

    fn linear(dependence: &Dependence, z: &[f64], constant: bool) -> Vector {
        let Dependence::Linear {
            constant: offset,
            parts,
        } = dependence
        else {
            unreachable!("without a tree every vector is linear")
        };
        let mut sum = if constant { *offset } else { Vector::zeros() };
        for &(first, c) in parts {
            sum += Vector::new(z[first], z[first + 1], z[first + 2]) * c;
        }
        sum
    }

    /// w = P l and, for a tree, the derivatives of the columns along l.
    pub fn along(&self, instant: &mut Instant) {
        if let Some(tree) = &self.tree {
            tree.along(instant);
            return;
        }
        for (dependence, value) in self.vectors.iter().zip(&mut instant.w) {
            *value = Self::linear(dependence, &instant.l, false);
        }
    }

    /// Adds Pᵀ R to the rows of the coordinates.
    pub fn pull_back(&self, columns: &[f64], forces: &[Vector], rows: &mut [f64]) {
        for (vector, force) in forces.iter().enumerate() {
            self.pull_back_one(vector, columns, force, rows);
        }
    }

    /// Adds Pᵀ f for a force on one vector.
    pub fn pull_back_one(&self, vector: usize, columns: &[f64], force: &Vector, rows: &mut [f64]) {
        match &self.vectors[vector] {
            Dependence::Articulated(packed) => {
                let [x, y, z] = packed.rows(columns);
                for (i, &row) in packed.support.iter().enumerate() {
                    rows[row] += x[i] * force.x + y[i] * force.y + z[i] * force.z;
                }
            }
            Dependence::Linear { parts, .. } => {
                for &(first, c) in parts {
                    for i in 0..3 {
                        rows[first + i] += c * force[i];
                    }
                }
            }
        }
    }

    /// Coordinates that move a vector.
    pub fn support(&self, vector: usize) -> Vec<usize> {
        match &self.vectors[vector] {
            Dependence::Articulated(packed) => packed.support.clone(),
            Dependence::Linear { parts, .. } => parts
                .iter()
                .flat_map(|&(first, _)| first..first + 3)
                .collect(),
        }
    }

    /// Poses of the bodies at an instant.
    pub fn poses(&self, instant: &Instant, bodies: usize) -> Vec<Pose> {
        if self.tree.is_some() {
            return instant.tree.poses.clone();
        }
        let z = &instant.z;
        let pose = |body: usize| {
            let q = &z[body_offset(body)..body_offset(body) + 12];
            Pose {
                centre: Vector::new(q[0], q[1], q[2]),
                directors: Matrix::from_column_slice(&q[3..]),
            }
        };
        (0..bodies).map(pose).collect()
    }
}
