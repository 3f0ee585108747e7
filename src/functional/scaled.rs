//! Elements of any kind times constants that follow from free parameters: `c(π) E`.
//!
//! A constant in which an energy is linear needs no formula of numbers that carry derivatives: `∂/∂π_a` is `∂c/∂π_a E`, of the element with
//! the constant one.

use crate::energy::Coefficient;
use crate::functional::{Kernel, Order, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};

/// Most parameters that one element follows: a viscous one of a Maxwell branch follows its modulus and its relaxation time.
const MOST: usize = 2;

/// A constant c that follows free parameters.
#[derive(Clone, Debug)]
pub struct FreeConstant {
    /// The constant.
    pub of: Coefficient,
    /// Parameters that it follows, scalars of the interval, two at most.
    pub parameters: Vec<usize>,
}

/// One element.
#[derive(Clone, Debug)]
pub struct ScaledElement<E> {
    /// The element E.
    pub of: E,
    /// The constant c.
    pub factor: FreeConstant,
}

/// A constant with its derivatives by its parameters.
#[derive(Clone, Copy)]
pub(super) struct Factor {
    value: f64,
    slopes: [f64; MOST],
    curvatures: [[f64; MOST]; MOST],
}

impl FreeConstant {
    fn parameters(&self, sample: &Sample<'_>) -> [f64; MOST] {
        let mut values = [0.0; MOST];
        for (value, &scalar) in values.iter_mut().zip(&self.parameters) {
            *value = sample.scalars[scalar];
        }
        values
    }

    /// Its value.
    pub(super) fn value(&self, sample: &Sample<'_>) -> f64 {
        self.of.at(&self.parameters(sample))
    }

    /// Its value with derivatives.
    pub(super) fn factor(&self, sample: &Sample<'_>) -> Factor {
        let values = self.parameters(sample);
        let mut factor = Factor {
            value: self.of.at(&values),
            slopes: [0.0; MOST],
            curvatures: [[0.0; MOST]; MOST],
        };
        for i in 0..self.parameters.len() {
            for j in 0..=i {
                let mut numbers = values.map(HyperDual::of);
                numbers[i].value.part = 1.0;
                numbers[j].part.value = 1.0;
                let by = self.of.at(&numbers);
                factor.slopes[i] = by.value.part;
                factor.curvatures[i][j] = by.part.part;
                factor.curvatures[j][i] = by.part.part;
            }
        }
        factor
    }
}

/// Derivatives of a scalar S(x, c(π)) from those of S and of S_c by x.
pub(super) struct OfConstant<'a, D> {
    /// Factor of S, which is c where S is linear in it, and `of` the scalar of the constant one.
    pub(super) scale: f64,
    pub(super) factor: Factor,
    /// Number of scalars of S.
    pub(super) base: usize,
    pub(super) of: [&'a D; 2],
    /// S_c and S_cc; zero where nobody asks for derivatives by parameters alone.
    pub(super) values: [f64; 2],
}

impl<D: Derivatives> Derivatives for OfConstant<'_, D> {
    const HAS_SECOND: bool = D::HAS_SECOND;

    #[inline]
    fn force(&self, i: usize) -> Vector {
        self.of[0].force(i) * self.scale
    }

    #[inline]
    fn row(&self, s: usize) -> f64 {
        match s.checked_sub(self.base) {
            None => self.of[0].row(s) * self.scale,
            Some(place) => self.factor.slopes[place] * self.values[0],
        }
    }

    #[inline]
    fn block(&self, i: usize, j: usize) -> Matrix {
        self.of[0].block(i, j) * self.scale
    }

    #[inline]
    fn column(&self, i: usize, s: usize) -> Vector {
        match s.checked_sub(self.base) {
            None => self.of[0].column(i, s) * self.scale,
            Some(place) => self.of[1].force(i) * self.factor.slopes[place],
        }
    }

    #[inline]
    fn entry(&self, s: usize, t: usize) -> f64 {
        let (slopes, of) = (&self.factor.slopes, &self.of);
        match (s.checked_sub(self.base), t.checked_sub(self.base)) {
            (None, None) => of[0].entry(s, t) * self.scale,
            (Some(place), None) => of[1].row(t) * slopes[place],
            (None, Some(place)) => of[1].row(s) * slopes[place],
            (Some(a), Some(b)) => {
                slopes[a] * slopes[b] * self.values[1]
                    + self.factor.curvatures[a][b] * self.values[0]
            }
        }
    }
}

/// Hands the derivatives of an element on with its constant.
struct WithFactor<'a, K: Kernel, S> {
    element: &'a ScaledElement<K>,
    factor: Factor,
    sample: &'a Sample<'a>,
    to: &'a mut S,
}

impl<K: Kernel, S> WithFactor<'_, K, S> {
    /// Derivatives of c E from those of E, or of a contraction with its value.
    fn times<'d, D>(&self, of: &'d D, value: f64) -> OfConstant<'d, D> {
        OfConstant {
            scale: self.factor.value,
            factor: self.factor,
            base: self.element.of.scalars(),
            of: [of; 2],
            values: [value, 0.0],
        }
    }

    /// The contraction ∇E·w; of a virtual work its value at the direction.
    fn contraction<D: Derivatives>(&self, d: &D) -> f64 {
        let (element, sample) = (&self.element.of, self.sample);
        let mut sum = 0.0;
        let arguments = match K::VIRTUAL {
            0 => element.vectors() * K::READINGS,
            _ => element.virtuals(),
        };
        for i in 0..arguments {
            let direction = element.vector(i).read(sample.h, sample.along);
            sum += d.force(i).dot(&direction);
        }
        for s in (0..element.scalars()).filter(|_| K::VIRTUAL == 0) {
            if let Some((scalar, factor)) = element.scalar(s) {
                sum += d.row(s) * factor * sample.scalars_along[scalar];
            }
        }
        sum
    }
}

impl<K: Kernel, S: Scatter> Scatter for WithFactor<'_, K, S> {
    const OF_PARAMETERS: bool = S::OF_PARAMETERS;
    const ORDER: Option<Order> = S::ORDER;

    fn plain<D: Derivatives>(&mut self, plain: &D) {
        let plain = self.times(plain, 0.0);
        self.to.plain(&plain);
    }

    fn along<D: Derivatives, W: Derivatives>(&mut self, plain: &D, along: &W) {
        let value = self.contraction(plain);
        let (plain, along) = (self.times(plain, 0.0), self.times(along, value));
        self.to.along(&plain, &along);
    }
}

impl<K: Kernel> Kernel for ScaledElement<K> {
    type Storage = K::Storage;

    const VIRTUAL: usize = K::VIRTUAL;
    const APPLIED: bool = K::APPLIED;
    const KINETIC: bool = K::KINETIC;
    const READINGS: usize = K::READINGS;
    const ISOTROPIC: bool = K::ISOTROPIC;
    const BY_DURATION: bool = K::BY_DURATION;
    const PARTS: Option<[&'static str; 2]> = K::PARTS;

    fn virtuals(&self) -> usize {
        self.of.virtuals()
    }

    fn couples(i: usize, j: usize) -> bool {
        K::couples(i, j)
    }

    fn vectors(&self) -> usize {
        self.of.vectors()
    }

    fn scalars(&self) -> usize {
        self.of.scalars() + self.factor.parameters.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        self.of.vector(i)
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        match s.checked_sub(self.of.scalars()) {
            None => self.of.scalar(s),
            Some(place) => Some((self.factor.parameters[place], 1.0)),
        }
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        self.factor.value(sample) * self.of.energy(sample)
    }

    fn first_part(&self, sample: &Sample<'_>) -> f64 {
        self.factor.value(sample) * self.of.first_part(sample)
    }

    fn prepare(&self, order: Order, sample: &Sample<'_>, storage: &mut Self::Storage) {
        self.of.prepare(order, sample, storage);
    }

    fn derivatives<S: Scatter>(
        &self,
        order: Order,
        sample: &Sample<'_>,
        storage: &Self::Storage,
        to: &mut S,
    ) {
        let mut with_factor = WithFactor::<K, S> {
            element: self,
            factor: self.factor.factor(sample),
            sample,
            to,
        };
        self.of
            .derivatives(order, sample, storage, &mut with_factor);
    }
}
