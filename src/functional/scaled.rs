//! Elements of any kind times constants that follow from free parameters: `c(π) E`.
//!
//! A constant in which an energy is linear needs no formula of numbers that carry derivatives: `∂/∂π_a` is `∂c/∂π_a E`, of the element with
//! the constant one.

use crate::energy::Coefficient;
use crate::functional::{Kernel, Order, Sample, Scatter, VectorArg};
use crate::math::{Derivatives, HyperDual, Matrix, Number, Vector};

/// Most parameters that one element follows: a viscous one of a Maxwell branch follows its modulus and its relaxation time.
const MOST: usize = 2;

/// One element.
#[derive(Clone, Debug)]
pub struct ScaledElement<E> {
    /// The element E.
    pub of: E,
    /// The constant c.
    pub factor: Coefficient,
    /// Parameters that they follow, scalars of the interval, two at most.
    pub parameters: Vec<usize>,
}

/// The constant c of an element with its derivatives by its parameters.
#[derive(Clone, Copy)]
struct Factor {
    value: f64,
    slopes: [f64; MOST],
    curvatures: [[f64; MOST]; MOST],
}

impl<E> ScaledElement<E> {
    fn parameters(&self, sample: &Sample<'_>) -> [f64; MOST] {
        let mut values = [0.0; MOST];
        for (value, &scalar) in values.iter_mut().zip(&self.parameters) {
            *value = sample.scalars[scalar];
        }
        values
    }

    fn value(&self, sample: &Sample<'_>) -> f64 {
        self.factor.at(&self.parameters(sample))
    }

    fn factor(&self, sample: &Sample<'_>) -> Factor {
        let values = self.parameters(sample);
        let mut factor = Factor {
            value: self.factor.at(&values),
            slopes: [0.0; MOST],
            curvatures: [[0.0; MOST]; MOST],
        };
        for i in 0..self.parameters.len() {
            for j in 0..=i {
                let mut numbers = values.map(HyperDual::of);
                numbers[i].value.part = 1.0;
                numbers[j].part.value = 1.0;
                let by = self.factor.at(&numbers);
                factor.slopes[i] = by.value.part;
                factor.curvatures[i][j] = by.part.part;
                factor.curvatures[j][i] = by.part.part;
            }
        }
        factor
    }
}

/// Derivatives of c E from those of E, or of its contraction from those of the contraction of E.
struct Times<'a, D> {
    factor: Factor,
    /// Number of scalars of E.
    base: usize,
    of: &'a D,
    /// The contraction of E; zero of E itself, whose value nobody asks for.
    value: f64,
}

impl<D: Derivatives> Derivatives for Times<'_, D> {
    const HAS_SECOND: bool = D::HAS_SECOND;

    fn force(&self, i: usize) -> Vector {
        self.of.force(i) * self.factor.value
    }

    fn row(&self, s: usize) -> f64 {
        match s.checked_sub(self.base) {
            None => self.of.row(s) * self.factor.value,
            Some(place) => self.factor.slopes[place] * self.value,
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix {
        self.of.block(i, j) * self.factor.value
    }

    fn column(&self, i: usize, s: usize) -> Vector {
        match s.checked_sub(self.base) {
            None => self.of.column(i, s) * self.factor.value,
            Some(place) => self.of.force(i) * self.factor.slopes[place],
        }
    }

    fn entry(&self, s: usize, t: usize) -> f64 {
        let Factor {
            value,
            slopes,
            curvatures,
        } = &self.factor;
        match (s.checked_sub(self.base), t.checked_sub(self.base)) {
            (None, None) => self.of.entry(s, t) * value,
            (Some(place), None) => self.of.row(t) * slopes[place],
            (None, Some(place)) => self.of.row(s) * slopes[place],
            (Some(one), Some(other)) => curvatures[one][other] * self.value,
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
    fn times<'d, D>(&self, of: &'d D, value: f64) -> Times<'d, D> {
        Times {
            factor: self.factor,
            base: self.element.of.scalars(),
            of,
            value,
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
        self.of.scalars() + self.parameters.len()
    }

    fn vector(&self, i: usize) -> VectorArg {
        self.of.vector(i)
    }

    fn scalar(&self, s: usize) -> Option<(usize, f64)> {
        match s.checked_sub(self.of.scalars()) {
            None => self.of.scalar(s),
            Some(place) => Some((self.parameters[place], 1.0)),
        }
    }

    fn energy(&self, sample: &Sample<'_>) -> f64 {
        self.value(sample) * self.of.energy(sample)
    }

    fn first_part(&self, sample: &Sample<'_>) -> f64 {
        self.value(sample) * self.of.first_part(sample)
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
            factor: self.factor(sample),
            sample,
            to,
        };
        self.of
            .derivatives(order, sample, storage, &mut with_factor);
    }
}
