//! Constants of formulas: numbers, or functions of free parameters.

use crate::math::Number;
use std::array;
use std::ops::{Add, Div, Mul, Sub};
use std::sync::Arc;

/// A constant of a formula as a function of free parameters π. Operations on numbers alone give a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// A constant that no parameter changes.
    Number(f64),
    /// `a + b π + c π² + d π³` of a parameter, by its place among those of the element.
    Parameter(usize, [f64; 4]),
    /// A sum.
    Sum(Arc<[Self; 2]>),
    /// A product.
    Product(Arc<[Self; 2]>),
    /// A quotient.
    Quotient(Arc<[Self; 2]>),
    /// A square root.
    Root(Arc<Self>),
}

impl Coefficient {
    /// Returns true if no parameter changes it.
    pub fn is_given(&self) -> bool {
        matches!(self, Self::Number(_))
    }

    /// The same times a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self * &factor.into()
    }

    /// Its square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        match self {
            Self::Number(value) => value.sqrt().into(),
            other => Self::Root(Arc::new(other)),
        }
    }

    /// Its value at parameters.
    #[inline(always)]
    pub fn at<T: Number>(&self, parameters: &[T]) -> T {
        self.of(&|place| parameters[place])
    }

    /// Its value at the parameters of places. Formulas ask for it in each evaluation: most are numbers.
    #[inline(always)]
    pub fn of<T: Number>(&self, parameter: &impl Fn(usize) -> T) -> T {
        match self {
            Self::Number(value) => T::of(*value),
            Self::Parameter(place, powers) => polynomial(parameter(*place), powers),
            combined => combined.combination(parameter),
        }
    }

    /// The value of a sum, product, quotient or root.
    fn combination<T: Number>(&self, parameter: &impl Fn(usize) -> T) -> T {
        match self {
            Self::Sum(of) => of[0].of(parameter) + of[1].of(parameter),
            Self::Product(of) => match of[1] {
                Self::Number(factor) => of[0].of(parameter).scaled(factor),
                _ => of[0].of(parameter) * of[1].of(parameter),
            },
            Self::Quotient(of) => of[0].of(parameter).over(of[1].of(parameter)),
            Self::Root(of) => of.of(parameter).sqrt(),
            Self::Number(_) | Self::Parameter(..) => self.of(parameter),
        }
    }
}

/// `a + b π + c π² + d π³`.
#[inline(always)]
fn polynomial<T: Number>(value: T, [a, b, c, d]: &[f64; 4]) -> T {
    let line = value.scaled(*b).shifted(*a);
    match [*c, *d] == [0.0; 2] {
        true => line,
        false => line + value * value * value.scaled(*d).shifted(*c),
    }
}

impl From<f64> for Coefficient {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl Add for &Coefficient {
    type Output = Coefficient;

    fn add(self, other: Self) -> Coefficient {
        use Coefficient::{Number, Parameter, Sum};
        match (self, other) {
            (Number(a), Number(b)) => Number(a + b),
            (Number(0.0), other) | (other, Number(0.0)) => other.clone(),
            (Parameter(place, [a, line @ ..]), Number(b))
            | (Number(b), Parameter(place, [a, line @ ..])) => {
                let [x, y, z] = *line;
                Parameter(*place, [a + b, x, y, z])
            }
            (Parameter(place, a), Parameter(other, b)) if place == other => {
                Parameter(*place, array::from_fn(|power| a[power] + b[power]))
            }
            _ => Sum(Arc::new([self.clone(), other.clone()])),
        }
    }
}

impl Sub for &Coefficient {
    type Output = Coefficient;

    fn sub(self, other: Self) -> Coefficient {
        self + &other.scaled(-1.0)
    }
}

impl Mul for &Coefficient {
    type Output = Coefficient;

    fn mul(self, other: Self) -> Coefficient {
        use Coefficient::{Number, Parameter, Product};
        match (self, other) {
            (Number(a), Number(b)) => Number(a * b),
            (Number(_), _) => other * self,
            (Parameter(place, a), Number(b)) => Parameter(*place, a.map(|power| power * b)),
            _ => Product(Arc::new([self.clone(), other.clone()])),
        }
    }
}

impl Div for &Coefficient {
    type Output = Coefficient;

    fn div(self, other: Self) -> Coefficient {
        use Coefficient::{Number, Quotient};
        match (self, other) {
            (Number(a), Number(b)) => Number(a / b),
            _ => Quotient(Arc::new([self.clone(), other.clone()])),
        }
    }
}
