//! Second derivatives that are added straight into the matrix of nodes, without a list of couplings.

use crate::element::Dilatation;
use crate::functional::{BlockMask, Coupling};
use crate::math::{Matrix, Vector};
use crate::mesh::CORNERS;
use crate::sparse::multigrid::{BlockPlaces, ElementVolume, GridNode, NodeBlock};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Number of components of a node; the last one is a scalar.
const COMPONENTS: usize = 4;
/// Component of the scalar.
const SCALAR: usize = 3;

/// Dependence of a vector on the unknowns of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VectorPlace {
    /// It does not move.
    Still,
    /// It is the place of a node, of which these components are unknown.
    Node(GridNode, [bool; 3]),
    /// It depends on more.
    Other,
}

/// Dependence of a scalar of an interval on the unknowns of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScalarPlace {
    /// It is given.
    Given,
    /// It is the unknown of a node.
    Node(GridNode),
}

/// Pressures with which second derivatives of volumes enter a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pressures {
    /// Those of the volumes, which may be far off before an iteration comes near its end: as far as a few shear moduli.
    Bounded,
    /// Those that were predicted.
    Predicted,
    /// Those of the volumes.
    Exact,
}

/// Largest pressure relative to the shear modulus that volumes are believed.
const BELIEVED: f64 = 2.0;

/// The volume of an element at nodes.
#[derive(Clone, Copy, Debug)]
pub struct NodeVolume {
    /// Its nodes that move, by corner.
    pub corners: [Option<GridNode>; 8],
    /// The volume.
    pub volume: ElementVolume,
    /// Its pressure in MPa.
    pub pressure: f64,
    /// Factor from the product of derivatives and an update to a change of the pressure.
    pub change: f64,
}

/// Matrix by node and neighbour: the sum of the blocks between both instants of an interval that are asked for, and likewise of the rows and
/// columns of scalars.
#[derive(Clone, Debug, Default)]
pub struct NodeBlocks {
    places: Arc<BlockPlaces>,
    vectors: Vec<VectorPlace>,
    scalars: Vec<ScalarPlace>,
    /// The blocks; lent by the solver for an evaluation.
    pub matrix: Vec<NodeBlock>,
    /// Volumes of elements whose products of derivatives are parts of the blocks.
    pub volumes: Vec<NodeVolume>,
    /// Pressures with which second derivatives of volumes enter, where these are asked for.
    pub pressures: Option<Pressures>,
    /// Predicted pressures in MPa, in the order of the volumes.
    pub predicted: Vec<f64>,
    /// False where it was time to stop before all elements were added.
    pub is_whole: bool,
    /// True if derivatives by given scalars are kept too.
    has_given: bool,
    /// Places of these by vector or scalar, and given scalar.
    given_slots: [FxHashMap<(u32, u32), u32>; 2],
    of_vectors: Vec<(u32, u32, Vector)>,
    of_scalars: Vec<(u32, u32, f64)>,
}

/// A block between two vectors with the components that are unknown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    block: usize,
    rows: [bool; 3],
    columns: [bool; 3],
}

impl NodeBlocks {
    /// Of vectors and scalars at the nodes of these blocks; `has_given` if derivatives by given scalars are kept too.
    pub fn new(
        places: Arc<BlockPlaces>,
        vectors: Vec<VectorPlace>,
        scalars: Vec<ScalarPlace>,
        has_given: bool,
    ) -> Self {
        Self {
            places,
            vectors,
            scalars,
            has_given,
            ..Self::default()
        }
    }

    /// Makes room for what couples; returns false if it couples nodes that are no neighbours, or something else.
    pub fn take(&mut self, coupling: Coupling) -> bool {
        use ScalarPlace::{Given, Node as Scalar};
        use VectorPlace::{Node, Other, Still};
        let touch = |a: GridNode, b: GridNode| self.places.block(a, b).is_some();
        match coupling {
            Coupling::Full(a, b) | Coupling::Isotropic(a, b) => {
                match (self.vectors[a], self.vectors[b]) {
                    (Other, _) | (_, Other) => false,
                    (Node(a, _), Node(b, _)) => touch(a, b),
                    (Still, _) | (_, Still) => true,
                }
            }
            Coupling::Mixed(a, s) => match (self.vectors[a], self.scalars[s]) {
                (Other, _) => false,
                (Node(a, _), Scalar(s)) => touch(a, s),
                (Node(..), Given) if self.has_given => {
                    let slots = &mut self.given_slots[0];
                    let list = &mut self.of_vectors;
                    slots.entry((a as u32, s as u32)).or_insert_with(|| {
                        list.push((a as u32, s as u32, Vector::zeros()));
                        list.len() as u32 - 1
                    });
                    true
                }
                (Still, _) | (_, Given) => true,
            },
            Coupling::Scalars(s, t) => match (self.scalars[s], self.scalars[t]) {
                (Scalar(s), Scalar(t)) => touch(s, t),
                (Given, Given) => true,
                (of_s, _) if self.has_given => {
                    let pair = if of_s == Given { (t, s) } else { (s, t) };
                    let pair = (pair.0 as u32, pair.1 as u32);
                    let list = &mut self.of_scalars;
                    self.given_slots[1].entry(pair).or_insert_with(|| {
                        list.push((pair.0, pair.1, 0.0));
                        list.len() as u32 - 1
                    });
                    true
                }
                _ => true,
            },
        }
    }

    /// Back to zero.
    pub fn clear(&mut self) {
        self.is_whole = true;
        self.matrix.as_flattened_mut().fill(0.0);
        self.volumes.clear();
        let of_vectors = self.of_vectors.iter_mut();
        of_vectors.for_each(|(.., sum)| sum.fill(0.0));
        self.of_scalars.iter_mut().for_each(|(.., sum)| *sum = 0.0);
    }

    /// Derivatives by a vector and a given scalar: both, and the sum.
    pub fn of_vectors(&self) -> impl Iterator<Item = (usize, usize, Vector)> + '_ {
        let list = self.of_vectors.iter();
        list.map(|&(a, s, sum)| (a as usize, s as usize, sum))
    }

    /// Derivatives by a scalar and a given one.
    pub fn of_scalars(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let list = self.of_scalars.iter();
        list.map(|&(s, t, sum)| (s as usize, t as usize, sum))
    }

    /// Adds the volume of a hexahedron of these vectors, with the sum of the weights of its blocks; returns the change of its pressure that makes
    /// it the one asked for.
    pub(super) fn add_volume(
        &mut self,
        vectors: [usize; 8],
        of: &Dilatation,
        weights: [f64; 2],
    ) -> f64 {
        let [factor, weight] = weights;
        // Beyond a dilatation of e the energy is no longer convex.
        let stiffness = of.stiffness.max(0.0);
        let mut volume = ElementVolume {
            factor: factor * weight * stiffness,
            ..ElementVolume::default()
        };
        let mut corners = [None; 8];
        for (i, vector) in vectors.into_iter().enumerate() {
            let VectorPlace::Node(node, free) = self.vectors[vector] else {
                continue;
            };
            let sides = CORNERS[i].iter().enumerate();
            let corner = sides.fold(0, |corner, (axis, side)| {
                corner | usize::from(*side > 0.0) << axis
            });
            for axis in (0..3).filter(|&axis| free[axis]) {
                volume.slopes[corner][axis] = of.slopes[i][axis];
            }
            corners[corner] = Some(node);
        }
        let most = BELIEVED * of.shear_modulus;
        let asked = match self.pressures {
            Some(Pressures::Predicted) => self.predicted.get(self.volumes.len()).copied(),
            Some(Pressures::Bounded) => Some(of.pressure.clamp(-most, most)),
            _ => None,
        };
        self.volumes.push(NodeVolume {
            corners,
            volume,
            pressure: of.pressure,
            // Rows and columns have the same weight.
            change: weight.sqrt() * stiffness,
        });
        asked.map_or(0.0, |asked| asked - of.pressure)
    }

    /// The block of two vectors; `None` where one of them does not move.
    #[inline(always)]
    pub(super) fn pair(&self, a: usize, b: usize) -> Option<Pair> {
        let VectorPlace::Node(row, rows) = self.vectors[a] else {
            return None;
        };
        let VectorPlace::Node(column, columns) = self.vectors[b] else {
            return None;
        };
        let block = self.places.block(row, column)?;
        Some(Pair {
            block,
            rows,
            columns,
        })
    }

    /// Adds a block of two vectors.
    #[inline(always)]
    pub(super) fn add_full(&mut self, pair: Pair, sum: &Matrix) {
        let block = &mut self.matrix[pair.block];
        for column in 0..3 {
            for row in 0..3 {
                if pair.rows[row] && pair.columns[column] {
                    block[COMPONENTS * column + row] += sum[(row, column)];
                }
            }
        }
    }

    /// Adds a multiple of the identity.
    #[inline(always)]
    pub(super) fn add_isotropic(&mut self, pair: Pair, factor: f64) {
        let block = &mut self.matrix[pair.block];
        for axis in 0..3 {
            if pair.rows[axis] && pair.columns[axis] {
                block[(COMPONENTS + 1) * axis] += factor;
            }
        }
    }

    /// Adds the row of a vector and the column of a scalar, and the row of the scalar and the column of the vector.
    #[inline(always)]
    pub(super) fn add_mixed(&mut self, a: usize, s: usize, [by_scalar, by_vector]: [Vector; 2]) {
        let VectorPlace::Node(node, free) = self.vectors[a] else {
            return;
        };
        let ScalarPlace::Node(other) = self.scalars[s] else {
            if let Some(&slot) = self.given_slots[0].get(&(a as u32, s as u32)) {
                self.of_vectors[slot as usize].2 += by_scalar;
            }
            return;
        };
        if let Some(block) = self.places.block(node, other) {
            let block = &mut self.matrix[block];
            for axis in (0..3).filter(|&axis| free[axis]) {
                block[COMPONENTS * SCALAR + axis] += by_scalar[axis];
            }
        }
        if let Some(block) = self.places.block(other, node) {
            let block = &mut self.matrix[block];
            for axis in (0..3).filter(|&axis| free[axis]) {
                block[COMPONENTS * axis + SCALAR] += by_vector[axis];
            }
        }
    }

    /// Adds the derivative by two scalars, in both orders where they are two.
    #[inline(always)]
    pub(super) fn add_scalars(&mut self, s: usize, t: usize, value: f64) {
        const OWN: usize = (COMPONENTS + 1) * SCALAR;
        match (self.scalars[s], self.scalars[t]) {
            (ScalarPlace::Node(a), ScalarPlace::Node(b)) => {
                if let Some(block) = self.places.block(a, b) {
                    self.matrix[block][OWN] += value;
                }
                if let Some(block) = self.places.block(b, a).filter(|_| s != t) {
                    self.matrix[block][OWN] += value;
                }
            }
            (of_s, _) => {
                let pair = match of_s {
                    ScalarPlace::Given => (t as u32, s as u32),
                    ScalarPlace::Node(_) => (s as u32, t as u32),
                };
                if let Some(&slot) = self.given_slots[1].get(&pair) {
                    self.of_scalars[slot as usize].2 += value;
                }
            }
        }
    }
}

impl BlockMask {
    /// Instants of rows, and of columns, of the blocks that are asked for.
    pub(super) fn instants(self) -> [[bool; 2]; 2] {
        let [a, b, c, d] = self.blocks;
        [[a || b, c || d], [a || c, b || d]]
    }
}
