//! Elements of any kind times a constant that follows from sought parameters: `c(π) E` with `c = c₀ + Σ s_a π_a`.
//!
//! A constant in which an energy is linear needs no number that carries derivatives: `∂/∂π_a` is `s_a E`, of the element with the constant one.

use crate::energy::Polynomial;
use crate::functional::{Kernel, Order, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, Matrix, Vector};
use std::fmt;
use std::marker::PhantomData;

/// One element.
#[derive(Clone, Debug)]
pub struct ScaledElement<E> {
    /// The element E.
    pub of: E,
    /// The constant c.
    pub factor: Polynomial,
    /// Parameters that it follows, scalars of the interval.
    pub parameters: Vec<usize>,
}

impl<E> ScaledElement<E> {
    fn factor(&self, sample: &Sample<'_>) -> f64 {
        let slopes = self.factor.slopes.iter();
        let parts = slopes.map(|&(place, s)| s * sample.scalars[self.parameters[place]]);
        self.factor.value + parts.sum::<f64>()
    }

    /// ∂c/∂π of the parameter at a place.
    fn slope(&self, place: usize) -> f64 {
        let slopes = self.factor.slopes.iter();
        slopes
            .filter(|(own, _)| *own == place)
            .map(|(_, s)| s)
            .sum()
    }
}

/// Elements of the kind `K` times constants.
pub struct Scaled<K>(PhantomData<K>);

impl<K> fmt::Debug for Scaled<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "elements times sought constants")
    }
}

/// Derivatives of c E from those of E, or of its contraction from those of the contraction of E.
struct Times<'a, E, D> {
    element: &'a ScaledElement<E>,
    factor: f64,
    /// Number of scalars of E.
    base: usize,
    of: &'a D,
    /// The contraction of E; zero of E itself, whose value nobody asks for.
    value: f64,
}

impl<'a, E, D> Times<'a, E, D> {
    fn new<K: Kernel<Element = E>>(
        element: &'a ScaledElement<E>,
        sample: &Sample<'_>,
        of: &'a D,
        value: f64,
    ) -> Self {
        Self {
            element,
            factor: element.factor(sample),
            base: K::scalars(&element.of),
            of,
            value,
        }
    }
}

impl<E, D: Derivatives> Derivatives for Times<'_, E, D> {
    fn force(&self, i: usize) -> Vector {
        self.of.force(i) * self.factor
    }

    fn row(&self, s: usize) -> f64 {
        match s.checked_sub(self.base) {
            None => self.of.row(s) * self.factor,
            Some(place) => self.element.slope(place) * self.value,
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        self.of.block(i, j) * self.factor
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        match s.checked_sub(self.base) {
            None => self.of.column(i, s) * self.factor,
            Some(place) => self.of.force(i) * self.element.slope(place),
        }
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        match (s.checked_sub(self.base), t.checked_sub(self.base)) {
            (None, None) => self.of.entry(s, t) * self.factor,
            (Some(place), None) => self.of.row(t) * self.element.slope(place),
            (None, Some(place)) => self.of.row(s) * self.element.slope(place),
            (Some(_), Some(_)) => 0.0,
        }
    }
}

/// Hands the derivatives of an element of the kind `K` on with its constant.
struct WithFactor<'a, K: Kernel, S> {
    element: &'a ScaledElement<K::Element>,
    sample: &'a Sample<'a>,
    to: &'a mut S,
}

impl<K: Kernel, S> WithFactor<'_, K, S> {
    /// The contraction ∇E·w; of a virtual work its value at the direction.
    fn contraction<D: Derivatives>(&self, d: &D) -> f64 {
        let (element, sample) = (&self.element.of, self.sample);
        let mut sum = 0.0;
        let arguments = match K::VIRTUAL {
            0 => K::vectors(element) * K::READINGS,
            _ => K::virtuals(element),
        };
        for i in 0..arguments {
            let direction = K::vector(element, i).read(sample.h, sample.along);
            sum += d.force(i).dot(&direction);
        }
        for s in (0..K::scalars(element)).filter(|_| K::VIRTUAL == 0) {
            if let Some((scalar, factor)) = K::scalar(element, s) {
                sum += d.row(s) * factor * sample.scalars_along[scalar];
            }
        }
        sum
    }
}

impl<K: Kernel, S: Scatter> Scatter for WithFactor<'_, K, S> {
    const OF_PARAMETERS: bool = S::OF_PARAMETERS;

    fn plain<D: Derivatives>(&mut self, plain: &D) {
        self.to
            .plain(&Times::new::<K>(self.element, self.sample, plain, 0.0));
    }

    fn along<D: Derivatives, W: Derivatives>(&mut self, plain: &D, along: &W) {
        let value = self.contraction(plain);
        let (element, sample) = (self.element, self.sample);
        let plain = Times::new::<K>(element, sample, plain, 0.0);
        let along = Times::new::<K>(element, sample, along, value);
        self.to.along(&plain, &along);
    }
}

impl<K: Kernel> Kernel for Scaled<K> {
    type Element = ScaledElement<K::Element>;
    type Storage = K::Storage;

    const VIRTUAL: usize = K::VIRTUAL;
    const APPLIED: bool = K::APPLIED;
    const READINGS: usize = K::READINGS;
    const ISOTROPIC: bool = K::ISOTROPIC;
    const BY_DURATION: bool = K::BY_DURATION;
    const PARTS: Option<[&'static str; 2]> = K::PARTS;

    fn virtuals(element: &Self::Element) -> usize {
        K::virtuals(&element.of)
    }

    fn couples(i: usize, j: usize) -> bool {
        K::couples(i, j)
    }

    fn vectors(element: &Self::Element) -> usize {
        K::vectors(&element.of)
    }

    fn scalars(element: &Self::Element) -> usize {
        K::scalars(&element.of) + element.parameters.len()
    }

    fn vector(element: &Self::Element, i: usize) -> VectorArg {
        K::vector(&element.of, i)
    }

    fn scalar(element: &Self::Element, s: usize) -> Option<(usize, f64)> {
        match s.checked_sub(K::scalars(&element.of)) {
            None => K::scalar(&element.of, s),
            Some(place) => Some((element.parameters[place], 1.0)),
        }
    }

    fn energy(element: &Self::Element, sample: &Sample<'_>) -> f64 {
        element.factor(sample) * K::energy(&element.of, sample)
    }

    fn first_part(element: &Self::Element, sample: &Sample<'_>) -> f64 {
        element.factor(sample) * K::first_part(&element.of, sample)
    }

    fn prepare(
        element: &Self::Element,
        order: Order,
        sample: &Sample<'_>,
        storage: &mut Self::Storage,
    ) {
        K::prepare(&element.of, order, sample, storage);
    }

    fn derivatives<S: Scatter>(
        element: &Self::Element,
        order: Order,
        sample: &Sample<'_>,
        storage: &Self::Storage,
        to: &mut S,
    ) {
        let mut with_factor = WithFactor::<K, S> {
            element,
            sample,
            to,
        };
        K::derivatives(&element.of, order, sample, storage, &mut with_factor);
    }
}
