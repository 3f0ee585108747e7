//! Forces along spans as quantities: what an energy pulls the ends of a span together with.

use crate::energy::{Energy, Law};
use crate::math::{Derivatives, Local, Number};
use nalgebra::{Matrix3, SVector, Vector3};

/// Force `∂E/∂r·r/|r|` of an energy E along its first vector r, the span of a part: positive where it pulls. Not finite for r = 0.
///
/// A quantity of the intervals, so that no derivatives above the second are asked for.
#[derive(Clone, Copy, Debug)]
pub struct SpanTension<E>(pub E);

/// The energy at a point, with its rates along a direction that is r for the first vector and zero otherwise.
#[derive(Clone, Copy, Debug)]
pub struct AlongSpanOnly<L, T> {
    of: L,
    r: Vector3<T>,
}

/// The force as the product of `m = ∂E/∂r·r` and `s = 1/|r|`, from the derivatives of E and their rates along r.
struct Tension<D, W, T> {
    plain: D,
    along: W,
    m: T,
    s: T,
    /// ∂s/∂r and ∂²s/∂r².
    slope: Vector3<T>,
    curvature: Matrix3<T>,
}

impl<E: Energy<M, T>, T: Number, const M: usize> Energy<M, T> for SpanTension<E> {
    type Local<const ORDER: usize> = AlongSpanOnly<E::Local<3>, T>;

    const OF_SQUARES: bool = E::OF_SQUARES;

    fn at<const ORDER: usize>(&self, p: &SVector<T, M>, _: &SVector<T, M>) -> Self::Local<ORDER> {
        const { assert!(E::VIRTUAL == 0 && E::READINGS == 1) };
        let r: Vector3<T> = p.fixed_rows::<3>(0).into();
        let mut w = SVector::<T, M>::zeros();
        w.fixed_rows_mut::<3>(0).copy_from(&r);
        let of = self.0.at::<3>(p, &w);
        AlongSpanOnly { of, r }
    }
}

impl<L: Law<M>, const M: usize> Law<M> for SpanTension<L> {
    type Formula<T: Number> = SpanTension<L::Formula<T>>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Self::Formula<T> {
        SpanTension(self.0.formula(parameters))
    }
}

impl<L: Local<T>, T: Number> Local<T> for AlongSpanOnly<L, T> {
    fn value(&self) -> T {
        self.of.plain::<1>().force(0).dot(&self.r) * self.r.dot(&self.r).sqrt().recip()
    }

    fn plain<const NV: usize>(&self) -> impl Derivatives<T> {
        let (plain, r) = (self.of.plain::<NV>(), self.r);
        let s = r.dot(&r).sqrt().recip();
        let cube = s * s * s;
        let outer = r * (r * (cube.scaled(3.0) * s * s)).transpose();
        Tension {
            m: plain.force(0).dot(&r),
            s,
            slope: r * -cube,
            curvature: outer - Matrix3::from_diagonal_element(cube),
            plain,
            along: self.of.along::<NV>(),
        }
    }

    fn along<const NV: usize>(&self) -> impl Derivatives<T> {
        self.plain::<NV>()
    }
}

impl<D: Derivatives<T>, W: Derivatives<T>, T: Number> Tension<D, W, T> {
    /// ∂m/∂x_i.
    fn slope_of_product(&self, i: usize) -> Vector3<T> {
        match i {
            0 => self.along.force(0) + self.plain.force(0),
            _ => self.along.force(i),
        }
    }
}

impl<D: Derivatives<T>, W: Derivatives<T>, T: Number> Derivatives<T> for Tension<D, W, T> {
    fn force(&self, i: usize) -> Vector3<T> {
        let force = self.slope_of_product(i) * self.s;
        match i {
            0 => force + self.slope * self.m,
            _ => force,
        }
    }

    fn row(&self, s: usize) -> T {
        self.along.row(s) * self.s
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<T> {
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

    fn column(&self, i: usize, s: usize) -> Vector3<T> {
        let column = self.along.column(i, s) * self.s;
        match i {
            0 => column + self.plain.column(0, s) * self.s + self.slope * self.along.row(s),
            _ => column,
        }
    }

    fn entry(&self, s: usize, t: usize) -> T {
        self.along.entry(s, t) * self.s
    }
}
