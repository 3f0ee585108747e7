//! Closing constraints of loops as functions of the coordinates of the spanning tree, without units.

use crate::coordinates::CoordinateMap;
use crate::kinematics::{Pose, Vectors};
use crate::math::{Random, Vector};
use crate::model::presolve::graph::Graph;
use crate::model::system::System;
use crate::model::terms::joint_constraints::{JointConstraints, Product};
use nalgebra::{DMatrix, DVector};

/// Singular values below this are none.
pub(crate) const NONE: f64 = 1e-8;
/// Singular values below this are no direction in which the constraints can be met: places and axes written with three digits leave less.
const WEAK: f64 = 3e-4;
/// Gap that counts as closed: what rounded places and axes leave of a length of 1.
const CLOSED: f64 = 1e-9;
/// Gap at which no further update is worth its while.
const ROUNDING: f64 = 1e-14;
/// Coordinates at which updates have diverged.
const FAR: f64 = 1e6;
/// Updates towards a closed configuration.
const UPDATES: usize = 60;
/// Displacements from the reference that are tried, in rad and lengths of the system.
const DISPLACEMENTS: [f64; 3] = [0.1, 0.03, 0.01];

/// Length of a stride along the motion, in the same, and the number of strides.
const STRIDE: f64 = 0.1;
const STRIDES: usize = 60;
/// Limit of the strides times the products in a decomposition of the gradients.
const WORK: usize = 1_000_000;

/// The closing constraints g(q) of the joints that close loops, and the tree with coordinates q.
pub(crate) struct Linkage {
    map: CoordinateMap,
    /// The closing joints, each with its constraints.
    pub(crate) closing: Vec<(usize, Vec<Product>)>,
    /// Both vectors of each constraint.
    vectors: Vec<[usize; 2]>,
    /// Typical sizes of the constraints and of the coordinates.
    sizes: [Vec<f64>; 2],
}

/// Values g and gradients G at a configuration.
pub(crate) struct Closure {
    pub(crate) values: DVector<f64>,
    pub(crate) gradients: DMatrix<f64>,
}

/// Result of a displacement along the loops.
pub(crate) enum Displaced {
    /// Gradients in closed configurations away from the reference.
    Moved(Vec<DMatrix<f64>>),
    /// Back to the reference: the displacement is possible to first order only.
    Back,
    /// Nowhere: this gap stays.
    Open(f64),
}

impl Linkage {
    pub(crate) fn new(system: &System, graph: &Graph, reference: &[Pose], length: f64) -> Self {
        let joints = graph.loops().iter();
        let constraints = |&j: &usize| {
            let made = JointConstraints::new(&system.joints[j], reference);
            (j, made.into_products())
        };
        let closing: Vec<(usize, Vec<Product>)> = joints.map(constraints).collect();
        let mut list = Vectors::default();
        let products = || closing.iter().flat_map(|(_, products)| products);
        let of = |product: &Product| product.vectors.each_ref().map(|v| list.index(v.clone()));
        let vectors = products().map(of).collect();
        let tree = graph.tree(system, reference, list.list());
        Self {
            map: CoordinateMap::articulated(tree, list.list(), &[], 0, 0),
            vectors,
            sizes: [
                products().map(|product| product.size(length)).collect(),
                graph.sizes(system, length),
            ],
            closing,
        }
    }

    /// Number of coordinates.
    pub(crate) fn coordinates(&self) -> usize {
        self.map.coordinates
    }

    /// Number of constraints.
    pub(crate) fn constraints(&self) -> usize {
        self.vectors.len()
    }

    /// Values and gradients at coordinates.
    pub(crate) fn at(&self, q: &DVector<f64>) -> Closure {
        let [of_constraints, of_coordinates] = &self.sizes;
        let z: Vec<f64> = q.iter().zip(of_coordinates).map(|(q, s)| q * s).collect();
        let mut instant = self.map.placed(&z);
        let (m, n) = (self.constraints(), self.coordinates());
        let mut values = DVector::zeros(m);
        let mut gradients = DMatrix::zeros(m, n);
        let mut row = vec![0.0; n];
        for (i, &[a, b]) in self.vectors.iter().enumerate() {
            values[i] = instant.x[a].dot(&instant.x[b]) / of_constraints[i];
            instant.forces.fill(Vector::zeros());
            instant.forces[a] = instant.x[b];
            instant.forces[b] += instant.x[a];
            row.fill(0.0);
            self.map.rows(&mut instant, &mut row);
            for (j, (value, size)) in row.iter().zip(of_coordinates).enumerate() {
                gradients[(i, j)] = value * size / of_constraints[i];
            }
        }
        Closure { values, gradients }
    }

    /// A random direction in the null space of gradients; `None` where that is empty.
    fn direction(&self, gradients: &DMatrix<f64>, random: &mut Random) -> Option<DVector<f64>> {
        let n = self.coordinates();
        let any: DVector<f64> = DVector::from_fn(n, |_, _| random.between(-1.0, 1.0));
        if rank(gradients, WEAK) == n {
            return None;
        }
        let along = solve(gradients, &(gradients * &any));
        let direction = any - along;
        let size = direction.amax();
        Some(direction / size)
    }

    /// Displaces the linkage from the reference, closes it again and moves it on; `None` where nothing can move.
    pub(crate) fn displaced(
        &self,
        gradients: &DMatrix<f64>,
        random: &mut Random,
    ) -> Option<Displaced> {
        let direction = self.direction(gradients, random)?;
        let mut open = None;
        let mut is_back = false;
        for size in DISPLACEMENTS {
            let (q, closure) = self.closed(&direction * size);
            let gap = closure.values.amax();
            match q.amax() {
                moved if moved < 0.1 * size => is_back = true,
                _ if gap <= CLOSED => {
                    return Some(Displaced::Moved(self.moved_on(q, closure, direction)));
                }
                _ => open = open.or(Some(gap)),
            }
        }
        Some(match open {
            Some(gap) if !is_back => Displaced::Open(gap),
            _ => Displaced::Back,
        })
    }

    /// Gradients along the motion from a closed configuration in about a direction.
    fn moved_on(
        &self,
        mut q: DVector<f64>,
        mut here: Closure,
        mut direction: DVector<f64>,
    ) -> Vec<DMatrix<f64>> {
        let size = self.constraints() * self.coordinates().pow(2);
        let strides = STRIDES.min(WORK / size.max(1));
        let mut all = Vec::with_capacity(strides + 1);
        for _ in 0..strides {
            direction -= solve(&here.gradients, &(&here.gradients * &direction));
            direction /= direction.amax();
            let (next, closure) = self.closed(&q + &direction * STRIDE);
            // Not where the direction is lost, and where another branch is reached.
            if !(closure.values.amax() <= CLOSED && (&next - &q).amax() < 2.0 * STRIDE) {
                break;
            }
            q = next;
            all.push(std::mem::replace(&mut here, closure).gradients);
        }
        all.push(here.gradients);
        all
    }

    /// Gradients where the tree is displaced and its loops are open.
    pub(crate) fn open(
        &self,
        gradients: &DMatrix<f64>,
        random: &mut Random,
    ) -> Option<DMatrix<f64>> {
        let direction = self.direction(gradients, random)?;
        Some(self.at(&(direction * DISPLACEMENTS[0])).gradients)
    }

    /// Closes the loops from coordinates by Gauss–Newton updates of least size, as far as possible.
    fn closed(&self, mut q: DVector<f64>) -> (DVector<f64>, Closure) {
        let mut here = self.at(&q);
        for _ in 0..UPDATES {
            if here.values.amax() <= ROUNDING {
                break;
            }
            let next = &q - solve(&here.gradients, &here.values);
            if !(next.iter().all(|x| x.abs() < FAR)) {
                break;
            }
            q = next;
            here = self.at(&q);
        }
        (q, here)
    }
}

/// Number of singular values above a limit.
pub(crate) fn rank(matrix: &DMatrix<f64>, limit: f64) -> usize {
    let values = matrix.singular_values();
    values.iter().filter(|&&value| value > limit).count()
}

/// The shortest update that meets equations as far as possible, without weak directions.
fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let parts = matrix.clone().svd(true, true);
    let solved = parts.solve(right, WEAK);
    solved.expect("both sets of vectors were computed")
}
