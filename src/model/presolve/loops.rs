//! Closing constraints of loops that follow from the others along the motion of their mechanism, and are left out.
//!
//! With coordinates q of the spanning tree, the joints that close loops demand g(q) = 0. A row of G = ∂g/∂q follows from the others where
//! the rank of G is less than the number of rows. In a singular configuration, as with all bars in line, that rank is less than along
//! the motion. It is therefore read where random displacements in the null space of G, closed again by Gauss–Newton, lead from
//! the reference, and further along the motion of small linkages. As many rows stay as the greatest rank. Those that are left out are
//! picked by pivoting in the left null spaces of G in all of these configurations.
//! Every result is checked against the rows that were left out.

use crate::kinematics::Pose;
use crate::math::Random;
use crate::model::analysis::ModelError;
use crate::model::presolve::graph::Graph;
use crate::model::presolve::linkage::{Displaced, Linkage, NONE, rank};
use crate::model::system::System;
use crate::model::terms::joint_constraints::Product;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::collections::BTreeMap;

/// Seed of the displacements, and their number.
const SEED: u64 = 7;
const DISPLACED: usize = 4;
/// Number of coordinates of the tree or of closing constraints above which loops are not looked at.
const MANY: usize = 1000;
/// Gap of a constraint that was left out, of angles in rad and of lengths relative to the system's, from which on a loop is open.
pub const OPEN: f64 = 1e-7;

/// The closing constraints that are left out of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loops {
    /// Constraints that stay, by joint of the presolved system that loses some.
    kept: BTreeMap<usize, Vec<Product>>,
    /// Those that are left out.
    left_out: Vec<Product>,
    /// Degrees of freedom of the tree with its loops closed; `None` where they were not looked at.
    pub mobility: Option<usize>,
    /// A warning about the reference configuration.
    pub warning: Option<String>,
    /// Length of the system in mm.
    length: f64,
}

impl Loops {
    /// Those of a system.
    ///
    /// # Errors
    /// A loop can be closed in the reference only, by rounded places or axes.
    pub(crate) fn new(
        system: &System,
        graph: &Graph,
        reference: &[Pose],
        length: f64,
    ) -> Result<Self, ModelError> {
        let mut made = Self {
            length,
            ..Self::default()
        };
        if graph.loops().is_empty() {
            return Ok(made);
        }
        let linkage = Linkage::new(system, graph, reference, length);
        let (m, n) = (linkage.constraints(), linkage.coordinates());
        if m.max(n) > MANY {
            made.warning = Some(format!(
                "the loops have more than {MANY} coordinates or constraints: whether constraints follow from others was not checked"
            ));
            return Ok(made);
        }
        let here = linkage.at(&DVector::zeros(n)).gradients;
        if !here.iter().all(|value| value.is_finite()) {
            return Ok(made);
        }
        let own = rank(&here, NONE);
        made.mobility = Some(n - own);
        if own == m {
            return Ok(made);
        }
        let samples = made.samples(&linkage, here, system)?;
        let greatest = samples.iter().map(|sample| rank(sample, NONE)).max();
        let greatest = greatest.unwrap_or(own);
        made.mobility = Some(n - greatest);
        if n == greatest && made.warning.is_none() {
            made.warning = Some("the loops leave no degree of freedom: nothing moves".to_owned());
        } else if greatest > own && made.warning.is_none() {
            made.warning = Some(format!(
                "the reference is a singular configuration of the loops: they leave {} degrees of freedom there and {} along the motion, which may branch",
                n - own,
                n - greatest
            ));
        }
        if greatest < m {
            made.leave_out(linkage.closing, &dependent(&samples, greatest));
        }
        Ok(made)
    }

    /// Gradients at closed configurations away from the reference, where it can move.
    fn samples(
        &mut self,
        linkage: &Linkage,
        here: DMatrix<f64>,
        system: &System,
    ) -> Result<Vec<DMatrix<f64>>, ModelError> {
        let mut random = Random::new(SEED);
        let (mut moved, mut gap, mut is_rigid) = (Vec::new(), 0.0_f64, false);
        for _ in 0..DISPLACED {
            match linkage.displaced(&here, &mut random) {
                Some(Displaced::Moved(gradients)) => moved.extend(gradients),
                Some(Displaced::Back) => {}
                Some(Displaced::Open(left)) => gap = gap.max(left),
                None => is_rigid = true,
            }
        }
        if is_rigid {
            return Ok(vec![here]);
        }
        if moved.is_empty() && gap > 0.0 {
            let joints = linkage.closing.iter().map(|(j, _)| &system.joints[*j].name);
            return Err(ModelError::OpenLoop {
                joints: joints
                    .map(|name| format!("\"{name}\""))
                    .collect::<Vec<_>>()
                    .join(", "),
                gap,
            });
        }
        if moved.is_empty() {
            self.warning = Some(
                "the loops can move to first order only: the reference is a dead point, or they hold it by constraints that are singular there"
                    .to_owned(),
            );
            let open = (0..DISPLACED).filter_map(|_| linkage.open(&here, &mut random));
            moved.extend(open);
        }
        Ok(moved)
    }

    /// Leaves out closing constraints, numbered through.
    fn leave_out(&mut self, closing: Vec<(usize, Vec<Product>)>, dependent: &[usize]) {
        let mut number = 0;
        for (joint, products) in closing {
            let (mut kept, mut left_out) = (Vec::new(), Vec::new());
            for product in products {
                match dependent.contains(&number) {
                    true => left_out.push(product),
                    false => kept.push(product),
                }
                number += 1;
            }
            if !left_out.is_empty() {
                self.kept.insert(joint, kept);
                self.left_out.extend(left_out);
            }
        }
    }

    /// The constraints that stay of a joint that loses some; `None` where it keeps all.
    pub(crate) fn kept(&self, joint: usize) -> Option<&[Product]> {
        self.kept.get(&joint).map(Vec::as_slice)
    }

    /// Names of the constraints that are left out.
    pub fn left_out(&self) -> impl Iterator<Item = &str> {
        self.left_out.iter().map(|product| product.name.as_str())
    }

    /// Returns true if no constraint is left out.
    pub fn is_empty(&self) -> bool {
        self.left_out.is_empty()
    }

    /// max |g| over the constraints that are left out at poses of the presolved bodies, without units or in mm.
    pub fn violation(&self, poses: &[Pose]) -> f64 {
        let values = self.left_out.iter().map(|product| product.at(poses, 1.0));
        values.fold(0.0, |m, value| m.max(value.abs()))
    }

    /// The greatest gap of a constraint that is left out at poses of the presolved bodies, in rad or relative to the length of the system, with its name.
    pub fn gap(&self, poses: &[Pose]) -> Option<(f64, &str)> {
        let gaps = self.left_out.iter().map(|product| {
            let gap = product.at(poses, self.length).abs();
            (gap, product.name.as_str())
        });
        gaps.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Numbers of the rows that follow from the others in all samples of this greatest rank, in order: those that are most independent in
/// bases of the left null spaces.
fn dependent(samples: &[DMatrix<f64>], greatest: usize) -> Vec<usize> {
    let samples = samples.iter().filter(|s| rank(s, NONE) == greatest);
    independent_rows(samples.map(|s| left_null_space(s, greatest)).collect())
}

/// Numbers of as many rows as bases with orthonormal columns have columns, in order.
///
/// They are picked one by one: the row whose part that is independent of those before is greatest where it is least.
pub(crate) fn independent_rows(mut bases: Vec<DMatrix<f64>>) -> Vec<usize> {
    let (rows, count) = bases.first().map_or((0, 0), |basis| basis.shape());
    let mut picked = Vec::with_capacity(count);
    for _ in 0..count {
        let least = |row: usize| {
            let norms = bases.iter().map(|basis| basis.row(row).norm());
            norms.fold(f64::INFINITY, f64::min)
        };
        let best = (0..rows).max_by(|&a, &b| least(a).total_cmp(&least(b)));
        let row = best.expect("there are rows to leave out");
        picked.push(row);
        for basis in &mut bases {
            let direction = basis.row(row).normalize();
            let along = &*basis * direction.transpose();
            *basis -= along * direction;
        }
    }
    picked.sort_unstable();
    picked
}

/// Basis of the vectors y with yᵀG = 0 of a matrix of this rank.
fn left_null_space(matrix: &DMatrix<f64>, rank: usize) -> DMatrix<f64> {
    let square = SymmetricEigen::new(matrix * matrix.transpose());
    let mut order: Vec<usize> = (0..matrix.nrows()).collect();
    order.sort_by(|&a, &b| square.eigenvalues[a].total_cmp(&square.eigenvalues[b]));
    let count = matrix.nrows() - rank;
    square.eigenvectors.select_columns(&order[..count])
}
