//! Viscosity of finite elements: the virtual work `−Σ δx̄·f(x̄, v)` of the stress σ = η d.
//!
//! The forces are linear in the velocities, so the work over an interval does not depend on its length: there is nothing to
//! derive by it.

use crate::element::{ElementGeometry, Viscosity, ViscousContraction, ViscousLocal};
use crate::functional::finite_elements::{Variations, middle};
use crate::functional::{Kernel, Order, Sample, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use std::sync::Arc;

/// One viscous finite element.
#[derive(Clone, Debug)]
pub struct ViscousElement<const NODES: usize = 8> {
    /// Gradients of the shape functions, which all elements of one place share.
    pub shape: Arc<ElementGeometry<NODES>>,
    /// The law.
    pub law: Viscosity,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
}

/// The kind of elements that are viscous finite elements of `NODES` nodes; arguments are the virtual displacements of the nodes, their places and their
/// velocities.
#[derive(Debug)]
pub enum ViscousElements<const NODES: usize = 8> {}

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

impl<const NODES: usize> Kernel for ViscousElements<NODES> {
    type Element = ViscousElement<NODES>;
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
    fn vectors(_: &ViscousElement<NODES>) -> usize {
        NODES
    }

    #[inline(always)]
    fn vector(element: &ViscousElement<NODES>, i: usize) -> VectorArg {
        let (node, reading) = node::<NODES>(i);
        let stencil = match reading {
            2 => Stencil::Rate,
            _ => Stencil::Mid,
        };
        stencil.of(element.nodes[node])
    }

    fn energy(element: &ViscousElement<NODES>, sample: &Sample<'_>) -> f64 {
        let [x, v] = element.state(sample);
        -sample.h * element.law.power(&element.shape, &x, &v)
    }

    fn prepare(
        element: &ViscousElement<NODES>,
        order: Order,
        sample: &Sample<'_>,
        Variations { plain, along }: &mut ViscousVariations<NODES>,
    ) {
        let ViscousElement { shape, law, nodes } = element;
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
        _: &ViscousElement<NODES>,
        order: Order,
        _: &Sample<'_>,
        variations: &ViscousVariations<NODES>,
        to: &mut S,
    ) {
        variations.hand(order, to);
    }
}
