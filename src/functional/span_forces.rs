//! Forces along spans as quantities: what an energy pulls the ends of a span together with.

use crate::energy::Energy;
use crate::functional::{Element, Formulas, Kernel, Order, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, Local, Matrix, Vector};
use nalgebra::SVector;
use std::fmt;
use std::marker::PhantomData;

/// Force `∂E/∂r·r/|r|` of the energy of elements of one formula along their first vector r, the span of a part: positive where it pulls. Not
/// finite for r = 0.
///
/// A quantity of the intervals, so that no derivatives above the second are asked for.
pub struct SpanForces<E, const M: usize, const NV: usize, const NS: usize>(PhantomData<E>);

impl<E, const M: usize, const NV: usize, const NS: usize> fmt::Debug for SpanForces<E, M, NV, NS> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "forces along spans, of {M} arguments")
    }
}

/// The force as the product of `m = ∂E/∂r·r` and `s = 1/|r|`, from the derivatives of E and their rates along r.
struct SpanForce<D, W> {
    plain: D,
    /// Rates of the derivatives along a direction that is r for the first vector and zero otherwise.
    along: W,
    m: f64,
    s: f64,
    /// ∂s/∂r and ∂²s/∂r².
    slope: Vector,
    curvature: Matrix,
}

impl<D: Derivatives, W: Derivatives> SpanForce<D, W> {
    fn new(r: Vector, plain: D, along: W) -> Self {
        let s = 1.0 / r.norm();
        let cube = s * s * s;
        let outer = r * (r * (3.0 * cube * s * s)).transpose();
        Self {
            m: plain.force(0).dot(&r),
            s,
            slope: r * -cube,
            curvature: outer - Matrix::from_diagonal_element(cube),
            plain,
            along,
        }
    }

    /// ∂m/∂x_i.
    fn slope_of_product(&self, i: usize) -> Vector {
        match i {
            0 => self.along.force(0) + self.plain.force(0),
            _ => self.along.force(i),
        }
    }
}

impl<D: Derivatives, W: Derivatives> Derivatives for SpanForce<D, W> {
    fn force(&self, i: usize) -> Vector {
        let force = self.slope_of_product(i) * self.s;
        match i {
            0 => force + self.slope * self.m,
            _ => force,
        }
    }

    fn row(&self, s: usize) -> f64 {
        self.along.row(s) * self.s
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        let mut block = self.along.block(i, j);
        for end in [i, j] {
            if end == 0 {
                block += self.plain.block(i, j);
            }
        }
        block *= self.s;
        if i == 0 {
            block += self.slope * self.slope_of_product(j).transpose();
        }
        if j == 0 {
            block += self.slope_of_product(i) * self.slope.transpose();
        }
        match (i, j) {
            (0, 0) => block + self.curvature * self.m,
            _ => block,
        }
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        let column = self.along.column(i, s) * self.s;
        match i {
            0 => column + self.plain.column(0, s) * self.s + self.slope * self.along.row(s),
            _ => column,
        }
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        self.along.entry(s, t) * self.s
    }
}

/// The span, the first of the arguments.
fn span<const M: usize>(p: &SVector<f64, M>) -> Vector {
    Vector::new(p[0], p[1], p[2])
}

impl<E, const M: usize, const NV: usize, const NS: usize> Kernel for SpanForces<E, M, NV, NS>
where
    E: Energy<M> + 'static,
{
    type Element = Element<E, NV, NS>;
    type Storage = ();

    const OF_SQUARES: bool = E::OF_SQUARES;

    fn vectors(_: &Self::Element) -> usize {
        const { assert!(E::VIRTUAL == 0 && E::READINGS == 1) };
        NV
    }

    fn scalars(_: &Self::Element) -> usize {
        NS
    }

    fn vector(element: &Self::Element, i: usize) -> VectorArg {
        element.vectors[i]
    }

    fn scalar(element: &Self::Element, s: usize) -> Option<(usize, f64)> {
        Some((element.scalars[s], 1.0))
    }

    fn energy(element: &Self::Element, sample: &Sample<'_>) -> f64 {
        let (p, _) = Formulas::<E, M, NV, NS>::arguments(element, Order::Gradient, sample);
        let local = element.energy.at::<1>(&p, &SVector::zeros());
        local.plain::<NV>().force(0).dot(&span(&p).normalize())
    }

    fn derivatives<S: Scatter>(
        element: &Self::Element,
        _: Order,
        sample: &Sample<'_>,
        (): &(),
        to: &mut S,
    ) {
        let (p, _) = Formulas::<E, M, NV, NS>::arguments(element, Order::Gradient, sample);
        let r = span(&p);
        let mut w = SVector::<f64, M>::zeros();
        w.fixed_rows_mut::<3>(0).copy_from(&r);
        let local = element.energy.at::<3>(&p, &w);
        to.plain(&SpanForce::new(r, local.plain::<NV>(), local.along::<NV>()));
    }
}
