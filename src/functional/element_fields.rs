//! The true electric field at a point of a finite element: a quantity of the intervals.

use crate::element::{FieldPoint, SpatialField};
use crate::functional::{Kernel, Order, Sample, ScalarArg, Scatter, Stencil, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};

/// |e|²/E² at a point of an element, with the nodes at one time of an interval and the potentials of the interval.
#[derive(Clone, Debug)]
pub struct ElementField<const NODES: usize = 8> {
    /// The point.
    pub point: FieldPoint<NODES>,
    /// Vectors of the nodes.
    pub nodes: [usize; NODES],
    /// Sources of the potentials of the nodes.
    pub terminals: [ScalarArg; NODES],
    /// Time at which the nodes are read.
    pub at: Stencil,
}

/// The kind of elements that are fields at points of elements of `NODES` nodes.
#[derive(Debug)]
pub enum ElementFields<const NODES: usize = 8> {}

impl<const NODES: usize> ElementField<NODES> {
    fn field(&self, sample: &Sample<'_>) -> SpatialField<NODES> {
        let read = |vector| {
            let arg = VectorArg {
                vector,
                stencil: self.at,
            };
            arg.read(sample.h, sample.vectors)
        };
        let potentials = self.terminals.map(|arg| arg.read(sample.scalars));
        self.point.at(&self.nodes.map(read), &potentials)
    }
}

/// The arguments are the nodes, and the scalars their potentials.
impl<const NODES: usize> Derivatives for SpatialField<NODES> {
    fn force(&self, i: usize) -> Vector {
        self.by_place(i)
    }

    fn row(&self, s: usize) -> f64 {
        self.by_potential(s)
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        self.by_places(i, j)
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        self.by_place_and_potential(i, s)
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.by_potentials(s, t)
    }
}

impl<const NODES: usize> Kernel for ElementFields<NODES> {
    type Element = ElementField<NODES>;
    type Storage = ();

    fn vectors(element: &ElementField<NODES>) -> usize {
        element.nodes.len()
    }

    fn scalars(element: &ElementField<NODES>) -> usize {
        element.terminals.len()
    }

    fn vector(element: &ElementField<NODES>, i: usize) -> VectorArg {
        VectorArg {
            vector: element.nodes[i],
            stencil: element.at,
        }
    }

    fn scalar(element: &ElementField<NODES>, s: usize) -> Option<(usize, f64)> {
        element.terminals[s].scalar
    }

    fn energy(element: &ElementField<NODES>, sample: &Sample<'_>) -> f64 {
        element.field(sample).value()
    }

    /// First and second derivatives: a quantity is asked for no others.
    fn derivatives<S: Scatter>(
        element: &ElementField<NODES>,
        _: Order,
        sample: &Sample<'_>,
        (): &(),
        to: &mut S,
    ) {
        to.plain(&element.field(sample));
    }
}
