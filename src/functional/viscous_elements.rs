//! Viscosity of finite elements: the virtual work `−Σ δx̄·f(x̄, v)` of the stress σ = η d.
//!
//! The forces are linear in the velocities, so the work over an interval does not depend on its length: there is nothing to
//! derive by it.

use crate::element::{ElementGeometry, Viscosity, ViscousContraction, ViscousLocal};
use crate::functional::hexahedra::middle;
use crate::functional::{Derivatives, Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Matrix, Vector};

/// One viscous hexahedron.
#[derive(Clone, Debug)]
pub struct ViscousHexahedron {
    /// Gradients of the shape functions.
    pub shape: ElementGeometry,
    /// The law.
    pub law: Viscosity,
    /// Vectors of the nodes.
    pub nodes: [usize; 8],
}

/// The kind of elements that are viscous hexahedra; arguments are the virtual displacements of the nodes, their places and their
/// velocities.
#[derive(Debug)]
pub enum ViscousHexahedra {}

/// Nodes of an element.
const NODES: usize = 8;

/// Derivatives of the virtual work, and of its contraction.
#[derive(Debug, Default)]
pub struct ViscousVariations {
    plain: ViscousLocal,
    along: ViscousContraction,
}

/// Node and reading of an argument: 0 virtual displacement, 1 place, 2 velocity.
#[inline(always)]
fn node(i: usize) -> (usize, usize) {
    (i % NODES, i / NODES)
}

impl ViscousHexahedron {
    /// Places and velocities of the nodes.
    fn state(&self, sample: &Sample<'_>) -> [[Vector; NODES]; 2] {
        let [x, y] = sample.vectors;
        let rates = self.nodes.map(|v| (y[v] - x[v]) / sample.h);
        [middle(sample.vectors, &self.nodes), rates]
    }
}

/// Of the virtual work: rows are virtual displacements, columns places and velocities.
impl Derivatives for ViscousLocal {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        -self.forces[i]
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        match node(j) {
            (j, 1) => -self.by_place[i][j],
            (j, _) => -self.by_velocity[i][j],
        }
    }

    fn row(&self, _s: usize) -> f64 {
        0.0
    }

    fn column(&self, _i: usize, _s: usize) -> Vector {
        Vector::zeros()
    }

    fn entry(&self, _s: usize, _t: usize) -> f64 {
        0.0
    }
}

/// Of the virtual work of the direction: rows and columns are places and velocities.
impl Derivatives for ViscousContraction {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        match node(i) {
            (i, 1) => -self.by_place[i],
            (i, _) => -self.by_velocity[i],
        }
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        match (node(i), node(j)) {
            ((i, 1), (j, 1)) => -self.place_place[i][j],
            ((i, 1), (j, _)) => -self.place_velocity[i][j],
            ((i, _), (j, _)) => -self.place_velocity[j][i].transpose(),
        }
    }

    fn row(&self, _s: usize) -> f64 {
        0.0
    }

    fn column(&self, _i: usize, _s: usize) -> Vector {
        Vector::zeros()
    }

    fn entry(&self, _s: usize, _t: usize) -> f64 {
        0.0
    }
}

impl Kernel for ViscousHexahedra {
    type Element = ViscousHexahedron;
    type Storage = ViscousVariations;

    const VIRTUAL: usize = NODES;
    const READINGS: usize = 3;
    const BY_DURATION: bool = false;

    /// Forces are linear in the velocities.
    #[inline(always)]
    fn couples(i: usize, j: usize) -> bool {
        node(i).1 != node(j).1 || node(i).1 == 1
    }

    #[inline(always)]
    fn vectors(_: &ViscousHexahedron) -> usize {
        NODES
    }

    #[inline(always)]
    fn scalars(_: &ViscousHexahedron) -> usize {
        0
    }

    #[inline(always)]
    fn vector(element: &ViscousHexahedron, i: usize) -> VectorArg {
        let (node, reading) = node(i);
        VectorArg {
            vector: element.nodes[node],
            stencil: match reading {
                2 => Stencil::Rate,
                _ => Stencil::Mid,
            },
        }
    }

    fn scalar(_: &ViscousHexahedron, _s: usize) -> Option<(usize, f64)> {
        None
    }

    fn energy(element: &ViscousHexahedron, sample: &Sample<'_>) -> f64 {
        let [x, v] = element.state(sample);
        -sample.h * element.law.power(&element.shape, &x, &v)
    }

    fn prepare(
        element: &ViscousHexahedron,
        order: Order,
        sample: &Sample<'_>,
        ViscousVariations { plain, along }: &mut ViscousVariations,
    ) {
        let ViscousHexahedron { shape, law, nodes } = element;
        let [x, v] = element.state(sample);
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
        _: &ViscousHexahedron,
        order: Order,
        _: &Sample<'_>,
        ViscousVariations { plain, along }: &ViscousVariations,
        to: &mut S,
    ) {
        to.plain(plain);
        if order == Order::Third {
            to.along(plain, along);
        }
    }
}
