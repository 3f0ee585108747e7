//! Viscosity of finite elements: the virtual work `−Σ δx̄·f(x̄, v)` of the stress σ = η d, and springs of Maxwell branches, energies W(x̄, q̄) of
//! places of nodes and viscous strains at Gauss points.
//!
//! Viscous forces are linear in the velocities, so the work over an interval does not depend on its length: there is nothing to
//! derive by it.

use crate::element::{
    BranchLocal, ElementEnergy, ElementGeometry, MaxwellSpring, NodeState, Viscosity,
    ViscousContraction, ViscousLocal, ViscousStrains,
};
use crate::functional::finite_elements::{Variations, middle};
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use std::sync::Arc;

/// One viscous finite element; arguments are the virtual displacements of the nodes, their places and their velocities.
#[derive(Clone, Debug)]
pub struct ViscousElement<const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law.
    pub law: Viscosity,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
}

/// Derivatives of the virtual work, and of its contraction.
type ViscousVariations<const NODES: usize> =
    Variations<ViscousLocal<NODES>, ViscousContraction<NODES>>;

/// Node and reading of an argument: 0 virtual displacement, 1 place, 2 velocity.
#[inline(always)]
fn node<const NODES: usize>(i: usize) -> (usize, usize) {
    (i % NODES, i / NODES)
}

impl<const NODES: usize> ViscousElement<NODES> {
    /// Places and velocities of the nodes.
    fn state(&self, sample: &Sample<'_>) -> [[Vector; NODES]; 2] {
        let [x, y] = sample.vectors;
        let rates = self.nodes.map(|v| (y[v] - x[v]) / sample.h);
        [middle(sample.vectors, &self.nodes), rates]
    }
}

/// Of the virtual work: rows are virtual displacements, columns places and velocities.
impl<const NODES: usize> Derivatives for ViscousLocal<NODES> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        -self.forces[i]
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        match node::<NODES>(j) {
            (j, 1) => -self.by_place[i][j],
            (j, _) => -self.by_velocity[i][j],
        }
    }
}

/// Of the virtual work of the direction: rows and columns are places and velocities.
impl<const NODES: usize> Derivatives for ViscousContraction<NODES> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        match node::<NODES>(i) {
            (i, 1) => -self.by_place[i],
            (i, _) => -self.by_velocity[i],
        }
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        match (node::<NODES>(i), node::<NODES>(j)) {
            ((i, 1), (j, 1)) => -self.place_place[i][j],
            ((i, 1), (j, _)) => -self.place_velocity[i][j],
            ((i, _), (j, _)) => -self.place_velocity[j][i].transpose(),
        }
    }
}

impl<const NODES: usize> Kernel for ViscousElement<NODES> {
    type Storage = ViscousVariations<NODES>;

    const VIRTUAL: usize = NODES;
    const READINGS: usize = 3;
    const BY_DURATION: bool = false;

    /// Forces are linear in the velocities.
    #[inline(always)]
    fn couples(i: usize, j: usize) -> bool {
        node::<NODES>(i).1 != node::<NODES>(j).1 || node::<NODES>(i).1 == 1
    }

    #[inline(always)]
    fn vectors(&self) -> usize {
        NODES
    }

    #[inline(always)]
    fn vector(&self, i: usize) -> VectorArg {
        let (node, reading) = node::<NODES>(i);
        let stencil = match reading {
            2 => Stencil::Rate,
            _ => Stencil::Mid,
        };
        stencil.of(self.nodes[node])
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let [x, v] = self.state(sample);
        -sample.h * self.law.power(&self.shape, &x, &v)
    }

    fn prepare(
        &self,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut ViscousVariations<NODES>,
    ) {
        let Self { shape, law, nodes } = self;
        let [x, v] = self.state(sample);
        match order {
            Order::Gradient => law.forces(shape, &x, &v, &mut plain.forces),
            _ => law.tangent(shape, &x, &v, plain),
        }
        if order == Order::Third {
            let w = middle(sample.along, nodes);
            law.contraction(shape, &x, &v, &w, along);
        }
    }

    #[inline(always)]
    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        _: &Sample<'_>,
        variations: &ViscousVariations<NODES>,
        to: &mut S,
    ) {
        variations.hand(order, to);
    }
}

/// Gauss points of an element.
pub const POINTS: usize = 8;

/// One branch of a finite element; arguments are the nodes, then both vectors of each Gauss point.
#[derive(Clone, Debug)]
pub struct MaxwellElement<const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law.
    pub law: MaxwellSpring,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Vectors (z₁, z₂, ·) and (a, b, c) of the viscous strain at each Gauss point.
    pub strains: [[usize; 2]; POINTS],
}

/// Gauss point of an argument, and which of its vectors it is; `None` for a node.
#[inline(always)]
fn point<const NODES: usize>(i: usize) -> Option<(usize, usize)> {
    i.checked_sub(NODES).map(|place| (place / 2, place % 2))
}

/// Coordinates of a vector of a Gauss point, with their components.
#[inline(always)]
fn coordinates(part: usize) -> impl Iterator<Item = (usize, usize)> {
    let coordinates = if part == 0 { 0..2 } else { 2..5 };
    coordinates.enumerate()
}

impl<const NODES: usize> MaxwellElement<NODES> {
    fn strains(&self, vectors: [&[Vector]; 2]) -> ViscousStrains {
        let mut strains = ViscousStrains::default();
        for (g, parts) in self.strains.iter().enumerate() {
            for (part, &v) in parts.iter().enumerate() {
                let value = (vectors[0][v] + vectors[1][v]) * 0.5;
                for (axis, m) in coordinates(part) {
                    strains[m][g] = value[axis];
                }
            }
        }
        strains
    }
}

impl<const NODES: usize> BranchLocal<NODES> {
    /// Derivatives by a node and a vector of a Gauss point.
    #[inline(always)]
    fn mixed(&self, node: usize, g: usize, part: usize) -> Matrix {
        let mut block = Matrix::zeros();
        for (axis, m) in coordinates(part) {
            for a in 0..3 {
                block[(a, axis)] = self.coupling[node][m][a][g];
            }
        }
        block
    }
}

/// The arguments are the nodes, then the vectors of the Gauss points.
impl<const NODES: usize> Derivatives for BranchLocal<NODES> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        let Some((g, part)) = point::<NODES>(i) else {
            return self.forces[i];
        };
        let mut force = Vector::zeros();
        for (axis, m) in coordinates(part) {
            force[axis] = self.rows[m][g];
        }
        force
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        match (point::<NODES>(i), point::<NODES>(j)) {
            (None, None) => self.stiffness[i][j],
            (None, Some((g, part))) => self.mixed(i, g, part),
            (Some((g, part)), None) => self.mixed(j, g, part).transpose(),
            (Some((g, rows)), Some((_, columns))) => {
                let mut block = Matrix::zeros();
                for (a, m) in coordinates(rows) {
                    for (b, n) in coordinates(columns) {
                        block[(a, b)] = self.inner[m][n][g];
                    }
                }
                block
            }
        }
    }
}

impl<const NODES: usize> Kernel for MaxwellElement<NODES> {
    type Storage = Variations<BranchLocal<NODES>>;

    /// Strains of different points do not meet.
    #[inline(always)]
    fn couples(i: usize, j: usize) -> bool {
        match (point::<NODES>(i), point::<NODES>(j)) {
            (Some((g, _)), Some((other, _))) => g == other,
            _ => true,
        }
    }

    #[inline(always)]
    fn vectors(&self) -> usize {
        NODES + 2 * POINTS
    }

    #[inline(always)]
    fn vector(&self, i: usize) -> VectorArg {
        Stencil::Mid.of(match point::<NODES>(i) {
            None => self.nodes[i],
            Some((g, part)) => self.strains[g][part],
        })
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        let x = middle(sample.vectors, &self.nodes);
        let strains = self.strains(sample.vectors);
        self.law.energy(&NodeState::new(&self.shape, &x, &strains))
    }

    fn prepare(&self, order: Order, sample: &Sample<'_>, to: &mut Self::Storage) {
        let x = middle(sample.vectors, &self.nodes);
        let strains = self.strains(sample.vectors);
        let at = NodeState::new(&self.shape, &x, &strains);
        to.fill(order, &self.law, at, || {
            let w = middle(sample.along, &self.nodes);
            (w, self.strains(sample.along))
        });
    }

    #[inline(always)]
    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        _: &Sample<'_>,
        variations: &Variations<BranchLocal<NODES>>,
        to: &mut S,
    ) {
        variations.hand(order, to);
    }
}
