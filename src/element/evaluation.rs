//! Evaluation of the energy of an element: over eight lanes, and over dual numbers of lanes for the rates of its derivatives along a direction.

use super::dual::Dual;
use super::geometry::ElementGeometry;
use super::lanes::{Lanes, Task, dispatch};
use super::local::{Output, Pair};
use super::number::{Points, Three};
use crate::math::Vector;
use pulp::Simd;

/// State of an element: places of its nodes in mm, and arguments beside them, such as their potentials in V.
#[derive(Clone, Copy, Debug)]
pub struct NodeState<'a, A, const NODES: usize> {
    pub(super) shape: &'a ElementGeometry<NODES>,
    /// Places and arguments, each with its rates along a direction where these are asked for.
    pub(super) places: [&'a [Vector; NODES]; 2],
    pub(super) arguments: [&'a A; 2],
}

impl<'a, A, const NODES: usize> NodeState<'a, A, NODES> {
    /// Nodes of the element `shape` at `x`.
    pub fn new(
        shape: &'a ElementGeometry<NODES>,
        x: &'a [Vector; NODES],
        arguments: &'a A,
    ) -> Self {
        Self {
            shape,
            places: [x; 2],
            arguments: [arguments; 2],
        }
    }

    /// The same with a direction.
    #[must_use]
    pub fn along(mut self, w: &'a [Vector; NODES], rates: &'a A) -> Self {
        (self.places[1], self.arguments[1]) = (w, rates);
        self
    }

    /// Places as numbers of a formula.
    #[inline(always)]
    pub(super) fn places<N: Points>(&self) -> [Three<N::Uniform>; NODES] {
        let [x, w] = self.places;
        let mut nodes = [[N::uniform(0.0, 0.0); 3]; NODES];
        for i in 0..NODES {
            for a in 0..3 {
                nodes[i][a] = N::uniform(x[i][a], w[i][a]);
            }
        }
        nodes
    }
}

/// An energy W of an element, whose formula is written once over any number.
pub trait ElementEnergy<const NODES: usize>: Sized {
    /// Arguments beside the places of the nodes.
    type Arguments;
    /// Storage of its derivatives, which a caller keeps and has filled again and again.
    type Local: Output<f64>;

    /// Writes W; its gradient if `ORDER` ≥ 1; its tangent if `ORDER` ≥ 2.
    #[doc(hidden)]
    fn write<N: Points, const ORDER: usize>(
        &self,
        token: N::Token,
        at: &NodeState<'_, Self::Arguments, NODES>,
        out: &mut impl Output<N::Uniform>,
    );

    /// W in mJ.
    fn energy(&self, at: &NodeState<'_, Self::Arguments, NODES>) -> f64 {
        let (law, mut energy) = (self, 0.0);
        let out = &mut energy;
        dispatch(Plain::<_, _, 0, NODES> { law, at, out });
        energy
    }

    /// Fills W and its first derivatives.
    fn gradient(&self, at: &NodeState<'_, Self::Arguments, NODES>, out: &mut Self::Local) {
        let law = self;
        dispatch(Plain::<_, _, 1, NODES> { law, at, out });
    }

    /// Fills W, its first and its second derivatives.
    fn tangent(&self, at: &NodeState<'_, Self::Arguments, NODES>, out: &mut Self::Local) {
        let law = self;
        dispatch(Plain::<_, _, 2, NODES> { law, at, out });
    }

    /// Fills `plain` as [`tangent`](Self::tangent) does, and `along` with the derivatives of all of it along the direction of the state: the
    /// second and third derivatives contracted with it.
    fn third(
        &self,
        at: &NodeState<'_, Self::Arguments, NODES>,
        plain: &mut Self::Local,
        along: &mut Self::Local,
    ) {
        let (law, out) = (self, Pair { plain, along });
        dispatch(Along { law, at, out });
    }
}

/// Derivatives to the order `ORDER` at a state.
struct Plain<'a, E: ElementEnergy<NODES>, O, const ORDER: usize, const NODES: usize> {
    law: &'a E,
    at: &'a NodeState<'a, E::Arguments, NODES>,
    out: &'a mut O,
}

impl<E, O, const ORDER: usize, const NODES: usize> Task for Plain<'_, E, O, ORDER, NODES>
where
    E: ElementEnergy<NODES>,
    O: Output<f64>,
{
    #[inline(always)]
    fn run<S: Simd, const K: usize>(self, unit: S) {
        let Self { law, at, out } = self;
        law.write::<Lanes<S, K>, ORDER>(unit, at, out);
    }
}

/// Second derivatives at a state, and their rates along its direction.
struct Along<'a, E: ElementEnergy<NODES>, const NODES: usize> {
    law: &'a E,
    at: &'a NodeState<'a, E::Arguments, NODES>,
    out: Pair<'a, E::Local>,
}

impl<E: ElementEnergy<NODES>, const NODES: usize> Task for Along<'_, E, NODES> {
    #[inline(always)]
    fn run<S: Simd, const K: usize>(mut self, unit: S) {
        let out = &mut self.out;
        self.law.write::<Dual<Lanes<S, K>>, 2>(unit, self.at, out);
    }
}
