//! Curved functions of a quantity: their derivatives by all that the quantity reads.

use crate::functional::{Kernel, Order, Outer, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use std::marker::PhantomData;

/// Derivatives of c(m) from those of m.
pub(super) struct OfQuantity<'a, D> {
    pub(super) outer: Outer,
    pub(super) of: &'a D,
}

impl<D: Derivatives> Derivatives for OfQuantity<'_, D> {
    fn force(&self, i: usize) -> Vector {
        self.of.force(i) * self.outer.slope
    }

    fn row(&self, s: usize) -> f64 {
        self.of.row(s) * self.outer.slope
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let square = self.of.force(i) * self.of.force(j).transpose();
        self.of.block(i, j) * self.outer.slope + square * self.outer.curvature
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let square = self.of.force(i) * self.of.row(s);
        self.of.column(i, s) * self.outer.slope + square * self.outer.curvature
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        let square = self.of.row(s) * self.of.row(t);
        self.of.entry(s, t) * self.outer.slope + square * self.outer.curvature
    }
}

/// Elements of a kernel that a curved function is taken of: all their arguments couple.
#[derive(Debug)]
pub struct Curved<K>(PhantomData<K>);

impl<K: Kernel> Kernel for Curved<K> {
    type Element = K::Element;
    type Storage = K::Storage;

    const READINGS: usize = K::READINGS;

    fn vectors(element: &K::Element) -> usize {
        K::vectors(element)
    }

    fn scalars(element: &K::Element) -> usize {
        K::scalars(element)
    }

    fn vector(element: &K::Element, i: usize) -> VectorArg {
        K::vector(element, i)
    }

    fn scalar(element: &K::Element, s: usize) -> Option<(usize, f64)> {
        K::scalar(element, s)
    }

    fn energy(element: &K::Element, sample: &Sample<'_>) -> f64 {
        K::energy(element, sample)
    }

    fn prepare(element: &K::Element, order: Order, sample: &Sample<'_>, storage: &mut K::Storage) {
        K::prepare(element, order, sample, storage);
    }

    fn derivatives<S: Scatter>(
        element: &K::Element,
        order: Order,
        sample: &Sample<'_>,
        storage: &K::Storage,
        to: &mut S,
    ) {
        K::derivatives(element, order, sample, storage, to);
    }
}
