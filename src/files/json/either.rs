//! Values that are written as a scalar or as an object, read without losing the place of an error.

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

use crate::files::json::wording::beside;

/// A type that is read from one scalar, or from an object.
pub(crate) trait ScalarOrObject<'de>: Sized {
    /// Both, for messages.
    const EXPECTED: &'static str;
    /// Type of the scalar.
    type Scalar: Deserialize<'de>;
    /// Type of the object.
    type Object: Deserialize<'de>;

    /// Makes the value from the scalar.
    fn scalar(scalar: Self::Scalar) -> Self;

    /// Makes the value from the object.
    fn object(object: Self::Object) -> Self;
}

/// Visits the scalar or the object, so that paths and messages of both survive.
pub(crate) struct Either<T>(pub(crate) PhantomData<T>);

impl<'de, T: ScalarOrObject<'de>> Visitor<'de> for Either<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        let read = T::Scalar::deserialize(text.into_deserializer());
        read.map(T::scalar).map_err(|error: E| {
            // A word alone is not all that may stand here.
            beside(&error.to_string(), T::EXPECTED).map_or(error, E::custom)
        })
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
        T::Scalar::deserialize(number.into_deserializer()).map(T::scalar)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<T, E> {
        self.visit_f64(number as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
        T::Object::deserialize(MapAccessDeserializer::new(map)).map(T::object)
    }
}

/// Reads a type by [`Either`].
macro_rules! scalar_or_object {
    ($($type:ty: $scalar:ty = $from_scalar:expr, $object:ty = $from_object:expr, $expected:literal;)*) => {
        $(
            impl<'de> ScalarOrObject<'de> for $type {
                const EXPECTED: &'static str = $expected;
                type Scalar = $scalar;
                type Object = $object;

                fn scalar(scalar: $scalar) -> Self {
                    $from_scalar(scalar)
                }

                fn object(object: $object) -> Self {
                    $from_object(object)
                }
            }

            impl<'de> Deserialize<'de> for $type {
                fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                    deserializer.deserialize_any(Either(PhantomData))
                }
            }
        )*
    };
}

pub(crate) use scalar_or_object;
