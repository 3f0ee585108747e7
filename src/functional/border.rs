//! Derivatives by the length of an interval, from those by arguments.
//!
//! With v = Δ/h and Π the projection on the rates, for G = h E(y, Δ/h), and for a quantity E(y, Δ/h) itself,
//!
//! ```text
//! ∂G/∂h = E − ∇E·Πv,     ∂/∂h (∇G) = ∇E − ∇²E Πv − Π∇E  (through the stencil weights),     ∂²G/∂h² = Πv·∇²E Πv / h,
//! ∂E/∂h = −∇E·Πv / h,    ∂/∂h (∇E) = −(∇²E Πv + Π∇E) / h,                                  ∂²E/∂h² = (2 ∇E·Πv + Πv·∇²E Πv) / h².
//! ```

use crate::functional::scatter::FirstDerivatives;
use crate::functional::{Kernel, Sample, Stencil};
use crate::math::{Derivatives, Vector};

/// Rates that an element reads.
pub(super) struct Rates<'a, K: Kernel> {
    element: &'a K,
    vectors: [&'a [Vector]; 2],
    h: f64,
}

impl<'a, K: Kernel> Rates<'a, K> {
    /// Rates Πv of the vectors.
    pub(super) fn new(element: &'a K, sample: &Sample<'a>) -> Self {
        Self {
            element,
            vectors: sample.vectors,
            h: sample.h,
        }
    }

    /// Their own rates along the direction.
    pub(super) fn along(element: &'a K, sample: &Sample<'a>) -> Self {
        Self {
            element,
            vectors: sample.along,
            h: sample.h,
        }
    }

    /// Arguments that are rates, with their values.
    fn list(&self) -> impl Iterator<Item = (usize, Vector)> {
        let count = self.element.vectors() * K::READINGS;
        (self.element.virtuals()..count).filter_map(|j| {
            let arg = self.element.vector(j);
            (arg.stencil == Stencil::Rate).then(|| (j, arg.read(self.h, self.vectors)))
        })
    }

    /// Rows of argument `i` of ∇²E Πv.
    fn block<D: Derivatives>(&self, d: &D, i: usize) -> Vector {
        let mut sum = Vector::zeros();
        for (j, v) in self.list() {
            let block = d.block(i, j);
            for c in 0..3 {
                sum += block.column(c) * v[c];
            }
        }
        sum
    }

    /// Row of scalar `s` of ∇²E Πv.
    fn entry<D: Derivatives>(&self, d: &D, s: usize) -> f64 {
        self.list().map(|(j, v)| d.column(j, s).dot(&v)).sum()
    }

    /// ∇E·Πv.
    pub(super) fn along_gradient<D: Derivatives>(&self, d: &D) -> f64 {
        self.list().map(|(j, v)| d.force(j).dot(&v)).sum()
    }

    /// Πu·∇²E Πv of the rates u of this element and `v`.
    pub(super) fn form<D: Derivatives>(&self, d: &D, v: &Self) -> f64 {
        let mut sum = 0.0;
        for (i, u) in self.list() {
            let product = v.block(d, i);
            for c in 0..3 {
                sum += u[c] * product[c];
            }
        }
        sum
    }
}

/// ∂/∂h (∇G) of an element, or of its contraction with the direction.
pub(super) struct Border<'a, K: Kernel, D, P = D> {
    pub(super) of: &'a D,
    pub(super) v: &'a Rates<'a, K>,
    /// Of a contraction: the rates of v along the direction, and the element itself.
    pub(super) along: Option<(&'a Rates<'a, K>, &'a P)>,
}

impl<K: Kernel, D: Derivatives, P: Derivatives> FirstDerivatives for Border<'_, K, D, P> {
    fn by_vector(&self, i: usize) -> Vector {
        let force = self.of.force(i);
        let mut by_h = force - self.v.block(self.of, i);
        if let Some((w, plain)) = self.along {
            by_h -= w.block(plain, i);
        }
        match self.v.element.vector(i).stencil {
            Stencil::Rate => by_h - force,
            _ => by_h,
        }
    }

    fn by_scalar(&self, s: usize) -> f64 {
        let mut through_rates = self.v.entry(self.of, s);
        if let Some((w, plain)) = self.along {
            through_rates += w.entry(plain, s);
        }
        self.of.row(s) - through_rates
    }
}

/// −h ∂/∂h (∇E) of an element that is a quantity.
pub(super) struct QuantityBorder<'a, K: Kernel, D> {
    pub(super) plain: &'a D,
    pub(super) v: &'a Rates<'a, K>,
}

impl<K: Kernel, D: Derivatives> FirstDerivatives for QuantityBorder<'_, K, D> {
    fn by_vector(&self, i: usize) -> Vector {
        let by_h = self.v.block(self.plain, i);
        match self.v.element.vector(i).stencil {
            Stencil::Rate => by_h + self.plain.force(i),
            _ => by_h,
        }
    }

    fn by_scalar(&self, s: usize) -> f64 {
        self.v.entry(self.plain, s)
    }
}
