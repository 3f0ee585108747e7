//! Laws: formulas whose constants are functions of free parameters.

use crate::energy::{Coefficient, Energy};
use crate::math::{Number, Vector};
use nalgebra::Vector3;

/// Constants that are functions of free parameters.
pub trait Constants: Clone + Send + Sync + 'static {
    /// The same constants as numbers.
    type Over<T: Number>;

    /// The numbers at parameters.
    fn with<T: Number>(&self, parameters: &[T]) -> Self::Over<T>;
}

/// A formula of `M` arguments whose constants are functions of parameters.
pub trait Law<const M: usize>: Clone + Send + Sync + 'static {
    /// The formula, of constants and arguments that are numbers `T`.
    type Formula<T: Number>: Energy<M, T>;

    /// The formula at parameters.
    fn formula<T: Number>(&self, parameters: &[T]) -> Self::Formula<T>;
}

impl Constants for Coefficient {
    type Over<T: Number> = T;

    fn with<T: Number>(&self, parameters: &[T]) -> T {
        self.at(parameters)
    }
}

impl Constants for Vector3<Coefficient> {
    type Over<T: Number> = Vector3<T>;

    fn with<T: Number>(&self, parameters: &[T]) -> Vector3<T> {
        Vector3::from_fn(|i, _| self[i].at(parameters))
    }
}

impl Constants for Vector {
    type Over<T: Number> = Self;

    fn with<T: Number>(&self, _: &[T]) -> Self {
        *self
    }
}

/// Makes a formula of `M` arguments a law, by the list of its fields, of which coefficients are functions of parameters; without fields a law
/// of no parameters. `<L>` is a law of elasticity.
macro_rules! law {
    ($name:ident of $arguments:literal) => {
        impl $crate::energy::Law<$arguments> for $name {
            type Formula<T: $crate::math::Number> = Self;

            fn formula<T: $crate::math::Number>(&self, _: &[T]) -> Self {
                *self
            }
        }
    };
    ($name:ident $(<$law:ident>)? { $($field:tt),* } of $arguments:literal) => {
        impl<$($law: $crate::energy::ElasticConstants)?> $crate::energy::Constants
            for $name<$($law,)? $crate::energy::Coefficient>
        {
            type Over<T: $crate::math::Number> = $name<$($law::Over<T>,)? T>;

            fn with<T: $crate::math::Number>(&self, parameters: &[T]) -> Self::Over<T> {
                $name { $($field: self.$field.with(parameters)),* }
            }
        }

        impl<$($law: $crate::energy::ElasticConstants)?> $crate::energy::Law<$arguments>
            for $name<$($law,)? $crate::energy::Coefficient>
        {
            type Formula<T: $crate::math::Number> = $name<$($law::Over<T>,)? T>;

            fn formula<T: $crate::math::Number>(&self, parameters: &[T]) -> Self::Formula<T> {
                $crate::energy::Constants::with(self, parameters)
            }
        }
    };
}
pub(crate) use law;
